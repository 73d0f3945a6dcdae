"""Interfaces that are sets of FE nodes: tied rigidly to a boundary node, or their mean motion."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.basics.tabular import brief
from sebody.fem.faces import surface_mass
from sebody.fem.model import FEModel

_LINE = 1e-6  # spread beside a line, relative to that along it, that does not hold a rotation


@dataclass(frozen=True, eq=False)
class RigidFace:
    """FE nodes that move as a rigid body with a boundary node of their own (RBE2).

    Parameters
    ----------
    point : (3,), planar (2,)
        The boundary node, in FE axes [length].
    nodes : sequence of int
        FE nodes tied to it, with all their DOFs.
    name : str
        For messages and notes.

    Raises
    ------
    InputError
        No finite point, or no nodes.
    """

    point: NDArray
    nodes: tuple[int, ...]
    name: str = ""

    __repr__ = brief

    def __post_init__(self) -> None:
        point = inputs.vector(self.point, f"point of {self.called}")
        object.__setattr__(self, "point", point)
        object.__setattr__(self, "nodes", _nodes(self.nodes, self.called, "tied to it"))

    @property
    def called(self) -> str:
        """Name in messages."""
        return f"the rigid face {self.name!r}" if self.name else "a rigid face"


@dataclass(frozen=True, eq=False)
class MeanFace:
    """Mean motion of FE nodes, which stay free to move about it (RBE3).

    The boundary node moves as the rigid body that fits the translations of the nodes best, in
    least squares over the area or by weights. It adds no stiffness: forces on it spread over the
    nodes as a linear traction does.

    Parameters
    ----------
    nodes : sequence of int
        FE nodes; their rotations, if they have any, take no part.
    point : (3,), planar (2,), optional
        The boundary node, in FE axes [length]; the centre of the nodes by default.
    weights : 'area', 'equal' or (n_nodes,)
        Weights of the squares: integrals over the faces of elements within the nodes (in a plane,
        over edges), the same for all, or positive numbers.
    name : str
        For messages and notes.

    Raises
    ------
    InputError
        No nodes, or other weights.
    """

    nodes: tuple[int, ...]
    point: NDArray | None = None
    weights: str | NDArray = "area"
    name: str = ""

    __repr__ = brief

    def __post_init__(self) -> None:
        object.__setattr__(self, "nodes", _nodes(self.nodes, self.called, "it is the mean of"))
        if self.point is not None:
            object.__setattr__(self, "point", inputs.vector(
                self.point, f"point of {self.called}"))
        remedy = f"give 'area', 'equal' or {len(self.nodes)} positive numbers"
        if isinstance(self.weights, str):
            inputs.choice(self.weights, f"weights of {self.called}", ("area", "equal"), remedy)
            return
        weights = inputs.vector(self.weights, f"weights of {self.called}", len(self.nodes),
                                remedy=remedy)
        if not np.all(weights > 0):
            raise inputs.refusal(f"weights of {self.called}", self.weights, remedy)
        object.__setattr__(self, "weights", weights)

    @property
    def called(self) -> str:
        """Name in messages."""
        return f"the mean face {self.name!r}" if self.name else "a mean face"


def _nodes(nodes: Sequence[int], what: str, how: str) -> tuple[int, ...]:
    remedy = f"name the FE nodes {how}"
    numbers = tuple(inputs.integer(node, f"node of {what}", remedy=remedy)
                    for node in inputs.items(nodes, f"nodes of {what}", remedy))
    if not numbers:
        raise InputError(f"{what} has no nodes: {remedy}")
    return numbers


class MeanMotion:
    """Mean of a set of nodes as linear functions of their translations, and its second order.

    Parameters
    ----------
    model : FEModel
    face : MeanFace
        Its nodes have all translations.

    Raises
    ------
    InputError
        Nodes without a face for weights by area, or a point of another dimension.
    """

    def __init__(self, model: FEModel, face: MeanFace):
        points = model.coordinates[list(face.nodes)]
        dimension = points.shape[1]
        self.rows = model.rows[list(face.nodes), :dimension]
        self._weights = _weights(model, face)
        portions = self._weights.sum(axis=0)
        self._portions = portions / portions.sum()
        centre = self._portions @ points
        self.point = centre if face.point is None else face.point
        if self.point.shape != (dimension,):
            raise InputError(f"point of {face.called} is {self.point}: give {dimension} finite "
                             "numbers")
        self._arms = np.zeros((len(points), 3))
        self._arms[:, :dimension] = points - centre
        self._lever = np.zeros(3)
        self._lever[:dimension] = self.point - centre
        self._spread = self._arms.T @ (self._weights @ self._arms)      # integral r r^T
        self._axes = slice(0, 3) if dimension == 3 else slice(2, 3)

    @property
    def turns(self) -> bool:
        """Tell if the nodes hold a rotation: they do not all lie on a line, in a plane at a point.
        """
        spread = np.linalg.eigvalsh(self._spread)
        across = 1 if self.rows.shape[1] == 3 else 2
        largest = np.abs(self._arms).max() ** 2 * abs(self._weights.sum())
        return bool(spread[across] > _LINE**2 * spread[2] and spread[2] > _LINE**2 * largest)

    @property
    def off_centre(self) -> bool:
        """Tell whether the point's displacement depends on the rotation."""
        return bool(np.abs(self._lever).max() > _LINE * np.abs(self._arms).max(initial=0.0))

    def translation(self) -> NDArray:
        """Displacement of the point, (D, k, D) of the translations of k nodes."""
        dimension = self.rows.shape[1]
        mean = self._portions[None, :, None] * np.eye(dimension)[:, None, :]
        if self.off_centre:
            # psi x d
            mean = mean + np.einsum("ijk,jab,k->iab", _EPSILON, self._whole_rotation(),
                                    self._lever)[:dimension, :, :dimension]
        return mean

    def rotation(self) -> NDArray:
        """Rotation vector (planar: angle), (r, k, D) of the translations."""
        return self._whole_rotation()[self._axes, :, :self.rows.shape[1]]

    def _whole_rotation(self) -> NDArray:
        """``J^-1 integral r x u``, (3, k, 3)."""
        weighed = self._weights @ self._arms
        moments = np.einsum("ija,kj->ika", _EPSILON, weighed)
        return np.einsum("ij,jka->ika", self._inverse_inertia(), moments)

    def _inverse_inertia(self) -> NDArray:
        inertia = np.trace(self._spread) * np.eye(3) - self._spread
        result = np.zeros((3, 3))
        own = (self._axes, self._axes)
        result[own] = np.linalg.inv(inertia[own])
        return result

    def second_order(self, force: NDArray, moment: NDArray, displacements: NDArray) -> NDArray:
        """Second derivative of the work of a force and a moment on the mean, sign reversed.

        The rotation of the mean is that of the polar decomposition of ``integral (r + u) r^T``:
        with ``E = integral u r^T`` and ``psi = J^-1 vee(E)`` it is, to second order, psi +
        ``J^-1 vee(psi~ psi~ S / 2 - psi~ E)``, S the integral of ``r r^T``; the point moves by
        ``psi x (psi x d) / 2`` beyond the mean of the nodes and ``psi x d``.

        Parameters
        ----------
        force : (D,)
        moment : (r,)
        displacements : (k, D, n)
            Translations of the nodes in n shapes.
        """
        count, dimension, n = displacements.shape
        f, m = np.zeros(3), np.zeros(3)
        f[:dimension], m[self._axes] = force, moment
        mu = self._inverse_inertia() @ (m + np.cross(self._lever, f))
        first = np.zeros((3, 3, n))     # E
        first[:dimension] = np.einsum("kan,kb->abn", displacements, self._weights @ self._arms)
        psi = self._inverse_inertia() @ np.einsum("ijk,kjn->in", _EPSILON, first)
        # mu . vee(psi~ E) = mu_i eps_ijk eps_kab psi_a E_bj
        mixed = np.einsum("i,ijk,kab->abj", mu, _EPSILON, _EPSILON)
        mixed = np.einsum("abj,am,bjn->mn", mixed, psi, first)
        skew = np.einsum("ijk,j->ik", _EPSILON, mu)        # mu~
        own = (self._spread @ skew - skew @ self._spread) / 2
        outer = np.outer(f, self._lever)
        own -= (outer + outer.T) / 2 - np.trace(outer) * np.eye(3)
        return mixed + mixed.T + psi.T @ own @ psi


_EPSILON = np.cross(np.eye(3)[:, None], np.eye(3)[None])    # (e_i x e_j)_k


def _weights(model: FEModel, face: MeanFace) -> sparse.csr_array:
    """Weights (k, k) of the products of two nodes' displacements."""
    if not isinstance(face.weights, str):
        return sparse.csr_array(sparse.diags_array(face.weights))
    if face.weights == "equal":
        return sparse.csr_array(sparse.eye_array(len(face.nodes)))
    weights = surface_mass(model, np.array(face.nodes))
    bare = np.flatnonzero(weights.diagonal() == 0)
    if len(bare):
        names = ", ".join(model.node_name(face.nodes[k]) for k in bare[:5])
        raise InputError(
            f"{face.called} by area has nodes on no face that lies within it: {names}"
            f"{' and more' if len(bare) > 5 else ''}; name all nodes of the faces and no others, "
            "give the FEModel its cells, or use weights='equal'")
    return weights
