"""The numbers of paths as kernels read them: rows of the recovery, splined in the way."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.model.body_points import followers_of, held_points
from sebody.model.parts import Node, Path, PathPiece, Superelement
from sebody.reduction.recovery import Recovery

if TYPE_CHECKING:
    from scipy.interpolate import CubicHermiteSpline

NO_EDGE = 1e300         # of the weight of the first and the last body, and of straight ends
MARGIN = 1e-6           # of the length: by which iterates may pass an end


class Rows(NamedTuple):
    """Values at the knots and slopes there, (K, 1 + N, D): of X, then of each coordinate."""

    values: NDArray
    slopes: NDArray
    followers: NDArray      # matrices Q_b, (m, n, n)


def path_numbers(path: Path, k: int, forces: bool = False, turns: bool = False) -> NDArray:
    """The row of constants of piece k of a path, see `sebody.kernels.paths`.

    Of `forces`: these act from end to end of a path alone, unless it goes on on the ground. Of
    what `turns` rows have the angle of the tangent, or in space the rotation of the section, in
    place of a point.
    """
    piece = path.pieces[k]
    rows = rows_of(piece) if not turns else angles_of(piece) if planar(path) else turns_of(piece)
    margin = 0.0 if forces else MARGIN * path.length
    held = ("refuse", "straight", "stop") if forces else ("refuse",)
    low = -margin if path.ends[0] in held else -NO_EDGE
    high = path.length + margin if path.ends[1] in held else NO_EDGE
    both = np.stack([rows.values, rows.slopes], axis=1)
    return np.concatenate([[len(piece.ways), len(rows.followers), piece.offset],
                           edges(path, k, path.blend), [low, high, 0.0 if turns else 1.0],
                           piece.ways, both.ravel(), rows.followers.ravel()])


def edges(path: Path, k: int, blend: float) -> list[float]:
    """Ways along piece k between which its weight rises and falls."""
    half, length = blend / 2, float(path.pieces[k].ways[-1])
    first = (-half, half) if k else (-NO_EDGE, -NO_EDGE)
    last = (length - half, length + half) if k < len(path.pieces) - 1 else (NO_EDGE, NO_EDGE)
    return [*first, *last]


def rows_of(piece: PathPiece) -> Rows:
    """Rows of a piece in axes of its body or node, twice differentiable in the way."""
    if isinstance(piece.carrier, Node):
        X = piece.points - piece.carrier.point
        n = piece.carrier_width
        shape = np.zeros((len(X), n, X.shape[1]))
        values = np.concatenate([X[:, None], shape], axis=1)
        return Rows(values, hermite_slopes(piece.ways, values), np.zeros((0, n, n)))
    body = piece.carrier
    recovery = recovery_of(body)
    places, n = list(piece.places), len(body.reduced.stiffness)
    followers = followers_of(body)
    z = np.eye(n + len(followers))
    Phi = recovery.displacement(z, places).transpose(1, 0, 2)
    X = recovery.points[places] - body.alpha @ held_points(body)
    values = np.concatenate([X[:, None], Phi], axis=1)
    turned = rotations_of(piece)
    along = hermite_slopes(piece.ways, X[:, None], None)[:, 0]
    return Rows(values, hermite_slopes(piece.ways, values, _ends(along, turned)), followers)


def angles_of(piece: PathPiece) -> Rows:
    """Rows of the angle of the tangent of a piece in a plane, to axes of its body or node.

    The first row is that of the path at the start, the others are rotations of the FE nodes.
    """
    along = rows_of(piece).slopes[:, 0]
    start = np.unwrap(np.arctan2(along[:, 1], along[:, 0]))[:, None, None]
    if isinstance(piece.carrier, Node):
        n = piece.carrier_width
        turned, followers = np.zeros((len(start), n, 1)), np.zeros((0, n, n))
    else:
        turned, followers = rotations_of(piece), followers_of(piece.carrier)
    values = np.concatenate([start, turned], axis=1)
    return Rows(values, hermite_slopes(piece.ways, values), followers)


def turns_of(piece: PathPiece) -> Rows:
    """Rows of the rotation of a section in space, in axes of its body: those of the FE nodes."""
    if isinstance(piece.carrier, Node):
        n = piece.carrier_width
        turned, followers = np.zeros((len(piece.ways), n, 3)), np.zeros((0, n, n))
    else:
        turned, followers = rotations_of(piece), followers_of(piece.carrier)
    values = np.concatenate([np.zeros((len(turned), 1, 3)), turned], axis=1)
    return Rows(values, hermite_slopes(piece.ways, values), followers)


def planar(path: Path) -> bool:
    """Tell whether a path is one in a plane."""
    return path.pieces[0].points.shape[1] == 2


def rotations_of(piece: PathPiece) -> NDArray:
    """Rotations of the FE nodes of a piece on a body, (K, N, 1 or 3); (K, N, 0) if they have none.
    """
    body = piece.carrier
    assert not isinstance(body, Node)
    z = np.eye(len(body.reduced.stiffness) + len(followers_of(body)))
    turned: NDArray = recovery_of(body).rotation(z, list(piece.places)).transpose(1, 0, 2)
    return turned


def recovery_of(body: Superelement) -> Recovery:
    """Its recovery, which bodies of paths have."""
    assert body.reduced.recovery is not None
    return body.reduced.recovery


def _ends(along: NDArray, turned: NDArray) -> NDArray | None:
    """Slopes of displacements at all knots by rotations of the FE nodes, (K, N, D); if they turn.
    """
    if turned.shape[2] == 0:
        return None
    if turned.shape[2] == 1:
        return turned * np.stack([-along[:, 1], along[:, 0]], axis=1)[:, None]
    return np.cross(turned, along[:, None])


def hermite_slopes(ways: NDArray, values: NDArray, turned: NDArray | None = None) -> NDArray:
    """Slopes at the knots of a cubic spline, (K, 1 + N, D).

    Its ends turn as FE nodes do, where these have rotations. Two knots have no more than these;
    without rotations they are a straight line.
    """
    from scipy.interpolate import CubicSpline  # of models with paths alone

    if len(ways) == 2 and turned is None:
        return np.repeat((np.diff(values, axis=0) / np.diff(ways)[:, None, None]), 2, axis=0)
    slopes = (np.repeat(np.diff(values, axis=0) / (ways[-1] - ways[0]), 2, axis=0)
              if len(ways) == 2 else CubicSpline(ways, values)(ways, 1))
    if turned is not None:
        slopes[:, 1:] = turned if len(ways) == 2 else CubicSpline(
            ways, values[:, 1:], bc_type=((1, turned[0]), (1, turned[-1])))(ways, 1)
    return slopes


def angle_at(path: Path, k: int, way: float) -> float:
    """Angle of the tangent of a piece at the start, by the way along it; straight on beyond ends.
    """
    from scipy.interpolate import CubicHermiteSpline

    piece, rows = path.pieces[k], angles_of(path.pieces[k])
    of = CubicHermiteSpline(piece.ways, rows.values[:, 0, 0], rows.slopes[:, 0, 0])
    return float(of(np.clip(way, 0.0, piece.ways[-1])))


def piece_at(path: Path, way: float) -> int:
    """Number of the piece of a path at a way; beyond its ends of the outer one."""
    return max(sum(way >= piece.offset for piece in path.pieces) - 1, 0)


def curve(path: Path, k: int) -> CubicHermiteSpline:
    """A piece of a path where it is at the start, in global axes, by the way along this piece."""
    from scipy.interpolate import CubicHermiteSpline

    piece, rows = path.pieces[k], rows_of(path.pieces[k])
    shift = piece.points[0] - rows.values[0, 0]
    return CubicHermiteSpline(piece.ways, rows.values[:, 0] + shift, rows.slopes[:, 0])
