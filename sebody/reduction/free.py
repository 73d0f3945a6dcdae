"""Parts and freedom of an FE model: its loose parts, and rigid motions that it resists."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.csgraph import connected_components

from sebody.basics.errors import InputError
from sebody.fem.model import FEModel
from sebody.reduction.checks import why_resisted
from sebody.reduction.factor import STRAIN
from sebody.reduction.ties import Ties

_SHOWN = 5          # nodes that a message names
_LARGE = 0.3        # of the largest force, those of nodes that a message names
_FELT, _FEW = 1e-3, 0.1     # force of a node, of the largest, that counts; part of all nodes
_MOTIONS = {2: ("a translation along x", "a translation along y", "a rotation"),
            3: tuple(f"a {kind} {axis}" for kind in ("translation along", "rotation about")
                     for axis in "xyz")}


class Resisted(InputError):
    """A stiffness that resists rigid motions.

    Parameters
    ----------
    message : str
    nodes : list of int
        FE nodes with the largest forces.
    turns : bool
        Whether it resists rotations alone, as under prestress.
    """

    def __init__(self, message: str, nodes: list[int], turns: bool):
        super().__init__(message)
        self.nodes, self.turns = nodes, turns


def check_connected(fe_model: FEModel, ties: Ties, stiffness: sparse.csc_array) -> None:
    """Refuse a model of several parts that no element connects.

    Parameters
    ----------
    stiffness : (n, n)
        Of the DOFs that rigid faces leave independent.

    Raises
    ------
    InputError
        It names the parts by their nodes.
    """
    owners = ties.owners()
    entries = sparse.coo_array(stiffness)
    there = entries.data != 0
    size = int(owners.max(initial=-1)) + 1
    graph = sparse.coo_array((np.ones(there.sum(), dtype=np.int8), (
        owners[entries.row[there]], owners[entries.col[there]])), shape=(size, size))
    stiff = np.zeros(size, dtype=bool)
    stiff[owners[stiffness.diagonal() > 0]] = True      # others hang on nothing at all
    _, part = connected_components(graph, directed=False)
    parts = np.unique(part[stiff])
    if len(parts) < 2:
        return
    count = len(fe_model.coordinates)
    by_size = sorted((np.flatnonzero((part == one) & stiff) for one in parts), key=len)[::-1]
    shown = [f"one of {len(own)} nodes ({_listed(fe_model, own[own < count])})"
             for own in by_size[:_SHOWN]]
    raise InputError(
        f"the FE model has {len(parts)} parts that share no node and no element: "
        f"{'; '.join(shown)}{'; ...' * (len(parts) > _SHOWN)}; make one mesh of them (fragments in "
        "gmsh, merged nodes), tie them in the FE program, or import each as a body of its own")


def check_free(fe_model: FEModel, ties: Ties, stiffness: sparse.csc_array, least: float) -> None:
    """Refuse a stiffness that resists a rigid motion by more than a part of its entries.

    Parameters
    ----------
    stiffness : (n, n)
        Of the DOFs that rigid faces leave independent.
    least : float
        Forces of rigid motions, relative to what they are without signs.

    Raises
    ------
    Resisted
        It names the motion, and the nodes with the largest forces.
    """
    forces, relative = _forces(ties, stiffness)
    if relative.max(initial=0.0) <= max(least, STRAIN) or stiffness.diagonal().min() <= 0:
        return          # DOFs without stiffness are named where it is factored
    worst = int(np.argmax(relative))
    dimension = fe_model.coordinates.shape[1]
    by_owner = np.zeros(int(ties.owners().max()) + 1)
    np.maximum.at(by_owner, ties.owners(), np.abs(forces[:, worst]))
    nodes = [int(k) for k in np.argsort(-by_owner)[:_SHOWN]
             if by_owner[k] >= _LARGE * by_owner.max()]
    turns = bool((relative[:dimension] <= STRAIN).all())
    # springs and supports are at few nodes, digits are missing everywhere
    local = bool(np.sum(by_owner > _FELT * by_owner.max()) < max(2, _FEW * len(by_owner)))
    names = [ties.owner_name(node) for node in nodes]
    raise Resisted(
        f"the stiffness resists rigid motion: {_MOTIONS[dimension][worst]} causes forces of "
        f"{relative[worst]:.1e} of their summands, the largest at {', '.join(names)}: "
        + why_resisted(relative[worst], turns, local), [node for node in nodes
                                            if node < len(fe_model.coordinates)], turns)


def _forces(ties: Ties, stiffness: sparse.csc_array) -> tuple[NDArray, NDArray]:
    """Forces (n, r) of rigid motions, moments over the extent; their largest, of its summands."""
    motions = ties.rigid / ties.lengths[:, None]
    forces = stiffness @ motions / ties.lengths[:, None]
    summands = (abs(stiffness) @ np.abs(motions)) / ties.lengths[:, None]
    largest = np.maximum(summands.max(axis=0, initial=0.0), np.finfo(float).tiny)
    return forces, np.abs(forces).max(axis=0, initial=0.0) / largest


def _listed(fe_model: FEModel, nodes: Sequence[int]) -> str:
    names = [fe_model.node_name(int(node)) for node in nodes[:_SHOWN]] or ["a rigid face"]
    return ", ".join(names) + ", ..." * (len(nodes) > _SHOWN)
