"""Velocities a run starts with, without the rounding that the weights of given ones leave.

A run keeps velocities that were given by a heavy mass, which leaves 1e-9 of them as noise: too much
for differences over small changes of a parameter. Here they are held, and all others change least
in the norm of kinetic energy:

    M dv + Phi^T mu = 0,   Phi dv = -phidot(v given)        of coordinates that are not given
"""

import numpy as np
from numpy.typing import NDArray

from sebody.assembly.allocation import allocate
from sebody.assembly.evaluation import evaluate, matrix
from sebody.contract.layout import RESIDUAL, VELOCITY
from sebody.engine.evaluate import move_prescribed, set_loads, to_body_axes
from sebody.engine.links import place_dependent
from sebody.gradients.factors import Factors, Scales
from sebody.model.numbering import coordinates
from sebody.runs.simulation import Simulation

WHAT = "the start"
SAME = 1e-6         # of the largest velocity: what is further off was fitted otherwise


def fitted_rates(made: Simulation) -> NDArray:
    """Velocities of the unknowns at the start of a simulation, (n,)."""
    n, system, model = made.numbering.free, made.system, made.model
    own = made.state.v[:n].copy()
    fixed = system.is_multiplier[:n] > 0
    if not made.start.changed or not fixed.any() or _is_driven(made):
        return own
    state = allocate(model, system, made.numbering, made.h, made.dense)
    set_loads(system, state.frames, state.loads, 0.0)
    move_prescribed(system, state)
    place_dependent(system.links, state.q, state.v, state.a, state.R, state.turns)
    evaluate(system, state, RESIDUAL, VELOCITY, WHAT)
    demand = np.where(fixed, -state.residual[:n], 0.0)
    A = matrix(system, state, WHAT, mass=1.0, damping=0.0, stiffness=0.0, constraint=1.0).toarray()
    known = made.numbering.dof_blocks
    given = [i for t in model.dof_blocks() if t.solved and t.given and t in known
             for i in coordinates(made.numbering, t)]
    A[given], A[:, given] = 0.0, 0.0
    A[given, given] = 1.0
    to_body_axes(system, state.frames, demand, False)
    answer = np.zeros(made.numbering.total)
    # constraints of what is given alone are redundant here
    answer[:n] = Factors(A, Scales(A), fixed, redundant=True).solve(demand[:, None])[:, 0]
    answer[:n][fixed] = 0.0
    to_body_axes(system, state.frames, answer, True)
    found = state.v[:n] + answer[:n]
    return found if np.allclose(found, own, rtol=0.0, atol=SAME * np.abs(own).max()) else own


def _is_driven(made: Simulation) -> bool:
    """Tell whether drives start with a speed: bodies then start in rigid-body motion."""
    ports = {int(port) for port in made.system.prescribed[:, 1]} | {
        made.numbering.ports[one] for joint in made.model.joints for one in joint.constraints
        if one.time_function is not None}
    return any(made.state.loads[3 * port + 1] != 0.0 for port in ports)
