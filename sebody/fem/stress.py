"""Stresses and strains that displacements of FE nodes cause, element by element.

An `FEModel` carries one operator for each kind of its elements. They are linear: the history at a
node takes the shapes of the elements around it alone, each once.

Components are ordered (xx, yy, zz, yz, zx, xy); shears of a strain are those of engineering, twice
the tensor's. Those of solids are along the axes of the FE model, those of beams along the axes of
the section.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.basics.tabular import brief
from sebody.fem import mesh
from sebody.fem.isoparametric import SOLID_KINDS, element_kind

FLAT = 1e-10        # volume of an element, of its size cubed, that is none


@dataclass(frozen=True, eq=False)
class SolidStress:
    """Stresses of solid elements of one kind, at their points of integration.

    Parameters
    ----------
    kind : str
        One of `isoparametric.SOLID_KINDS`.
    nodes : (n, k) of int
        Nodes of the elements.
    coordinates : (n_nodes, 3)
        Of the FE model [length].
    elasticity : (6, 6) or (n, 6, 6)
        Stress of a strain, of all elements or of each.
    strains : (g, 6, 3 k), optional
        Strains at the points of unit displacements, the same for all elements, in place of those
        of the shape functions: of elements with incompatible modes.
    """

    kind: str
    nodes: NDArray
    coordinates: NDArray
    elasticity: NDArray
    strains: NDArray | None = None

    __repr__ = brief

    @property
    def points_per_element(self) -> int:
        """Points of integration of an element."""
        return len(element_kind(self.kind).values)

    def places(self) -> NDArray:
        """The points of integration, (n, g, 3)."""
        return element_kind(self.kind).values @ self.coordinates[self.nodes]

    def strain(self, moved: NDArray, elements: NDArray | slice = slice(None)) -> NDArray:
        """Strains at the points of integration of some elements.

        Parameters
        ----------
        moved : (n_nodes, >= 3, s)
            DOFs of all nodes in s states, translations first.

        Returns
        -------
        (elements, g, 6, s)
        """
        nodal = moved[self.nodes[elements], :3]
        n, k, _, s = nodal.shape
        if self.strains is not None:
            return (self.strains.reshape(-1, 3 * k) @ nodal.reshape(n, 3 * k, s)).reshape(
                n, -1, 6, s)
        g = self.points_per_element
        slopes = element_kind(self.kind).slopes.reshape(3 * g, k)
        # by the element's coordinates, (n, g, 3, 3 s), then by x, y and z
        derived = (slopes @ nodal.reshape(n, k, 3 * s)).reshape(n, g, 3, 3 * s)
        gradient = (self._inverse[elements] @ derived).reshape(n, g, 3, 3, s)    # [axis, component]
        strain = np.empty((n, g, 6, s))
        for axis in range(3):
            after, last = (axis + 1) % 3, (axis + 2) % 3
            strain[:, :, axis] = gradient[:, :, axis, axis]
            strain[:, :, 3 + axis] = gradient[:, :, last, after] + gradient[:, :, after, last]
        return strain

    def stress(self, moved: NDArray, elements: NDArray | slice = slice(None)) -> NDArray:
        """Stresses at the points of integration likewise."""
        strain = self.strain(moved, elements)
        law = self.elasticity if self.elasticity.ndim == 2 else self.elasticity[elements][:, None]
        return law @ strain

    def at_nodes(self, values: NDArray) -> NDArray:
        """Values at points (n, g, c, s) carried to the nodes of the elements, (n, k, c, s)."""
        to_nodes = element_kind(self.kind).to_nodes
        n, g, c, s = values.shape
        return (to_nodes @ values.reshape(n, g, c * s)).reshape(n, -1, c, s)

    def restricted(self, place: NDArray, coordinates: NDArray) -> SolidStress:
        """Restrict to elements whose nodes are kept: `place` has new numbers, -1 for others."""
        kept = np.all(place[self.nodes] >= 0, axis=1)
        law = self.elasticity if self.elasticity.ndim == 2 else self.elasticity[kept]
        return replace(self, nodes=place[self.nodes[kept]], coordinates=coordinates,
                       elasticity=law)

    def volumes(self) -> NDArray:
        """Volume about each point, of the size cubed; negative where it is mirrored, (n, g)."""
        jacobian = self.jacobian()
        size = np.abs(jacobian).max(axis=(1, 2, 3))
        return np.linalg.det(jacobian) / np.where(size > 0, size, 1.0)[:, None]**3

    def jacobian(self) -> NDArray:
        """Derivatives of x, y and z by the element's coordinates, (n, g, 3, 3)."""
        corners = self.coordinates[self.nodes]
        slopes = element_kind(self.kind).slopes
        return (slopes.reshape(-1, slopes.shape[2]) @ corners).reshape(len(corners), -1, 3, 3)

    @cached_property
    def _inverse(self) -> NDArray:
        """Derivatives of the element's coordinates by x, y and z, (n, g, 3, 3)."""
        _refuse(self, np.abs(self.volumes()).min(axis=1) <= FLAT, "has no volume")
        return np.linalg.inv(self.jacobian())


@dataclass(frozen=True, eq=False)
class StressModes:
    """Stresses at some points of unit reduced coordinates, as an FE program has computed them.

    Parameters
    ----------
    points : (p, 3)
        In FE axes [length].
    modes : (p, 6, n)
        Stress of each of the n reduced coordinates.
    nodes : (p,) of int
        FE node that each point belongs to, -1 for none.
    """

    points: NDArray
    modes: NDArray
    nodes: NDArray

    __repr__ = brief

    def __post_init__(self) -> None:
        points = inputs.array(self.points, "points of stress modes", (None, 3))
        modes = inputs.array(self.modes, "stress modes", (len(points), 6, None))
        nodes = inputs.vector(self.nodes, "nodes of stress modes", len(points)).astype(int)
        for name, value in (("points", points), ("modes", modes), ("nodes", nodes)):
            object.__setattr__(self, name, value)

    def restricted(self, place: NDArray, coordinates: NDArray) -> StressModes:
        """Restrict to the points that belong to kept nodes."""
        nodes = np.where(self.nodes < 0, -1, place[self.nodes])
        return StressModes(self.points[nodes >= 0], self.modes[nodes >= 0], nodes[nodes >= 0])


def solid_stress(coordinates: ArrayLike, cells: Sequence[tuple[str, ArrayLike]],
                 youngs_modulus: float, poisson_ratio: float) -> tuple[SolidStress, ...]:
    """Stress operators of isotropic solid elements of any program, for ``FEModel(stress=...)``.

    Parameters
    ----------
    coordinates : (n_nodes, 3)
        As those of the FE model [length].
    cells : sequence of (str, (n, k) of int)
        Kind of the elements, by meshio's names and in its order of nodes; kinds that are no solids
        are left out.
    youngs_modulus, poisson_ratio : float
        Material of all of them.

    Raises
    ------
    InputError
        No solid elements, a wrong number of nodes, elements without volume or turned inside out in
        a part of them (a whole one may be mirrored, which changes no strain), or an
        invalid material.
    """
    coordinates = inputs.array(coordinates, "coordinates", (None, 3))
    inputs.number(youngs_modulus, "youngs_modulus", above=0)
    inputs.number(poisson_ratio, "poisson_ratio", above=-1, below=0.5)
    law = elasticity(youngs_modulus, poisson_ratio)
    operators = []
    for kind, nodes in mesh.cells(cells, len(coordinates)):
        if kind not in SOLID_KINDS:
            continue
        count = element_kind(kind).values.shape[1]
        if nodes.shape[1] != count:
            raise InputError(f"cells of kind {kind!r} have {nodes.shape[1]} nodes each: give "
                             f"{count}, in meshio's order")
        operators.append(SolidStress(kind, nodes, coordinates, law))
        volumes = operators[-1].volumes()
        _refuse(operators[-1], np.abs(volumes).min(axis=1) <= FLAT, "has no volume")
        _refuse(operators[-1], (volumes > 0).any(axis=1) & (volumes < 0).any(axis=1),
                "is partly inverted")
    if not operators:
        raise InputError(f"cells have no solid elements: give cells of the kinds "
                         f"{', '.join(SOLID_KINDS)}")
    return tuple(operators)


def _refuse(one: SolidStress, wrong: NDArray, what: str) -> None:
    if wrong.any():
        k = int(np.argmax(wrong))
        raise InputError(f"element {k} of kind {one.kind!r}, with the nodes "
                         f"{one.nodes[k].tolist()}, {what}: correct its nodes, in meshio's order")


def elasticity(youngs_modulus: float, poisson_ratio: float) -> NDArray:
    """Isotropic stress of the strains (xx, yy, zz, 2 yz, 2 zx, 2 xy), shape (6, 6)."""
    shear = youngs_modulus / (2 * (1 + poisson_ratio))
    lame = 2 * shear * poisson_ratio / (1 - 2 * poisson_ratio)
    law = np.diag([2 * shear] * 3 + [shear] * 3)
    law[:3, :3] += lame
    return law


def von_mises(stress: NDArray, axis: int = -1) -> NDArray:
    """Von Mises's equivalent stress of the components along an axis."""
    xx, yy, zz, yz, zx, xy = np.moveaxis(stress, axis, 0)
    return np.sqrt(((xx - yy)**2 + (yy - zz)**2 + (zz - xx)**2) / 2
                   + 3 * (yz**2 + zx**2 + xy**2))


def principal(stress: NDArray) -> NDArray:
    """Principal stresses (..., 3), ascending, of components (..., 6); NaN where these are."""
    order = np.array([[0, 5, 4], [5, 1, 3], [4, 3, 2]])
    known = np.isfinite(stress).all(axis=-1, keepdims=True)
    return np.where(known, np.linalg.eigvalsh(np.where(known, stress, 0.0)[..., order]), np.nan)
