"""Ansys: ``.full`` with the nodes of ``.rst`` or ``.cdb`` beside it, read by ansys-mapdl-reader.

Write the ``.full`` of a free model, with the sparse or block Lanczos solver. The reader skips DOFs
that are not in the matrices (midside nodes that were dropped, fixed ones).
"""

from pathlib import Path

import numpy as np
from scipy import sparse

from sebody.basics.errors import InputError
from sebody.basics.files.own_process import read_in_own_process
from sebody.basics.files.reading import existing
from sebody.fem.model import FEModel
from sebody.io.reading import Reading
from sebody.io.reduced import NAMES
from sebody.io.triplets import WrongEntry, symmetric

_REMEDY = "write file.full of a free model (WRFULL or a modal analysis), and file.rst or file.cdb"
_NO_MATERIAL = ("materials are not read from files of Ansys; give the FE model of read_fe_model "
                "its stress=solid_stress(...), or divide the body where it spins fast")
# of elements that are solids: meshio's names by the number of different nodes, see `_cell`
_SOLIDS = {20: "hexahedron20", 8: "hexahedron", 10: "tetra10", 4: "tetra"}


def read(path: Path) -> Reading:
    """The FE model of a ``.full`` file.

    Raises
    ------
    InputError
        A damaged file, DOFs that are not mechanical, supports, or nodes without coordinates.
    """
    reference, stiffness, mass = full_matrices(path)
    empty = np.flatnonzero((stiffness.diagonal() == 0) & (mass.diagonal() == 0))
    if len(empty):
        nodes = list(dict.fromkeys(reference[empty, 0].tolist()))
        shown = ", ".join(map(str, nodes[:6])) + (", ..." if len(nodes) > 6 else "")
        raise InputError(f"{path} is of a model that is held: {len(empty)} rows of the nodes "
                         f"{shown} are empty; delete its supports (DDELE), a body must be free")
    mesh = _mesh(path)
    labels = mesh["labels"]
    places = np.searchsorted(labels, reference[:, 0])
    known = labels[np.minimum(places, len(labels) - 1)] == reference[:, 0]
    if not known.all():
        raise InputError(f"{path} has rows of node {reference[np.argmin(known), 0]}, which the "
                         "file of the nodes does not have: give files of one model")
    dof_map = [(int(node), NAMES[dof]) for node, dof in zip(places, reference[:, 1], strict=True)]
    return Reading(FEModel(
        stiffness, mass, mesh["points"], dof_map=dof_map, labels=labels,
        node_sets=_sets(mesh, labels), cells=_cells(mesh, labels), source=f"Ansys {path.name}",
        missing=dict.fromkeys(("stresses", "stiffening"), _NO_MATERIAL)))


def full_matrices(path: Path) -> tuple[np.ndarray, sparse.csc_array, sparse.csc_array]:
    """Node and DOF from 0 of every row (n, 2), stiffness and mass; empty rows where it is held.

    Raises
    ------
    InputError
        A file of another kind or damaged, or DOFs that are not mechanical.
    """
    parts = _read(path, "matrices")
    reference, size = parts["reference"], len(parts["reference"])
    matrices = []
    for name in ("stiffness", "mass"):
        rows, columns, values = (parts[f"{name}_{part}"] for part in ("rows", "columns", "values"))
        if rows.size and max(rows.max(), columns.max()) >= size:
            raise InputError(f"{path} is damaged (an entry in row {max(rows.max(), columns.max())} "
                             f"of {size}): {_REMEDY}")
        try:
            matrices.append(symmetric(rows, columns, values, size))
        except WrongEntry as error:
            k = error.entry
            raise InputError(f"{path} is damaged (entry ({rows[k] + 1}, {columns[k] + 1}) of the "
                             f"{name} {error}): {_REMEDY}") from error
    wrong = (reference[:, 1] > 5) | (reference[:, 1] < 0)
    if wrong.any():
        row = int(np.argmax(wrong))
        raise InputError(f"{path}: DOF {reference[row, 1]} of node {reference[row, 0]} is not "
                         "mechanical: leave out temperatures, pressures and Lagrange multipliers")
    return reference, *matrices


def _mesh(path: Path) -> dict[str, np.ndarray]:
    for suffix in (".rst", ".cdb"):
        beside = path.with_suffix(suffix)
        if beside.exists():
            return _read(beside, "mesh")
    raise InputError(f"{path} has no coordinates: put {path.with_suffix('.rst')} or "
                     f"{path.with_suffix('.cdb')} of the same model beside it (CDWRITE)")


def _read(path: Path, what: str) -> dict[str, np.ndarray]:
    existing(path, "file", _REMEDY)
    return read_in_own_process("sebody.io.ansys_process", path, what, remedy=_REMEDY)


def _sets(mesh: dict[str, np.ndarray], labels: np.ndarray) -> dict[str, list[int]]:
    return {name.removeprefix("set "): np.unique(np.searchsorted(labels, nodes)).tolist()
            for name, nodes in mesh.items() if name.startswith("set ")}


def _cells(mesh: dict[str, np.ndarray], labels: np.ndarray) -> list[tuple[str, np.ndarray]]:
    """Solids of full numbers of nodes; others are left out of the picture."""
    by_kind: dict[str, list] = {}
    for nodes in np.split(mesh["elements"], mesh["ends"][:-1]):
        nodes = nodes[nodes > 0]
        if len(nodes) in _SOLIDS and len(set(nodes)) == len(nodes):
            by_kind.setdefault(_SOLIDS[len(nodes)], []).append(np.searchsorted(labels, nodes))
    return [(kind, np.array(cells)) for kind, cells in by_kind.items()]
