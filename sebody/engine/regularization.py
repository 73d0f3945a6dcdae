"""Redundant constraints and motions without mass: regularized factors, projected corrections.

With redundant constraints the iteration matrix M is singular, and a residual has parts that no
correction removes: rounding, or a small misfit of the joints. The factors are those of
``A = M + R + L``. The diagonal R is negative at multipliers, `REGULARIZATION` times the strength of
their constraints; L is positive at bodies with nearly no inertia about an axis. A matrix of this
kind has factors in any order of elimination (Vanderbei 1995). The correction is

    z = (I - A^-1 R)^k A^-1 r    with k `PROJECTIONS`.

Where the constraints act with the strength s relative to R / REGULARIZATION, this is the solution
times ``(s / (s + REGULARIZATION))^(k + 1)``: all of it where s is far above REGULARIZATION, nothing
where s is rounding. So no rank is decided upon, multipliers get no part that exerts no force, and
the motion does not depend on R. R has one size for all multipliers of an equation, L for all axes
of a rotation: neither depends on the directions of axes. What L changes, at most `LIGHT` of a
correction, further iterations correct; where something without mass can move it leaves that alone.

Rounding in the factors is divided by REGULARIZATION^(k + 1) and multiplied by its own power k, so
REGULARIZATION must stay well above that rounding, which thin bodies increase by 1 / LIGHT.
"""

import math

import numpy as np

from sebody.compiler.decorators import compiled
from sebody.contract.layout import C_MASS
from sebody.engine import elimination
from sebody.engine.evaluate import to_body_axes

REGULARIZATION = 1e-8       # of R at multipliers, for elimination without row exchanges
EXCHANGED = 1e-10       # the same for inverses, which rounding spoils less
LIGHT = 1e-3            # of R at thin bodies, relative to their largest moment of inertia
WEAKEST = 1e-7          # strength of constraints below which a small matrix is regularized
PROJECTIONS = 2         # of corrections and of multipliers


@compiled
def regularize(system, state, regularization):
    """Add R and L to the iteration matrix."""
    for k in range(system.constraint_columns.size):
        state.constraint_columns[k] = state.matrix[system.constraint_columns[k]]
    _set_regularization(system, state, regularization)
    for i in range(system.diagonal.size):
        state.matrix[system.diagonal[i]] += state.regularization[i]
    state.control.regularized = 1


@compiled
def _set_regularization(system, state, regularization):
    """R and L from the rows of the constraints and the masses, and scales by equations."""
    n, size, R = system.diagonal.size, state.projected, state.regularization
    mass = state.coefficients[C_MASS]
    for i in range(n):
        size[i] = R[i] = 0.0
    for i in range(n):
        part = system.part[i]
        if system.is_multiplier[i] == 0.0:
            size[part] = max(size[part], abs(state.matrix[system.diagonal[i]]),
                             mass * system.inertias[i])
    for k in range(system.rows.size):
        i, j = system.rows[k], system.columns[k]
        if i < n and j < n and system.is_multiplier[i] > 0.0 and system.is_multiplier[j] == 0.0:
            R[i] += state.matrix[k] * state.matrix[k] / size[system.part[j]]
    for i in range(n):
        if system.is_multiplier[i] > 0.0:
            size[system.part[i]] = max(size[system.part[i]], R[i])
    for i in range(n):
        if system.is_multiplier[i] == 0.0:
            R[i] = LIGHT * mass * system.massless_axes[i]
        else:
            strength = size[system.part[i]]
            strength = strength if strength > 0.0 else 1.0
            R[i] = -regularization * strength
            state.weight[i] = np.sqrt(strength)
            state.scale[i] = 1.0 / state.weight[i]


@compiled
def project_inverse(system, state, inverse, n):
    """Project the scaled inverse of A, transposed, in place."""
    R, result, row = np.empty((n, n)), np.empty((n, n)), np.empty(n)
    for k in range(n):
        for j in range(n):
            R[k, j] = (state.regularization[k] * system.is_multiplier[k] * state.scale[k]
                       * state.scale[k] * inverse[k, j])
            result[k, j] = inverse[k, j]
    for _ in range(PROJECTIONS):
        for i in range(n):
            for j in range(n):          # loops: assigned slices take seconds to compile
                row[j] = result[i, j]
            for k in range(n):
                for j in range(n):
                    result[i, j] -= row[k] * R[k, j]
    for i in range(n):
        for j in range(n):
            inverse[i, j] = result[i, j]


@compiled
def project(system, state):
    """Project the correction that was solved for by blocks."""
    n = system.diagonal.size
    for _ in range(PROJECTIONS):
        for i in range(n):
            state.projected[i] = (state.regularization[i] * system.is_multiplier[i]
                                  * state.correction[i])
        elimination.solve(system, state, state.projected, state.projected)
        for i in range(n):
            state.correction[i] -= state.projected[i]


@compiled
def spread(system, state, inverse, dense):
    """Take from the multipliers the part that exerts no force: what is left is of least norm.

    That part grows as the constraints turn. It is what ``A^-1 R`` leaves as it is; of all other
    parts that leaves ``REGULARIZATION / s``, so it is applied several times.
    """
    n, part = system.diagonal.size, state.projected
    for i in range(n):
        part[i] = state.q[i] * system.is_multiplier[i]
    to_body_axes(system, state.frames, part, False)
    for _ in range(PROJECTIONS):
        for i in range(n):
            part[i] *= state.regularization[i] * system.is_multiplier[i]
        if dense:
            _times_inverse(state, inverse, part, n)
        else:
            elimination.solve(system, state, part, part)
    to_body_axes(system, state.frames, part, True)
    for i in range(n):
        if system.is_multiplier[i] > 0.0:
            state.q[i] -= part[i]
            state.dq[i] -= part[i]


@compiled
def _times_inverse(state, inverse, x, n):
    """Multiply by a matrix whose scaled transpose is given."""
    right = np.empty(n)
    for i in range(n):
        right[i] = state.scale[i] * x[i]
    for i in range(n):
        total = 0.0
        for j in range(n):
            total += inverse[j, i] * right[j]
        x[i] = state.scale[i] * total


@compiled
def regularized_norms(system, state, n):
    """Norms of a correction by a regularized matrix, of the increment and of the accelerations.

    Of multipliers count their forces, divided by the scales of the matrix as corrections of
    coordinates are: a part that exerts little force may be as uncertain as the force allows.
    """
    change, force = state.projected, state.pulled
    norm = size = accelerations = 0.0
    for i in range(n):
        change[i] = force[i] = 0.0
    for k in range(system.constraint_columns.size):
        at = system.constraint_columns[k]
        i, j = system.rows[at], system.columns[at]
        change[i] += state.constraint_columns[k] * state.correction[j]
        force[i] += state.constraint_columns[k] * state.q[j]
    for i in range(n):
        if system.is_multiplier[i] > 0.0:
            continue
        f, g = change[i] * state.scale[i], force[i] * state.scale[i]
        w = state.weight[i]
        d, s, x, z = (state.correction[i] * w, state.shift[i] * w, state.dq[i] * w,
                      state.a[i] * w)
        norm += d * d + s * s + f * f
        size += x * x + g * g
        accelerations += z * z
    return math.sqrt(norm), math.sqrt(size), math.sqrt(accelerations)
