"""The recursion over steps from the last to the first, compiled: a column for each objective.

Equations as numbered in the README of this folder.
"""

from sebody.compiler.decorators import compiled
from sebody.engine.evaluate import to_body_axes
from sebody.gradients.products import transposed
from sebody.gradients.recursion import turn
from sebody.gradients.step_equation import ASKED, DONE, FAILED, begin, conclude, solve


@compiled(nogil=True)
def backward(system, state, products, columns, rows, lengths, offsets, ends, besides, seeds, seeded,
             numbers, first, last, weights, sizes):
    """(11) to (15) over steps from the last to the first; the event that asks for an inverse.

    DONE in place of it, or FAILED. `numbers` are alpha_m, alpha_f, beta, gamma and the duration of
    the run; `seeds` (events, m, 3, n) and `weights` (events, m, n + k) are read or written.
    """
    m = columns.now.shape[0]
    for e in range(last, first - 1, -1):
        h = lengths[e]
        code, factors = begin(system, state, products, columns, rows[e], ends[e], besides[e], h,
                              numbers)
        for j in range(m):
            if code == 0:
                _demand(system, state, products, columns, j, seeds[e, j], seeded[e], factors)
                code = solve(system, state, products, columns, j, factors[0], factors[1], True)
        if code != 0:
            return e if code == ASKED else FAILED
        sizes[e] = 0.0
        for j in range(m):
            size = _over(system, state, columns, j, h, offsets[e], numbers, weights[e, j])
            sizes[e] = max(sizes[e], size)
        conclude(system, state, columns)
    return DONE


@compiled
def _demand(system, state, products, columns, j, seed, seeded, factors):
    """The right side of (11) of column j, with what objectives say of the state if it is seeded."""
    n, given, motion = columns.right.size, columns.given, columns.motion
    cm, cd, cu = factors
    for i in range(n):
        free = 1.0 - system.is_multiplier[i]
        for c in range(3):
            given[c, j, i] = motion[c, j, i]
            if seeded:
                given[c, j, i] += seed[c, i] * (1.0 if c == 0 else free)
    _weigh(system, state, products, columns, j)
    for i in range(n):
        columns.right[i] = given[0, j, i]
    turn(columns, columns.T, columns.right, True)
    for i in range(n):
        columns.right[i] = -columns.right[i]
        if system.is_multiplier[i] == 0.0:
            columns.right[i] -= (cd * given[1, j, i] + cm * given[2, j, i]
                                 + cu * motion[3, j, i] + columns.increments[j, i])
    to_body_axes(system, state.frames, columns.right, False)


@compiled
def _weigh(system, state, products, columns, j):
    """Bars of column j by what the step keeps, whose own ones are at hand."""
    n, k = columns.right.size, columns.kept.shape[1]
    if k == 0:
        return
    for i in range(n):
        products.forces[i] = 0.0
    for i in range(k):
        products.kept[1, i] = columns.kept[j, i]
    transposed(system, state, products, n)
    for i in range(n):
        for c in range(3):
            columns.given[c, j, i] += products.motion[c, i]
        columns.increments[j, i] = columns.turned[j, i] + products.motion[3, i]
        columns.turned[j, i] = 0.0
    for i in range(k):
        columns.own[j, i] = columns.before[j, i] + products.kept[0, i]
        columns.before[j, i] = 0.0


@compiled
def _over(system, state, columns, j, h, offset, numbers, weights):
    """(12) to (15) of column j with its solution, which goes to `weights`.

    The result is the largest effect of a disturbance of the state before on the objective.
    """
    n, given, found, motion = columns.right.size, columns.given, columns.found, columns.motion
    am, af, b, g, duration = numbers
    for i in range(n):
        weights[i] = columns.now[j, i]
    for i in range(columns.kept.shape[1]):
        weights[n + i] = columns.kept[j, i]
        columns.kept[j, i] = columns.own[j, i] + columns.through[j, i]
    to_body_axes(system, state.frames, weights, True)
    for i in range(n):
        free = 1.0 - system.is_multiplier[i]
        X, V, A = (free * (given[0, j, i] + found[0, j, i]),
                   free * (given[1, j, i] + found[1, j, i]),
                   free * (given[2, j, i] + found[2, j, i]))
        U = motion[3, j, i] + h * g * V + (1.0 - am) / (1.0 - af) * A
        motion[0, j, i], motion[1, j, i] = X, V - U / (b * h)
        motion[2, j, i] = -af / (1.0 - af) * A
        motion[3, j, i] = h * (1.0 - g) * V + am / (1.0 - af) * A - (0.5 - b) / b * U
    turn(columns, columns.H, motion[0, j], True)
    size = 0.0
    for i in range(n):
        motion[2, j, i] += (1.0 - offset) * motion[3, j, i]
        motion[3, j, i] *= offset
        size = max(size, abs(motion[0, j, i]) * system.magnitude[i],
                   abs(motion[1, j, i]) * system.magnitude[i] / duration)
    return size
