"""Nastran, read by pyyeti: superelements in OP4 files, and DMIG in punch or OP2 files.

``EXTSEOUT(STIFFNESS, MASS, ..., DMIGOP4)`` writes the matrices to OP4 and the boundary nodes to
``.asm`` (or ``.pch``); ``EXTSEOUT(..., DMIGPCH)`` writes DMIG cards, whose rows name their nodes.
Output coordinate systems of nodes (CD) are turned to the basic system.
"""

import warnings
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sebody.basics.errors import InputError
from sebody.basics.files.reading import called, existing
from sebody.io.reading import Reading
from sebody.io.reduced import reduced_parts
from sebody.io.text import read_text

_REMEDY = "write it with EXTSEOUT(STIFFNESS, MASS, ASMBULK, DMIGOP4) or DMIGPCH"
_CARDS = (".asm", ".pch", ".bdf", ".dat")       # that may hold GRID cards, in this order


def read_op4(path: Path) -> Reading:
    """The superelement of an OP4 file and the bulk data beside it.

    Raises
    ------
    InputError
        A damaged file, no pair of stiffness and mass, or nodes that do not fit their rows.
    """
    matrices = _called(lambda: _nastran().op4.read(str(path), into="dct", justmatrix=True), path)
    matrices = {name.lower(): matrix for name, matrix in matrices.items()}
    stiffness, mass = _pair(matrices, path)
    cards = _beside(path)
    table = _uset(cards)
    told = len(table.index)
    if told < len(stiffness) and not (table.index.get_level_values("dof") == 0).any():
        raise InputError(f"{path} has {len(stiffness)} rows, {len(stiffness) - told} more than the "
                         f"nodes of {cards}, which has no SPOINT cards: modes are scalar points; "
                         "put the .asm that EXTSEOUT(ASMBULK) writes beside it, or add its SPOINT "
                         "cards")
    if told != len(stiffness):
        raise InputError(f"{path} has {len(stiffness)} rows and {cards} lists {told}: give "
                         "files of one run")
    return _reading(stiffness, mass, list(table.index), table, path)


def read_dmig(path: Path) -> Reading:
    """The superelement of the DMIG cards in a punch or OP2 file, with the GRID cards beside it.

    Raises
    ------
    InputError
        As for `read_op4`.
    """
    matrices = _called(lambda: _nastran().rddmig(str(path), square=True), path)
    frames = {name.lower(): frame for name, frame in matrices.items()}
    stiffness, mass = _pair({name: frame.values for name, frame in frames.items()}, path)
    indices = [list(frame.index) for frame in frames.values() if frame.shape == stiffness.shape]
    if indices[0] != indices[1]:
        raise InputError(f"{path}: stiffness and mass are of different DOFs: {_REMEDY}")
    own = path.suffix == ".pch" and "GRID" in read_text(path, "punch file", _REMEDY)
    return _reading(stiffness, mass, indices[0], _grids(path if own else _beside(path)), path)


def _reading(stiffness: NDArray, mass: NDArray, index: list, table: Any, path: Path) -> Reading:
    """A body from rows by (id, DOF), DOF 0 of scalar points, in output coordinate systems."""
    points, turns = _nodes(table, path)
    rows = [None if dof == 0 else (int(node), int(dof) - 1) for node, dof in index]
    unknown = [node for node, _ in filter(None, rows) if node not in points]
    if unknown:
        raise InputError(f"{path} has rows of node {unknown[0]}, which has no GRID card: {_REMEDY}")
    turn = np.eye(len(rows))
    place = {row: i for i, row in enumerate(rows) if row is not None}
    for node, axes in turns.items():
        for first in (0, 3):
            rows_of_node = [place.get((node, first + k)) for k in range(3)]
            if None not in rows_of_node:
                turn[np.ix_(rows_of_node, rows_of_node)] = axes       # output from basic components
    parts, names = reduced_parts(turn.T @ stiffness @ turn, turn.T @ mass @ turn, rows, points,
                                 str(path))
    return Reading(parts, names, source=f"Nastran {path.name}")


def _nodes(table: Any, path: Path) -> tuple[dict[int, NDArray], dict[int, NDArray]]:
    """Places, and components in the output systems of the basic axes, (3, 3), by node."""
    whole = table[table.index.get_level_values("dof") > 0]
    motion = _called(lambda: _nastran().rbgeom_uset(whole), path)
    points, turns = {}, {}
    for i, (node, dof) in enumerate(whole.index):
        if dof == 1:
            points[int(node)] = whole.iloc[i][["x", "y", "z"]].to_numpy(dtype=float)
            turns[int(node)] = motion[i:i + 3, :3]
    return points, turns


def _uset(cards: Path) -> Any:
    """Rows of the matrices of a superelement, in the order of its SECONCT card."""
    if cards.suffix != ".asm":
        return _grids(cards)
    punch = cards.with_suffix(".pch")       # its EXTRN card says which DOFs nodes keep
    fewer = punch.exists() and "EXTRN" in read_text(punch, "punch file", _REMEDY)
    return _called(lambda: _nastran().asm2uset(str(cards), try_rdextrn=fewer), cards)[0]


def _grids(cards: Path) -> Any:
    """All nodes of GRID cards."""
    return _called(lambda: _nastran().bulk2uset(str(cards)), cards)[0]


def _nastran() -> ModuleType:
    """pyyeti's Nastran, which at import changes how NumPy prints: that is put back."""
    with np.printoptions():
        from pyyeti import nastran
        from pyyeti.nastran import op4  # noqa: F401
    return nastran


def _beside(path: Path) -> Path:
    for suffix in _CARDS:
        cards = path.with_suffix(suffix)
        if cards.exists() and cards != path:
            return cards
    raise InputError(f"{path} has no nodes: put the bulk data with GRID cards beside it, as "
                     f"{path.with_suffix('.asm')}, which EXTSEOUT(ASMBULK) writes")


def _pair(found: dict[str, NDArray], path: Path) -> tuple[NDArray, NDArray]:
    """Stiffness and mass: the matrices K... and M... with otherwise equal names."""
    for name, matrix in found.items():
        other = found.get("m" + name[1:])
        if name.startswith("k") and other is not None:
            if matrix.shape != other.shape or matrix.shape[0] != matrix.shape[1]:
                raise InputError(f"{path}: {name} has shape {matrix.shape} and m{name[1:]} "
                                 f"{other.shape}: {_REMEDY}")
            return np.asarray(matrix, dtype=float), np.asarray(other, dtype=float)
    have = ", ".join(found) or "none"
    raise InputError(f"{path} has no pair of matrices KXX and MXX, or KAAX and MAAX; it has "
                     f"{have}: {_REMEDY}")


def _called(function: Callable[[], Any], path: Path) -> Any:
    """A file as pyyeti reads it; its exceptions become input errors that name the file."""
    existing(path, "file", _REMEDY)
    with warnings.catch_warnings():
        warnings.simplefilter("error", RuntimeWarning)      # of files that end early
        return called(function, path, _REMEDY)
