"""Matrix Market: two matrices, the mapping of their rows, and the places of the nodes.

Ansys writes such files by APDL (``*EXPORT, ..., MMF`` or ``HBMAT``), and so does ``scipy.io``. A
body ``NAME`` is ``NAME_K.mtx``, ``NAME_M.mtx``, ``NAME.mapping`` with ``row node DOF`` a line, as
``HBMAT`` writes it (DOF UX to ROTZ, or 1 to 6), and ``NAME.nodes`` with ``node x y z``, as NLIST.

Every count and index is compared with what is there. SciPy's reader trusts a file: it allocates the
memory that a damaged header asks for, and writes to places outside the matrix.
"""

import re
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.fem.model import FEModel
from sebody.io.reading import Reading
from sebody.io.reduced import NAMES
from sebody.io.text import fault, first_repeated, read_text
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


_DIRECTIONS = {word: name for k, name in enumerate(NAMES)
               for word in (("UX", "UY", "UZ", "ROTX", "ROTY", "ROTZ")[k], str(k + 1),
                            name.upper())}
_NO_MESH = ("the files have no mesh and no materials; give the FE model of read_fe_model its "
            "stress=solid_stress(...), or divide the body where it spins fast")
_REMEDY = "give NAME_K.mtx, NAME_M.mtx, NAME.mapping and NAME.nodes, see sebody/io/README.md"


def read(path: Path) -> Reading:
    """The FE model of the files.

    Parameters
    ----------
    path : Path
        ``NAME_K.mtx`` or ``NAME_M.mtx``.

    Raises
    ------
    InputError
        A missing or damaged file, matrices that do not fit the mapping, or nodes without a place.
    """
    match = re.fullmatch(r"(.+)_[KM]", path.stem)
    if not match:
        raise InputError(f"{path} is not named NAME_K.mtx or NAME_M.mtx: {_REMEDY}")
    name = match[1]
    mapping = path.with_name(f"{name}.mapping")
    rows = _mapping(mapping)
    stiffness, mass = (_matrix(path.with_name(f"{name}_{kind}.mtx"), len(rows), mapping)
                       for kind in "KM")
    points = _nodes(path.with_name(f"{name}.nodes"))
    index = {label: k for k, label in enumerate(points)}
    for label, _ in rows:
        if label not in index:
            raise InputError(f"{mapping} has rows of node {label}, which has no place in "
                             f"{path.with_name(f'{name}.nodes')}: list all nodes there")
    model = FEModel(stiffness, mass, np.array(list(points.values())),
                    dof_map=[(index[label], kind) for label, kind in rows],
                    labels=np.array(list(points)), source=f"Matrix Market {name}",
                    missing=dict.fromkeys(("stresses", "stiffening"), _NO_MESH))
    return Reading(model)


def _matrix(path: Path, size: int, mapping: Path) -> sparse.csc_array:
    text = read_text(path, "matrix file", _REMEDY)
    try:
        market = parsed(text)
        if market.shape == (size, size):
            matrix = market.matrix()
    except ValueError as error:
        raise InputError(f"matrix file {path} is no Matrix Market file, or cut off ({error}): "
                         "export it again") from error
    if market.shape != (size, size):
        raise InputError(f"matrix file {path} has shape {market.shape}, but {mapping} lists "
                         f"{size} rows: give files of one export")
    lower, upper = sparse.tril(matrix, -1), sparse.triu(matrix, 1)
    if bool(lower.count_nonzero()) != bool(upper.count_nonzero()):   # one triangle, called general
        matrix = matrix + (lower + upper).T
    return sparse.csc_array(matrix)


def _mapping(path: Path) -> list[tuple[int, str]]:
    """Node and name of the DOF of every row, in the order of the rows."""
    mapping: dict[int, tuple[int, str]] = {}
    for number, line in enumerate(read_text(path, "mapping", _REMEDY).splitlines(), 1):
        words = line.replace(",", " ").split()
        if len(words) != 3 or not (words[0].isdecimal() and words[1].isdecimal()):
            if mapping and words:
                raise fault(path, number, "no row, node and DOF", _REMEDY)
            continue                    # headings
        row, node, kind = int(words[0]), int(words[1]), _DIRECTIONS.get(words[2].upper())
        if kind is None:
            raise fault(path, number, f"DOF {words[2]} is not a mechanical DOF", "leave out "
                                                                                 "elements "
                        "with pressures, temperatures and Lagrange multipliers")
        if row in mapping:
            raise fault(path, number, f"row {row} occurs twice", "export it again")
        mapping[row] = node, kind
    missing = sorted(set(range(1, len(mapping) + 1)) - set(mapping))
    if not mapping or missing:
        raise InputError(f"mapping {path} has no row {missing[0] if missing else 1}: the file is "
                         "cut off, export it again")
    rows = [mapping[row] for row in sorted(mapping)]
    twice = first_repeated(rows)
    if twice:
        raise InputError(f"mapping {path} gives rows {twice[0] + 1} and {twice[1] + 1} the same "
                         f"DOF, {rows[twice[1]][1]} of node {rows[twice[1]][0]}: export it again")
    return rows


def _nodes(path: Path) -> dict[int, list[float]]:
    """Places by label; lines that begin with no whole number are headings."""
    coordinates: dict[int, list[float]] = {}
    for number, line in enumerate(read_text(path, "node file", _REMEDY).splitlines(), 1):
        words = line.replace(",", " ").split()
        if not words or not words[0].isdecimal():
            continue
        try:
            place = [float(word) for word in words[1:4]]
        except ValueError:
            place = []
        if len(place) != 3 or not np.isfinite(place).all():
            raise fault(path, number, "no node with three coordinates", _REMEDY)
        if int(words[0]) in coordinates:
            raise fault(path, number, f"node {words[0]} occurs twice", "list each node once")
        coordinates[int(words[0])] = place
    if not coordinates:
        raise InputError(f"node file {path} has no nodes: {_REMEDY}")
    return coordinates
