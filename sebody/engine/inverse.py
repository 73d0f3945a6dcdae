"""Inverse of a small matrix in compiled code; not LAPACK's, which exports would have to bring."""

import numpy as np

from sebody.compiler.decorators import compiled
from sebody.kernels.abi import at, pointer_to


@compiled
def invert(A):
    """Replace a matrix by its inverse; False if it is singular or not finite.

    Gauss-Jordan elimination in place with row exchanges, see G. H. Golub and C. F. Van Loan,
    Matrix Computations, 3.4.
    """
    n = A.shape[0]
    exchanged = np.empty(n, np.int64)
    for k in range(n):
        p, largest = k, abs(A[k, k])
        for i in range(k + 1, n):
            if abs(A[i, k]) > largest:
                p, largest = i, abs(A[i, k])
        if not 0.0 < largest < np.inf:
            return False
        exchanged[k] = p
        if p != k:
            _exchange(A[k], A[p])
        factor = 1.0 / A[k, k]
        A[k, k] = 1.0
        for j in range(n):
            A[k, j] *= factor
        row = at(pointer_to(A), n * k)
        for i in range(n):
            if i != k:
                factor, A[i, k] = A[i, k], 0.0
                _subtract(n, factor, row, at(pointer_to(A), n * i))
    for k in range(n - 1, -1, -1):
        if exchanged[k] != k:
            _exchange(A[:, k], A[:, exchanged[k]])
    return True


@compiled(forceinline=True, apart=True)
def _subtract(n, factor, row, other):
    for j in range(n):
        other[j] -= factor * row[j]


@compiled
def _exchange(a, b):
    for j in range(a.size):
        a[j], b[j] = b[j], a[j]
