"""Ansys: ``.full`` with the nodes of ``.rst`` or ``.cdb`` beside it, read by ansys-mapdl-reader.

Write the ``.full`` of a free model, with the sparse or block Lanczos solver. The reader skips DOFs
that are not in the matrices (midside nodes that were dropped, fixed ones).
"""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from scipy import sparse

from sebody.errors import InputError
from sebody.fem.model import FEModel
from sebody.files.reading import called, existing
from sebody.io.reading import Reading
from sebody.io.reduced import NAMES

_REMEDY = "write file.full of a free model (WRFULL or a modal analysis), and file.rst or file.cdb"
# of elements that are solids: meshio's names by the number of different nodes, see `_cell`
_SOLIDS = {20: "hexahedron20", 8: "hexahedron", 10: "tetra10", 4: "tetra"}


def read(path: Path) -> Reading:
    """The FE model of a ``.full`` file.

    Raises
    ------
    InputError
        A damaged file, DOFs that are none of a body, supports, or nodes without coordinates.
    """
    reference, stiffness, mass = full_matrices(path)
    held = np.flatnonzero((stiffness.diagonal() == 0) & (mass.diagonal() == 0))
    if len(held):
        nodes = list(dict.fromkeys(reference[held, 0].tolist()))
        shown = ", ".join(map(str, nodes[:6])) + (", ..." if len(nodes) > 6 else "")
        raise InputError(f"{path} is of a model that is held: {len(held)} rows of the nodes "
                         f"{shown} are empty; delete its supports (DDELE), a body must be free")
    mesh = _mesh(path)
    labels = np.asarray(mesh.nnum)
    places = np.searchsorted(labels, reference[:, 0])
    known = labels[np.minimum(places, len(labels) - 1)] == reference[:, 0]
    if not known.all():
        raise InputError(f"{path} has rows of node {reference[np.argmin(known), 0]}, which the "
                         "file of the nodes does not have: give files of one model")
    dof_map = [(int(node), NAMES[dof]) for node, dof in zip(places, reference[:, 1], strict=True)]
    return Reading(FEModel(
        stiffness, mass, np.asarray(mesh.nodes)[:, :3], dof_map=dof_map, labels=labels,
        node_sets=_sets(mesh, labels), cells=_cells(mesh, labels), source=f"Ansys {path.name}"))


def full_matrices(path: Path) -> tuple[np.ndarray, sparse.csc_array, sparse.csc_array]:
    """Node and DOF from 0 of every row (n, 2), stiffness and mass; empty rows where it is held.

    Raises
    ------
    InputError
        A file of another kind or damaged, or DOFs that are none of a body.
    """
    from ansys.mapdl import reader

    full = _called(lambda: reader.read_binary(str(path)), path)
    if not hasattr(full, "load_km"):
        raise InputError(f"{path} is no .full file: {_REMEDY}")
    reference, *matrices = _called(lambda: full.load_km(sort=True), path)
    wrong = (reference[:, 1] > 5) | (reference[:, 1] < 0)
    if wrong.any():
        row = int(np.argmax(wrong))
        raise InputError(f"{path}: DOF {reference[row, 1]} of node {reference[row, 0]} is none of "
                         "a body: leave out temperatures, pressures and Lagrange multipliers")
    return reference, *map(_whole, matrices)


def _whole(triangle: sparse.spmatrix) -> sparse.csc_array:
    """Both triangles of a symmetric matrix, of which the reader gives one."""
    matrix = sparse.csc_array(triangle)
    return sparse.csc_array(matrix + sparse.triu(matrix, 1).T if not sparse.tril(matrix, -1).nnz
                            else matrix)


def _mesh(path: Path) -> Any:
    from ansys.mapdl import reader

    for suffix in (".rst", ".cdb"):
        beside = path.with_suffix(suffix)
        if beside.exists():
            make = reader.Archive if suffix == ".cdb" else reader.read_binary
            return _called(lambda make=make, beside=beside: _nodes_of(make(str(beside))), beside)
    raise InputError(f"{path} has no coordinates: put {path.with_suffix('.rst')} or "
                     f"{path.with_suffix('.cdb')} of the same model beside it (CDWRITE)")


def _nodes_of(file: Any) -> Any:
    """The object that has nnum and nodes: results keep it as `mesh`, archives are it."""
    return getattr(file, "mesh", file)


def _sets(mesh: Any, labels: np.ndarray) -> dict[str, list[int]]:
    found = getattr(mesh, "node_components", None) or {}
    return {str(name): np.unique(np.searchsorted(labels, nodes)).tolist()
            for name, nodes in found.items()}


def _cells(mesh: Any, labels: np.ndarray) -> list[tuple[str, np.ndarray]]:
    """Solids of full numbers of nodes; others are left out of the picture."""
    found: dict[str, list] = {}
    for element in mesh.elem:
        nodes = np.asarray(element)[10:]
        nodes = nodes[nodes > 0]
        if len(nodes) in _SOLIDS and len(set(nodes)) == len(nodes):
            found.setdefault(_SOLIDS[len(nodes)], []).append(np.searchsorted(labels, nodes))
    return [(kind, np.array(cells)) for kind, cells in found.items()]


def _called(function: Callable[[], Any], path: Path) -> Any:
    """What the reader makes of a file; whatever it raises is said of the file."""
    existing(path, "file", _REMEDY)
    return called(function, path, _REMEDY)
