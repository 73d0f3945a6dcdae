"""Reference of displacements: the undeformed body that moves with a chosen node.

A body that is held at a node is compared with the undeformed body that has the position and the
rotation of this node, so the support does not move. On two supports that let it turn it is compared
with the undeformed body on the chord between them, which turns about the chord with the first one:
neither support moves across the chord. Bodies that are welded together, such as the
parts of a beam, are measured from one node, so displacements are continuous from part to part. A
body without support or joint is compared with the undeformed body on its floating frame.
"""

from collections.abc import Hashable, Iterator
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.model.arguments import dof_block
from sebody.model.mechanism import Mechanism
from sebody.model.parts import COUPLING, DofBlock, Node, Superelement
from sebody.results.recording import Recording

APART = "distance", "path"              # joints whose nodes are not at one place
NO_SUPPORT = "drive", COUPLING, *APART  # joints that hold no place of a body
FRAME = "frame"         # in place of the name of a node: the floating frame of the body


class Undeformed(NamedTuple):
    """The undeformed body of a reference in n states, seen from the floating frame of the body.

    A point X of the body, from the origin of the frame, is at ``rotation X + shift``.
    """

    rotation: NDArray       # (n, D, D)
    shift: NDArray          # (n, D)

    def places(self, points: NDArray) -> NDArray:
        """Places (n, k, D) of points (k, D)."""
        return points @ self.rotation.transpose(0, 2, 1) + self.shift[:, None]


class Chord(NamedTuple):
    """From the first to the second of two nodes whose positions are supported."""

    node: Node
    other: Node


def undeformed(recording: Recording, body: Superelement, rotation: NDArray, origin: NDArray,
               at: Node | Chord, states: slice | NDArray) -> Undeformed:
    """The undeformed body at a node, or on a chord, seen from a frame.

    Parameters
    ----------
    rotation, origin : (n, D, D), (n, D)
        Of the floating frame, see `BodyMotion`.
    at : Node or Chord
        See `Welded.reference`.
    states : slice or (n,) of int
        Recorded states in which they are.
    """
    node = at.node if isinstance(at, Chord) else at
    held = np.array([body.nodes[i].point for i in body.reduced.position_nodes])
    arm = body.alpha @ held - node.point        # from the node to the frame, both undeformed
    place = _places(recording, node, states)
    turned = (_rotations(recording, node, states)
              if node not in body.nodes or node in _full(body) else rotation)
    if isinstance(at, Chord):
        chord = _places(recording, at.other, states) - place
        turned = _least_rotations(turned @ (at.other.point - node.point), chord) @ turned
    back = rotation.transpose(0, 2, 1)
    shift = place + turned @ arm - origin
    return Undeformed(back @ turned, (back @ shift[:, :, None])[:, :, 0])


def _places(recording: Recording, node: Node, states: slice | NDArray) -> NDArray:
    """Positions (n, D) of a node."""
    position = dof_block(node, "position")
    first = recording.numbering.dof_blocks[position]
    return recording.recorded("q")[states, first:first + position.start.size]


def _least_rotations(vectors: NDArray, others: NDArray) -> NDArray:
    """Rotations (n, D, D) by the least angles that turn vectors (n, D) to the directions of others.
    """
    a, b = (v / np.linalg.norm(v, axis=1)[:, None] for v in (vectors, others))
    # (1 + a.b) I of a and b in their plane, and their bivector; of any dimension
    across = np.einsum("ni,nj->nij", b, a) - np.einsum("ni,nj->nij", a, b)
    cosine = np.einsum("ni,ni->n", a, b)[:, None, None]
    return np.eye(a.shape[1]) + across + across @ across / (1.0 + cosine)


class Set(NamedTuple):
    """Nodes at one place."""

    number: int
    fixed: bool             # whether one of them is


def together(model: Mechanism) -> dict[str, Set]:
    """Nodes that joints and rigid links keep together, by name; those of the ground, too."""
    union = _Union()
    nodes = [*model.nodes.values(), *model.grounds]
    for joint in model.joints:
        if joint.kind not in APART:
            union.join(joint.node.name, joint.to.name)
    for one in model.connections:
        if one.kind == "position" and one.to is not None:
            union.join(one.node.name, one.to.name)
    for node in nodes:
        if node.position is not None:
            union.join(node.position, node.name)
    roots = {node.name: union.root(node.name) for node in nodes}
    fixed = {roots[node.name] for node in nodes if node.position is not None
             and node.position.fixed}
    number = {root: k for k, root in enumerate(dict.fromkeys(roots.values()))}
    return {name: Set(number[root], root in fixed) for name, root in roots.items()}


class Welded:
    """Nodes of a model that move as one, and bodies that are welded together at such nodes."""

    def __init__(self, model: Mechanism):
        self._model = model
        self._nodes, self._bodies = _Union(), _Union()
        for joint in model.joints:
            if joint.kind == "weld":
                self._nodes.join(_key(joint.node), _key(joint.to))
        for body in model.bodies.values():
            for node in _full(body):
                self._bodies.join(body.name, self._cluster(node))
        nodes = [*model.nodes.values(), *model.grounds]
        self._clamped = {self._cluster(node) for node in nodes
                         if _is_fixed(node.position) and _is_fixed(node.rotation)}
        self._fixed = {self._cluster(node) for node in nodes if _is_fixed(node.position)}
        self._jointed = self._with_joints()

    def reference(self, body: Superelement, name: str | None = None) -> Node | Chord | None:
        """The node, or chord, that displacements of a body are measured from.

        None for its floating frame.

        Parameters
        ----------
        name : str, optional
            A node of the body or of one that is welded to it, or `FRAME`; see `default`.

        Raises
        ------
        InputError
            A node of another body, or one without a position and a rotation where it needs them.
        """
        if name is None:
            return self.default(body)
        if inputs.name(name, "reference of displacements") == FRAME:
            return None
        known = {node.name: node for node in self.candidates(body)}
        if name in known:
            return known[name]
        raise InputError(f"displacements of body {body.name!r} cannot be measured from {name!r}: "
                         f"give one of its nodes, {', '.join(known)}, or {FRAME!r}, its floating "
                         "frame")

    def default(self, body: Superelement) -> Node | Chord | None:
        """The first node that is fixed with its rotation, else the chord of two supported ones.

        The chord leads from the first of them to the farthest. Else the first node that is fixed,
        else the first one with a joint. None if there is none; of several bodies that are welded
        together their first node.
        """
        nodes = list(self.candidates(body))
        supported = [] if any(self._cluster(node) in self._clamped for node in nodes) else [
            node for node in nodes if node.position in self._supported]
        if supported:
            first = supported[0]
            other = max(supported, key=lambda node: float(np.linalg.norm(node.point - first.point)))
            if np.any(other.point != first.point):
                return Chord(first, other)
        for held in (self._clamped, self._fixed, self._jointed):
            for node in nodes:
                if self._cluster(node) in held:
                    return node
        return nodes[0] if len(self.bodies(body)) > 1 else None

    def has(self, body: Superelement, name: str) -> bool:
        """Tell if displacements of a body can be measured from a node of this name, or `FRAME`."""
        return name == FRAME or any(node.name == name for node in self.candidates(body))

    def candidates(self, body: Superelement) -> Iterator[Node]:
        """Nodes that displacements of a body can be measured from, each once."""
        group = self.bodies(body)
        by_name: dict[str, Node] = {}
        for one in group:
            nodes = _full(one) if len(group) > 1 else [one.nodes[i]
                                                       for i in one.reduced.position_nodes]
            by_name |= {node.name: node for node in nodes}
        yield from by_name.values()

    def clusters(self) -> dict[str, int]:
        """Numbers of nodes by name, equal for those that move as one."""
        roots = {node.name: self._cluster(node)
                 for node in (*self._model.nodes.values(), *self._model.grounds)}
        number = {root: k for k, root in enumerate(dict.fromkeys(roots.values()))}
        return {name: number[root] for name, root in roots.items()}

    def bodies(self, body: Superelement) -> list[Superelement]:
        """Bodies that are welded to one, in the order of the model, this one among them."""
        root = self._bodies.root(body.name)
        return [one for one in self._model.bodies.values()
                if self._bodies.root(one.name) == root]

    def _with_joints(self) -> set[Hashable]:
        """Clusters with a joint; nodes that share a position alone have one, too."""
        clusters = {self._cluster(node) for joint in self._model.joints if joint.kind != "weld"
                    for node in (joint.node, joint.to)}
        sharing: dict[DofBlock, set[Hashable]] = {}
        for node in self._model.nodes.values():
            if node.position is not None:
                sharing.setdefault(node.position, set()).add(self._cluster(node))
        return clusters.union(*(group for group in sharing.values() if len(group) > 1))

    @cached_property
    def _supported(self) -> set[DofBlock | None]:
        """Positions that are fixed, or held by a joint to what is fixed."""
        positions = {node.position for node in self._model.nodes.values()
                     if _is_fixed(node.position)}
        for joint in self._model.joints:
            if joint.kind not in NO_SUPPORT:
                for one, other in ((joint.node, joint.to), (joint.to, joint.node)):
                    if _is_fixed(other.position):
                        positions.add(one.position)
        return positions

    def _cluster(self, node: Node) -> Hashable:
        """Representative of all nodes that move as one with a node."""
        return self._nodes.root(_key(node))


class _Union:
    """Disjoint sets that can be joined, each with a representative."""

    def __init__(self) -> None:
        self._parent: dict[Hashable, Hashable] = {}

    def root(self, one: Hashable) -> Hashable:
        while one in self._parent:
            one = self._parent[one]
        return one

    def join(self, one: Hashable, other: Hashable) -> None:
        one, other = self.root(one), self.root(other)
        if one != other:
            self._parent[other] = one


def _key(node: Node) -> tuple[Hashable, Hashable]:
    """Equal for nodes that share a rotation, and a position or rigid links from one."""
    position = node.position
    if position is not None and position.root is not None and all(
            rotation is node.rotation for rotation, _ in position.arms):
        position = position.root
    return node.rotation, position if node.rotation is not None else node


def _is_fixed(block: DofBlock | None) -> bool:
    return block is not None and block.fixed


def _full(body: Superelement) -> list[Node]:
    """Nodes of which a body keeps the position and the rotation."""
    return [body.nodes[i] for i in body.reduced.position_nodes if i in body.reduced.rotation_nodes]


def _rotations(recording: Recording, node: Node, states: slice | NDArray) -> NDArray:
    """Rotation matrices (n, D, D) of a node."""
    if recording.model.planar:
        first = recording.numbering.dof_blocks[dof_block(node, "rotation")]
        angle = recording.recorded("q")[states, first]
        c, s = np.cos(angle), np.sin(angle)
        return np.stack([c, -s, s, c], axis=1).reshape(-1, 2, 2)
    k = recording.numbering.rotations[dof_block(node, "rotation")]
    return recording.recorded("R")[states, 9 * k:9 * k + 9].reshape(-1, 3, 3)
