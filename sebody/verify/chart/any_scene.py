"""Charts of any scene: variants on the axes of `advise`, compared with the reference model.

The reference model runs with ever shorter steps and is extrapolated; where it divides beams, half
as many bodies tell what the division leaves. Variants are uniform: all parts of the model get as
many bodies and modes, as far as each can.
"""

from collections.abc import Iterable, Iterator, Sequence
from itertools import chain
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from sebody.basics.errors import InputError, SimulationError
from sebody.engine.state import Scheme
from sebody.explore.advice.changes import Builder, Choice, Step
from sebody.explore.advice.forms import Form, Part, parts_of
from sebody.explore.advice.quantities import (
    FREQUENCY,
    Quantities,
    Values,
    difference,
    parted,
)
from sebody.explore.advice.reference import Reference, reference, still
from sebody.model.model import Model
from sebody.results.result import Result
from sebody.runs.first_run import prepare
from sebody.runs.schemes import generalized_alpha
from sebody.runs.simulation import Simulation
from sebody.runs.tolerance import Tolerance
from sebody.runs.whole_runs import planned_simulation
from sebody.verify.bench import peer
from sebody.verify.chart.advised import FAMILY, Advised, advised
from sebody.verify.chart.cases import STEPS, TOLERANCE, schemes
from sebody.verify.chart.points import Point, Study
from sebody.verify.chart.timing import BARS, Times, poor_variants, processor_seconds, repeated

if TYPE_CHECKING:
    from sebody.scenes.scene import Scene

REFERENCE = (2, 4, 8)       # steps of the reference's runs in a given one
GRID = 4                    # given steps on whose grid histories are compared, where they fit
LOCAL = (1e-2, 1e-3, 1e-4)  # local tolerances of variable steps
ERROR = ("error: largest difference from the reference model at any time, relative to the largest "
         "change of the quantity, never below the reference's own")
DIVISION = 3.0              # errors of second order: differences by halving over what is left


class Plan(NamedTuple):
    """A variant before it runs."""

    family: str
    label: str
    choice: Choice
    scheme: Scheme | None = None


def measure_any(scene: "Scene", quantities: Sequence[str] = (),
                tolerance: float = TOLERANCE) -> list[Study]:
    """Run variants of any scene, and the model that is advised.

    Parameters
    ----------
    scene : Scene
    quantities : sequence of str
        What is compared, see `advise`, each in a study of its own; by default the position of the
        scene's tip, or of the node that moves the farthest.
    tolerance : float
        Of the advice, which keeps all quantities.

    Raises
    ------
    InputError
        A quantity that does not exist or does not change.
    SimulationError
        The reference model does not run.
    """
    with poor_variants():
        return _measured(_Chart(scene, quantities), tolerance)


def _measured(chart: "_Chart", tolerance: float) -> list[Study]:
    exact = chart.reference()
    kept, runs = [], []
    advice = advised(chart.model, chart.h, chart.t_end, chart.names, tolerance)
    chosen = [Plan(FAMILY, advice.label, Choice((), advice.step))] if advice.advice else []
    for plan in [*chosen, *chart.plans()]:
        try:
            model = (advice.advice.model if plan in chosen else
                     chart.builder.make(plan.choice).model)
            values, result = chart.run(model, plan.choice.step, plan.scheme)
            errors = [max(difference(one, best.values, best.sizes, (1, 1)), best.error)
                      for one, best in zip(parted(values), exact, strict=True)]
        except (InputError, SimulationError):
            continue
        kept.append((plan, errors, result))
        runs.append(lambda model=model, plan=plan: processor_seconds(
            chart.simulation(model, plan.choice.step, plan.scheme), chart.t_end))
    times = repeated(runs)
    return [_study(chart, k, best, kept, times, advice, tolerance)
            for k, best in enumerate(exact)]


def _study(chart: "_Chart", k: int, best: Reference, kept: list[tuple], times: list[Times],
           found: Advised, tolerance: float) -> Study:
    """Study of one quantity."""
    points = [Point(plan.family, plan.label, errors[k], one.quickest / chart.t_end,
                    result.numbering.free, plan.choice.step.h, result.iterations_per_step,
                    one.slowest / chart.t_end)
              for (plan, errors, result), one in zip(kept, times, strict=True)]
    choice = next((one for one in points if one.family == FAMILY), None)
    return Study(points, chart.names[k], best.error, choice, tolerance,
                 (ERROR, BARS, found.told, peer.told()))


class _Chart:
    """A scene, its parts and the runs of its variants."""

    def __init__(self, scene: "Scene", quantities: Sequence[str]):
        self.model, self.h = scene.model, scene.h
        count = max(round(scene.t_end / scene.h), 1)
        self.grid = GRID if count >= GRID else 1
        self.t_end = (count - count % self.grid) * scene.h
        wanted = Quantities(list(quantities) or [self._moving(scene.tip)])
        wanted.check(self.model, self.h)
        # histories first, as values have them
        self.names = sorted(wanted.names, key=lambda name: FREQUENCY.fullmatch(name) is not None)
        self.quantities = wanted
        self.parts: list[Part] = parts_of(self.model, self.quantities.owners)
        self.builder = Builder(self.model, self.parts, self.quantities.owners)
        self.given = tuple(part.given for part in self.parts)
        self.detailed = tuple(part.detailed for part in self.parts)

    def _moving(self, tip: str) -> str:
        """The quantity that is compared if none is named."""
        result = self._simulated(self.model, Step(self.h), None)
        ways = {f"{name}.{what}": np.abs(x - x[0]).max() for what in ("position", "rotation")
                for name, node in self.model.nodes.items()
                if getattr(node, what) is not None
                and getattr(node, what) in result.numbering.dof_blocks
                for x in [result[f"{name}.{what}"]]}
        usual = f"{tip}.position"
        if ways.get(usual, 0.0) > 0.0:
            return usual
        farthest = [max((name for name in ways if name.endswith(what)), key=ways.get, default="")
                    for what in ("position", "rotation")]
        moving = [name for name in farthest if ways.get(name, 0.0) > 0.0]
        if not moving:
            raise InputError("nothing moves: give the scene a load, a drive or an initial "
                             "velocity")
        return moving[0]

    def run(self, model: Model, step: Step, scheme: Scheme | None) -> tuple[Values, Result]:
        """The quantities on the chart's grid, and the result they are from."""
        result = self._simulated(model, step, scheme)
        return self.quantities.of(result, self.h), result

    def simulation(self, model: Model, step: Step, scheme: Scheme | None) -> Simulation:
        """A run that begins, recorded on the chart's grid."""
        tolerance = None if step.local is None else Tolerance(step.local)
        return planned_simulation(model, step.h, self.t_end, scheme,
                                  round(self.grid * self.h / step.h), tolerance=tolerance)

    def _simulated(self, model: Model, step: Step, scheme: Scheme | None) -> Result:
        return self.simulation(model, step, scheme).run_to(self.t_end).result()

    def reference(self) -> list[Reference]:
        """The reference model, extrapolated in the step, with what its division leaves.

        One of each quantity.
        """
        models = {bodies: self.builder.make(Choice(forms, Step(self.h))).model
                  for bodies, forms in self._divisions()}
        prepare([*models.values(), self.model])
        whole = models.pop(max(models))
        runs = [self.run(whole, Step(self.h / k), None)[0] for k in REFERENCE]
        for k in still(runs[-1]):
            raise InputError(f"quantity {self.names[k]!r} does not change: give one that the "
                             "motion changes")
        found = [reference(list(one)) for one in zip(*map(parted, runs), strict=True)]
        for half in models.values():
            other, _ = self.run(half, Step(self.h / REFERENCE[-1]), None)
            found = [best._replace(error=best.error + difference(
                         one, fine, best.sizes, (1, 1)) / DIVISION)
                     for best, one, fine in zip(found, parted(other), parted(runs[-1]),
                                                strict=True)]
        return found

    def _divisions(self) -> Iterator[tuple[int, tuple[Form, ...]]]:
        """Forms of the reference model, and with half as many bodies where it divides any."""
        most = max((form.bodies for form in self.detailed), default=1)
        yield most, self.detailed
        if most > 1:
            yield most // 2, tuple(_form(part, most // 2, part.detailed.modes * 2)
                                   for part in self.parts)

    def plans(self) -> list[Plan]:
        """All variants, none twice."""
        by_key: dict[tuple, Plan] = {}
        for plan in chain(self._modes_and_bodies(), self._options(), self._rigid(),
                          self._steps(), self._schemes()):
            by_key.setdefault((plan.choice, plan.scheme), plan)
        return list(by_key.values())

    def _plan(self, family: str, label: str, forms: Iterable[Form],
              step: Step | None = None) -> Plan:
        return Plan(family, label, Choice(tuple(forms), step or Step(self.h)))

    def _modes_and_bodies(self) -> Iterator[Plan]:
        flexible = [form for part in self.parts for form in part.forms if not form.rigid]
        for bodies in sorted({form.bodies for form in flexible}):
            for modes in sorted({form.modes for form in flexible if form.bodies == bodies}):
                yield self._plan("modes" if bodies == 1 else "bodies",
                                 f"{_counted(bodies, 'body')}, {_counted(modes, 'mode')}",
                                 (_form(part, bodies, modes) for part in self.parts))

    def _options(self) -> Iterator[Plan]:
        """The given model with each inertia option, with and without stiffening."""
        for inertia, stiffening in sorted({(form.inertia, form.stiffening) for part in self.parts
                                           for form in part.forms if not form.rigid}):
            name = f"inertia {inertia}" + ", stiffening" * stiffening
            yield self._plan("inertia", name, (
                next((form for form in part.forms if form[1:5] == (
                    part.given.bodies, part.given.modes, inertia, stiffening)), part.given)
                for part in self.parts))

    def _rigid(self) -> Iterator[Plan]:
        """Each part rigid, and all of them."""
        if len(self.parts) > 1:
            for part in self.parts:
                yield self._plan("rigid", f"{part.name} rigid", (
                    _rigid(one) if one is part else one.given for one in self.parts))
        if self.parts:
            yield self._plan("rigid", "all rigid", map(_rigid, self.parts))

    def _steps(self) -> Iterator[Plan]:
        bases = {"as given": self.given, "all rigid": tuple(map(_rigid, self.parts)),
                 "1 body, 0 modes": tuple(_form(part, 1, 0) for part in self.parts),
                 "reference": self.detailed}
        for name, forms in bases.items() if self.parts else [("", ())]:
            for finer, told in STEPS.items():
                if self.grid * finer >= 1.0:
                    yield self._plan("steps", f"{name}, {told}".removeprefix(", "), forms,
                                     Step(self.h / finer))
            for local in LOCAL:
                told = f"{name}, variable step, tolerance {local:g}".removeprefix(", ")
                yield self._plan("steps", told, forms, Step(self.grid * self.h, local))

    def _schemes(self) -> Iterator[Plan]:
        given = Choice(self.given, Step(self.h))
        yield Plan("schemes", "as given", given, generalized_alpha())
        for name, scheme in schemes().items():
            yield Plan("schemes", name, given, scheme)


def _rigid(part: Part) -> Form:
    return next(form for form in part.forms if form.rigid)


def _form(part: Part, bodies: int, modes: int) -> Form:
    """The form of a part with the best options that comes nearest to some bodies and modes."""
    flexible = [form for form in part.forms if not form.rigid
                and form[3:] == part.detailed[3:]]
    return min(flexible, key=lambda form: (abs(form.bodies - bodies), abs(form.modes - modes)))


def _counted(number: int, what: str) -> str:
    ending = "" if number == 1 else "s"
    return f"{number} {what}{ending}".replace("bodys", "bodies")
