"""Forces and moments on nodes, and what nodes pass to each other without an equation.

Elements, joints with equations and loads give each node what their kernels say: minus their entries
in the residual. Joints from shared and fixed DOF blocks, supports and rigid links take no equation:
what they pass follows from the balance of every node. Where several of them join the same nodes,
such as two hinges to the ground on one node, this has many solutions: the one of least norm is
taken, as for multipliers of redundant constraints.
"""

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_matrix
from scipy.sparse.linalg import splu

from sebody.assembly.numbering import Numbering, stretch
from sebody.basics.vectors import moment_of
from sebody.model.arguments import dof_block
from sebody.model.mechanism import Mechanism
from sebody.model.parts import Connection, DofBlock, Element, Joint, Node, Superelement

Part = Element | Superelement


class Balance:
    """Forces on the nodes of a model in some recorded states, in global axes.

    Parameters
    ----------
    elements : (n, forces of all elements)
        Their residuals, see `Numbering.forces_at`.
    q : (n, coordinates)
    R : (n, 9 rotations)
    """

    def __init__(self, model: Mechanism, numbering: Numbering, elements: NDArray, q: NDArray,
                 R: NDArray):
        self._model, self._numbering = model, numbering
        self._elements, self._q, self._R = elements, q, R
        kept = _kept(model.connections)
        at = self._of_all_elements(kept)
        self._passed: dict[str, tuple[list[Connection], NDArray]] = {}
        for kind in ("position", "rotation"):
            own = [c for c in kept if c.kind == kind]
            given = {node: sums for node, k, sums in at if k == kind}
            if kind == "rotation":
                self._add_levers(given)
            self._passed[kind] = own, self._solve(own, given)

    def rotation(self, dof_block: DofBlock | None) -> NDArray:
        """Rotation matrices of a block, (n, 3, 3), in a plane (n, 2, 2); of none, no rotation."""
        d, n = self._model.dimension, len(self._q)
        if dof_block is None or dof_block not in self._numbering.dof_blocks:
            return np.broadcast_to(np.eye(d), (n, d, d))
        if d == 2:
            angle = self._q[:, self._numbering.dof_blocks[dof_block]]
            c, s = np.cos(angle), np.sin(angle)
            return np.stack([c, -s, s, c], axis=1).reshape(n, 2, 2)
        k = self._numbering.rotations[dof_block]
        return self._R[:, 9 * k:9 * k + 9].reshape(n, 3, 3)

    def position(self, node: Node) -> NDArray:
        """Positions of a node, (n, d)."""
        return self._q[:, stretch(self._numbering, dof_block(node, "position"))]

    def on(self, part: Part, node: Node, kind: str) -> NDArray:
        """Force or moment of an element on a node, (n, size); zero where it does not act.

        Of a body it is the force of inertia, weight and deformation, which is minus that of
        everything else on the body.
        """
        total = np.zeros((len(self._q), self._size(kind)))
        first = self._numbering.forces_at[part]
        for place, at in zip(part.attachments, part.firsts, strict=True):
            block = getattr(place.node, place.kind)
            if place.node is node and place.kind == kind:
                begin = first + at
                values = -self._elements[:, begin:begin + block.start.size]
                if block.rotational and not self._model.planar:
                    values = np.einsum("nij,nj->ni", self.rotation(block), values)
                total += values
        return total

    def of_joint(self, joint: Joint, kind: str) -> NDArray:
        """Force or moment of a joint on its node, of its equations and without them."""
        connections, values = self._passed[kind]
        total = np.zeros((len(self._q), self._size(kind)))
        for k, connection in enumerate(connections):
            if connection.joint is joint:
                total += values[:, k]
        for equation in joint.constraints:
            total += self.on(equation, joint.node, kind)
        return total

    def axes(self, joint: Joint) -> NDArray:
        """Matrices (n, d, d) whose columns are the axes of a joint, in global axes."""
        if joint.axes is not None:
            return self.rotation(joint.axes.carrier.rotation) @ joint.axes.columns
        line = self.position(joint.to) - self.position(joint.node)
        first = line / np.linalg.norm(line, axis=1, keepdims=True)
        if self._model.planar:
            return np.stack([first, first[:, ::-1] * [-1.0, 1.0]], axis=2)
        second = np.cross(first, np.eye(3)[np.argmin(np.abs(first), axis=1)])
        second /= np.linalg.norm(second, axis=1, keepdims=True)
        return np.stack([first, second, np.cross(first, second)], axis=2)

    def _size(self, kind: str) -> int:
        return self._model.dimension if kind == "position" else self._model.rotation_size

    def _of_all_elements(self, connections: Iterable[Connection]
                         ) -> list[tuple[Node, str, NDArray]]:
        """Sums over all elements on the nodes that are joined without an equation."""
        model = self._model
        wanted = {(node, c.kind): (node, c.kind, np.zeros((len(self._q), self._size(c.kind))))
                  for c in connections for node in (c.node, c.to) if node is not None}
        parts: list[Part] = [*model.bodies.values(), *model.rigid_bodies.values(),
                             *model.constraints, *model.loads]
        for part in parts:
            for node, kind in dict.fromkeys((p.node, p.kind) for p in part.attachments):
                if (node, kind) in wanted:
                    wanted[node, kind][2][:] += self.on(part, node, kind)
        return list(wanted.values())

    def _solve(self, connections: list[Connection], given: dict[Node, NDArray]) -> NDArray:
        """What connections pass to their nodes so that each of these is in balance, (n, c, size).

        Of all solutions of ``B f + given = 0``, B the incidence matrix, that of least norm:
        ``f = B^T y`` with ``B B^T y = -given``.
        """
        if not connections:
            return np.zeros((len(self._q), 0, 1))
        without = _representatives(connections)
        rows = {key: k for k, key in enumerate(key for key in given if key not in without)}
        entries = [(rows[node], k, sign) for k, c in enumerate(connections)
                   for node, sign in ((c.node, 1.0), (c.to, -1.0))
                   if node is not None and node in rows]
        row, column, sign = zip(*entries, strict=True)
        B = csc_matrix((sign, (row, column)), shape=(len(rows), len(connections)))
        demand = np.stack([-given[key] for key in rows])
        y = splu(csc_matrix(B @ B.T)).solve(demand.reshape(len(rows), -1))
        return (B.T @ y).reshape(len(connections), *demand.shape[1:]).transpose(1, 0, 2)

    def _add_levers(self, moments: dict[Node, NDArray]) -> None:
        """Add the moments of the forces that rigid links pass, about the nodes they start from.

        A link passes the force f to its end and ``-f`` at this end to where it starts, a place
        r before the end: there the moment ``-r x f``.
        """
        connections, forces = self._passed["position"]
        for k, c in enumerate(connections):
            if c.to is not None and c.to in moments and c.node in moments:
                r = self.position(c.node) - self.position(c.to)
                moments[c.to] -= moment_of(r, forces[:, k])


class _Groups:
    """Nodes that are joined, by a forest; None is the ground."""

    def __init__(self) -> None:
        self._above: dict[Node | None, Node | None] = {}

    def of(self, node: Node | None) -> Node | None:
        """Representative of the group of a node; the ground represents its own group."""
        while (above := self._above.get(node, node)) != node:
            node = above
        return node

    def join(self, one: Node | None, other: Node | None) -> bool:
        """Make two groups one; whether they were two."""
        a, b = self.of(one), self.of(other)
        if a is None:
            a, b = b, a
        if a != b:
            self._above[a] = b
        return a != b


def _kept(connections: Iterable[Connection]) -> list[Connection]:
    """Connections without the spare ones where joints join the same nodes."""
    connections_used, groups = [], {"position": _Groups(), "rotation": _Groups()}
    for connection in sorted(connections, key=lambda c: c.spare):
        two = groups[connection.kind].join(connection.node, connection.to)
        if two or not connection.spare:
            connections_used.append(connection)
    return connections_used


def _representatives(connections: Iterable[Connection]) -> set[Node]:
    """One node of every group that is not joined to the ground: its balance is that of the rest."""
    groups, connections = _Groups(), list(connections)
    for c in connections:
        groups.join(c.node, c.to)
    found = {groups.of(c.node) for c in connections}
    return {key for key in found if key is not None}
