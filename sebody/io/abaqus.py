"""Abaqus: ``*SUBSTRUCTURE MATRIX OUTPUT`` and ``*MATRIX GENERATE``, both ``.mtx``.

Neither file has coordinates: they come from the deck, ``.inp`` with the same stem.
"""

import re
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from sebody.basics.errors import InputError
from sebody.io.damping import with_damping
from sebody.io.deck.model import deck_model
from sebody.io.deck.reading import Deck, read_deck
from sebody.io.reading import Reading
from sebody.io.reduced import reduced_parts
from sebody.io.rigid import rigid_residual
from sebody.io.text import fault, read_text, regular_table
from sebody.io.triplets import WrongEntry, symmetric

_SUBSTRUCTURE = "write it with *SUBSTRUCTURE MATRIX OUTPUT, STIFFNESS=YES, MASS=YES"
_GENERATE = ("write it with *MATRIX GENERATE, STIFFNESS, MASS and *MATRIX OUTPUT, STIFFNESS, MASS, "
             "FORMAT=LABELS")
# types of *MATRIX, without blanks
_KINDS = {"stiffness": "STIFFNESS", "mass": "MASS", "damping": "VISCOUSDAMPING"}
_STRUCTURAL = "STRUCTURALDAMPING"
# selectively reduced integration, hourglass control, modified elements
_OWN_WAYS = ("C3D8", "C3D8R", "C3D10M")
_ORDERED = 1e-6     # of forces that rigid motion causes, relative to a row's entries without signs
_HELD = 1e36        # what Abaqus writes on the diagonal of a fixed DOF


def read_substructure(path: Path) -> Reading:
    """The reduced body of a substructure.

    Raises
    ------
    InputError
        A file that is cut off, has no stiffness or mass or only one node's, an unsymmetric
        stiffness, DOFs that are not mechanical, nodes without coordinates.
    """
    labels, directions, matrices = _substructure(path)
    rows = [(label, k) for label, own in zip(labels, directions, strict=True) for k in own]
    found = {name: _square(path, kind, matrices, len(rows))
             for name, kind in _KINDS.items() if name != "damping" or kind in matrices}
    deck = _deck(path)
    points = {label: np.array(point) for label, point in deck.nodes.items()}
    parts, names, left = reduced_parts(found, rows, points, str(path))
    structural = [_STRUCTURAL] if any(matrices.get(_STRUCTURAL, (0, []))[1]) else []
    parts, notes = with_damping(parts, f"*MATRIX, TYPE={_KINDS['damping']}", structural)
    return Reading(parts, names, source=f"Abaqus substructure {path.name}", notes={**left, **notes})


def _square(path: Path, kind: str, matrices: dict, size: int) -> NDArray:
    """The symmetric matrix (size, size) of a type."""
    if kind not in matrices:
        raise InputError(f"{path} has no *MATRIX, TYPE={kind}: {_SUBSTRUCTURE}")
    line, values = matrices[kind]
    if len(values) != size * (size + 1) // 2:
        raise fault(path, line, f"*MATRIX, TYPE={kind} has {len(values)} numbers, but "
                    f"*USER ELEMENT has {size} DOFs, which need {size * (size + 1) // 2}",
                    f"the file is cut off or unsymmetric: {_SUBSTRUCTURE}")
    matrix = np.zeros((size, size))
    matrix[np.tril_indices(size)] = values
    return matrix + np.tril(matrix, -1).T


def _substructure(path: Path) -> tuple[list[int], list[list[int]], dict]:
    """Node labels, their directions from 0, and by type the line and numbers of each matrix."""
    labels: list[int] = []
    at: dict[int, list[int]] = {}       # directions from this position of a node on
    matrices: dict[str, tuple[int, list[float]]] = {}
    where, listing, count = "", False, 0
    for number, line in enumerate(read_text(path, "matrix file", _SUBSTRUCTURE).splitlines(), 1):
        words = [word.strip() for word in line.strip("* \t").split(",") if word.strip()]
        if line.startswith("**"):
            listing = listing and bool(words) and all(word.isdecimal() for word in words)
            labels += [int(word) for word in words] if listing else []
            listing = listing or "ELEMENT NODES" in line
        elif line.startswith("*"):
            where = _keyword(path, number, line)
            if where in matrices:
                raise fault(path, number, f"*MATRIX, TYPE={where} occurs twice, first in line "
                            f"{matrices[where][0]}", f"give one substructure: {_SUBSTRUCTURE}")
            if where in (*_KINDS.values(), _STRUCTURAL):
                matrices[where] = number, []
            elif where == "USER ELEMENT":
                count = _count(path, number, line)
        elif where == "USER ELEMENT" and words:
            first, *own = _whole(path, number, words) if at else [1, *_whole(path, number, words)]
            at[first] = [k - 1 for k in own]
        elif where in matrices:
            matrices[where][1].extend(_numbers(path, number, words))
    if not at or len(labels) != count:
        raise InputError(f"{path} names {len(labels)} of {count} nodes in *USER ELEMENT: "
                         f"{_SUBSTRUCTURE}")
    directions, own = [], []
    for position in range(1, count + 1):
        own = at.get(position, own)
        directions.append(own)
    if len(set(labels)) < len(labels):
        twice = next(label for label in labels if labels.count(label) > 1)
        raise InputError(f"{path} names node {twice} twice, as CalculiX does: its *SUBSTRUCTURE "
                         "GENERATE writes no mass and a stiffness that is not condensed, so use "
                         f"*FREQUENCY, SOLVER=MATRIXSTORAGE; in Abaqus {_SUBSTRUCTURE}")
    return labels, directions, matrices


def _count(path: Path, number: int, line: str) -> int:
    """Number of nodes that *USER ELEMENT states; each has an entry in a list."""
    match = re.search(r"NODES\s*=\s*(\d{1,9})\b", line)
    if not match:
        raise fault(path, number, "*USER ELEMENT has no number of nodes", _SUBSTRUCTURE)
    return int(match[1])


def _keyword(path: Path, number: int, line: str) -> str:
    """``USER ELEMENT``, or the type of a matrix."""
    keyword = line.upper().replace(" ", "")
    if keyword.startswith("*USERELEMENT"):
        if "UNSYM" in keyword:
            raise fault(path, number, "the substructure is unsymmetric", "reduce a symmetric "
                        "model: without *STEP, UNSYMM=YES, friction and follower loads")
        return "USER ELEMENT"
    kind = re.match(r"\*MATRIX,TYPE=(\w+)", keyword)
    return kind[1] if kind else ""


def _whole(path: Path, number: int, words: list[str]) -> list[int]:
    try:
        numbers = [int(word) for word in words]
    except ValueError as error:
        raise fault(path, number, "no list of DOFs", _SUBSTRUCTURE) from error
    return _directions(path, number, numbers)


def _directions(path: Path, number: int, found: list[int]) -> list[int]:
    if any(not 1 <= k <= 6 for k in found[1:]):
        raise fault(path, number, f"DOFs {found}, of which 1 to 6 are those of a body",
                    "reduce a mechanical model without temperatures, and without *SELECT "
                    "EIGENMODES, whose DOFs the file does not distinguish")
    return found


def _numbers(path: Path, number: int, words: list[str]) -> list[float]:
    try:
        numbers = [float(word.upper().replace("D", "E")) for word in words]
    except ValueError as error:
        raise fault(path, number, "no row of numbers", _SUBSTRUCTURE) from error
    if not np.isfinite(numbers).all():
        raise fault(path, number, "a number is not finite", _SUBSTRUCTURE)
    return numbers


def read_generated(path: Path) -> Reading:
    """The FE model of ``JOB_STIF1.mtx`` and ``JOB_MASS1.mtx`` beside ``JOB.inp``.

    Raises
    ------
    InputError
        A missing or damaged file, supports, internal nodes, nodes without coordinates, or rows by
        number that are not those of the deck's nodes in the order of their labels.
    """
    match = re.fullmatch(r"(.*)_(STIF|MASS)(\d+)", path.stem, re.IGNORECASE)
    if not match:
        raise InputError(f"{path} is not named as Abaqus does, JOB_STIF1.mtx and JOB_MASS1.mtx: "
                         "give them their names back")
    job, _, step = match.groups()
    files = [_entries(path.with_name(f"{job}_{kind}{step}.mtx")) for kind in ("STIF", "MASS")]
    deck = _deck(path.with_name(f"{job}.mtx"))
    if files[0].by_number != files[1].by_number:
        raise InputError(f"{files[0].path} and {files[1].path} are of different formats: "
                         f"{_GENERATE}")
    # rows of both, by label and direction; what has mass but no stiffness is there, too
    keys = (_numbered(files, deck) if files[0].by_number else
            np.unique(np.concatenate([pairs for file in files for pairs in file.places]), axis=0))
    unknown = [label for label in keys[:, 0].tolist() if label not in deck.nodes]
    if unknown:
        raise InputError(f"{path} has rows of node {unknown[0]}, which {deck.path} does not have: "
                         "give files of one job, flattened (no parts and instances)")
    stiffness, mass = (file.matrix(keys) for file in files)
    dofs = [(label, direction - 1) for label, direction in keys.tolist()]
    reading = deck_model(deck, list(deck.nodes), dofs, stiffness, mass, f"Abaqus {job}", _OWN_WAYS)
    if files[0].by_number and rigid_residual(reading.model) > _ORDERED:
        raise InputError(f"{files[0].path} resists rigid motion of the nodes of {deck.path} in the "
                         "order of their labels, so its rows are in another order, or the body is "
                         f"held: {_GENERATE}, which names the node of each row")
    kinds = {"damping": "DMPV", "structural damping": "DMPS"}
    damped = {what: file.name for what, kind in kinds.items()
              if (file := path.with_name(f"{job}_{kind}{step}.mtx")).exists()}
    if not damped:
        return reading
    missing = {what: f"{name} is not reduced; give the body damping ratios of its modes"
               for what, name in damped.items()}
    return reading._replace(model=replace(
        reading.model, missing={**reading.model.missing, **missing}))


class Entries(NamedTuple):
    """Entries of a matrix of *MATRIX OUTPUT.

    Parameters
    ----------
    path : Path
    rows : (n, 5) or (n, 3)
        Label, direction, label, direction, value; or row, column, value.
    lines : (n,)
        Their lines in the file.
    """

    path: Path
    rows: NDArray
    lines: NDArray

    @property
    def by_number(self) -> bool:
        """Tell whether the file is of FORMAT=COORDINATE, which names no nodes."""
        return self.rows.shape[1] == 3

    @property
    def places(self) -> tuple[NDArray, NDArray]:
        """Label and direction of the rows and of the columns, (n, 2) each."""
        whole = self.rows[:, :4].astype(int)
        return whole[:, :2], whole[:, 2:]

    def matrix(self, keys: NDArray) -> sparse.csc_array:
        """The matrix of rows with these labels and directions (n, 2)."""
        if self.by_number:
            found = [self.rows[:, k].astype(int) - 1 for k in (0, 1)]
        else:
            # directions are 1 to 6, so labels and directions sort as these numbers do
            order = 8 * keys[:, 0] + keys[:, 1]
            found = [np.searchsorted(order, 8 * pairs[:, 0] + pairs[:, 1]) for pairs in self.places]
        try:
            return symmetric(*found, self.rows[:, -1], len(keys))
        except WrongEntry as error:
            entry = ", ".join(f"{x:g}" for x in self.rows[error.entry, :-1])
            raise fault(self.path, int(self.lines[error.entry]), f"entry {entry} {error}",
                        f"the file is damaged, or the model unsymmetric: {_GENERATE}") from error


def _numbered(files: list[Entries], deck: Deck) -> NDArray:
    """Label and direction of each row by its number: nodes of elements in the order of labels."""
    used = {label for group in deck.elements for nodes in group.nodes.values() for label in nodes}
    labels = sorted((used or set(deck.nodes)) & set(deck.nodes))
    size = int(max(file.rows[:, :2].max() for file in files))
    each = size // len(labels) if labels else 0
    if each not in (3, 6) or each * len(labels) != size:
        raise InputError(f"{files[0].path} has {size} rows, and {deck.path} {len(labels)} nodes "
                         f"at its elements, of 3 or of 6 DOFs each: {_GENERATE}, which names the "
                         "node of each row")
    return np.column_stack([np.repeat(labels, each), np.tile(np.arange(1, each + 1), len(labels))])


def _entries(path: Path) -> Entries:
    """Entries of a file of either format."""
    for columns in (5, 3):
        rows = regular_table(path, columns, ",")
        if rows is not None:
            found = Entries(path, rows, np.arange(1, len(rows) + 1))
            break
    else:
        found = _line_by_line(path)
    _check_entries(found)
    return found


def _line_by_line(path: Path) -> Entries:
    lines, rows = [], []
    for number, line in enumerate(read_text(path, "matrix file", _GENERATE).splitlines(), 1):
        words = line.replace(",", " ").split()
        if not words or line.startswith("*"):
            continue
        try:
            row = [float(word.upper().replace("D", "E")) for word in words]
        except ValueError:
            row = []
        if len(row) not in (3, 5) or rows and len(row) != len(rows[0]):
            raise fault(path, number, "no row of node, DOF, node, DOF, value", _GENERATE)
        rows.append(row)
        lines.append(number)
    if not rows:
        raise InputError(f"matrix file {path} is empty: {_GENERATE}")
    return Entries(path, np.array(rows), np.array(lines))


def _check_entries(found: Entries) -> None:
    """Refuse entries that are not of a free mechanical model."""
    rows = found.rows
    places = rows[:, :-1]
    finite = np.isfinite(rows).all(axis=1)
    mechanical = (np.where(finite[:, None], places, 1) % 1 == 0).all(axis=1) & (
        places >= 1).all(axis=1)
    if not found.by_number:
        mechanical &= (places[:, 1::2] <= 6).all(axis=1)
    held = np.abs(rows[:, -1]) >= _HELD
    internal = (places < 0).any(axis=1) & (not found.by_number)
    for wrong, what, remedy in (
            (~finite, "no row of node, DOF, node, DOF, value", _GENERATE),
            (internal, "{} is a node that Abaqus has made within an element, as in B33",
             "use B31 or B32, and no other elements with internal nodes"),
            (~mechanical, "{} is not a mechanical DOF",
             "leave out hybrid elements, Lagrange multipliers and temperatures"),
            (held, "{} is fixed", "remove *BOUNDARY: the body must be free")):
        if wrong.any():
            k = int(np.argmax(wrong))
            where = (f"row {rows[k, 0]:g}" if found.by_number else
                     f"node {rows[k, 0]:g}, DOF {rows[k, 1]:g},")
            raise fault(found.path, int(found.lines[k]), what.format(where), remedy)


def _deck(path: Path) -> Deck:
    deck = path.with_suffix(".inp")
    if not deck.exists():
        raise InputError(f"{path} has no coordinates: put the deck with *NODE beside it, as {deck}")
    return read_deck(deck)
