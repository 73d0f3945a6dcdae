"""Variable steps of a run: what errors count, the first step, and how stiff friction sticks."""

import numpy as np

from sebody.assembly.numbering import placed, rotational
from sebody.engine.state import State
from sebody.engine.system import System
from sebody.model.extent import extent
from sebody.model.mechanism import Mechanism
from sebody.model.numbering import Numbering
from sebody.runs.planning import Plan
from sebody.runs.tolerance import Tolerance

FIRST_STEP = 1e-3       # of the output grid: first step if nothing is accelerated at the start
USUAL = 1e-3            # relative tolerance at which the output grid says how stiff friction sticks


def natural_step(model: Mechanism, h: float, tolerance: Tolerance, plan: Plan) -> float:
    """Length of the steps that bristles and teeth of gears are stiff for [time].

    Under a force they give way by the square of it, and those that are far stiffer than steps
    resolve break away again when they have just been caught. It falls with the tolerance as steps
    do, so that what bristles give way by falls as the error of the run. Where runs divide a plan,
    it is their usual step.
    """
    if plan.stiff and len(plan.schedule):
        return plan.usual
    return h * min(1.0, (tolerance.least(extent(model)) / USUAL)**(1.0 / 3.0))


def begin_steps(model: Mechanism, system: System, numbering: Numbering, state: State, h: float,
                tolerance: Tolerance, plan: Plan) -> bool:
    """Switch on variable steps; the first step is short against the accelerations.

    Parameters
    ----------
    h : float
        The output grid [time].

    Returns
    -------
    bool
        Whether everything has a size for its error to be relative to; see `tolerance.UNSIZED`.
    """
    n = numbering.free
    coordinates = np.flatnonzero(placed(model, numbering)[:n])
    sizes = system.magnitude[coordinates]
    state.error_weights[coordinates] = 1.0 / tolerance.allowed(
        sizes, rotational(model, numbering)[coordinates])
    bend = np.abs(state.a[:n] * state.error_weights[:n]).max()
    state.clock.chosen = min(h, 0.1 / np.sqrt(bend)) if bend > 0 else FIRST_STEP * h
    state.clock.allowed, state.clock.origin = plan.allowed, state.clock.time
    state.control.held = 1
    state.control.adaptive = 1
    return tolerance.position > 0.0 or bool(np.all(sizes))
