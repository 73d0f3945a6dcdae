"""Small dense products the kernels call."""

from numba import njit


@njit(cache=True, error_model="numpy")
def symmetric_product(A, x, out, n):
    """``out = A x`` of a symmetric (n, n) matrix stored flat: columns are added up row by row."""
    for i in range(n):
        out[i] = A[i] * x[0]
    for j in range(1, n):
        xj = x[j]
        first = j * n
        for i in range(n):
            out[i] += A[first + i] * xj


@njit(cache=True, error_model="numpy")
def inverse_3(a, b, c, d, e, f, g, h, i):
    """Inverse of a 3x3 matrix, row by row, by cofactors."""
    A, B, C = e * i - f * h, f * g - d * i, d * h - e * g
    r = 1.0 / (a * A + b * B + c * C)
    return (A * r, (c * h - b * i) * r, (b * f - c * e) * r,
            B * r, (a * i - c * g) * r, (c * d - a * f) * r,
            C * r, (b * g - a * h) * r, (a * e - b * d) * r)
