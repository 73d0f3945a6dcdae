"""Arrays as blocks of whole numbers in one stretch of bytes, which the page of an animation reads.

Each column of an array is stored in steps of its own range, of 16 bits or fewer a number; of 32
bits where such steps would be seen. Columns that do not change are not stored. The numbers of a
column are stored as their differences, all low bytes of a block before all high ones: so they
compress well.
"""

import zlib

import numpy as np
from numpy.typing import NDArray

DIGITS = 12             # of the ranges of columns


class Blocks:
    """Bytes that are collected, and what stands for each array in the header."""

    def __init__(self) -> None:
        self._pieces: list[bytes] = []
        self._length = 0
        self._known: dict[bytes, dict] = {}

    def values(self, array: NDArray, seen: float = np.inf, bits: int = 16) -> dict:
        """A block of (rows, columns) of numbers.

        Parameters
        ----------
        seen : float
            Smallest difference that is seen: steps are not larger.
        bits : int
            Of a number, unless `seen` asks for more; fewer than 16 compress better.
        """
        array = np.asarray(array, dtype=float)
        low, high = (array.min(axis=0), array.max(axis=0)) if len(array) else (
            np.zeros(array.shape[1]),) * 2
        low = np.array([float(f"{value:.{DIGITS}g}") for value in low])
        varying = np.flatnonzero(high > low)
        most, kind = (1 << bits) - 1, "<u2"
        if np.any((high - low) / most > seen):
            most, kind = 0xFFFFFFFF, "<u4"
        step = np.array([float(f"{value:.{DIGITS}g}") for value in (high - low)[varying] / most])
        # ranges of denormal numbers have no step: they are constant
        varying, step = varying[step > 0], step[step > 0]
        whole = np.clip(np.rint((array[:, varying] - low[varying]) / step), 0, most).astype(kind)
        return self._block(whole, {"shape": list(array.shape), "low": low.tolist(),
                                   "step": step.tolist(), "varying": varying.tolist()})

    def indices(self, array: NDArray) -> dict:
        """A block of whole numbers >= 0."""
        array = np.asarray(array)
        kind = "<u4" if array.size and array.max() > 0xFFFF else "<u2"
        return self._block(array.reshape(-1, 1).astype(kind), {"count": int(array.size)})

    def bytes(self) -> bytes:
        """All blocks, one after the other, compressed."""
        return zlib.compress(b"".join(self._pieces), 9)

    def _block(self, whole: NDArray, described: dict) -> dict:
        columns = np.ascontiguousarray(whole.T)
        steps = np.diff(columns, axis=1, prepend=columns.dtype.type(0))
        signed = steps.view(steps.dtype.str.replace("u", "i"))
        # -1, 1, -2 become 1, 2, 3: high bytes of small differences are zero
        plain = ((signed << 1) ^ (signed >> (8 * signed.itemsize - 1))).view(steps.dtype)
        content = plain.ravel().view("u1").reshape(-1, plain.itemsize).T.tobytes()
        if content not in self._known:          # bodies of a kind share their shapes
            self._known[content] = {"at": self._length, "bytes": whole.itemsize}
            self._pieces.append(content)
            self._length += len(content)
        return self._known[content] | described
