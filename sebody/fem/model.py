"""FE models as programs hand them over: matrices, node coordinates, the meaning of the DOFs."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import sparse

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.basics.units import parsed_units
from sebody.fem import mesh
from sebody.fem.beam_stress import BeamStress
from sebody.fem.layout import PLANAR, SOLID, SPATIAL, equal_rows, mapped_rows
from sebody.fem.mass_field import MassField, nodal_field
from sebody.fem.materials import Material, checked_materials
from sebody.fem.matrices import fe_matrix
from sebody.fem.stress import SolidStress


@dataclass(frozen=True, eq=False)
class FEModel:
    """Linear FE model in global axes; its nodes may have different DOFs.

    Parameters
    ----------
    stiffness, mass : (n_dofs, n_dofs), dense or sparse
        Symmetric FE matrices of the free body; kept as CSC.
    coordinates : (n_nodes, 3), planar (n_nodes, 2)
        Node positions [length].
    node_dofs : tuple of str
        DOFs of one node in order: ``('x', 'y', 'z', 'rx', 'ry', 'rz')``, planar
        ``('x', 'y', 'rz')``, solids ``('x', 'y', 'z')``; an ``r`` marks a rotation. With a
        `dof_map`, the DOFs that occur in it.
    mass_field : MassField, optional
        What the mass matrix is made of, for the inertia of the moving body. Models whose mass is
        the same along x, y and z, and that have at most lumped rotary inertia, have that of their
        nodes by default.
    geometric_stiffness : function, optional
        Geometric stiffness (n_dofs, n_dofs), sparse and symmetric, of the linear stresses that a
        displacement (n_dofs,) of the free body causes.
    dof_map : sequence of (int, str), optional
        Node index and DOF name of every row, where nodes have different DOFs or rows another
        order; node after node with `node_dofs` by default. A node may have no DOFs.
    labels : (n_nodes,) of int, optional
        Labels of the nodes in the FE program.
    node_sets : mapping of str to sequence of int
        Named sets of node indices.
    cells : sequence of (str, (n, k) of int)
        Kind of the elements, by meshio's names, and their nodes.
    source : str
        Where the model comes from, in words.
    units : str
        Units of its numbers, such as ``mm t N s``.
    outlines : (n_lines, corners, 3), optional
        Edges of the sections of the cells of kind line, about their axes, for pictures [length].
    stress : sequence of SolidStress or BeamStress
        What stresses the displacements cause, one for each kind of element; see `solid_stress`.
    followers : (n_nodes dimension, n_dofs), sparse, optional
        Displacements of nodes without DOFs that follow others; rows of all other nodes are zero.
    missing : mapping of str to str
        Why the model has no 'stresses', 'stiffening' or 'exact inertia', if its source says so:
        ``why; what to do``.
    materials : sequence of Material
        What it is made of, for the units.
    damping : (n_dofs, n_dofs), dense or sparse, optional
        Symmetric matrix of viscous damping that resists no rigid motion.

    Raises
    ------
    InputError
        Unknown DOF layout, shapes that do not fit together, entries that are no finite real
        numbers, matrices that are not symmetric, or labels, sets or cells that name other nodes.
    """

    stiffness: sparse.csc_array
    mass: sparse.csc_array
    coordinates: NDArray
    node_dofs: tuple[str, ...] = SPATIAL
    mass_field: MassField | None = None
    geometric_stiffness: Callable[[NDArray], sparse.csc_array] | None = None
    dof_map: Sequence[tuple[int, str]] | None = None
    labels: NDArray | None = None
    node_sets: Mapping[str, Sequence[int]] = field(default_factory=dict)
    cells: Sequence[tuple[str, NDArray]] = ()
    source: str = ""
    units: str = ""
    outlines: NDArray | None = None
    stress: Sequence[SolidStress | BeamStress] = ()
    followers: sparse.csr_array | None = None
    missing: Mapping[str, str] = field(default_factory=dict)
    materials: Sequence[Material] = ()
    damping: sparse.csc_array | None = None
    rows: NDArray = field(init=False, repr=False)   # (n_nodes, k): row of each DOF, -1 for none

    def __repr__(self) -> str:
        known = {"mass field": self.mass_field, "geometric stiffness": self.geometric_stiffness,
                 "cells": self.cells, "stress": self.stress, "node sets": self.node_sets}
        has = ", ".join(name for name, value in known.items() if value)
        return (f"<FEModel: {len(self.coordinates)} nodes, {self.stiffness.shape[0]} DOFs"
                + f"; {has}" * bool(has) + ">")

    def __post_init__(self) -> None:
        self._check_nodes()
        count, dimension = self.coordinates.shape
        size = int(np.sum(self.rows >= 0))
        for name in ("stiffness", "mass", "damping"):
            if name == "damping" and self.damping is None:
                continue
            matrix = fe_matrix(getattr(self, name), name)
            if matrix.shape != (size, size):
                have = (f"{count} nodes with {self.dofs_per_node} DOFs each" if self.dof_map is None
                        else f"the {size} rows of dof_map")
                raise InputError(f"{name} has shape {matrix.shape}; {have} need ({size}, {size})")
            object.__setattr__(self, name, matrix)
        if self.geometric_stiffness is not None:
            inputs.function(self.geometric_stiffness, "geometric_stiffness", "give a function of a "
                            "displacement (n_dofs,), or leave it out")
        if self.mass_field is not None:
            inputs.instance(self.mass_field, "mass_field", MassField, "give a MassField, or leave "
                            "it out").check(size, dimension)
        else:
            own = nodal_field(self.mass, self.coordinates, self.rows)
            object.__setattr__(self, "mass_field", own)
        if self.followers is not None and self.followers.shape != (count * dimension, size):
            raise InputError(f"followers has shape {self.followers.shape}; {count} nodes and "
                             f"{size} DOFs need ({count * dimension}, {size})")
        checked = mesh.labels(self.labels, count), mesh.node_sets(self.node_sets, count), \
            mesh.cells(self.cells, count)
        for name, value in zip(("labels", "node_sets", "cells"), checked, strict=True):
            object.__setattr__(self, name, value)
        if self.outlines is not None:
            lines = sum(len(nodes) for kind, nodes in self.cells if kind == "line")
            object.__setattr__(self, "outlines", inputs.array(
                self.outlines, "outlines", (lines, None, 3),
                remedy=f"give corners (x, y, z) for each of the {lines} cells of kind line"))
        object.__setattr__(self, "materials", checked_materials(self.materials))
        object.__setattr__(self, "units", str(parsed_units(self.units) or ""))
        inputs.text(self.source, "source of an FE model")
        remedy = "give SolidStress, as solid_stress makes them"
        object.__setattr__(self, "stress", tuple(
            inputs.instance(one, "stress", SolidStress | BeamStress, remedy)
            for one in inputs.items(self.stress, "stress", remedy)))

    def _check_nodes(self) -> None:
        """Coordinates, and the rows of every node."""
        layouts = f"use {SPATIAL}, {PLANAR} or {SOLID}"
        node_dofs = tuple(one if isinstance(one, str) else inputs.shown(one) for one in
                          inputs.items(self.node_dofs, "node_dofs", layouts))
        if node_dofs not in (SPATIAL, PLANAR, SOLID):
            raise InputError(f"node_dofs {node_dofs} unknown; {layouts}")
        dimension = sum(not name.startswith("r") for name in node_dofs)
        need = f"DOFs {node_dofs} need (n_nodes, {dimension})"
        coordinates = inputs.reals(self.coordinates, "coordinates", need)
        if self.dof_map is not None and coordinates.ndim == 2 and coordinates.shape[1] in (2, 3):
            dimension = coordinates.shape[1]    # the map says which DOFs there are
        if coordinates.ndim != 2 or coordinates.shape[1] != dimension or not len(coordinates):
            raise InputError(f"coordinates have shape {coordinates.shape}; {need}")
        if not np.isfinite(coordinates).all():
            node = int(np.argwhere(~np.isfinite(coordinates))[0][0])
            raise InputError(f"coordinates of node {node} are {coordinates[node]}; give finite "
                             "numbers")
        if self.dof_map is None:
            rows = equal_rows(len(coordinates), node_dofs)
        else:
            dof_map, node_dofs, rows = mapped_rows(self.dof_map, *coordinates.shape)
            object.__setattr__(self, "dof_map", dof_map)
        rows.flags.writeable = False
        for name, value in (("node_dofs", node_dofs), ("coordinates", coordinates), ("rows", rows)):
            object.__setattr__(self, name, value)

    @property
    def dofs_per_node(self) -> int:
        """Number of DOFs that a node can have."""
        return len(self.node_dofs)

    @property
    def extent(self) -> float:
        """Longest edge of the box around the nodes [length]."""
        return float(np.max(np.ptp(self.coordinates, axis=0)))

    def dofs(self, node: int, kind: str = "full") -> NDArray:
        """Rows of one node in the matrices; `kind` is 'full', 'translation' or 'rotation'.

        Raises
        ------
        InputError
            A node or kind there is not.
        """
        last = len(self.coordinates) - 1
        node = inputs.integer(node, "node", least=0, most=last, remedy=(
            f"the model has nodes 0 to {last}" + (
                "" if self.labels is None else "; node(label) is the index of a label")))
        is_rotation = np.array([name.startswith("r") for name in self.node_dofs])
        wanted = {
            "full": np.full(len(is_rotation), True),
            "translation": ~is_rotation,
            "rotation": is_rotation,
        }
        rows = self.rows[node, wanted[inputs.choice(kind, "kind of DOFs", wanted)]]
        return rows[rows >= 0]

    def node_at(self, point: ArrayLike) -> int:
        """Index of the node at `point`; InputError when the nearest is not there."""
        point = inputs.vector(point, "point", self.coordinates.shape[1])
        distance = np.linalg.norm(self.coordinates - point, axis=1)
        nearest = int(np.argmin(distance))
        if distance[nearest] > 1e-6 * self.extent:
            raise InputError(
                f"no node at {point}: the nearest, {self.node_name(nearest)}, is "
                f"{distance[nearest]:.3g} away; give the position of a node"
            )
        return nearest

    def node(self, label: int) -> int:
        """Index of the node with a label of the FE program; InputError for an unknown one."""
        if self.labels is None:
            raise InputError("the model has no node labels; use node indices, from 0 to "
                             f"{len(self.coordinates) - 1}")
        label = inputs.integer(label, "node label")
        nodes = np.flatnonzero(self.labels == label)
        if not len(nodes):
            near = self.labels[np.argsort(np.abs(self.labels - label), kind="stable")[:3]]
            raise InputError(f"the model has no node with the label {label}; labels near it are "
                             f"{', '.join(map(str, sorted(near)))}")
        return int(nodes[0])

    def node_set(self, name: str) -> tuple[int, ...]:
        """Node indices of a named set; InputError for an unknown one."""
        remedy = ("known are " + ", ".join(map(repr, self.node_sets)) if self.node_sets else
                  "the model has none; select nodes by place, see sebody.fem.selection")
        if not isinstance(name, str) or name not in self.node_sets:
            raise InputError(f"node set {inputs.shown(name)} is unknown: {remedy}")
        return self.node_sets[name]

    def node_name(self, node: int) -> str:
        """The node as messages name it: by its label where the model has labels."""
        return f"node {node if self.labels is None else self.labels[node]}"

    def by_nodes(self, shapes: NDArray) -> NDArray:
        """Displacements (n_dofs, m) node after node, (n_nodes k, m); 0 for DOFs there are not.

        Nodes without DOFs move as `followers` says.
        """
        if self.dof_map is None:
            return shapes
        rows = self.rows.ravel()
        result = np.zeros((len(rows), shapes.shape[1]))
        result[rows >= 0] = shapes[rows[rows >= 0]]
        if self.followers is not None:
            count, dimension = self.coordinates.shape
            moved = (self.followers @ shapes).reshape(count, dimension, -1)
            result.reshape(count, -1, shapes.shape[1])[:, :dimension] += moved
        return result
