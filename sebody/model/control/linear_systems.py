"""Laws that are linear systems of matrices A, B, C, D: as given, or made as filters."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.model.control.law import Flow, Law, constant


def discrete(A: ArrayLike, B: ArrayLike, C: ArrayLike, D: ArrayLike) -> Law:
    """``u = C x + D y``, then ``x = A x + B y``: a linear system in discrete time, as it is.

    Parameters
    ----------
    A, B, C, D : (k, k), (k, n), (m, k), (m, n)
        Such as a compensator by python-control with the controller's period.
    """
    matrices = _matrices("discrete", A, B, C, D)
    k, (m, n) = len(matrices[0]), matrices[3].shape
    return Law("a discrete system", _discrete, (n,), m, np.zeros(k), constant(*matrices))


def linear(A: ArrayLike, B: ArrayLike, C: ArrayLike, D: ArrayLike) -> Law:
    """``x' = A x + B y``, ``u = C x + D y``: a linear system in continuous time.

    Parameters
    ----------
    A, B, C, D : (k, k), (k, n), (m, k), (m, n)
        Such as a compensator or an observer by python-control.
    """
    matrices = _matrices("linear", A, B, C, D)
    k, (m, n) = len(matrices[0]), matrices[3].shape
    return Law("a linear system", _only_continuous, (n,), m, np.zeros(k), _needs_no_period(
        "linear"), _linear_flow(matrices))


def _linear_flow(matrices: list[NDArray]) -> Flow:
    A, B, C, D = matrices
    return Flow(_linear, np.zeros(len(A)), constant(np.block([[B, A], [D, C]]))(0.0),
                _linear_derivatives)


def _linear(t, y, x, rates, u, parameters):
    n, k, m = y.size, x.size, u.size
    for i in range(k + m):
        row, total = i * (n + k), 0.0
        for j in range(n):
            total += parameters[row + j] * y[j]
        for j in range(k):
            total += parameters[row + n + j] * x[j]
        if i < k:
            rates[i] = total
        else:
            u[i - k] = total


def _linear_derivatives(t, y, x, derivatives, parameters):
    rows, columns = derivatives.shape
    for i in range(rows):
        for j in range(columns):
            derivatives[i, j] = parameters[i * columns + j]


def _only_continuous(t, y, x, u, parameters):
    u[0] = np.nan


def _needs_no_period(name: str) -> Callable[[float], NDArray]:
    def refuse(period: float) -> NDArray:
        raise InputError(f"{name} is a law in continuous time and was given the period {period:g}: "
                         "leave out period=, or give discrete(A, B, C, D) for it")
    return refuse


def _matrices(law: str, A: ArrayLike, B: ArrayLike, C: ArrayLike, D: ArrayLike) -> list[NDArray]:
    A, D = (np.atleast_2d(inputs.array(np.atleast_2d(X), f"{law}: {name}", (None, None)))
            for name, X in (("A", A), ("D", D)))
    k, (m, n) = len(A), D.shape
    return [inputs.array(np.reshape(X, shape) if np.size(X) == shape[0] * shape[1] else X,
                         f"{law}: {name}", shape)
            for name, X, shape in (("A", A, (k, k)), ("B", B, (k, n)), ("C", C, (m, k)),
                                   ("D", D, (m, n)))]


def _discrete(t, y, x, u, parameters):
    k, n, m = x.size, y.size, u.size
    A, B = parameters[:k * k], parameters[k * k:k * k + k * n]
    C, D = parameters[k * (k + n):k * (k + n + m)], parameters[k * (k + n + m):]
    for i in range(m):
        u[i] = 0.0
        for j in range(k):
            u[i] += C[i * k + j] * x[j]
        for j in range(n):
            u[i] += D[i * n + j] * y[j]
    after = np.zeros(k)
    for i in range(k):
        for j in range(k):
            after[i] += A[i * k + j] * x[j]
        for j in range(n):
            after[i] += B[i * n + j] * y[j]
    for i in range(k):
        x[i] = after[i]


def low_pass(frequency: float, order: int = 2) -> Law:
    """Butterworth's low-pass filter of one signal; sampled by Tustin's rule.

    Parameters
    ----------
    frequency : float
        Cut-off frequency in cycles per unit of time, below half of the sampling frequency.
    order : int
    """
    frequency = inputs.number(frequency, "low_pass: frequency", above=0.0)
    order = inputs.integer(order, "low_pass: order", least=1, most=10)

    def packed(period: float) -> NDArray:
        from scipy.signal import butter, tf2ss  # takes 0.2 s to import

        if not 2.0 * frequency * period < 1.0:
            raise InputError(f"low_pass: frequency is {frequency:g}, and the period {period:g} "
                             f"samples it with {1 / period:g}: give less than half of this")
        return constant(*tf2ss(*butter(order, 2.0 * frequency * period)))(period)

    return Law("a low-pass filter", _discrete, (1,), 1, np.zeros(order), packed,
               _linear_flow(_butterworth(frequency, order)))


def _butterworth(frequency: float, order: int) -> list[NDArray]:
    """Butterworth's filter in continuous time, as sections in series.

    Of a pair of poles ``w^2 / (s^2 + 2 c w s + w^2)``, of a real one ``w / (s + w)``.
    """
    w = 2.0 * np.pi * frequency
    A, B = np.zeros((order, order)), np.zeros((order, 1))
    before, k = -1, 0       # the state that a section gets; the input for the first
    for pair in range(order // 2):
        c = np.sin(np.pi * (2 * pair + 1) / (2 * order))
        A[k, k], A[k, k + 1], A[k + 1, k] = -2.0 * c * w, -w, w
        (B if before < 0 else A)[k, max(before, 0)] = w
        before, k = k + 1, k + 2
    if order % 2:
        A[k, k] = -w
        (B if before < 0 else A)[k, max(before, 0)] = w
    return [A, B, np.eye(order)[-1:], np.zeros((1, 1))]
