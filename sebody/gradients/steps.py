"""Compiled recursions over steps, by products in place of matrices.

The equation of a step is solved with the inverse of an older step's matrix and refined by products
with the exact one, until corrections are as small as asked. Unknowns are those of the run: in axes
of frames, where the matrix hardly changes, so that an inverse serves many steps. Where corrections
do not shrink any more, the caller is asked for an inverse of the step at hand.

Equations as numbered in the README of this folder; a column each for objectives or parameters.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sebody.compiler.decorators import compiled
from sebody.contract.layout import OK
from sebody.engine.arrays import Arrays
from sebody.engine.evaluate import set_loads_beside, to_body_axes
from sebody.engine.inverse import invert
from sebody.engine.links import place_dependent
from sebody.gradients.guesses import add_old, guess, times
from sebody.gradients.products import along, prepare, transposed
from sebody.kernels.rotations import exp_map, tangent_operator

DONE = -1               # in place of the number of an event that asks for an inverse
FAILED = -2             # an evaluation, or refinement with the inverse of the step itself
ASKED, REFUSED = 1, 2   # what a solution ends with, beside 0
MOST = 12               # products for a column of a step
SLOW = 0.4              # corrections that shrink less ask for an inverse
ROUNDED = 1e-11         # corrections as small, relative, that do not shrink: rounding
LOOSE = 1e-7            # the same with the inverse of the step itself
NONE = 1e-200           # corrections of this size: an open contact has a force of 1e-300
CAUTION = 10.0          # what a correction leaves: times what corrections have left so far
FORGET = 0.9            # of the pace, from step to step
SPARE = 3               # products of a column that are worth no new inverse
PRODUCTS, INVERSES, SPENT, FRESH, GUESSES = range(5)    # places in `Columns.counts`


@dataclass(frozen=True, eq=False)
class Columns(Arrays):
    """What a recursion carries from step to step, of m columns and n unknowns.

    ==========  ====================================================================================
    motion      (4, m, n) motion, rates, second rates and auxiliary ones, or bars of these
    kept        (m, k) of the k numbers that laws keep, see `laws`
    before      (m, k) changes of these before the last step, which a restart at its end reads
                again; or what such a restart gives to the bars of the step
    turned      (m, n) the same of increments of the step
    own         (m, k) bars of kept numbers by what a step keeps, without its solution
    increments  (m, n) the same of increments of the step
    through     (m, k) bars by the residuals: products of the solutions
    given       (3, m, n) the same for the event at hand: with what objectives say, or predicted
    found       (3, m, n) products of the solutions
    last        (3, m, n) solutions of the events before, newest first, in axes of frames
    rights      (3, m, n) their right sides
    now         (m, n) that of the event at hand
    asked       (m, n) its right side
    inverse     (n, n) of the matrix of a step or of its transpose, in axes of frames
    old         (3, n, n) products with unit weights in this step, in axes of frames
    added       (n, n) what makes the equilibrated matrix regular where constraints are redundant
    rows        (n,) factors of the rows of the matrix that make its entries about one
    scale       (n,) sizes of the unknowns of the equation: of the columns likewise, inverse
    right       (n,) right side, then residual
    change      (n,) vector that is multiplied: the guess, then corrections
    product     (n,)
    plain       (n,) the inverse times the right side
    places      (r,) first coordinate of every rotation that is solved for
    H, T        (r, 9) of the step
    counts      products, inverses, products spent on an old inverse; whether it is this event's;
                solutions in `last`
    reach       (1,) size of corrections at which refinement ends
    pace        (1,) by how much corrections shrink
    length      (1,) step that the inverse is of
    ==========  ====================================================================================
    """

    motion: NDArray
    kept: NDArray
    before: NDArray
    turned: NDArray
    own: NDArray
    increments: NDArray
    through: NDArray
    given: NDArray
    found: NDArray
    last: NDArray
    rights: NDArray
    now: NDArray
    asked: NDArray
    inverse: NDArray
    old: NDArray
    added: NDArray
    rows: NDArray
    scale: NDArray
    right: NDArray
    change: NDArray
    product: NDArray
    plain: NDArray
    places: NDArray
    H: NDArray
    T: NDArray
    counts: NDArray
    reach: NDArray
    pace: NDArray
    length: NDArray

    @classmethod
    def of(cls, m: int, n: int, k: int, places: NDArray, tolerance: float) -> "Columns":
        """All zero."""
        r = len(places)
        return cls(*(np.zeros(shape) for shape in (
            (4, m, n), (m, k), (m, k), (m, n), (m, k), (m, n), (m, k), (3, m, n), (3, m, n),
            (3, m, n), (3, m, n), (m, n), (m, n), (n, n), (3, n, n), (n, n), n, n, n, n, n, n)),
            np.ascontiguousarray(places, dtype=np.int64), np.zeros((r, 9)), np.zeros((r, 9)),
            np.zeros(5, dtype=np.int64), np.array([tolerance]), np.ones(1), np.zeros(1))


@compiled
def put(system, state, products, columns, row, end, beside):
    """The state of an event, with its H and T, ready for products; a status."""
    for i in range(state.now.size):
        state.now[i] = row[i]
    set_loads_beside(system, state.frames, state.loads, end, beside)
    place_dependent(system.links, state.q, state.v, state.a, state.R, state.turns)
    for r in range(columns.places.size):
        first = columns.places[r]
        x, y, z = state.q[first], state.q[first + 1], state.q[first + 2]
        H, T = exp_map(-x, -y, -z), tangent_operator(x, y, z)
        for i in range(9):
            columns.H[r, i], columns.T[r, i] = H[i], T[i]
    return prepare(system, state, products)


@compiled(forceinline=True)
def _turn(columns, operators, x, back):
    """Multiply rotations in a vector by operators, or by their transposes."""
    for r in range(columns.places.size):
        first, R = columns.places[r], operators[r]
        a, b, c = x[first], x[first + 1], x[first + 2]
        for i in range(3):
            x[first + i] = (R[i] * a + R[3 + i] * b + R[6 + i] * c if back else
                            R[3 * i] * a + R[3 * i + 1] * b + R[3 * i + 2] * c)


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
        _turn(columns, columns.T, moved, True)
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
    _turn(columns, columns.T, xi, False)
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


@compiled
def _solve(system, state, products, columns, j, cm, cd, back):
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
def _conclude(system, state, columns):
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


@compiled
def is_old(columns, h):
    """Whether the inverse is of another step length, or has cost more than a new one."""
    counts = columns.counts
    return counts[FRESH] == 0 and (h != columns.length[0] or counts[SPENT] > columns.right.size)


@compiled(nogil=True)
def backward(system, state, products, columns, rows, lengths, offsets, ends, besides, seeds, seeded,
             numbers, first, last, weights, sizes):
    """(11) to (15) over steps from the last to the first; the event that asks for an inverse.

    DONE in place of it, or FAILED. `numbers` are alpha_m, alpha_f, beta, gamma and the duration of
    the run; `seeds` (events, m, 3, n) and `weights` (events, m, n + k) are read or written.
    """
    n, m = columns.right.size, columns.now.shape[0]
    am, af, b, g, duration = numbers
    given, found, motion = columns.given, columns.found, columns.motion
    for e in range(last, first - 1, -1):
        h = lengths[e]
        cm, cd, cu = (1.0 - am) / ((1.0 - af) * b * h * h), g / (b * h), 1.0 / (b * h * h)
        if is_old(columns, h):
            return e
        if put(system, state, products, columns, rows[e], ends[e], besides[e]) != OK:
            return FAILED
        for j in range(m):
            for i in range(n):
                free = 1.0 - system.is_multiplier[i]
                for c in range(3):
                    given[c, j, i] = motion[c, j, i]
                    if seeded[e]:
                        given[c, j, i] += seeds[e, j, c, i] * (1.0 if c == 0 else free)
            _weigh(system, state, products, columns, j)
            for i in range(n):
                columns.right[i] = given[0, j, i]
            _turn(columns, columns.T, columns.right, True)
            for i in range(n):
                columns.right[i] = -columns.right[i]
                if system.is_multiplier[i] == 0.0:
                    columns.right[i] -= (cd * given[1, j, i] + cm * given[2, j, i]
                                         + cu * motion[3, j, i] + columns.increments[j, i])
            to_body_axes(system, state.frames, columns.right, False)
            code = _solve(system, state, products, columns, j, cm, cd, True)
            if code != 0:
                return e if code == ASKED else FAILED
        size = 0.0
        for j in range(m):
            for i in range(n):
                weights[e, j, i] = columns.now[j, i]
            for i in range(columns.kept.shape[1]):
                weights[e, j, n + i] = columns.kept[j, i]
                columns.kept[j, i] = columns.own[j, i] + columns.through[j, i]
            to_body_axes(system, state.frames, weights[e, j], True)
            for i in range(n):
                free = 1.0 - system.is_multiplier[i]
                X, V, A = (free * (given[0, j, i] + found[0, j, i]),
                           free * (given[1, j, i] + found[1, j, i]),
                           free * (given[2, j, i] + found[2, j, i]))
                U = motion[3, j, i] + h * g * V + (1.0 - am) / (1.0 - af) * A
                motion[0, j, i], motion[1, j, i] = X, V - U / (b * h)
                motion[2, j, i] = -af / (1.0 - af) * A
                motion[3, j, i] = h * (1.0 - g) * V + am / (1.0 - af) * A - (0.5 - b) / b * U
            _turn(columns, columns.H, motion[0, j], True)
            for i in range(n):
                motion[2, j, i] += (1.0 - offsets[e]) * motion[3, j, i]
                motion[3, j, i] *= offsets[e]
                size = max(size, abs(motion[0, j, i]) * system.magnitude[i],
                           abs(motion[1, j, i]) * system.magnitude[i] / duration)
        sizes[e] = size
        _conclude(system, state, columns)
    return DONE


@compiled(nogil=True)
def forward(system, state, products, columns, rows, lengths, offsets, ends, besides, slopes,
            numbers, first, last, states):
    """(8) to (10) over steps from the first to the last; the event that asks for an inverse.

    DONE in place of it, or FAILED. `slopes` (events, m, n + k) are those of the residuals, and of
    what laws keep, by parameters; `states` (events, m, 3, n), motion, rates and second rates, is
    written.
    """
    n, m = columns.right.size, columns.now.shape[0]
    am, af, b, g, _ = numbers
    given, motion = columns.given, columns.motion
    for e in range(first, last + 1):
        h = lengths[e]
        cm, cd, cu = (1.0 - am) / ((1.0 - af) * b * h * h), g / (b * h), 1.0 / (b * h * h)
        if is_old(columns, h):
            return e
        if put(system, state, products, columns, rows[e], ends[e], besides[e]) != OK:
            return FAILED
        for j in range(m):
            for i in range(n):
                free = 1.0 - system.is_multiplier[i]
                aux, aux_now = _predicted(motion, j, i, offsets[e], h, b)
                v, a = motion[1, j, i], motion[2, j, i]
                given[0, j, i] = motion[0, j, i]
                given[1, j, i] = free * (v + h * (1.0 - g) * aux + h * g * aux_now)
                given[2, j, i] = free * ((1.0 - am) * aux_now + am * aux - af * a) / (1.0 - af)
            _turn(columns, columns.H, given[0, j], False)
            for i in range(n):
                given[0, j, i] *= 1.0 - system.is_multiplier[i]
                for c in range(3):
                    products.motion[c, i] = given[c, j, i]
                products.motion[3, i] = 0.0
            for i in range(products.kept.shape[1]):
                products.kept[0, i] = columns.kept[j, i]
            along(system, state, products, n)
            for i in range(n):
                columns.right[i] = -(slopes[e, j, i] + products.forces[i])
            to_body_axes(system, state.frames, columns.right, False)
            code = _solve(system, state, products, columns, j, cm, cd, False)
            if code != 0:
                return e if code == ASKED else FAILED
        for j in range(m):
            y = columns.right
            for i in range(n):
                y[i] = columns.now[j, i]
            to_body_axes(system, state.frames, y, True)
            for i in range(n):
                columns.turned[j, i] = y[i]
            for i in range(n):
                free = 1.0 - system.is_multiplier[i]
                _, aux_now = _predicted(motion, j, i, offsets[e], h, b)
                motion[3, j, i] = free * (aux_now + cu * y[i])
                motion[1, j, i] = given[1, j, i] + free * cd * y[i]
                motion[2, j, i] = given[2, j, i] + free * cm * y[i]
            _turn(columns, columns.T, y, False)
            for i in range(n):
                motion[0, j, i] = given[0, j, i] + y[i]
                for c in range(3):
                    states[e, j, c, i] = motion[c, j, i]
            _keep(system, state, products, columns, j, slopes[e, j])
        _conclude(system, state, columns)
    return DONE


@compiled(forceinline=True)
def _predicted(motion, j, i, offset, h, b):
    """Auxiliary acceleration at the begin of a step, and at its end without increments."""
    aux = (1.0 - offset) * motion[2, j, i] + offset * motion[3, j, i]
    return aux, -(motion[1, j, i] / h + (0.5 - b) * aux) / b
