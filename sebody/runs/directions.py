"""Directions of the measures of friction and contacts among all coordinates: rates are ``row . v``.
"""

import numpy as np
from numpy.typing import NDArray

from sebody.basics.vectors import moment_of
from sebody.engine.state import State
from sebody.model.body_points import shapes
from sebody.model.numbering import Numbering, stretch
from sebody.model.parts import DofBlock, Element


def directions(element: Element, numbering: Numbering, state: State) -> list[NDArray]:
    """Directions of an element's measures among all coordinates: rates are ``row . v``.

    Of contacts the axes of space at its nodes: of the centre against the surface.
    """
    c, size = element.constants, len(element.dof_blocks[0].start)
    kind = element.kind.removeprefix("planar_")
    places = [t for t in element.dof_blocks if not t.rotational]
    turns = [t for t in element.dof_blocks if t.rotational]
    if element.point is not None:
        return [of_point(element, numbering, state, axis) for axis in np.eye(size)]
    if kind.startswith(("sphere_on", "point_on")):
        return [pair(numbering, state, places, axis, [axis, axis]) for axis in np.eye(size)]
    if kind == "friction_way":
        return [_one(numbering, places[0])]
    if kind.startswith("friction_slide"):
        return [_slide(numbering, state, places, turns[0], element.vector("e"))]
    if kind.startswith("friction_cylindrical"):
        return [_slide(numbering, state, places, turns[0], element.vector("e")),
                c["radius"] * _turn(numbering, state, turns, np.cross(c["n"], c["m"]))]
    if kind.startswith("friction_spherical"):
        Ra, Rb = (rotation_of(numbering, state, t) for t in turns)
        return [pair(numbering, state, turns, axis, [Ra.T @ Rb @ axis, axis])
                for axis in np.eye(3)]
    if kind == "gear_play":
        return [_of_gear(element, numbering, state, 1)]
    return [_turn(numbering, state, turns, np.cross(c["n"], c["m"]) if "n" in c else None)]


def _one(numbering: Numbering, way: DofBlock) -> NDArray:
    """The row of a way along a path, which is a coordinate."""
    row = np.zeros(numbering.total)
    row[stretch(numbering, way)] = 1.0
    return row


def of_mesh(gear: Element, numbering: Numbering, state: State) -> NDArray:
    """The row of the teeth of a gear: of the angle of the first less the ratio times the second."""
    first, second = (_of_gear(gear, numbering, state, k) for k in (1, 2))
    return first - gear.number("ratio") * second


def _of_gear(gear: Element, numbering: Numbering, state: State, k: int) -> NDArray:
    """The row of the angle of one of the two joints of a gear."""
    c = gear.constants
    return _turn(numbering, state, list(gear.dof_blocks[2 * k - 2:2 * k]),
                 np.cross(c[f"n{k}"], c[f"m{k}"]) if f"n{k}" in c else None)


def of_point(element: Element, numbering: Numbering, state: State, axis: NDArray) -> NDArray:
    """The row of a point inside a body, undeformed as at the start, against the surface's node."""
    assert element.point is not None
    row, body = np.zeros(numbering.total), element.point.body
    by = shapes(element.point) @ axis
    for one, at in zip(body.attachments, body.firsts, strict=True):
        size = one.dof_block.start.size
        _add(row, numbering, state, one.dof_block, by[at:at + size])
    first = numbering.modes[body.name]
    row[first:first + body.reduced.modes] = by[len(by) - body.reduced.modes:]
    _add(row, numbering, state, element.dof_blocks[-2], -axis)
    return row


def _turn(numbering: Numbering, state: State, turns: list[DofBlock], axis: NDArray | None
          ) -> NDArray:
    axis = np.ones(1) if axis is None else axis
    return pair(numbering, state, turns, axis, [axis, axis])


def _slide(numbering: Numbering, state: State, places: list[DofBlock], carrier: DofBlock,
           e: NDArray) -> NDArray:
    along = rotation_of(numbering, state, carrier) @ e
    return pair(numbering, state, places[::-1], along, [along, along])


def pair(numbering: Numbering, state: State, dof_blocks: list[DofBlock], axis: NDArray,
         vectors: list[NDArray]) -> NDArray:
    """A row that takes the rate of the second DOF block from that of the first."""
    row = np.zeros(numbering.total)
    for dof_block, sign, vector in zip(dof_blocks, (1.0, -1.0), vectors, strict=True):
        _add(row, numbering, state, dof_block, sign * vector)
    return row


def _add(row: NDArray, numbering: Numbering, state: State, dof_block: DofBlock, vector: NDArray
         ) -> None:
    """Add a vector along a DOF block, or along what it follows."""
    own = dof_block.root if dof_block.root is not None else dof_block
    row[stretch(numbering, own)] += vector
    for rotation, arm in dof_block.arms:
        force = rotation_of(numbering, state, rotation).T @ vector    # in axes of the arm
        row[stretch(numbering, rotation)] += moment_of(arm, force)


def rotation_of(numbering: Numbering, state: State, dof_block: DofBlock) -> NDArray:
    """Rotation matrix of a DOF block in space; in a plane (2, 2)."""
    if dof_block in numbering.rotations:
        k = numbering.rotations[dof_block]
        return state.R[9 * k:9 * k + 9].reshape(3, 3)
    angle = state.q[numbering.dof_blocks[dof_block]]
    return np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
