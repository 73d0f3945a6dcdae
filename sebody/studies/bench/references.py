"""Reference paths of the tip, from the checkout's test data, and errors against them."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

FOLDER = Path(__file__).parents[3] / "tests" / "data"


def tip_error(name: str, t: NDArray, tip: NDArray) -> float | None:
    """Relative L2 error of the tip's path at the times that the reference has, too.

    None outside a checkout, where there is no reference.
    """
    path = FOLDER / f"{name}.npz"
    if not path.exists():
        return None
    data = np.load(path)
    place = np.searchsorted(data["t"], t - 1e-9)
    shared = (place < len(data["t"]))
    shared[shared] &= np.abs(data["t"][place[shared]] - t[shared]) < 1e-9
    exact = data["tip_position"][place[shared]][:, :tip.shape[1]]
    return float(np.linalg.norm(tip[shared] - exact) / np.linalg.norm(exact))
