"""Regulators of the scenes with controllers: SciPy's Riccati equation on a state space."""

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm, solve_discrete_are

from sebody.analysis import StateSpace


def sampled(system: StateSpace, period: float) -> tuple[NDArray, NDArray]:
    """A and B in discrete time of a system whose inputs hold between samples."""
    n, m = system.B.shape
    E = expm(period * np.block([[system.A, system.B], [np.zeros((m, n + m))]]))
    return E[:n, :n], E[:n, n:]


def regulator(system: StateSpace, Q: NDArray, R: NDArray, period: float) -> NDArray:
    """The gain K of ``u = -K x`` that minimizes the sum of ``x'Q x + u'R u`` over the samples."""
    A, B = sampled(system, period)
    X = solve_discrete_are(A, B, Q, R)
    return np.linalg.solve(R + B.T @ X @ B, B.T @ X @ A)
