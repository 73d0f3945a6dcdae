"""Nastran, read by pyyeti: superelements in OP4 files, and DMIG in punch or OP2 files.

``EXTSEOUT(STIFFNESS, MASS, ..., DMIGOP4)`` writes the matrices to OP4 and the boundary nodes to
``.asm`` (or ``.pch``); ``EXTSEOUT(..., DMIGPCH)`` writes DMIG cards, whose rows name their nodes.
Output coordinate systems of nodes (CD) are turned to the basic system.
"""

import warnings
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.basics.errors import InputError
from sebody.basics.files.reading import called, existing
from sebody.io.damping import with_damping
from sebody.io.reading import Reading
from sebody.io.reduced import reduced_parts
from sebody.io.text import read_text
from sebody.reduction.checks import RIGID_LIMIT, coordinate_names, rigid_residual
from sebody.reduction.rigid_motions import rigid_motions

_REMEDY = "write it with EXTSEOUT(STIFFNESS, MASS, ASMBULK, DMIGOP4) or DMIGPCH"
# beginnings of the names of output matrices: acceleration, displacement, load, stress and other
# output transformation matrices, and those of EXTSEOUT
_OUTPUTS = ("atm", "dtm", "ltm", "otm", "stm", "mug", "mes", "mef", "mee", "mqg")
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
    found = _set(matrices, path)
    stiffness = found.matrices["stiffness"]
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
    # nodes may keep some of their DOFs, but places and axes need all six
    return _reading(found, list(table.index), _grids(cards), path)


def read_dmig(path: Path) -> Reading:
    """The superelement of the DMIG cards in a punch or OP2 file, with the GRID cards beside it.

    Raises
    ------
    InputError
        As for `read_op4`.
    """
    matrices = _called(lambda: _nastran().rddmig(str(path), square=True), path)
    if path.suffix == ".pch":
        _check_once(path)
    frames = {name.lower(): frame for name, frame in matrices.items()}
    square = {name: frame for name, frame in frames.items() if frame.index.equals(frame.columns)}
    # rows of zeros are not written, so that of rotations without inertia only the stiffness has any
    rows = sorted({key for frame in square.values() for key in frame.index})
    whole = {name: frame.reindex(index=rows, columns=rows, fill_value=0.0).to_numpy()
             for name, frame in square.items()}
    whole |= {name: _by_rows(frame, rows) for name, frame in frames.items()
              if name.startswith(_OUTPUTS)}
    found = _set(whole, path)
    own = path.suffix == ".pch" and "GRID" in read_text(path, "punch file", _REMEDY)
    return _reading(found, rows, _grids(path if own else _beside(path)), path)


def _by_rows(frame: Any, rows: list) -> NDArray:
    """An output matrix with a column for each row of the stiffness.

    Its own columns are named by nodes and directions (form 2), or counted (form 9).
    """
    if frame.columns.nlevels == 2:
        return frame.reindex(columns=rows, fill_value=0.0).to_numpy()
    whole = np.zeros((len(frame), max(len(rows), max(frame.columns, default=0))))
    whole[:, np.array(frame.columns, dtype=int) - 1] = frame.to_numpy()
    return whole


def _check_once(path: Path) -> None:
    """Refuse an entry that occurs twice, of symmetric matrices also across the diagonal.

    Nastran stops at such cards; of what pyyeti reads the last one counts.
    """
    cards = _called(lambda: _nastran().rdcards(str(path), name="dmig", return_var="list", blank=""),
                    path)
    seen: set[tuple] = set()
    symmetric: dict[str, bool] = {}
    for card in cards:
        name = str(card[0]).upper()
        if name not in symmetric or card[1] == 0:
            symmetric[name] = card[2] == 6
            continue
        column = tuple(card[1:3])
        for row in zip(card[4::4], card[5::4], strict=False):
            pair = tuple(sorted((row, column))) if symmetric[name] else (row, column)
            if (name, *pair) in seen:
                raise InputError(
                    f"{path}: DMIG {name} has the entry of {_dof(*row)} and {_dof(*column)} twice"
                    + ", once on either side of the diagonal" * symmetric[name]
                    + ": write each entry of a symmetric matrix (form 6) once, or form 1")
            seen.add((name, *pair))


def _dof(node: int, direction: int) -> str:
    return f"DOF {direction} of node {node}" if direction else f"scalar point {node}"


class Found(NamedTuple):
    """Matrices of a superelement.

    Parameters
    ----------
    matrices : dict of (n, n)
        'stiffness', 'mass' and, if there is one, 'damping'.
    damping : str
        What the file calls the last.
    structural : tuple of str
        What it calls structural damping.
    outputs : dict of (m, n)
        Matrices of what inner points do, by their names.
    """

    matrices: dict[str, NDArray]
    damping: str
    structural: tuple[str, ...]
    outputs: dict[str, NDArray]


def _reading(found: Found, index: list, table: Any, path: Path) -> Reading:
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
    turned = {name: turn.T @ matrix @ turn for name, matrix in found.matrices.items()}
    outputs = {name: matrix @ turn for name, matrix in found.outputs.items()}
    parts, names, left = reduced_parts(turned, rows, points, str(path), outputs)
    _check_systems(parts, reduced_parts(found.matrices, rows, points, str(path))[0],
                   [node for node, axes in turns.items() if not np.allclose(axes, np.eye(3))], path)
    parts, notes = with_damping(parts, found.damping, found.structural)
    return Reading(parts, names, source=f"Nastran {path.name}", notes={**left, **notes})


def _check_systems(parts: dict, basic: dict, nodes: list[int], path: Path) -> None:
    """Refuse output systems that contradict the matrices, which fit basic axes without them."""
    if nodes and not _is_free(parts) and _is_free(basic):
        raise InputError(f"{path}: the matrices are along basic axes, but the cards give node"
                         f"{'s' * (len(nodes) > 1)} {', '.join(map(str, nodes[:6]))} output "
                         "systems (CD): take CD, or GRDSET, off the cards")


def _is_free(parts: dict) -> bool:
    """Tell whether a reduced stiffness resists no rigid motion."""
    points, K = parts["coordinates"], parts["stiffness"]
    rigid = rigid_motions(points, parts["keeps"], len(K), points.mean(axis=0))
    names = coordinate_names(parts["keeps"], 3, parts["modes"])
    return rigid_residual(K, rigid, names)[0] <= RIGID_LIMIT


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
    """All nodes of GRID cards, with the systems of GRDSET where theirs are blank."""
    nastran = _nastran()

    def read(name: str) -> list:
        return _called(lambda: nastran.rdcards(str(cards), name=name, return_var="list", blank="",
                                               no_data_return=[]), cards)
    defaults = read("grdset")
    if not defaults:
        return _called(lambda: nastran.bulk2uset(str(cards)), cards)[0]
    # fields behind the name: label, CP, place, CD
    of_place, of_motion = ([*defaults[0], *[""] * 6][k] or 0 for k in (1, 5))
    rows = [[*grid, *[""] * 6][:6] for grid in read("grid")]
    rows.sort(key=lambda row: row[0])
    labels, places = [row[0] for row in rows], [[x or 0.0 for x in row[2:5]] for row in rows]
    systems, outputs = ([default if row[k] == "" else row[k] for row in rows]
                        for k, default in ((1, of_place), (5, of_motion)))
    return _called(lambda: nastran.addgrid(
        None, np.array(labels, dtype=np.int64), "b", np.array(systems), np.array(places, float),
        np.array(outputs), nastran.rdcord2cards(str(cards))), cards)


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


def _set(found: dict[str, NDArray], path: Path) -> Found:
    """Stiffness and mass, the matrices K... and M... with otherwise equal names, and B... and K4...
    """
    for name, stiffness in found.items():
        ending = name[1:]
        if not name.startswith("k") or "m" + ending not in found:
            continue
        called = {"stiffness": name, "mass": "m" + ending, "damping": _damping(found, "b" + ending)}
        matrices = {what: found[own] for what, own in called.items() if own in found}
        for what, matrix in matrices.items():
            if matrix.shape != stiffness.shape or matrix.shape[0] != matrix.shape[1]:
                raise InputError(f"{path}: {name} has shape {stiffness.shape} and {called[what]} "
                                 f"{matrix.shape}: {_REMEDY}")
            if what != "stiffness" and np.any(np.imag(matrix)):
                raise InputError(f"{path}: {called[what]} is complex: write real matrices")
        own = _damping(found, "k4" + ending)
        structural = [own.upper()] if np.any(found.get(own, 0)) else []
        if np.any(np.imag(stiffness)):
            structural.append(f"the imaginary part of {name.upper()}")
        return Found({what: np.asarray(np.real(matrix), dtype=float)
                      for what, matrix in matrices.items()}, called["damping"].upper(),
                     tuple(structural), _outputs(found, len(stiffness), path))
    have = ", ".join(found) or "none"
    raise InputError(f"{path} has no pair of matrices KXX and MXX, or KAAX and MAAX; it has "
                     f"{have}: {_REMEDY}")


def _damping(found: dict[str, NDArray], name: str) -> str:
    """The name of a damping matrix, which EXTSEOUT writes with a 1, as a placeholder if empty."""
    numbered = name + "1"
    return numbered if name not in found and found.get(numbered, np.zeros(1)).size > 1 else name


def _outputs(found: dict[str, NDArray], size: int, path: Path) -> dict[str, NDArray]:
    """Matrices of displacements, forces and stresses of inner points by the rows of the stiffness.
    """
    outputs = {name.upper(): np.asarray(matrix) for name, matrix in found.items()
               if name.startswith(_OUTPUTS) and matrix.size > 1}      # others are placeholders
    for name, matrix in outputs.items():
        if matrix.ndim != 2 or matrix.shape[1] != size or np.any(np.imag(matrix)):
            raise InputError(f"{path}: the output matrix {name} has shape {matrix.shape}, or is "
                             f"complex: it needs {size} columns, one for each row of the stiffness")
    return {name: np.real(matrix).astype(float) for name, matrix in outputs.items()}


def _called(function: Callable[[], Any], path: Path) -> Any:
    """A file as pyyeti reads it; its exceptions become input errors that name the file."""
    existing(path, "file", _REMEDY)
    with warnings.catch_warnings():
        warnings.simplefilter("error", RuntimeWarning)      # of files that end early
        return called(function, path, _REMEDY)
