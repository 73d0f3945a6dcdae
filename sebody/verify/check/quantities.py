"""Criteria of quantities: tapes against histories, their rates against differences, and back.

Of all quantities that a machine has which is made of every kind of part, in space and in a plane.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.basics.errors import InputError
from sebody.fem import planar_beam, rectangle, straight_beam
from sebody.kernels.tapes import play, play_along, play_back
from sebody.model.control.laws import pid
from sebody.model.model import Model
from sebody.quantities.names import names
from sebody.quantities.reading import Reading, evaluate
from sebody.quantities.symbols import NoTape
from sebody.quantities.table import OF_MODEL, OWNERS
from sebody.reduction.craig_bampton import craig_bampton
from sebody.results.result import Result
from sebody.results.tapes import States
from sebody.runs.simulation import Simulation
from sebody.verify.check.states import STATES, CheckRow

QUANTITIES = "quantities"       # the name by which they are chosen
PREFIX = "quantity "            # of the names of rows
STEP, APART = 1e-3, 12          # of the run, and steps from one state to the next
SHIFT = 1e-5                    # of differences, of the numbers that a tape reads
AWAY = 10.0     # of these, from the state: an open contact is where its force begins
# rounding of both forms, of the largest value or a hundredth; errors of differences; rounding
VALUE, ALONG, TRANSPOSED = "values", "rates against differences", "weights against rates"
LIMITS = {VALUE: 1e-12, ALONG: 1e-7, TRANSPOSED: 1e-12}
LEAST = 1e-2


def machine(planar: bool) -> Model:
    """A hinged beam with a slider, a bead, a rod, a spring, a stop, a motor, and a controller."""
    model = Model(planar=planar)
    n = model.dimension

    def point(*numbers: float) -> tuple[float, ...]:
        return numbers[:n]
    model.gravity(point(0.4, -9.0, 2.0))
    section = rectangle(0.03, 0.02, 2e9, 0.3, 1200.0)
    fe = (planar_beam if planar else straight_beam)(point(0.0, 0.0, 0.0), point(0.8, 0.6, 0.0),
                                                    section, elements=4)
    base, end = (model.node(name, place) for name, place in (
        ("base", point(0.0, 0.0, 0.0)), ("end", point(0.8, 0.6, 0.0))))
    model.superelement("beam", craig_bampton(fe, [(0, "full"), (4, "full")], 2), [base, end])
    ball = model.node("ball", point(1.2, 0.1, 0.2))
    collar = model.node("collar", point(0.2, 0.9, 0.1))
    for name, node, mass in (("bob", ball, 0.7), ("ring", collar, 0.3)):
        model.rigid_body(name, node, mass, 0.01 if planar else 0.01 * np.eye(3))
    if planar:
        model.revolute(base, name="hinge")
    else:
        model.revolute(base, axis=(0.2, 0.3, 1.0), name="hinge")
    model.distance(end, ball, name="rod")
    model.prismatic(end, collar.point - end.point, collar, name="slide")
    model.spring(ball, collar, stiffness=20.0, damping=0.3, name="spring")
    model.stop("hinge", -0.1, 0.01, stiffness=1e3, name="stop")
    model.force(ball, point(0.6, 0.0, 0.8) if not planar else (0.6, 0.8), 2.0, name="push")
    bead = model.node("bead", point(0.4, 0.3, 0.0), "translation")
    model.point_mass("bead mass", bead, 0.1)
    model.path("rail", on="beam")
    model.path_joint(bead, "rail", name="runs")
    model.actuator("motor", joint="hinge")
    model.sensor("seen", "hinge.rate", rate=500.0)
    model.controller("loop", pid(2.0, 0.5, 0.1, 50.0), ["hinge.angle"], ["motor"], 0.002)
    return model


class Taped(NamedTuple):
    """A quantity with its tape."""

    name: str
    reading: Reading
    shape: tuple[int, ...]


def check_quantities() -> list[CheckRow]:
    """All criteria of all quantities that have tapes, by kinds of owners, each with its worst."""
    rows = []
    for planar in (False, True):
        run = Simulation(machine(planar), STEP)
        start, taped = run.state.now.copy(), []
        for state in range(STATES):
            run.run_to((state + 1) * APART * STEP)
            result = run.result()
            taped = taped or _taped(run, result, start)
            rows += _checked(run, result, taped, planar, state)
    return rows


def _taped(run: Simulation, result: Result, start: NDArray) -> list[Taped]:
    found = []
    for name in names(result):
        states = States(run.model, run.numbering, run.system, run.state, start)
        try:
            shape = states.put(name)
        except NoTape:
            continue
        found.append(Taped(name, states.reading(), shape))
    return found


def _checked(run: Simulation, result: Result, taped: list[Taped], planar: bool, state: int
             ) -> list[CheckRow]:
    """Criteria in one state."""
    worst: dict[tuple[str, str], float] = {}
    for one in taped:
        if evaluate(run.system, run.state, one.reading):
            raise InputError(f"{one.name} cannot be evaluated in the check's state {state}")
        random = np.random.default_rng(state)
        for criterion, error in ((VALUE, _value(one, result[one.name])),
                                 *_derivatives(one.reading, random)):
            key = _kind(result, one.name) + " in a plane" * planar, criterion
            worst[key] = max(worst.get(key, 0.0), error)
    return [CheckRow(PREFIX + kind, criterion, state, error, None, LIMITS[criterion])
            for (kind, criterion), error in worst.items()]


def _kind(result: Result, name: str) -> str:
    """Kind of the owner of a quantity, and its name without the owner."""
    if name in OF_MODEL:
        return name
    owner, _, quantity = name.rpartition(".")
    kind = next(one.kind for one in OWNERS
                if quantity in one.quantities and owner in one.names(result))
    return f"{kind}: {quantity}"


def _value(one: Taped, history: NDArray) -> float:
    """The tape against the history in a result, in the last state of this."""
    size = max(LEAST, np.abs(history).max(initial=0.0))
    return float(np.abs(one.reading.values.reshape(one.shape) - history[-1]).max(initial=0.0)
                 / size)


def _derivatives(read: Reading, random: np.random.Generator) -> list[tuple[str, float]]:
    """Rates of a tape along a direction against differences; weights followed back to the same."""
    at, outputs = read.inputs[:, 0], read.outputs
    point = read.numbers[at].copy()
    direction = random.normal(size=at.size) * np.maximum(np.abs(point), 1.0)
    tape = read.steps, read.factors, read.weights

    def moved(by: float) -> NDArray:
        numbers = read.numbers.copy()
        numbers[at] = point + by * direction
        play(*tape, numbers)
        return numbers
    known = moved(AWAY * SHIFT)
    rates = np.zeros(known.size)
    rates[at] = direction
    play_along(*tape, known, rates)
    along = rates[outputs]
    size = max(np.abs(along).max(initial=0.0), np.abs(known[outputs]).max(initial=0.0), LEAST)
    by_differences = (moved((AWAY + 1) * SHIFT) - moved((AWAY - 1) * SHIFT))[outputs] / (2 * SHIFT)
    weights, bars = random.normal(size=outputs.size), np.zeros(known.size)
    np.add.at(bars, outputs, weights)
    given = np.abs(weights) @ np.abs(along)
    play_back(*tape, known, bars)
    terms = bars[at] * direction
    given = max(given, np.abs(terms).sum(), LEAST)
    return [(ALONG, float(np.abs(along - by_differences).max(initial=0.0) / size)),
            (TRANSPOSED, float(abs(weights @ along - terms.sum()) / given))]
