"""What an old inverse says of the solution of a step, without products: see `step_equation`."""

from sebody.compiler.decorators import compiled
from sebody.engine.evaluate import to_body_axes
from sebody.gradients.columns import GUESSES


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
