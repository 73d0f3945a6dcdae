"""What `advise` chooses for twelve scenes, against a full search over the same choices.

    python tests/benchmarks/bench_advise.py [--json] [--keep FILE] [SCENE ...]

Errors are measured against the reference model with sixteen times as many steps, extrapolated;
times are the processor's in the quickest of several runs that take turns. With `--keep` scenes that
are done are read from the file, and an interrupted run goes on with the next one.
"""

import argparse
import json
import re
import statistics
import sys
import time
from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np

from sebody.basics.errors import SebodyError
from sebody.basics.files import replacing
from sebody.explore.advice import Advice, advise
from sebody.explore.advice.changes import Step
from sebody.verify.chart.timing import poor_variants, processor_seconds, repeated

sys.path.insert(0, str(Path(__file__).parent))
from advice_scenes import SCENES, AdviceScene
from brute_force import BruteForce, Found, begun

TOLERANCES = (1e-2, 1e-3)
QUICKEST = 4        # choices of the full search whose times are measured again
FACTORS = 3.0, 0.1  # predicted over confirmed error: within the first either way, never below


def measured(scene: AdviceScene, tolerances: Sequence[float] = TOLERANCES) -> dict:
    """All numbers of a scene."""
    full = BruteForce(scene.build(), scene.quantities, scene.h, scene.t_end)
    full.explore(max(tolerances))
    found = {f"{tolerance:g}": _against(scene, full, tolerance) for tolerance in tolerances}
    return {"tuning": scene.tuning, "forms": [len(part.forms) for part in full.parts],
            "steps": len(full.steps), "exact": full.exact, "reference": full.own_error,
            "tolerances": found}


def _against(scene: AdviceScene, full: BruteForce, tolerance: float) -> dict:
    """Advice at a tolerance beside the full search."""
    sure, lucky, count = full.cheapest(tolerance)
    passing = [*sure[:QUICKEST], *lucky[:1]]
    try:
        begin = time.thread_time()
        advice = advise(scene.build(), scene.h, scene.t_end, scene.quantities, tolerance)
        worked = time.thread_time() - begin
    except SebodyError as reason:
        return {"refused": str(reason), "least": _told(sure[0]) if sure else None}
    step = _step(advice)
    seconds = _seconds(full, advice, step, passing)
    detailed = seconds["detailed"]
    best = min(sure[:QUICKEST], key=lambda one: seconds[id(one)], default=None)
    least = min(seconds["chosen"], seconds[id(best)] if best else np.inf)
    luck = min([least, *(seconds[id(one)] for one in passing)])
    return {
        "chosen": [*advice.changes, f"step {step}"],
        "predicted": advice.predicted, "confirmed": advice.error,
        "measured": full.error_of(advice.model, step),
        "seconds": seconds["chosen"], "least seconds": least, "by luck": luck,
        "least": _told(best) if best else None, "choices run": count,
        "detailed": detailed, "given": seconds["given"],
        "search": sum(one.seconds for one in advice.table) / advice.table[0].seconds,
        "runs": len(advice.table), "search with set-up": worked / detailed,
        "trials": [one.predicted / one.error for one in advice.table
                   if one.kind not in ("reference", "given") and 0 < one.error < np.inf]}


def _step(advice: Advice) -> Step:
    """Steps of the advised run, fixed or variable."""
    chosen = next(one for one in reversed(advice.table)
                  if (one.error, one.step) == (advice.error, advice.step))
    return Step(advice.step, chosen.local)


def _seconds(full: BruteForce, advice: Advice, step: Step, passing: list[Found]) -> dict:
    """Times of runs that take turns, by what they are of."""
    models = {"chosen": (advice.model, step), "detailed": (full.builder.make(full.detailed).model,
                                                          full.fine),
              "given": (full.model, Step(full.h))}
    models |= {id(one): (full.builder.make(one.choice).model, one.choice.step)
               for one in passing}
    with poor_variants():
        times = repeated([lambda own=own: processor_seconds(begun(*own, full.h), full.t_end)
                          for own in models.values()])
    return {name: one.quickest for name, one in zip(models, times, strict=True)}


def _told(found: Found) -> list[str]:
    """A choice in words."""
    return [*("rigid" if form.rigid else f"{form.bodies} x {form.modes} modes {form.inertia}"
              + "+" * form.stiffening for form in found.choice.forms),
            f"step {found.choice.step}"]


def ratios(found: dict) -> dict:
    """How good all the choices are."""
    rows = [row for one in found.values() for row in one["tolerances"].items()]
    cases = [row for _, row in rows if "refused" not in row]
    predictions = [row["predicted"] / row["confirmed"] for row in cases]
    trials = [ratio for row in cases for ratio in row["trials"]]
    return {
        "cases": len(rows), "refused": len(rows) - len(cases),
        "within the tolerance": sum(row["measured"] <= float(tolerance) for tolerance, row in rows
                                    if "refused" not in row),
        "time within twice the least": sum(row["seconds"] <= 2 * row["least seconds"]
                                           for row in cases),
        "time over the least, median and most": _spread(
            row["seconds"] / row["least seconds"] for row in cases),
        "the same over the least by luck": _spread(
            row["seconds"] / row["by luck"] for row in cases),
        "search, in runs of the reference, median and most": _spread(
            row["search"] for row in cases),
        "the same with set-up of models": _spread(row["search with set-up"] for row in cases),
        "predicted over confirmed within 3": _share(predictions),
        "smallest predicted over confirmed": min(predictions, default=np.nan),
        "the same of all trials": _share(trials),
        "smallest of all trials": min(trials, default=np.nan)}


def _spread(values: Iterable[float]) -> list[float]:
    found = sorted(values)
    return [statistics.median(found), found[-1]] if found else []


def _share(predictions: list[float]) -> float:
    within = [1 / FACTORS[0] <= one <= FACTORS[0] for one in predictions]
    return sum(within) / max(len(within), 1)


def table(found: dict) -> str:
    """The page's tables."""
    lines = ["| scene | tolerance | chosen | error predicted / confirmed / measured | ms, of that "
             "the least | least of all | search, runs of the reference: loop / all | reference, "
             "given "
             "ms |", "|---|---|---|---|---|---|---|---|"]
    for name, one in found.items():
        star = "" if one["tuning"] else " *"
        for tolerance, row in one["tolerances"].items():
            if "refused" in row:
                lines.append(f"| {name}{star} | {tolerance} | refused: {row['refused']} | | | "
                             f"{_joined(row['least'])} | | |")
                continue
            lines.append(
                f"| {name}{star} | {tolerance} | {'; '.join(map(_short, row['chosen']))} | "
                f"{row['predicted']:.1e} / {row['confirmed']:.1e} / {row['measured']:.1e} | "
                f"{1e3 * row['seconds']:.2f}, x {row['seconds'] / row['least seconds']:.1f} | "
                f"{_joined(row['least'])} | {row['search']:.1f} / "
                f"{row['search with set-up']:.0f} | "
                f"{1e3 * row['detailed']:.0f}, {1e3 * row['given']:.1f} |")
    return "\n".join([*lines, "", *(f"* {what}: {_number(value)}"
                                    for what, value in ratios(found).items())])


def _short(sentence: str) -> str:
    """A change without its numbers."""
    return re.sub(r" instead of [^,;]*", "", sentence.partition(":")[0].partition("; the first")[0])


def _joined(choice: list[str] | None) -> str:
    return "; ".join(choice) if choice else "none"


def _number(value: object) -> str:
    if isinstance(value, list):
        return ", ".join(map(_number, value))
    return f"{value:.2g}" if isinstance(value, float) else str(value)


def main(arguments: list[str] | None = None, scenes: Iterable[AdviceScene] = SCENES) -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("scenes", nargs="*", metavar="SCENE", help="all of them by default")
    parser.add_argument("--json", action="store_true", help="all numbers")
    parser.add_argument("--keep", type=Path, metavar="FILE.json",
                        help="where scenes that are done are kept")
    options = parser.parse_args(arguments)
    kept = (json.loads(options.keep.read_text(encoding="utf-8"))
            if options.keep and options.keep.exists() else {})
    found = {}
    for scene in scenes:
        if options.scenes and scene.name not in options.scenes:
            continue
        begin = time.perf_counter()
        found[scene.name] = kept[scene.name] if scene.name in kept else measured(scene)
        if options.keep:
            with replacing(options.keep, "numbers") as file:
                file.write(json.dumps({**kept, **found}).encode())
        print(f"{scene.name}: {time.perf_counter() - begin:.0f} s", file=sys.stderr, flush=True)
    print(json.dumps(found) if options.json else table(found))


if __name__ == "__main__":
    main()
