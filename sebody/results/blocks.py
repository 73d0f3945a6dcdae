"""Arrays as blocks of whole numbers in one stretch of bytes, which the page of an animation reads.

Each column of an array is stored in steps of its own range, 16 bits a number; 32 bits where steps
of 16 bits would be seen, 8 for colours. Columns that do not change are not stored.
"""

import numpy as np
from numpy.typing import NDArray

ALIGNED = 4             # bytes: where blocks begin


class Blocks:
    """Bytes that are collected, and what stands for each array in the header."""

    def __init__(self) -> None:
        self._pieces: list[bytes] = []
        self._length = 0
        self._known: dict[bytes, dict] = {}

    def values(self, array: NDArray, seen: float = np.inf) -> dict:
        """A block of (rows, columns) of numbers.

        Parameters
        ----------
        seen : float
            Smallest difference that is seen: steps are not larger.
        """
        array = np.asarray(array, dtype=float)
        low, high = (array.min(axis=0), array.max(axis=0)) if len(array) else (
            np.zeros(array.shape[1]),) * 2
        varying = np.flatnonzero(high > low)
        wide = np.any((high - low) / 0xFFFF > seen)
        most, kind = (0xFFFFFFFF, "<u4") if wide else (0xFFFF, "<u2")
        step = (high - low)[varying] / most
        # ranges of denormal numbers have no step: they are constant
        varying, step = varying[step > 0], step[step > 0]
        whole = np.rint((array[:, varying] - low[varying]) / step).astype(kind)
        return self._block(whole, {"shape": list(array.shape), "low": low.tolist(),
                                   "step": step.tolist(), "varying": varying.tolist()})

    def colours(self, array: NDArray) -> dict:
        """A block of (rows, columns) of numbers from 0 to 1, to 1/255."""
        whole = np.rint(255 * np.asarray(array)).astype("u1")
        return self._block(whole, {"shape": list(whole.shape)})

    def indices(self, array: NDArray) -> dict:
        """A block of whole numbers >= 0."""
        array = np.asarray(array)
        kind = "<u4" if array.size and array.max() > 0xFFFF else "<u2"
        return self._block(array.ravel().astype(kind), {"count": int(array.size)})

    def bytes(self) -> bytes:
        """All blocks, one after the other."""
        return b"".join(self._pieces)

    def _block(self, whole: NDArray, described: dict) -> dict:
        content = whole.tobytes()
        if content not in self._known:          # bodies of a kind share their shapes
            padded = content + bytes(-len(content) % ALIGNED)
            self._known[content] = {"at": self._length, "bytes": whole.itemsize}
            self._pieces.append(padded)
            self._length += len(padded)
        return self._known[content] | described
