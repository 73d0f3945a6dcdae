"""Factors of two matrices at a time: that of the steps, and that of accelerations at samples.

Where controllers set inputs, accelerations are solved for anew at every sample. The inverse of the
steps is set aside meanwhile, and that of the accelerations between samples: both are used as long
as corrections converge with them. Only small models whose matrices need no regularization keep two;
all others factorize at the sample and after it.
"""

import numpy as np
from numpy.typing import NDArray

from sebody.compiler.decorators import compiled
from sebody.contract.counts import whole_vectors
from sebody.engine.newton import REFACTORIZATION_COST, SLOWEST
from sebody.engine.state import EVALUATED, FACTORS_KEPT, KEPT
from sebody.engine.system import System

# State.spare: whether it holds factors of accelerations, and whether those of the steps, which were
# set aside; what matrix the next step wants; corrections beyond those with new factors; the floor
# that belongs to the scales. Then an inverse, scales, weights, and the element matrices of bodies
VALID, ASIDE, WANTED, EXCESS, FLOOR, FIRST = range(6)
FEWEST = 2              # corrections with new factors: one, and one that is rounding


def spare(system: System, unknowns: int, dense: bool) -> NDArray:
    """Memory for the other factors; none for models in which nothing is sampled."""
    if not dense or not (system.control.periods.size or system.control.inputs.size):
        return np.zeros(0)
    of_bodies = int(system.at_J[system.first_joint[0]])
    return np.zeros(FIRST + unknowns * (whole_vectors(unknowns) + 2) + of_bodies)


@compiled
def exchange(system, state, lead):
    """Begin a restart: set the factors of the steps aside, if both are kept, and take the others.

    Not where accelerations are also looked ahead with (`lead`), which new factors are taken for.
    """
    control, spare = state.control, state.spare
    wanted = control.wanted
    control.wanted = KEPT if control.restart == FACTORS_KEPT else EVALUATED
    if (spare.size == 0 or lead != 0.0 or system.massless[0] == 1 or control.regularized == 1
            or system.regularized[0] == 1):
        return
    swap_factors(system, state)
    spare[ASIDE], spare[WANTED] = 1.0, wanted
    if spare[VALID] == 1.0:
        control.wanted = KEPT


@compiled
def keep_matrices_of_bodies(system, state):
    """Before a restart evaluates element matrices: those of the steps may be wanted, rotated."""
    if state.spare.size == 0 or state.spare[ASIDE] == 0.0 or state.control.fresh > 0:
        return
    first = state.spare.size - system.at_J[system.first_joint[0]]
    for k in range(first, state.spare.size):
        state.spare[k] = state.J[k - first]


@compiled
def give_back(system, state):
    """End a restart: take back the factors of the steps, keep those of the accelerations."""
    control, spare = state.control, state.spare
    control.wanted = EVALUATED
    if spare.size == 0 or spare[ASIDE] == 0.0:
        state.clock.contraction = SLOWEST       # nothing is known of the next step
        return
    swap_factors(system, state)
    spare[ASIDE] = 0.0
    if control.regularized == 1:                # which neither is then
        control.regularized, spare[VALID] = 0, 0.0
        state.clock.contraction = SLOWEST
        return
    control.wanted = np.int64(spare[WANTED])
    if control.fresh > 0:
        spare[EXCESS] = 0.0
        first = spare.size - system.at_J[system.first_joint[0]]
        for k in range(first, spare.size):
            state.J[k - first] = spare[k]
    else:
        spare[EXCESS] += max(control.iteration - FEWEST, 0)
    spare[VALID] = 1.0 if spare[EXCESS] <= REFACTORIZATION_COST else 0.0


@compiled
def swap_factors(system, state):
    """Exchange the factors in use and the others, with scales and what belongs to these."""
    n, spare, at = system.diagonal.size, state.spare, FIRST
    spare[FLOOR], state.clock.floor = state.clock.floor, spare[FLOOR]
    for j in range(n):
        for i in range(state.inverse.shape[1]):
            spare[at], state.inverse[j, i] = state.inverse[j, i], spare[at]
            at += 1
    for i in range(n):
        spare[at], state.scale[i] = state.scale[i], spare[at]
        spare[at + n], state.weight[i] = state.weight[i], spare[at + n]
        at += 1
