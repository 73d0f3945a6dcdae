"""Abaqus: ``*SUBSTRUCTURE MATRIX OUTPUT`` and ``*MATRIX GENERATE``, both ``.mtx``.

Neither file has coordinates: they come from the deck, ``.inp`` with the same stem.
"""

import re
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sebody.basics.errors import InputError
from sebody.io.deck.model import deck_model
from sebody.io.deck.reading import Deck, read_deck
from sebody.io.reading import Reading
from sebody.io.reduced import reduced_parts
from sebody.io.text import fault, read_text
from sebody.io.triplets import symmetric

_SUBSTRUCTURE = "write it with *SUBSTRUCTURE MATRIX OUTPUT, STIFFNESS=YES, MASS=YES"
_GENERATE = ("write it with *MATRIX GENERATE, STIFFNESS, MASS and *MATRIX OUTPUT, STIFFNESS, MASS, "
             "FORMAT=LABELS")
# selectively reduced integration, hourglass control, modified elements
_OWN_WAYS = ("C3D8", "C3D8R", "C3D10M")
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
    found = {}
    for kind in ("STIFFNESS", "MASS"):
        if kind not in matrices:
            raise InputError(f"{path} has no *MATRIX, TYPE={kind}: {_SUBSTRUCTURE}")
        line, values = matrices[kind]
        size = len(rows)
        if len(values) != size * (size + 1) // 2:
            raise fault(path, line, f"*MATRIX, TYPE={kind} has {len(values)} numbers, but "
                        f"*USER ELEMENT has {size} DOFs, which need {size * (size + 1) // 2}",
                        f"the file is cut off or unsymmetric: {_SUBSTRUCTURE}")
        matrix = np.zeros((size, size))
        matrix[np.tril_indices(size)] = values
        found[kind] = matrix + np.tril(matrix, -1).T
    deck = _deck(path)
    points = {label: np.array(point) for label, point in deck.nodes.items()}
    parts, names = reduced_parts(found["STIFFNESS"], found["MASS"], rows, points, str(path))
    return Reading(parts, names, source=f"Abaqus substructure {path.name}")


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
            if where in ("STIFFNESS", "MASS"):
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
        A missing or damaged file, supports, internal nodes, or nodes without coordinates.
    """
    match = re.fullmatch(r"(.*)_(STIF|MASS)(\d+)", path.stem, re.IGNORECASE)
    if not match:
        raise InputError(f"{path} is not named as Abaqus does, JOB_STIF1.mtx and JOB_MASS1.mtx: "
                         "give them their names back")
    job, _, step = match.groups()
    entries = [_entries(path.with_name(f"{job}_{kind}{step}.mtx")) for kind in ("STIF", "MASS")]
    deck = _deck(path.with_name(f"{job}.mtx"))
    # rows of both, by label and direction; what has mass but no stiffness is there, too
    keys = np.unique(np.concatenate([rows[:, pair] for rows in entries
                                     for pair in ([0, 1], [2, 3])]).astype(int), axis=0)
    unknown = [label for label in keys[:, 0].tolist() if label not in deck.nodes]
    if unknown:
        raise InputError(f"{path} has rows of node {unknown[0]}, which {deck.path} does not have: "
                         "give files of one job, flattened (no parts and instances)")
    stiffness, mass = (_matrix(rows, keys) for rows in entries)
    dofs = [(label, direction - 1) for label, direction in keys.tolist()]
    return deck_model(deck, list(deck.nodes), dofs, stiffness, mass, f"Abaqus {job}",
                      _OWN_WAYS)


def _entries(path: Path) -> NDArray:
    """Rows of label, direction, label, direction, value, (n, 5)."""
    lines = read_text(path, "matrix file", _GENERATE).splitlines()
    entries = []
    for number, line in enumerate(lines, 1):
        words = line.replace(",", " ").split()
        if not words or line.startswith("*"):
            continue
        try:
            row = [float(word.upper().replace("D", "E")) for word in words]
        except ValueError:
            row = []
        if len(row) != 5 or not np.isfinite(row).all():
            raise fault(path, number, "no row of node, DOF, node, DOF, value", _GENERATE)
        if any(x != int(x) for x in row[:4]) or min(row[0], row[2]) < 1 or not (
                1 <= row[1] <= 6 and 1 <= row[3] <= 6):
            raise fault(path, number, f"node {row[0]:g}, DOF {row[1]:g}, is not a mechanical DOF",
                        "leave out hybrid elements, Lagrange multipliers and temperatures")
        if abs(row[4]) >= _HELD:
            raise fault(path, number, f"node {row[0]:g}, DOF {row[1]:g}, is fixed",
                        "remove *BOUNDARY: the body must be free")
        entries.append(row)
    if not entries:
        raise InputError(f"matrix file {path} is empty: {_GENERATE}")
    return np.array(entries)


def _matrix(entries: NDArray, keys: NDArray):
    places = {tuple(key): k for k, key in enumerate(keys.tolist())}
    rows, columns = (np.array([places[tuple(pair)] for pair in entries[:, own].astype(int).tolist()]
                              ) for own in ([0, 1], [2, 3]))
    return symmetric(rows, columns, entries[:, 4], len(keys))


def _deck(path: Path) -> Deck:
    deck = path.with_suffix(".inp")
    if not deck.exists():
        raise InputError(f"{path} has no coordinates: put the deck with *NODE beside it, as {deck}")
    return read_deck(deck)
