"""Forces and moments on nodes, and what nodes pass to each other without an equation.

Elements, joints with equations and loads give each node what their kernels say: minus their entries
in the residual. Joints from shared and fixed DOF blocks, supports and rigid links take no equation:
what they pass follows from the balance of every node. Where several of them join the same nodes,
such as two hinges to the ground on one node, this has many solutions: the one of least norm is
taken, as for multipliers of redundant constraints.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import cached_property

import numpy as np
from scipy.sparse import csc_matrix
from scipy.sparse.linalg import SuperLU, splu

from sebody.model.parts import Connection, Element, Joint, Node, Superelement
from sebody.quantities.algebra import cross, dot, minus, moment, plus, scaled, times
from sebody.quantities.expressions import Matrix, Number, choice, inverse, root
from sebody.quantities.numbers import Numbers

Part = Element | Superelement
ROUNDED = 1e-13         # of weights of forces, which are numbers like one and a half


def balance(of: Numbers) -> Balance:
    """The balance of some numbers, made once."""
    if "balance" not in of.made:
        of.made["balance"] = Balance(of)
    return of.made["balance"]


class Balance:
    """Forces on the nodes of a model, in global axes.

    Parameters
    ----------
    numbers : Numbers
        Of the states.
    """

    def __init__(self, numbers: Numbers):
        self._of, self._model = numbers, numbers.model
        self._passed: dict[tuple[str, int], list[Number]] = {}
        self._given: dict[tuple[Node, str], list[Number]] = {}

    def on(self, part: Part, node: Node, kind: str) -> list[Number]:
        """Force or moment of an element on a node; zero where it does not act.

        Of a body it is the force of inertia, weight and deformation, which is minus that of
        everything else on the body.
        """
        total: list[Number] = [0.0] * self._size(kind)
        first = self._of.numbering.forces_at[part]
        for place, at in zip(part.attachments, part.firsts, strict=True):
            block = getattr(place.node, place.kind)
            if place.node is node and place.kind == kind:
                values = [-self._of.force(first + at + k) for k in range(block.start.size)]
                if block.rotational and not self._model.planar:
                    values = times(self._of.rotation(block), values)
                total = plus(total, values)
        return total

    def of_joint(self, joint: Joint, kind: str) -> list[Number]:
        """Force or moment of a joint on its node, of its equations and without them."""
        total: list[Number] = [0.0] * self._size(kind)
        for k, connection in enumerate(self._kept[kind]):
            if connection.joint is joint:
                total = plus(total, self._by_connection(kind, k))
        for equation in joint.constraints:
            total = plus(total, self.on(equation, joint.node, kind))
        return total

    def axes(self, joint: Joint) -> Matrix:
        """The matrix whose columns are the axes of a joint, in global axes.

        The first one is the axis of the joint, the line between the nodes of a distance, or the
        tangent of a path.
        """
        if joint.axes is not None:
            R = self._of.rotation(joint.axes.carrier.rotation)
            columns = [times(R, column) for column in joint.axes.columns.T.tolist()]
            return [list(row) for row in zip(*columns, strict=True)]
        first = _unit(self._tangent(joint) or minus(*(
            self._of.part("q", node, "position") for node in (joint.to, joint.node))))
        if self._model.planar:
            return [[first[0], -first[1]], [first[1], first[0]]]
        small = [-(x * x) for x in first]       # across the axis of space that is furthest from it
        across = [cross(first, axis) for axis in np.eye(3).tolist()]
        second = _unit([choice(small, [one[i] for one in across]) for i in range(3)])
        return [list(row) for row in zip(first, second, cross(first, second), strict=True)]

    def _tangent(self, joint: Joint) -> list[Number]:
        """Tangent of the path that a joint is on, which its elements keep; empty of other joints.
        """
        total: list[Number] = []
        for one in joint.constraints:
            if one.path is not None and not one.path.turns:
                own = [self._of.recorded("frames", k) for k in self._of.numbering.memories[one]]
                total = plus(total, own) if total else own
        return total

    def _size(self, kind: str) -> int:
        return self._model.dimension if kind == "position" else self._model.rotation_size

    @cached_property
    def _kept(self) -> dict[str, list[Connection]]:
        kept = _without_spare(self._model.connections)
        return {kind: [c for c in kept if c.kind == kind] for kind in ("position", "rotation")}

    @cached_property
    def _parts_on(self) -> dict[tuple[Node, str], list[Part]]:
        """The elements on the nodes that are joined without an equation."""
        model = self._model
        found: dict[tuple[Node, str], list[Part]] = {
            (node, kind): [] for kind, own in self._kept.items()
            for c in own for node in (c.node, c.to) if node is not None}
        parts: list[Part] = [*model.bodies.values(), *model.rigid_bodies.values(),
                             *model.constraints, *model.loads]
        for part in parts:
            for place in dict.fromkeys((p.node, p.kind) for p in part.attachments):
                if place in found:
                    found[place].append(part)
        return found

    @cached_property
    def _systems(self) -> dict[str, System]:
        return {kind: System(own, [node for node, k in self._parts_on if k == kind])
                for kind, own in self._kept.items() if own}

    def _by_connection(self, kind: str, k: int) -> list[Number]:
        """Force or moment that a connection passes to its node."""
        if (kind, k) not in self._passed:
            total: list[Number] = [0.0] * self._size(kind)
            for node, weight in self._systems[kind].weights(k):
                total = plus(total, scaled(weight, self._on_node(node, kind)))
            self._passed[kind, k] = total
        return self._passed[kind, k]

    def _on_node(self, node: Node, kind: str) -> list[Number]:
        """Force or moment of elements on a node, with moments of forces that rigid links pass.

        A link passes the force f to its end and ``-f`` at this end to where it starts, a place
        r before the end: there the moment ``-r x f``.
        """
        if (node, kind) in self._given:
            return self._given[node, kind]
        total: list[Number] = [0.0] * self._size(kind)
        for part in self._parts_on[node, kind]:
            total = plus(total, self.on(part, node, kind))
        if kind == "rotation":
            for k, c in enumerate(self._kept["position"]):
                if c.to is node and (c.node, kind) in self._parts_on:
                    r = minus(*(self._of.part("q", one, "position") for one in (c.node, node)))
                    total = minus(total, moment(r, self._by_connection("position", k)))
        self._given[node, kind] = total
        return total


class System:
    """Forces that connections pass to their nodes so that each of these is in balance.

    Of all solutions of ``B f + given = 0``, B the incidence matrix, that of least norm:
    ``f = B^T y`` with ``B B^T y = -given``.
    """

    def __init__(self, connections: list[Connection], nodes: list[Node]):
        without = _representatives(connections)
        self._nodes = [node for node in nodes if node not in without]
        rows = {node: k for k, node in enumerate(self._nodes)}
        entries = [(rows[node], k, sign) for k, c in enumerate(connections)
                   for node, sign in ((c.node, 1.0), (c.to, -1.0))
                   if node is not None and node in rows]
        row, column, sign = zip(*entries, strict=True)
        self._incidence = csc_matrix((sign, (row, column)),
                                     shape=(len(rows), len(connections)))

    @cached_property
    def _factors(self) -> SuperLU:
        return splu(csc_matrix(self._incidence @ self._incidence.T))

    def weights(self, k: int) -> list[tuple[Node, float]]:
        """Nodes, and the weights of what is given to them in what connection k passes."""
        column = self._incidence[:, [k]].toarray()[:, 0]
        found = -self._factors.solve(column)
        return [(node, float(w)) for node, w in zip(self._nodes, found, strict=True)
                if abs(w) > ROUNDED]


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
        """Make two groups one; tell whether they were two."""
        a, b = self.of(one), self.of(other)
        if a is None:
            a, b = b, a
        if a != b:
            self._above[a] = b
        return a != b


def _without_spare(connections: Iterable[Connection]) -> list[Connection]:
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


def _unit(vector: list[Number]) -> list[Number]:
    return scaled(inverse(root(dot(vector, vector))), vector)
