"""The equation of a step, solved by products in place of its matrix.

It is solved with the inverse of an older step's matrix and refined by products with the exact one,
until corrections are as small as asked. Unknowns are those of the run: in axes of frames, where the
matrix hardly changes, so that an inverse serves many steps. Where corrections do not shrink any
more, the caller is asked for an inverse of the step at hand.

Equations as numbered in the README of this folder.
"""

import numpy as np

from sebody.compiler.decorators import compiled
from sebody.contract.layout import OK
from sebody.engine.evaluate import to_body_axes
from sebody.engine.inverse import invert
from sebody.gradients.products import along, transposed
from sebody.gradients.recursion import FRESH, GUESSES, PRODUCTS, SPENT, put, turn

DONE = -1               # of recursions, in place of the number of an event that asks for an inverse
FAILED = -2             # an evaluation, or refinement with the inverse of the step itself
ASKED, REFUSED = 1, 2   # what a step or its solution ends with, beside 0
MOST = 12               # products for a column of a step
SLOW = 0.4              # corrections that shrink less ask for an inverse
ROUNDED = 1e-11         # corrections as small, relative, that do not shrink: rounding
LOOSE = 1e-7            # the same with the inverse of the step itself
NONE = 1e-200           # corrections of this size: an open contact has a force of 1e-300
CAUTION = 10.0          # what a correction leaves: times what corrections have left so far
FORGET = 0.9            # of the pace, from step to step
SPARE = 3               # products of a column that are worth no new inverse


@compiled
def guess(columns, j):
    """The first guess of column j goes to `Columns.change`; `plain` is set.

    What the old inverse P misses, ``w - P b`` of solutions w for right sides b, changes slowly, and
    is extrapolated quadratically from the steps before.
    """
    n, change, plain = columns.right.size, columns.change, columns.plain
    for i in range(n):
        columns.asked[j, i] = columns.right[i]
        columns.product[i] = _ahead(columns, columns.rights, j, i)
    times(columns.inverse, columns.product, change)
    times(columns.inverse, columns.right, plain)
    for i in range(n):
        change[i] = plain[i] + _ahead(columns, columns.last, j, i) - change[i]
        columns.now[j, i] = 0.0
        for c in range(3):
            columns.found[c, j, i] = 0.0


@compiled(forceinline=True)
def _ahead(columns, before, j, i):
    """An entry of vectors of the steps before, extrapolated by as many as there are."""
    one, two, three = before[0, j, i], before[1, j, i], before[2, j, i]
    known = columns.counts[GUESSES]
    return 3.0 * (one - two) + three if known > 2 else 2.0 * one - two if known > 1 else one


@compiled
def add_old(system, state, products, columns, j):
    """Add products with `Columns.change` to those of column j: in the step that P is of."""
    n, bars = columns.right.size, products.motion
    for c in range(3):
        for i in range(n):
            bars[c, i] = 0.0
        for k in range(n):
            factor = columns.change[k]
            for i in range(n):
                bars[c, i] += factor * columns.old[c, k, i]
        to_body_axes(system, state.frames, bars[c], True)
        for i in range(n):
            columns.found[c, j, i] += bars[c, i]


@compiled(fastmath={"contract", "reassoc"})
def times(A, x, out):
    """``A x``, in the order of sums that is quickest."""
    n = x.size
    for i in range(n):
        total = 0.0
        for k in range(n):
            total += A[i, k] * x[k]
        out[i] = total


@compiled
def begin(system, state, products, columns, row, end, beside, h, numbers):
    """Put the state of a step of length h: 0, ASKED or REFUSED, and cm, cd and cu.

    `numbers` are alpha_m, alpha_f, beta, gamma and the duration of the run.
    """
    am, af, b, g, _ = numbers
    factors = (1.0 - am) / ((1.0 - af) * b * h * h), g / (b * h), 1.0 / (b * h * h)
    if _is_old(columns, h):
        return ASKED, factors
    return (0 if put(system, state, products, columns, row, end, beside) == OK else REFUSED
            ), factors


@compiled
def _is_old(columns, h):
    """Tell if the inverse is of another step length, or has cost more than a new one."""
    counts = columns.counts
    return counts[FRESH] == 0 and (h != columns.length[0] or counts[SPENT] > columns.right.size)


@compiled
def matrix(system, state, products, columns, cm, cd, back, found):
    """The matrix of a step, or its transpose, in axes of frames, column by column: (7).

    The state is put.
    """
    n = columns.right.size
    for i in range(n):
        for k in range(n):
            columns.change[k] = 0.0
        columns.change[i] = 1.0
        _multiply(system, state, products, columns, 0, cm, cd, back)
        for k in range(n):
            found[k, i] = columns.product[k]
        if back:
            for c in range(3):
                to_body_axes(system, state.frames, products.motion[c], False)
                for k in range(n):
                    columns.old[c, i, k] = products.motion[c, k]


@compiled
def invert_now(system, state, products, columns, cm, cd, back):
    """The inverse of the matrix of the step that is put, with known scales; False if singular."""
    A, n = columns.inverse, columns.right.size
    matrix(system, state, products, columns, cm, cd, back, A)
    for i in range(n):
        for j in range(n):
            A[i, j] *= columns.rows[i] / columns.scale[j]
            A[i, j] += columns.added[i, j]
    if not invert(A):
        return False
    for i in range(n):
        for j in range(n):
            A[i, j] *= columns.rows[j] / columns.scale[i]
    return True


@compiled
def _multiply(system, state, products, columns, j, cm, cd, back):
    """The matrix, or its transpose, times `change`, both in axes of frames, goes to `product`.

    Products with weights are added to those of column j.
    """
    n, w, bars, moved = columns.right.size, products.forces, products.motion, columns.product
    columns.counts[PRODUCTS] += 1
    _hold(products)
    if back:
        for i in range(n):
            w[i] = columns.change[i]
        to_body_axes(system, state.frames, w, True)
        transposed(system, state, products, n)
        for i in range(n):
            for c in range(3):
                columns.found[c, j, i] += bars[c, i]
            moved[i] = bars[0, i]
        for i in range(products.kept.shape[1]):
            columns.through[j, i] += products.kept[0, i]
        turn(columns, columns.T, moved, True)
        for i in range(n):
            if system.is_multiplier[i] == 0.0:
                moved[i] += cd * bars[1, i] + cm * bars[2, i] + bars[3, i]
        to_body_axes(system, state.frames, moved, False)
        return
    xi = bars[0]
    for i in range(n):
        xi[i] = columns.change[i]
    to_body_axes(system, state.frames, xi, True)
    for i in range(n):
        free = 1.0 - system.is_multiplier[i]
        bars[1, i], bars[2, i], bars[3, i] = cd * free * xi[i], cm * free * xi[i], free * xi[i]
    turn(columns, columns.T, xi, False)
    along(system, state, products, n)
    for i in range(n):
        moved[i] = w[i]
    to_body_axes(system, state.frames, moved, False)


@compiled(forceinline=True)
def _hold(products):
    """Nothing of what laws keep changes, or has weights."""
    for i in range(products.kept.shape[1]):
        products.kept[0, i] = products.kept[1, i] = 0.0


@compiled
def solve(system, state, products, columns, j, cm, cd, back):
    """Solve for column j with `right`, in axes of frames; 0, ASKED or REFUSED.

    Corrections are multiplied, not the whole solution, and products add up. The last correction,
    after which less is left than is asked if it goes on as before, is not multiplied any more.
    """
    n, counts, own = columns.right.size, columns.counts, columns.now[j]
    change, pace, last = columns.change, columns.pace, np.inf
    guess(columns, j)
    for i in range(columns.kept.shape[1]):
        columns.through[j, i] = 0.0
    for k in range(MOST):
        _multiply(system, state, products, columns, j, cm, cd, back)
        counts[SPENT] += k >= SPARE
        for i in range(n):
            own[i] += change[i]
            columns.right[i] -= columns.product[i]
        times(columns.inverse, columns.right, change)
        size = largest = drift = 0.0
        for i in range(n):
            size = max(size, abs(change[i]) * columns.scale[i])
            largest = max(largest, abs(own[i]) * columns.scale[i])
            drift = max(drift, abs(own[i] + change[i] - columns.plain[i]) * columns.scale[i])
        slow = not size < SLOW * last and size > NONE
        if slow and size > ROUNDED * largest:
            if counts[FRESH] == 0:
                return ASKED
            if not size <= LOOSE * largest:
                return REFUSED
            columns.reach[0] = max(columns.reach[0], size / largest)
        elif k > 0 and not slow and last > NONE:
            pace[0] = max(pace[0], size / last)
        elif k == 0:
            pace[0] = max(FORGET * pace[0], drift / largest if largest > 0.0 else 0.0)
        if slow or min(CAUTION * pace[0], 1.0) * size <= columns.reach[0] * largest + NONE:
            for i in range(n):
                own[i] += change[i]
            if back and columns.kept.shape[1] > 0:      # old branches may be others
                _multiply(system, state, products, columns, j, cm, cd, back)
            elif back:
                add_old(system, state, products, columns, j)
            return 0
        last = size
    return ASKED if counts[FRESH] == 0 else REFUSED


@compiled
def conclude(system, state, columns):
    """Shift the solutions of the events before."""
    counts = columns.counts
    for j in range(columns.now.shape[0]):
        for i in range(columns.right.size):
            for k in range(2, 0, -1):
                columns.last[k, j, i] = columns.last[k - 1, j, i]
                columns.rights[k, j, i] = columns.rights[k - 1, j, i]
            columns.last[0, j, i] = columns.now[j, i]
            columns.rights[0, j, i] = columns.asked[j, i]
    counts[FRESH], counts[GUESSES] = 0, min(counts[GUESSES] + 1, 3)
