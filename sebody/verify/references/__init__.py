"""Reference solutions: geometrically exact beams, from a program that shares nothing with this one.

`tests/data/geometrically_exact_beam.py` of the repository makes the files; the README beside it
lists their contents and errors.
"""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray


def reference(name: str) -> dict[str, NDArray]:
    """Histories of a scene, such as ``t`` (n,) and ``tip_position`` (n, 3).

    Parameters
    ----------
    name : str
        ``hinged_beam``, ``spherical_beam`` or ``spherical_beam_strong``.
    """
    with np.load(Path(__file__).with_name(f"{name}.npz")) as data:
        return dict(data)


def tip_error(name: str, t: NDArray, tip: NDArray) -> float:
    """Relative L2 error of the tip's path at the times that the reference has, too.

    Parameters
    ----------
    name : str
        Of the reference.
    t : (m,) array
        Times of the path.
    tip : (m, 2) or (m, 3) array
        Positions.
    """
    exact = reference(name)
    place = np.searchsorted(exact["t"], t - 1e-9)
    shared = (place < len(exact["t"]))
    shared[shared] &= np.abs(exact["t"][place[shared]] - t[shared]) < 1e-9
    path = exact["tip_position"][place[shared]][:, :tip.shape[1]]
    return float(np.linalg.norm(tip[shared] - path) / np.linalg.norm(path))
