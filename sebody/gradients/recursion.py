"""Numbers that a recursion over steps carries, in columns, and the state of a step."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sebody.compiler.decorators import compiled
from sebody.engine.arrays import Arrays
from sebody.gradients.products import prepare
from sebody.gradients.recorded_states import put_state
from sebody.kernels.rotations import exp_map, tangent_operator

PRODUCTS, INVERSES, SPENT, FRESH, GUESSES = range(5)    # places in `Columns.counts`


@dataclass(frozen=True, eq=False)
class Columns(Arrays):
    """Numbers that a recursion carries from step to step, of m columns and n unknowns.

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
        zeros = [np.zeros(shape) for shape in (
            (4, m, n), (m, k), (m, k), (m, n), (m, k), (m, n), (m, k), (3, m, n), (3, m, n),
            (3, m, n), (3, m, n), (m, n), (m, n), (n, n), (3, n, n), (n, n), n, n, n, n, n, n)]
        others = [np.ascontiguousarray(places, dtype=np.int64), np.zeros((r, 9)), np.zeros((r, 9)),
                  np.zeros(5, dtype=np.int64), np.array([tolerance]), np.ones(1), np.zeros(1)]
        return cls(*zeros, *others)


@compiled
def put(system, state, products, columns, row, end, beside):
    """The state of an event, with its H and T, ready for products; a status."""
    put_state(system, state, row, end, beside)
    for r in range(columns.places.size):
        first = columns.places[r]
        x, y, z = state.q[first], state.q[first + 1], state.q[first + 2]
        H, T = exp_map(-x, -y, -z), tangent_operator(x, y, z)
        for i in range(9):
            columns.H[r, i], columns.T[r, i] = H[i], T[i]
    return prepare(system, state, products)


@compiled(forceinline=True)
def turn(columns, operators, x, back):
    """Multiply rotations in a vector by operators, or by their transposes."""
    for r in range(columns.places.size):
        first, R = columns.places[r], operators[r]
        a, b, c = x[first], x[first + 1], x[first + 2]
        for i in range(3):
            x[first + i] = (R[i] * a + R[3 + i] * b + R[6 + i] * c if back else
                            R[3 * i] * a + R[3 * i + 1] * b + R[3 * i + 2] * c)
