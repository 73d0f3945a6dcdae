"""Nodes that turn with a path: what is refused, and the elements."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.contract.names import path_turn_kind
from sebody.model.arguments import axes, dof_block
from sebody.model.mechanism import Mechanism
from sebody.model.parts import DofBlock, Element, Node, Path, Superelement, rotations
from sebody.model.path_equations import equation
from sebody.model.path_sections import sections
from sebody.model.path_tables import angle_at, piece_at, rotations_of

PAIRS = (0, 1), (1, 2), (2, 0)      # directions of the node and of the section


def check_turns(model: Mechanism, what: str, a: Node, path: Path, turns: object, axis: object
                ) -> None:
    """Refuse a node that cannot turn with a path, and arguments that have no meaning.

    Raises
    ------
    InputError
        A node without a rotation or on which a body of the path turns, FE nodes without rotations,
        an axis of a node that turns freely or in a plane.
    """
    if turns is None:
        if axis is not None:
            raise InputError(f"{what}: axis is of a node that turns with the path: leave it out, "
                             "or give turns='with'")
        return
    inputs.choice(turns, f"{what}: turns", ("with",))
    if axis is not None and model.planar:
        raise InputError(f"{what}: axis is of models in space; in a plane a node turns with the "
                         "path or freely: leave axis= out, or turns=")
    rotation = dof_block(a, "rotation")
    for piece in path.pieces:
        if any(one.dof_block is rotation for one in piece.attachments):
            raise InputError(f"{what}: turns='with', but the node turns as a node of "
                             f"{piece.carrier.name!r} does, which carries path {path.name!r}: "
                             "leave turns= out, or give a node of its own")
        if isinstance(piece.carrier, Superelement) and not rotations_of(piece).size:
            raise InputError(f"{what}: turns='with', but FE nodes of superelement "
                             f"{piece.carrier.name!r} have no rotations: leave turns= out, and put "
                             "the node on two wheels that are attached to it, with a path_joint "
                             "each")


def turning(model: Mechanism, name: str, a: Node, path: Path, way: DofBlock, hidden: Node,
            axis: ArrayLike | None) -> list[Element]:
    """Elements of a node that turns with a path, of one equation each."""
    def kind(frame: str) -> str:
        return path_turn_kind(frame, model.planar)

    at = float(way.start[0])
    on = piece_at(path, at)
    local = at - path.pieces[on].offset
    if model.planar:
        return equation(name, rotations(a), path, way, hidden, kind,
                        constants={"held": angle_at(path, on, local)}, turns=True)
    pieces, equations = sections(path), []
    section = pieces[on].at(local)
    for held, direction in _across(model, a, section, axis):
        rows = [one.rows(np.linalg.solve(section, direction)) for one in pieces]
        equations += equation(name, rotations(a), path, way, hidden, kind, rows=rows,
                              constants={"held": held}, turns=True)
    return equations


def _across(model: Mechanism, a: Node, section: NDArray, axis: ArrayLike | None
            ) -> list[tuple[NDArray, NDArray]]:
    """Directions of node and section that stay across each other, global axes at the start.

    Three pairs keep all directions, two keep an axis.
    """
    if axis is None:        # the triad between knots is that of a spline: nearly one
        u, _, vt = np.linalg.svd(section)
        triad = u @ vt
        return [(triad[:, one], triad[:, other]) for one, other in PAIRS]
    free, first, second = axes(model, axis, "path joint", a)
    return [(free, first), (free, second)]
