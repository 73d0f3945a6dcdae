"""Static equilibrium under loads applied in steps, also in a steadily rotating frame."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sebody.assembly.evaluation import evaluate
from sebody.basics import inputs, memory
from sebody.basics.errors import InputError, SimulationError
from sebody.contract.layout import FIELD, RECORD_T, RESIDUAL
from sebody.engine.evaluate import set_loads
from sebody.model.arguments import known
from sebody.model.model import Model
from sebody.model.parts import Node
from sebody.results.postprocessing import Forces
from sebody.results.result import Result
from sebody.results.static_summary import static_residuals
from sebody.runs.bearing_speeds import copied_for_reading, read_tables
from sebody.runs.loading import CHOICES, Loading
from sebody.runs.rotating_frame import Spin
from sebody.runs.settling import pace
from sebody.runs.simulation import Standstill
from sebody.runs.tuning import unbend
from sebody.runs.turning_parts import parts_of

TOLERANCE = 1e-11           # of the last correction, by default
STICKING = 1e-7             # of extents: by which the loads move what sticks, no more


def equilibrium(model: Model, steps: int = 10, t: float = 0.0, tolerance: float = TOLERANCE,
                spin: ArrayLike | None = None, unstable: str = "leave",
                hub: Node | str | None = None) -> Result:
    """Equilibrium under gravity and the loads of a time, applied in equal steps.

    Points that slide freely along paths are held where they start until all loads are applied, then
    let go: the last state is where they come to rest.

    Parameters
    ----------
    steps : int
        Load steps; divided where Newton's iteration does not converge.
    t : float
        Time at which the time functions of the loads are evaluated [time].
    tolerance : float
        Of the last correction, relative to the model's characteristic length or in radians.
    spin : (3,) array_like or float, optional
        Angular velocity of a steady rotation about an axis through the origin [1/time]; a number
        in a plane. What the model lets turn freely about this axis turns, with all that bodies,
        links, welds or gears tie to it, and the rest stands. Where nothing turns by itself,
        everything rests in a frame that turns, fixed nodes, supports and loads included.
    unstable : {"leave", "keep"}
        What becomes of a state that is not stable, as of a column above its buckling load: it is
        left for a stable one, which the structure moves to, or kept, with a warning. Nothing is
        said of stability where loads or friction leave no potential (the tangent is not symmetric),
        or in a rotating frame.
    hub : Node or str, optional
        With a spin: a node on the axis of what turns, which need not go through the origin.

    Returns
    -------
    Result
        One row a load step; its time is the share of the load, from 0 to 1. Velocities and
        accelerations are those of the rotation. Its `stability` says whether the last state is
        stable, and at which share of the load an unstable one was left or kept.

    Raises
    ------
    InputError
        Not a positive number of steps, a spin of the wrong shape, or one outside a bearing's table,
        a hub that does not turn.
    SimulationError
        No equilibrium is found, or one that only the model has, in which bodies without geometric
        stiffening fold up under tension; what was found before is in its `result`.
    """
    steps = inputs.integer(steps, "steps", least=1)
    t = inputs.number(t, "t")
    tolerance = inputs.number(tolerance, "tolerance", above=0, below=1)
    unstable = inputs.choice(unstable, "unstable", CHOICES)
    model = inputs.instance(model, "model", Model, "give a sebody.Model")
    _refuse_states(model)
    given = Spin.of(model, spin)
    own = None if hub is None else known(model, hub).name
    model = copied_for_reading(model)
    axle = None if own is None else model.nodes[own]
    whole = parts_of(model, given, axle) if given.rotates else given
    read_tables(model, whole)
    return _equilibrium(at_rest(model, t), whole, steps, tolerance, unstable)


def steady_rotation(model: Model, steps: int, spin: Spin) -> Result:
    """Equilibrium of a steady rotation of everything, or of the parts that the spin has.

    Raises
    ------
    SimulationError
        As `equilibrium`.
    """
    steps = inputs.integer(steps, "steps", least=1)
    _refuse_states(model)
    return _equilibrium(at_rest(model, 0.0), spin, steps, TOLERANCE, "leave")


def _equilibrium(run: Standstill, spin: Spin, steps: int, tolerance: float, unstable: str
                 ) -> Result:
    memory.check(8.0 * steps * run.state.now.size, f"steps is {steps}: the record of all",
                 "give fewer")
    path = Loading(run, spin, steps, tolerance, unstable == "keep")
    try:
        path.follow()
    except SimulationError as error:
        error.result = _result(run, path)
        raise
    return _result(run, path)


def at_rest(model: Model, t: float) -> Standstill:
    """The model as built, with all of the loads of a time and without rates."""
    run = _still(Standstill(model, 1.0), t)
    if not any(load.tuned for load in model.loads):
        # what nothing presses does not stick
        run.state.q[run.system.is_multiplier[:run.state.q.size] > 0] = 0.0
        return run
    # bristles as stiff as loads move the model by this in a step: of its own time, not of units
    still = Spin.of(run.model, None)
    squares = [pace(run, still)]
    run.state.loads[:], run.state.coefficients[FIELD:] = 0.0, 0.0       # but springs pull
    squares.append(pace(run, still))
    square = max(squares)
    return _still(Standstill(model, np.sqrt(STICKING / square) if 0.0 < square < np.inf else 1.0),
                  t)


def _still(run: Standstill, t: float) -> Standstill:
    """Without rates and bent bristles, with the loads of a time."""
    unbend(run.model, run.numbering, run.state)
    state = run.state
    state.v[:], state.a[:], state.aux[:] = 0.0, 0.0, 0.0
    set_loads(run.system, state.frames, state.loads, t)
    return run


def _refuse_states(model: Model) -> None:
    """Refuse continuous controllers with states, which have no value at rest before they rest."""
    for one in model.controllers.values():
        if not one.period and one.states.size:
            raise InputError(f"controller {one.name!r} is continuous and has states, which an "
                             "equilibrium does not solve for: run the model until it rests, or "
                             "give the controller a law without states")


def _result(run: Standstill, path: Loading) -> Result:
    stability = path.verdict()
    if stability.startswith("unstable"):
        since = f" ({'; '.join(path.notes)})" * bool(path.notes)
        run.watch.say("stability", f"the equilibrium is unstable{since}: a disturbance lets it "
                      "move away" + "; unstable='leave' looks for a stable one" * path.keep)
    run.watch.look(run.model, run.numbering, run.rows.all())
    results = run.result()
    results.stability = stability
    results.forces = _forces(run, results.unique_rows, path)
    results.constraint_residuals = static_residuals(results)
    return results


def _forces(run: Standstill, rows: NDArray, path: Loading) -> Forces:
    """Forces under the share of the load of each row; the time in a row is that share."""
    state, forces = run.state, []
    kept = [array.copy() for array in (state.now, state.loads, state.coefficients)]
    for row in rows:
        state.now[:] = row
        path.load(row[RECORD_T])
        evaluate(run.system, state, RESIDUAL, RESIDUAL, "a load step")
        forces.append((state.g.copy(), state.residual.copy()))
    state.now[:], state.loads[:], state.coefficients[:] = kept
    return Forces(*(np.array(values) for values in zip(*forces, strict=True)))
