"""Elements of joints on paths: one on each body of a path, which add to the same equations."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sebody.basics.errors import InputError
from sebody.contract.names import path_across_kind, path_kind
from sebody.model.arguments import direction
from sebody.model.frames import FRAMES
from sebody.model.mechanism import Mechanism
from sebody.model.parts import (
    Attachment,
    DofBlock,
    Element,
    Node,
    OnPath,
    Path,
    positions,
)
from sebody.model.path_sections import STEEP, Sections, sections, upright
from sebody.model.path_tables import piece_at

VERTICAL = np.array([0.0, 0.0, 1.0])


def equation(name: str, places: tuple[Attachment, ...], path: Path, way: DofBlock, hidden: Node,
             kind: Callable[[str], str], *, multipliers: int = 1,
             constants: Mapping[str, float | NDArray] | None = None, turns: bool = False,
             rows: Sequence[NDArray] | None = None) -> list[Element]:
    """Elements of one equation, or of a vector of them.

    Parameters
    ----------
    places : tuple of Attachment
        Of the node.
    kind : callable
        The kind by the frame of a body.
    rows : sequence of (K, 2, 3) arrays, optional
        A direction along each piece.
    """
    equations: list[Element] = []
    for k, piece in enumerate(path.pieces):
        carrier = piece.carrier
        frame = "converged_mean" if isinstance(carrier, Node) else FRAMES[carrier.frame].kernel
        equations.append(Element(
            name, kind(frame), piece.attachments + places + (Attachment(hidden, "position"),),
            constants or {}, 0 if equations else multipliers,
            path=OnPath(path, k, way, turns, None if rows is None else rows[k]),
            shares=equations[0] if equations else None))
    return equations


def holding(model: Mechanism, what: str, name: str, a: Node, path: Path, way: DofBlock,
            hidden: Node, across: ArrayLike | None) -> list[Element]:
    """Elements that hold a node on a path: all around, or free in a direction across."""
    if across is None:
        return equation(name, positions(a), path, way, hidden,
                        lambda frame: path_kind(frame, model.planar), multipliers=model.dimension)
    pieces, directions = _held(model, what, a, path, float(way.start[0]), across)
    return [one for held in directions for one in equation(
        name, positions(a), path, way, hidden, path_across_kind,
        rows=[piece.rows(held) for piece in pieces])]


def _held(model: Mechanism, what: str, a: Node, path: Path, way: float, across: ArrayLike
          ) -> tuple[tuple[Sections, ...], tuple[NDArray, NDArray]]:
    """Sections, and in their triads the two directions in which a node is held.

    Raises
    ------
    InputError
        In a plane, or a direction that is none across the path.
    """
    if model.planar:
        raise InputError(f"{what}: across is of models in space; in a plane the path holds its "
                         "node in no other direction: leave it out")
    if isinstance(across, str) and across == "free":
        pieces = upright(path, VERTICAL)
        if pieces is None:
            raise InputError(f"{what}: across='free' is level, and path {path.name!r} goes along "
                             "the z axis somewhere: give the direction in which the node is free")
        return pieces, (np.eye(3)[0], np.eye(3)[1])
    given = direction(model, across, "freedom across a path", a)
    on, pieces = piece_at(path, way), sections(path)
    section = pieces[on].at(way - path.pieces[on].offset)
    tangent = section[:, 0] / np.linalg.norm(section[:, 0])
    normal = np.cross(tangent, given)
    if np.linalg.norm(normal) < STEEP:
        raise InputError(f"{what}: across is {across!r}, which is along path {path.name!r}: give "
                         "a direction across it")
    return pieces, (np.linalg.solve(section, tangent),
                    np.linalg.solve(section, normal / np.linalg.norm(normal)))
