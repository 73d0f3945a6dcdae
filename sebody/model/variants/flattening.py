"""Nodes, DOF blocks and vectors of a spatial model in a plane, each refused that is not in it."""

import numpy as np
from numpy.typing import NDArray

from sebody.basics.errors import InputError
from sebody.model.pairs import NEAR
from sebody.model.parts import Attachment, DofBlock, Motion, Node
from sebody.model.plane import Plane

_SAME = 1e-9            # a direction is in the plane, or normal to it, but for this part of it


class Flattening:
    """Parts of a spatial model that are in a plane, and their planar counterparts.

    Parameters
    ----------
    plane : Plane
    size : float
        Characteristic length of the model [length].
    """

    def __init__(self, plane: Plane, size: float) -> None:
        self.plane, self._near = plane, NEAR * size
        self._nodes: dict[Node, Node] = {}
        self._dof_blocks: dict[DofBlock, DofBlock] = {}

    def point(self, point: NDArray, what: str) -> NDArray:
        """Planar coordinates of a point, (2,).

        Raises
        ------
        InputError
            It is off the plane.
        """
        components = self.plane.axes.T @ (point - self.plane.origin)
        if abs(components[2]) > self._near:
            raise InputError(f"{what} is {abs(components[2]):.4g} off the plane")
        return components[:2]

    def vector(self, vector: NDArray, what: str) -> NDArray:
        """Planar components of a vector, (2,).

        Raises
        ------
        InputError
            It has a component along the normal.
        """
        components = self.plane.axes.T @ vector
        if abs(components[2]) > _SAME * np.linalg.norm(components):
            raise InputError(f"{what} has a component out of the plane")
        return components[:2]

    def axial(self, vector: NDArray, what: str) -> float:
        """Component of an axial vector about the normal.

        Raises
        ------
        InputError
            It has a component about an axis in the plane.
        """
        components = self.plane.axes.T @ vector
        if np.abs(components[:2]).max() > _SAME * np.linalg.norm(components):
            raise InputError(f"{what} is not normal to the plane")
        return components[2]

    def is_normal(self, direction: NDArray) -> bool:
        """Tell whether a direction is normal to the plane."""
        own = self.plane.axes.T @ direction
        return bool(np.abs(own[:2]).max() <= _SAME * np.linalg.norm(own))

    def is_inside(self, direction: NDArray) -> bool:
        """Tell whether a direction is in the plane."""
        own = self.plane.axes.T @ direction
        return bool(abs(own[2]) <= _SAME * np.linalg.norm(own))

    def node(self, node: Node) -> Node:
        """The planar node, the same for the same node."""
        if node not in self._nodes:
            hidden = not node.point.size        # the node of an unknown of a rope
            self._nodes[node] = Node(
                node.name, node.point if hidden else self.point(node.point, f"node {node.name!r}"),
                *(None if dof_block is None else self.dof_block(dof_block)
                  for dof_block in (node.position, node.rotation)))
        return self._nodes[node]

    def place(self, place: Attachment) -> Attachment:
        """The planar place."""
        return Attachment(self.node(place.node), place.kind)

    def dof_block(self, dof_block: DofBlock) -> DofBlock:
        """The planar DOF block, without motions, the same for the same DOF block."""
        if dof_block not in self._dof_blocks:
            what = f"initial velocity of {dof_block.name}"
            if dof_block.rotational:
                start, rate = np.zeros(1), np.array([self.axial(dof_block.rate, what)])
            elif _hidden(dof_block):
                start, rate = dof_block.start, dof_block.rate
            else:
                start = self.point(dof_block.start, dof_block.name)
                rate = self.vector(dof_block.rate, what)
            made = self._dof_blocks[dof_block] = DofBlock(
                dof_block.name, start, rate, dof_block.fixed, given=dof_block.given,
                rotational=dof_block.rotational)
            if dof_block.root is not None:
                made.root = self.dof_block(dof_block.root)
                made.arms = tuple(
                    (self.dof_block(rotation),
                     self.vector(arm, f"the rigid link to {dof_block.name}"))
                    for rotation, arm in dof_block.arms)
        return self._dof_blocks[dof_block]

    def motion(self, motion: Motion) -> Motion:
        """The planar prescribed motion."""
        what = f"the direction of {motion.name!r}"
        if _hidden(motion.place.dof_block):
            return motion._replace(place=self.place(motion.place))
        direction = (np.array([self.axial(motion.direction, what)])
                     if motion.place.kind == "rotation" else self.vector(motion.direction, what))
        return motion._replace(direction=direction, place=self.place(motion.place))


def _hidden(dof_block: DofBlock) -> bool:
    """Tell whether a block is one unknown that is no coordinate of a place."""
    return not dof_block.rotational and dof_block.start.size == 1
