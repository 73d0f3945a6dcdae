"""Redundant constraints of eight members: see `sebody.engine.regularization`.

Inverses are regularized as factors of elimination are, since both are made without row exchanges.
"""

import math

from sebody.compiler.decorators import compiled
from sebody.compiler.inside.lanes import spread, where
from sebody.contract.layout import C_MASS
from sebody.engine import elimination
from sebody.engine.evaluate import to_body_axes
from sebody.engine.matrix import ROUNDING
from sebody.engine.newton import WIDEST_GAP
from sebody.engine.regularization import LIGHT, PROJECTIONS, REGULARIZATION
from sebody.kernels.abi import at


@compiled
def regularize(system, state, wanted):
    """Add R and L to the iteration matrix; members that want no matrix keep theirs."""
    n, size, sums, R = system.diagonal.size, state.projected, state.pulled, state.regularization
    mass, own = state.coefficients[C_MASS], state.constraint_columns
    for k in range(system.constraint_columns.size):
        own[k] = where(wanted, state.matrix[system.constraint_columns[k]], own[k])
    for i in range(n):
        size[i] = sums[i] = spread(0.0)
    for i in range(n):
        part = system.part[i]
        if system.is_multiplier[i] == 0.0:
            diagonal = max(abs(state.matrix[system.diagonal[i]]), mass * system.inertias[i])
            size[part] = max(size[part], diagonal)
    for k in range(system.rows.size):
        i, j = system.rows[k], system.columns[k]
        if i < n and j < n and system.is_multiplier[i] > 0.0 and system.is_multiplier[j] == 0.0:
            sums[i] += state.matrix[k] * state.matrix[k] / size[system.part[j]]
    for i in range(n):
        if system.is_multiplier[i] > 0.0:
            size[system.part[i]] = max(size[system.part[i]], sums[i])
    for i in range(n):
        if system.is_multiplier[i] == 0.0:
            R[i] = where(wanted, LIGHT * mass * system.massless_axes[i], R[i])
        else:
            strength = size[system.part[i]]
            strength = where(strength > 0.0, strength, spread(1.0))
            R[i] = where(wanted, -REGULARIZATION * strength, R[i])
            state.weight[i] = where(wanted, math.sqrt(strength), state.weight[i])
            state.scale[i] = 1.0 / state.weight[i]
        state.matrix[system.diagonal[i]] += R[i]


@compiled
def project_inverse(system, state, inverse, result, n):
    """Project the scaled inverse, transposed, in place; `result` is scratch memory."""
    row = state.projected
    for k in range(n * n):
        result[k] = inverse[k]
    for _ in range(PROJECTIONS):
        for i in range(n):
            own = at(result, i * n)
            for j in range(n):
                row[j] = own[j]
            for k in range(n):
                if system.is_multiplier[k] > 0.0:
                    factor = row[k] * state.regularization[k] * state.scale[k] * state.scale[k]
                    column = at(inverse, k * n)
                    for j in range(n):
                        own[j] = own[j] - factor * column[j]
    for k in range(n * n):
        inverse[k] = result[k]


@compiled
def spread_multipliers(system, state, inverse, dense, evaluated):
    """Take from the multipliers of some members the part that exerts no force."""
    n, part, right = system.diagonal.size, state.projected, state.pulled
    for i in range(n):
        part[i] = state.q[i] * system.is_multiplier[i]
    to_body_axes(system, state.frames, part, False)
    for _ in range(PROJECTIONS):
        for i in range(n):
            part[i] = part[i] * (state.regularization[i] * system.is_multiplier[i])
        if not dense:
            elimination.solve(system, state, part, part)
            continue
        for i in range(n):
            right[i] = state.scale[i] * part[i]
        for i in range(n):
            total = spread(0.0)
            for j in range(n):
                total += inverse[j * n + i] * right[j]
            part[i] = state.scale[i] * total
    to_body_axes(system, state.frames, part, True)
    for i in range(n):
        if system.is_multiplier[i] > 0.0:
            taken = where(evaluated, part[i], spread(0.0))
            state.q[i] -= taken
            state.dq[i] -= taken


@compiled
def leaves_gap(system, state, norm):
    """Which members keep a residual that no correction removes."""
    n, left = system.diagonal.size, spread(0.0)
    for i in range(n):
        residual = state.residual[i]
        left += residual * residual * state.scale[i] * state.scale[i]
    return math.sqrt(left) > n * norm + WIDEST_GAP / ROUNDING * state.clock.floor
