"""The recursion over steps from the first to the last, compiled: a column for each parameter.

Equations as numbered in the README of this folder.
"""

from sebody.compiler.decorators import compiled
from sebody.engine.evaluate import to_body_axes
from sebody.gradients.products import along
from sebody.gradients.recursion import turn
from sebody.gradients.step_equation import ASKED, DONE, FAILED, begin, conclude, solve


@compiled(nogil=True)
def forward(system, state, products, columns, rows, lengths, offsets, ends, besides, slopes,
            numbers, first, last, states):
    """(8) to (10) over steps from the first to the last; the event that asks for an inverse.

    DONE in place of it, or FAILED. `slopes` (events, m, n + k) are those of the residuals, and of
    what laws keep, by parameters; `states` (events, m, 3, n), motion, rates and second rates, is
    written.
    """
    m = columns.now.shape[0]
    for e in range(first, last + 1):
        h, offset = lengths[e], offsets[e]
        code, factors = begin(system, state, products, columns, rows[e], ends[e], besides[e], h,
                              numbers)
        for j in range(m):
            if code == 0:
                _predict(system, state, products, columns, j, h, offset, numbers, slopes[e, j])
                code = solve(system, state, products, columns, j, factors[0], factors[1], False)
        if code != 0:
            return e if code == ASKED else FAILED
        for j in range(m):
            _over(system, state, columns, j, h, offset, numbers, factors, states[e, j])
            _keep(system, state, products, columns, j, slopes[e, j])
        conclude(system, state, columns)
    return DONE


@compiled
def _predict(system, state, products, columns, j, h, offset, numbers, slopes):
    """(8) and the right side of (9) of column j."""
    n, given, motion = columns.right.size, columns.given, columns.motion
    am, af, b, g, _ = numbers
    for i in range(n):
        free = 1.0 - system.is_multiplier[i]
        aux, aux_now = _auxiliary(motion, j, i, offset, h, b)
        v, a = motion[1, j, i], motion[2, j, i]
        given[0, j, i] = motion[0, j, i]
        given[1, j, i] = free * (v + h * (1.0 - g) * aux + h * g * aux_now)
        given[2, j, i] = free * ((1.0 - am) * aux_now + am * aux - af * a) / (1.0 - af)
    turn(columns, columns.H, given[0, j], False)
    for i in range(n):
        given[0, j, i] *= 1.0 - system.is_multiplier[i]
        for c in range(3):
            products.motion[c, i] = given[c, j, i]
        products.motion[3, i] = 0.0
    for i in range(products.kept.shape[1]):
        products.kept[0, i] = columns.kept[j, i]
    along(system, state, products, n)
    for i in range(n):
        columns.right[i] = -(slopes[i] + products.forces[i])
    to_body_axes(system, state.frames, columns.right, False)


@compiled(forceinline=True)
def _auxiliary(motion, j, i, offset, h, b):
    """Auxiliary acceleration at the begin of a step, and at its end without increments."""
    aux = (1.0 - offset) * motion[2, j, i] + offset * motion[3, j, i]
    return aux, -(motion[1, j, i] / h + (0.5 - b) * aux) / b


@compiled
def _over(system, state, columns, j, h, offset, numbers, factors, states):
    """(10) of column j with its solution; motion, rates and second rates go to `states`."""
    n, given, motion, y = columns.right.size, columns.given, columns.motion, columns.right
    cm, cd, cu = factors
    for i in range(n):
        y[i] = columns.now[j, i]
    to_body_axes(system, state.frames, y, True)
    for i in range(n):
        columns.turned[j, i] = y[i]
    for i in range(n):
        free = 1.0 - system.is_multiplier[i]
        _, aux_now = _auxiliary(motion, j, i, offset, h, numbers[2])
        motion[3, j, i] = free * (aux_now + cu * y[i])
        motion[1, j, i] = given[1, j, i] + free * cd * y[i]
        motion[2, j, i] = given[2, j, i] + free * cm * y[i]
    turn(columns, columns.T, y, False)
    for i in range(n):
        motion[0, j, i] = given[0, j, i] + y[i]
        for c in range(3):
            states[c, i] = motion[c, j, i]


@compiled
def _keep(system, state, products, columns, j, slopes):
    """Changes of column j of what the step keeps, from the motion at its end; `turned` is known."""
    n, k = columns.right.size, columns.kept.shape[1]
    if k == 0:
        return
    for i in range(n):
        free = 1.0 - system.is_multiplier[i]
        products.motion[0, i] = columns.motion[0, j, i]
        products.motion[1, i], products.motion[2, i], products.motion[3, i] = (
            free * columns.motion[1, j, i], free * columns.motion[2, j, i],
            free * columns.turned[j, i])
    for i in range(k):
        products.kept[0, i] = columns.before[j, i] = columns.kept[j, i]
    along(system, state, products, n)
    for i in range(k):
        columns.kept[j, i] = products.kept[1, i] + slopes[n + i]
