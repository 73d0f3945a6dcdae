"""The text of a Matrix Market file, with every count and index compared with what is there.

SciPy's reader trusts a file: it allocates the memory that a damaged header asks for, and writes to
places outside the matrix.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from sebody.basics import inputs
from sebody.io.triplets import WrongEntry, symmetric

_WORDS = {"layout": ("coordinate", "array"), "numbers": ("real", "integer", "double"),
          "symmetry": ("general", "symmetric")}


class Market(NamedTuple):
    """A text whose beginning is understood.

    Parameters
    ----------
    shape : tuple of int
    entries : int or None
        How many there are; None of a layout without places.
    symmetric : bool
        Whether it is one triangle.
    body : str
        The lines of the entries.
    """

    shape: tuple[int, int]
    entries: int | None
    symmetric: bool
    body: str

    def matrix(self) -> sparse.csc_array:
        """The whole matrix, of a shape that the caller has compared with what it expects.

        Raises
        ------
        ValueError
            Too few or too many entries, texts, or places outside the matrix.
        """
        values = np.array(self.body.lower().replace("d", "e").split(), dtype=float)
        rows, columns, values = (self._by_columns(values) if self.entries is None else
                                 self._with_places(values))
        if self.symmetric:
            return self._whole(rows, columns, values)
        matrix = sparse.csc_array(sparse.coo_array((values, (rows, columns)), shape=self.shape))
        if matrix.nnz < len(values):
            self._whole(rows, columns, values)
        return matrix

    def _whole(self, rows: NDArray, columns: NDArray, values: NDArray) -> sparse.csc_array:
        try:
            return symmetric(rows, columns, values, self.shape[0])
        except WrongEntry as error:
            k = error.entry
            raise ValueError(f"entry {k + 1}, ({rows[k] + 1}, {columns[k] + 1}), {error}"
                             ) from error

    def _by_columns(self, values: NDArray) -> tuple[NDArray, NDArray, NDArray]:
        columns, rows = np.indices(self.shape[::-1]).reshape(2, -1)
        if self.symmetric:
            below = rows >= columns
            rows, columns = rows[below], columns[below]
        if len(values) != len(rows):
            raise ValueError(f"{len(values)} entries of {len(rows)}")
        return rows, columns, values

    def _with_places(self, values: NDArray) -> tuple[NDArray, NDArray, NDArray]:
        if len(values) != 3 * self.entries:
            raise ValueError(f"{len(values) / 3:.6g} entries of {self.entries}")
        rows, columns, values = values.reshape(-1, 3).T
        for name, places, most in (("row", rows, self.shape[0]), ("column", columns,
                                                                 self.shape[1])):
            wrong = (places != np.floor(places)) | (places < 1) | (places > most)
            if wrong.any():
                raise ValueError(f"{name} {places[wrong][0]:g} of {most}")
        return rows.astype(int) - 1, columns.astype(int) - 1, values


def parsed(text: str) -> Market:
    """The beginning of a text: kind, layout and size.

    Raises
    ------
    ValueError
        It is not that of a matrix of real numbers.
    """
    banner, _, rest = text.partition("\n")
    words = banner.lower().split()
    if words[:2] != ["%%matrixmarket", "matrix"] or len(words) != 5:
        raise ValueError(f"it begins with {inputs.shown(banner)}")
    for name, word in zip(_WORDS, words[2:], strict=True):
        if word not in _WORDS[name]:
            raise ValueError(f"{name} of type {word}, not {' or '.join(_WORDS[name])}")
    while rest.startswith("%") or rest[:1].isspace():
        rest = rest.partition("\n")[2] if rest.startswith("%") else rest.lstrip()
    sizes, _, body = rest.partition("\n")
    counts = [int(word) for word in sizes.split()]
    places = words[2] == "coordinate"
    if len(counts) != 2 + places or min(counts) < 0:
        raise ValueError(f"its size is {inputs.shown(sizes)}")
    if places and 2 * counts[2] > len(body):      # a digit and a blank at the very least
        raise ValueError(f"{counts[2]} entries in {len(body)} bytes")
    return Market((counts[0], counts[1]), counts[2] if places else None, words[4] == "symmetric",
                  body)
