"""Shapes of bodies that bend a path: without any, slow motion along the path is wrong."""

import numpy as np
from numpy.typing import NDArray

from sebody.basics.tabular import counted
from sebody.model.gravity_fields import gravity_at
from sebody.model.mechanism import Mechanism
from sebody.model.parts import Node, Path, PathPiece
from sebody.model.path_tables import recovery_of

BENDS = 0.1         # of the largest displacement in a mode: what bends the path, at least
NOTHING = 1e-6      # of the largest of all modes: modes of torsion move no node of an axis
FEW = 2             # modes that bend a path, below which it is told
SHORT = 1 / 3       # of the path: clamped at its ends, a piece so long sags by (1/3)^3 / 4 = 1 %


def bending(piece: PathPiece, along: NDArray | None) -> int:
    """Internal modes of a body that bend its piece of a path.

    Parameters
    ----------
    along : (D,) or None
        Direction of the loads on the path, of which what is along the path does not count; none to
        take for each mode what is largest.
    """
    carrier = piece.carrier
    assert not isinstance(carrier, Node)
    recovery, n = recovery_of(carrier), len(carrier.reduced.stiffness)
    if not carrier.reduced.modes:
        return 0
    modes = np.eye(n)[n - carrier.reduced.modes:]
    # under the same energy, whatever their amplitudes are counted by
    modes /= np.sqrt(np.diag(carrier.reduced.stiffness)[n - carrier.reduced.modes:])[:, None]
    largest = np.linalg.norm(recovery.displacement(modes), axis=2).max(axis=1, initial=0.0)
    moved = recovery.displacement(modes, list(piece.places))
    line = np.column_stack([np.ones(len(piece.ways)), piece.ways / piece.ways[-1]])
    bent = moved - line @ (np.linalg.pinv(line) @ moved)     # a straight path is not bent
    tangents = np.gradient(piece.points, piece.ways, axis=0)
    tangents /= np.linalg.norm(tangents, axis=1, keepdims=True)
    if along is None:
        across = bent - np.sum(bent * tangents, axis=2, keepdims=True) * tangents
        sizes = np.linalg.norm(across, axis=2)
    else:
        normal = along - (tangents @ along)[:, None] * tangents
        sizes = np.abs(np.sum(bent * normal, axis=2))
    moves = largest > NOTHING * largest.max()
    return int(np.sum(moves & (sizes.max(axis=1, initial=0.0) > BENDS * largest)))


def cautions(model: Mechanism, path: Path) -> list[str]:
    """Cautions on the bodies of a path that joints or forces move along."""
    field = gravity_at(model, 0.0)
    gravity = np.linalg.norm(field)
    found = []
    for piece in path.pieces:
        carrier = piece.carrier
        if isinstance(carrier, Node) or len(piece.ways) < 3 or (
                piece.ways[-1] <= SHORT * path.length):
            continue
        down = field / gravity if gravity > 0.0 else None
        if down is not None and _is_along(piece, down):
            down = None
        if (count := bending(piece, down)) < FEW:
            of = counted(count, "internal mode") if count else "no internal mode"
            towards = "" if down is None else " in the direction of gravity"
            found.append(
                f"path {path.name!r}: {of} of {carrier.name!r} bends it{towards}, so what moves "
                "along it sags too little: reduce the body with paths=, which adds static modes, "
                "or with more modes")
    return found


def _is_along(piece: PathPiece, direction: NDArray) -> bool:
    """Tell whether a path goes in a direction, so that it is not bent by loads along this."""
    chord = piece.points[-1] - piece.points[0]
    length = np.linalg.norm(chord)
    return bool(length > 0.0 and abs(chord @ direction) > (1.0 - BENDS**2 / 2) * length)
