"""What the word of `advise` is worth: its first try at scenes, against exact beams.

    python tests/benchmarks/bench_trust.py [--json] [--keep FILE] [--singles] [SCENE ...]

Of every scene and tolerance: whether it is answered as an engineer would ask first, what is
confirmed and what the error is against beams of many bodies with an eighth of the step and less,
the time against the least of a grid, the work of the search, and how good predictions of single
forms are. With `--keep` scenes that are done are read from the file; with `--singles` only
predictions are looked at.
"""

import argparse
import json
import statistics
import sys
import time
import warnings
from collections.abc import Iterable, Iterator
from pathlib import Path

import numpy as np

from sebody import LimitWarning, Model
from sebody.analysis import equilibrium
from sebody.basics.errors import SebodyError
from sebody.basics.files import replacing
from sebody.explore.advice.changes import Choice, Step
from sebody.explore.advice.estimates import expected
from sebody.explore.advice.first_runs import LONGER, run_first
from sebody.explore.advice.forms import Form, alike
from sebody.explore.advice.limits import include, refusal
from sebody.explore.advice.quantities import Quantities, Values, compared
from sebody.explore.advice.reference import Reference, reference
from sebody.explore.advice.report import conclusion
from sebody.explore.advice.runner import FINER, Laboratory
from sebody.explore.advice.runs import Runs
from sebody.explore.advice.search import Search
from sebody.model.variants import divide
from sebody.runs.simulation import Simulation
from sebody.runs.tolerance import Tolerance
from sebody.verify.chart.timing import poor_variants, processor_seconds, repeated

sys.path.insert(0, str(Path(__file__).parent))
from advice_general import GENERAL
from advice_scenes import SCENES, AdviceScene

TOLERANCES = (1e-2, 1e-3)
BUDGET = 20.0
EXACT = (4, 8, 16)      # steps of the truth in one given step
CLOSE = 1.5             # times the chosen one's time, up to which others are timed again
TIMED = 6               # of those
MOST = 40               # that run at all, evenly over the grid by their predicted times
SAME = 1.01             # factor by which errors against two references may differ
FLOOR = 0.01            # of the tolerance: smaller errors are alike
TEN = 10.0
GRID = ((1, 0, "b", False), (1, 1, "b", False), (1, 2, "c", True), (1, 4, "c", True),
        (2, 0, "b", False), (2, 0, "c", True), (4, 0, "c", True), (8, 0, "c", True))


class Truth:
    """Exact beams of a scene: many bodies with exact inertia and stiffening, short steps."""

    def __init__(self, scene: AdviceScene):
        self.scene, self.quantities = scene, Quantities(scene.quantities)
        model = scene.build()
        self.quantities.check(model, scene.h)
        for name, elements in [(beam.name, beam.elements) for beam in model.beams]:
            bodies = max(scene.exact, elements)
            model = divide(model, name, bodies, 2 * bodies, modes=0, inertia="floating_field",
                           stiffening=True).model
        runs = [self.values(model, Step(scene.h / k)) for k in EXACT]
        self.reference: Reference = reference(runs)

    def begun(self, model: Model, step: Step) -> Simulation:
        """A run, recorded on the scene's grid or on longer steps."""
        every = max(round(self.scene.h / step.h), 1)
        local = None if step.local is None else Tolerance(step.local)
        start = equilibrium(model) if self.scene.start else None
        return Simulation(model, step.h, output_every=every, tolerance=local, start=start)

    def values(self, model: Model, step: Step) -> Values:
        """The quantities of a run."""
        with poor_variants():
            result = self.begun(model, step).run_to(self.scene.t_end).result()
        every = max(round(self.scene.h / step.h), 1)
        return self.quantities.of(result, step.h * every, self.scene.h)

    def error(self, model: Model, step: Step) -> float:
        """Of a model, against the exact beams; infinite if it does not run."""
        try:
            values = self.values(model, step)
        except SebodyError:
            return np.inf
        stride = max(round(step.h / self.scene.h), 1)
        return compared(values, self.reference.values, self.reference.sizes, (1, stride)).error


def laboratory(scene: AdviceScene, tolerance: float) -> Laboratory:
    """As `advise` begins: its reference is there."""
    wanted, model = Quantities(scene.quantities), scene.build()
    wanted.check(model, scene.h)
    lab = Laboratory(model, wanted, Runs(wanted, scene.h, scene.t_end, None,
                                         scene.start is not None), tolerance)
    run_first(lab)
    include(lab)
    return lab


def measured(scene: AdviceScene) -> dict:
    """All numbers of a scene."""
    truth = Truth(scene)
    found = {f"{tolerance:g}": _advised(scene, truth, tolerance) for tolerance in TOLERANCES}
    return {"truth": truth.reference.error, "tolerances": found,
            "singles": singles(scene, max(TOLERANCES))}


def _advised(scene: AdviceScene, truth: Truth, tolerance: float) -> dict:
    """Advice at a tolerance, beside exact beams and a grid."""
    try:
        lab = laboratory(scene, tolerance)
    except SebodyError as reason:
        return {"refused": str(reason)}
    search = Search(lab, BUDGET)
    found, given = search.go(), lab.given()
    work, guarded, runs = lab.spent(), lab.guarded, lab.count
    advice = conclusion(search, found, given)
    row = {"chosen": [*advice.changes, f"step {found.choice.step}"], "error": advice.error,
           "predicted": advice.predicted, "confirmed": advice.confirmed, "doubt": advice.doubt,
           "true": truth.error(advice.model, found.choice.step), "work": work - guarded,
           "guards": guarded, "runs": runs, "refused": refusal(search, found)}
    if not row["refused"]:
        row |= _times(lab, truth, found.choice, tolerance)
    return row


def _times(lab: Laboratory, truth: Truth, chosen: Choice, tolerance: float) -> dict:
    """Time of a choice, and the least of a grid of others that are good enough."""
    passing, limit = [], CLOSE * lab.cost.of(chosen)
    others = sorted((one for one in dict.fromkeys(_grid(lab, chosen))
                     if one != chosen and lab.cost.of(one) <= limit), key=lab.cost.of)
    for k in np.unique(np.linspace(0, len(others) - 1, MOST).round()) if others else ():
        choice = others[int(k)]
        try:
            model = lab.builder.build(choice)
        except SebodyError:
            continue
        if max(truth.error(model, one) for one in (choice.step, choice.step.finer())) <= tolerance:
            with poor_variants():
                passing.append((processor_seconds(truth.begun(model, choice.step),
                                                  truth.scene.t_end), choice))
    best = [chosen, *(choice for _, choice in sorted(passing, key=lambda one: one[0])[:TIMED])]
    with poor_variants():
        times = repeated([lambda one=one: processor_seconds(
            truth.begun(lab.builder.build(one), one.step), truth.scene.t_end) for one in best])
    seconds = [one.quickest for one in times]
    least = int(np.argmin(seconds))
    return {"seconds": seconds[0], "least": seconds[least], "grid": len(passing),
            "least choice": [_told(form) for form in best[least].forms][:4]
            + [f"step {best[least].step}"]}


def _grid(lab: Laboratory, chosen: Choice) -> Iterator[Choice]:
    """All parts alike, in some forms; and the chosen forms with those of one group changed."""
    h, count = lab.runs.h, round(lab.runs.t_end / lab.runs.h)
    steps = [Step(k * h) for k in LONGER if count % k == 0] + [
        Step(h / k) for k in (*FINER, 8, 16)] + [chosen.step]
    for step in steps:
        yield chosen._replace(step=step)
        for wanted in (None, *GRID):
            yield chosen._replace(step=step, forms=tuple(
                _nearest(part.forms, wanted, form) for part, form in zip(
                    lab.parts, chosen.forms, strict=True)))
    for group in alike(lab.parts):
        for form in lab.parts[group[0]].forms:
            yield chosen._replace(forms=tuple(
                form if k in group else one for k, one in enumerate(chosen.forms)))


def _nearest(forms: Iterable[Form], wanted: tuple | None, otherwise: Form) -> Form:
    """A form of a part by its bodies, modes, inertia and stiffening; rigid if none is wanted."""
    for form in forms:
        if form.rigid if wanted is None else not form.rigid and form[1:5] == wanted:
            return form
    return otherwise


def singles(scene: AdviceScene, tolerance: float) -> list[dict]:
    """Predicted and measured errors of single forms, beside the reference forms of the others."""
    try:
        lab = laboratory(scene, tolerance)
    except SebodyError:
        return []
    base, found = Search(lab, BUDGET).base, []
    for k, *_ in alike(lab.parts):
        part = lab.parts[k]
        for wanted in (None, *GRID):
            form = _nearest(part.forms, wanted, part.detailed)
            if form == part.detailed:
                continue
            choice = base._replace(forms=tuple(
                form if k == i else one for i, one in enumerate(base.forms)))
            try:
                error = lab.apart(lab.run(choice), base.step.h)
            except SebodyError:
                continue
            found.append({"part": part.name, "form": _told(form), "measured": error,
                          "predicted": expected(lab.estimates.of_form(k, form)),
                          "by": lab.estimates.raw(k, form), "tolerance": tolerance})
    return found


def _told(form: Form) -> str:
    return "rigid" if form.rigid else (
        f"{form.bodies} x {form.modes} {form.inertia}" + "+" * form.stiffening)


def _off(one: dict) -> float:
    """Factor by which a prediction is off; errors far below the tolerance, and above all, alike."""
    a, b = (min(max(one[name], FLOOR * one["tolerance"]), 1.0) for name in ("predicted",
                                                                            "measured"))
    return a / b


def shares(found: dict) -> dict:
    """What the issue asks for."""
    rows = [(float(tolerance), row) for one in found.values()
            for tolerance, row in one.get("tolerances", {}).items()]
    answered = [(tolerance, row) for tolerance, row in rows if not row["refused"]]
    sure = [(tolerance, row) for tolerance, row in answered if row["confirmed"]]
    off = [_off(one) for scene in found.values() for one in scene["singles"]]
    ratio = [row["seconds"] / row["least"] for _, row in answered]
    work = [row["work"] for _, row in answered]
    return {
        "cases": len(rows), "answered at the first try": len(answered), "confirmed": len(sure),
        "confirmed, and true error within the tolerance": sum(
            row["true"] <= tolerance for tolerance, row in sure),
        "confirmed, and true error at most that, to 1 % and the truth's own error": sum(
            row["true"] <= SAME * row["error"] + one["truth"] for one in found.values()
            for row in one.get("tolerances", {}).values()
            if not row["refused"] and row["confirmed"]),
        "true over confirmed error, most": max(
            (row["true"] / row["error"] for _, row in sure), default=np.nan),
        "not confirmed, and true error above the tolerance": sum(
            row["true"] > tolerance for tolerance, row in answered if not row["confirmed"]),
        "time within 1.5 of the least of the grid": sum(one <= 1.5 for one in ratio),
        "time over the least, median and most": _spread(ratio),
        "work of the search beyond guards, in runs of the reference model, median and most": (
            _spread(work)),
        "single forms": len(off),
        "predicted within ten": sum(1 / TEN <= one <= TEN for one in off) / max(len(off), 1),
        "worst predictions": [min(off, default=np.nan), max(off, default=np.nan)]}


def _spread(values: list[float]) -> list[float]:
    return [statistics.median(values), max(values)] if values else []


def table(found: dict) -> str:
    """The page's table."""
    lines = ["| scene | tolerance | chosen | confirmed | true error (of the truth itself) | time "
             "over the least | search, guards: runs of the reference model |",
             "|---|---|---|---|---|---|---|"]
    for name, one in found.items():
        for tolerance, row in one.get("tolerances", {}).items():
            if "chosen" not in row or row["refused"]:
                lines.append(f"| {name} | {tolerance} | refused: {row['refused'][:160]} | | | | |")
                continue
            kept = row["chosen"] if len(row["chosen"]) < 6 else [
                f"{len(row['chosen']) - 1} changes", row["chosen"][-1]]
            sure = f"{row['error']:.1e}" if row["confirmed"] else (
                f"not: {row['error']:.1e}, reference {row['doubt']:.1e}")
            lines.append(
                f"| {name} | {tolerance} | {'; '.join(text.partition(':')[0] for text in kept)} | "
                f"{sure} | {row['true']:.1e} ({one['truth']:.0e}) | "
                f"{row['seconds'] / row['least']:.2f} | {row['work']:.1f}, {row['guards']:.1f} |")
    return "\n".join([*lines, "", *(f"* {what}: {_number(value)}"
                                    for what, value in shares(found).items())])


def _number(value: object) -> str:
    if isinstance(value, list):
        return ", ".join(map(_number, value))
    return f"{value:.2g}" if isinstance(value, float) else str(value)


def _plain(value: object) -> object:
    """A number of NumPy as one of Python."""
    return value.item()


def main(arguments: list[str] | None = None,
         scenes: Iterable[AdviceScene] = (*SCENES, *GENERAL)) -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("scenes", nargs="*", metavar="SCENE", help="all of them by default")
    parser.add_argument("--json", action="store_true", help="all numbers")
    parser.add_argument("--singles", action="store_true", help="predictions alone")
    parser.add_argument("--keep", type=Path, metavar="FILE.json",
                        help="where scenes that are done are kept")
    options = parser.parse_args(arguments)
    warnings.simplefilter("ignore", LimitWarning)
    kept = (json.loads(options.keep.read_text(encoding="utf-8"))
            if options.keep and options.keep.exists() else {})
    found = {}
    for scene in scenes:
        if options.scenes and scene.name not in options.scenes:
            continue
        begin = time.perf_counter()
        if scene.name in kept:
            found[scene.name] = kept[scene.name]
            continue
        found[scene.name] = ({"singles": singles(scene, max(TOLERANCES))} if options.singles
                             else measured(scene))
        if options.keep:
            with replacing(options.keep, "numbers") as file:
                file.write(json.dumps({**kept, **found}, default=_plain).encode())
        print(f"{scene.name}: {time.perf_counter() - begin:.0f} s", file=sys.stderr, flush=True)
    print(json.dumps(found, default=_plain) if options.json else table(found))


if __name__ == "__main__":
    main()
