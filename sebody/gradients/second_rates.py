"""Derivatives of the second rates of constraints by motion and rates, at restarts.

Differences of second rates that are polynomials of rates and smooth functions of motion: of the
fourth order, at a few states of a run.
"""

import numpy as np
from numpy.typing import NDArray

from sebody.basics.errors import InputError
from sebody.contract.layout import ACCELERATION, OK
from sebody.engine.evaluate import run_kernels, sum_forces
from sebody.engine.links import place_dependent
from sebody.gradients.linear import Linear
from sebody.results import rotations
from sebody.small_motion.moved_states import STEPS, WEIGHTS

STEP = 1e-3         # of differences, of the size of a coordinate or in radians


def second_rates(linear: Linear, fixed: NDArray) -> tuple[NDArray, NDArray]:
    """Second rates of the state that `linear` was evaluated in last, (multipliers, n) each."""
    state, system, n = linear.state, linear.system, linear.free
    by_motion, by_rates = np.zeros((2, int(fixed.sum()), n))
    if not fixed.any():
        return by_motion, by_rates
    now = state.now.copy()
    turning = {int(first) + k: (r, k) for r, first in enumerate(system.rotation_at)
               for k in range(3)}
    speed = max(float(np.abs(state.v).max(initial=0.0)), 1.0)
    for i in np.flatnonzero(~fixed).tolist():
        size = STEP * max(float(system.magnitude[i]), float(np.abs(state.q[:n]).max()) * 1e-3
                          ) if i not in turning else STEP
        for found, by, step in ((by_motion, "motion", size or STEP), (by_rates, "rates", speed)):
            for at, weight in zip(STEPS, WEIGHTS, strict=True):
                state.now[:] = now
                if by == "rates":
                    state.v[i] += at * step
                elif i in turning:
                    r, k = turning[i]
                    R = state.R[9 * r:9 * r + 9].reshape(3, 3)
                    R[:] = R @ rotations.matrices(at * step * np.eye(3)[k])
                else:
                    state.q[i] += at * step
                found[:, i] += weight / step * _evaluated(linear)[:n][fixed]
    state.now[:] = now
    return by_motion, by_rates


def _evaluated(linear: Linear) -> NDArray:
    system, state = linear.system, linear.state
    place_dependent(system.links, state.q, state.v, state.a, state.R, state.turns)
    state.g[:] = 0.0
    status = run_kernels(ACCELERATION, int(system.first_joint[0]), system.address.size, system,
                         state)
    if status != OK:
        raise InputError("constraints at a jump of the loads cannot be differentiated")
    sum_forces(system, state, state.residual)
    return state.residual.copy()
