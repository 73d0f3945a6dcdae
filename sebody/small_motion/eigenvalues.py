"""Eigenvalues of small motion ``M x'' + C x' + K x = 0``, and how far rounding leaves them open.

With the mass factors ``M = L L^T``, ``u = L^T x`` and the stiffness ``V diag(k) V^T`` in these
coordinates, ``y = D V^T u`` and ``w = u'`` follow

    [ y' ]   [ 0                  D V^T ] [ y ]
    [ w' ] = [ -K V D^-1          -C    ] [ w ]      D = diag(sqrt |k|)

whose entries are frequencies, not their squares: rounding is relative to the highest frequency.
Where nothing takes or gives energy (K is symmetric, C is skew) and K is positive, the matrix is
skew-symmetric. Its eigenvalues are those of a Hermitian matrix, without any growth.

What rounding of the three matrices moves an eigenvalue by is at most, to first order and with its
vectors x and y (F. Tisseur, Linear Algebra and its Applications 309, 2000, p. 339),

    eps |y|^T (|K| + |v| |C| + |v|^2 |M|) |x| / |y^H (2 v M + C) x|
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import LinAlgError, cholesky, eig, eigh, solve_triangular

EPS = np.finfo(float).eps
DAMPED = 10.0       # damping that is rounding, by that of the masses times the highest frequency
TINY = 1e-300
NEGLIGIBLE = 100 * EPS  # part of the largest square of a frequency that is rounding of all squares
FLUTTER = 1e-6      # imaginary over real part of a square: less comes from rounding of double ones


class Eigenvalues(NamedTuple):
    """Eigenvalues of one of each conjugate pair, by ascending frequency."""

    values: NDArray     # (m,) complex
    shapes: NDArray     # (n, m) complex, of unit length, their largest component real
    rounding: NDArray   # (m,) size of the part of the values that is rounding


class _Pairs(NamedTuple):
    """Eigenvalues with right and left vectors of unit mass, and what the solver adds to errors."""

    values: NDArray
    right: NDArray
    left: NDArray
    added: float


def eigenvalues(M: NDArray, C: NDArray, K: NDArray) -> Eigenvalues:
    """Eigenvalues of three matrices (n, n); the mass may be singular."""
    try:
        L = cholesky((M + M.T) / 2, lower=True)
    except LinAlgError:
        roots = _without_mass(M, C, K)
    else:
        own = _by_mass(*(_over(A, L) for A in (C, K)), *_noise(M, K, L))
        roots = own._replace(right=_under(own.right, L), left=_under(own.left, L))
    order = np.lexsort((roots.values.real, roots.values.imag))
    values, right, left = roots.values[order], roots.right[:, order], roots.left[:, order]
    return Eigenvalues(values, _normalised(right),
                       _rounding(M, C, K, values, right, left) + roots.added)


def undamped(M: NDArray, K: NDArray) -> tuple[NDArray, NDArray]:
    """Squares of frequencies without damping, ascending, and shapes of unit mass, both real.

    Forces that turn with what they act on, and moments, have a stiffness that is not symmetric. In
    the shapes of its symmetric part its skew part couples them, and may make pairs complex.

    Raises
    ------
    LinAlgError
        The mass is singular.
    ArithmeticError
        Squares are complex: some motion flutters.
    """
    squares, shapes = eigh((K + K.T) / 2, (M + M.T) / 2)
    skew = shapes.T @ ((K - K.T) / 2) @ shapes
    rounding = NEGLIGIBLE * np.abs(squares).max(initial=0.0)
    if np.abs(skew).max(initial=0.0) <= rounding:
        return squares, shapes
    values, turns = eig(np.diag(squares) + skew)
    if np.any(np.abs(values.imag) > FLUTTER * np.abs(values.real) + rounding):
        raise ArithmeticError
    order = np.argsort(values.real)
    turns = turns[:, order].real
    return values.real[order], shapes @ (turns / np.linalg.norm(turns, axis=0))


def _over(A: NDArray, L: NDArray) -> NDArray:
    """``L^-1 A L^-T``."""
    return solve_triangular(L, solve_triangular(L, A, lower=True).T, lower=True).T


def _under(shapes: NDArray, L: NDArray) -> NDArray:
    """``L^-T shapes``."""
    return solve_triangular(L, shapes, trans="T", lower=True)


def _noise(M: NDArray, K: NDArray, L: NDArray) -> tuple[NDArray, NDArray]:
    """Errors by rounding of M and K in the unit mass and stiffness of undamped modes, (n,)."""
    own = _over(K, L)
    shapes = np.abs(_under(eigh((own + own.T) / 2)[1], L))
    return tuple(EPS * np.einsum("ij,ik,kj->j", shapes, np.abs(A), shapes) for A in (M, K))


def _by_mass(C: NDArray, K: NDArray, inert: NDArray, elastic: NDArray) -> _Pairs:
    """Eigenvalues of a unit mass; `inert` and `elastic` are the rounding of mass and stiffness."""
    n = len(K)
    k, V = eigh((K + K.T) / 2)
    null = np.abs(k) <= elastic
    fastest = max(np.sqrt(np.abs(k).max(initial=0.0)), np.linalg.norm(C, 2))
    damping = np.linalg.norm(C + C.T, 2) / 2
    conservative = (np.linalg.norm(K - K.T, 2) / 2 <= elastic.max(initial=0.0) and
                    damping <= DAMPED * inert.max(initial=0.0) * fastest)
    if conservative:
        C, k = (C - C.T) / 2, np.where(null, 0.0, k)
        if np.all(k >= 0.0):
            return _undamped(C, k, V, damping)
    D = np.sqrt(np.maximum(np.abs(k), elastic))
    D[D == 0.0] = 1.0
    forces = V * k if conservative else K @ V
    A = np.block([[np.zeros((n, n)), D[:, None] * V.T], [-forces / D, -C]])
    values, left, right = eig(A, left=True)
    upper = values.imag >= 0.0
    return _Pairs(values[upper], V @ (right[:n, upper] / D[:, None]), left[n:, upper],
                  n * EPS * fastest + damping * conservative)


def _undamped(C: NDArray, k: NDArray, V: NDArray, dropped: float) -> _Pairs:
    """Eigenvalues of a gyroscopic motion with a stiffness that is positive, or zero.

    A motion without stiffness has the value 0 twice, at rest and at constant speed, unless the
    gyroscopic matrix couples it to others.
    """
    null = k == 0.0
    stiff = V[:, ~null] * np.sqrt(k[~null])
    m, n = stiff.shape[1], len(V)
    A = np.block([[np.zeros((m, m)), stiff.T], [-stiff, -C]])
    frequencies, vectors = eigh(-1j * A)
    added = n * EPS * np.abs(frequencies).max(initial=0.0)
    zero = np.abs(frequencies) <= added
    kept = zero | (frequencies > 0.0)
    values = 1j * np.concatenate([np.where(zero, 0.0, frequencies)[kept], np.zeros(null.sum())])
    shapes = np.hstack([vectors[m:, kept], V[:, null]])
    return _Pairs(values, shapes, shapes, added + dropped)


def _without_mass(M: NDArray, C: NDArray, K: NDArray) -> _Pairs:
    """Eigenvalues where some motion has no mass: those of a pencil, infinite ones left out."""
    n = len(M)
    identity, zero = np.eye(n), np.zeros((n, n))
    values, left, right = eig(np.block([[zero, identity], [-K, -C]]),
                              np.block([[identity, zero], [zero, M]]), left=True)
    finite = np.isfinite(values) & (values.imag >= 0.0)
    return _Pairs(values[finite], right[:n, finite], left[n:, finite],
                  EPS * np.abs(values[finite]).max(initial=0.0))


def _rounding(M: NDArray, C: NDArray, K: NDArray, values: NDArray, right: NDArray, left: NDArray
              ) -> NDArray:
    """Shift of eigenvalues by rounding of the matrices; of double ones by the root of it."""
    x, y, v = np.abs(right), np.abs(left), np.abs(values)
    change = EPS * sum(factor * np.einsum("ij,ik,kj->j", y, np.abs(A), x)
                       for factor, A in ((1.0, K), (v, C), (v * v, M)))
    inertia = np.einsum("ij,ik,kj->j", left.conj(), M, right)
    slope = np.abs(2.0 * values * inertia + np.einsum("ij,ik,kj->j", left.conj(), C, right))
    return np.minimum(change / np.maximum(slope, TINY),
                      np.sqrt(change / np.maximum(np.abs(inertia), TINY)))


def _normalised(shapes: NDArray) -> NDArray:
    largest = np.take_along_axis(shapes, np.abs(shapes).argmax(axis=0)[None], axis=0)
    turn = np.where(largest == 0.0, 1.0, np.conj(largest) / np.maximum(np.abs(largest), TINY))
    return shapes * turn / np.maximum(np.linalg.norm(shapes, axis=0), TINY)
