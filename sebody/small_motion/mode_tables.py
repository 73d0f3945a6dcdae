"""Modes of small motion as tables: frequencies and damping."""

import numpy as np
from numpy.typing import NDArray

from sebody.basics import tabular

HEADS = "mode", "frequency [Hz]", "damping ratio", "real part [1/s]"
RIGID = 1e-7        # of the largest eigenvalue: a smaller one is that of a rigid motion
ROUNDING = 1e-12    # damping ratio that is none


def frequencies(values: NDArray) -> NDArray:
    """Frequencies of eigenvalues, in cycles per unit of time: Hz where it is the second."""
    return np.asarray(values).imag / (2 * np.pi)


def damping_ratios(values: NDArray) -> NDArray:
    """Damping over critical damping of eigenvalues; NaN of rigid motions, which have none."""
    size = np.abs(values)
    known = size > RIGID * size.max(initial=0.0)
    return np.where(known, -np.real(values) / np.where(known, size, 1.0), np.nan)


def text(title: str, values: NDArray) -> str:
    """Eigenvalues as a table of text."""
    return tabular.text(title, HEADS, _rows(values))


def html(title: str, values: NDArray) -> str:
    """Eigenvalues as a table of HTML."""
    return tabular.titled(title, HEADS, _rows(values))


def _rows(values: NDArray) -> list[tuple[str, ...]]:
    return [(str(k + 1), f"{frequency:.6g}", _ratio(ratio), f"{value.real + 0.0:.4g}")
            for k, (value, frequency, ratio) in enumerate(zip(
                values, frequencies(values), damping_ratios(values), strict=True))]


def _ratio(ratio: float) -> str:
    return "-" if np.isnan(ratio) else "0" if abs(ratio) < ROUNDING else f"{ratio:.4g}"
