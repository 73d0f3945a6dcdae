"""Paths along bodies, and along curves that are fixed on a node or the ground."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import accumulate

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.basics.spelling import unknown
from sebody.model.arguments import dof_block, known
from sebody.model.body_points import label_place
from sebody.model.frames import FRAMES
from sebody.model.impacts import impact_constants
from sebody.model.mechanism import Mechanism
from sebody.model.nodes import ground
from sebody.model.parts import Node, Path, PathPiece, Superelement
from sebody.model.path_tables import curve
from sebody.reduction.recovery import Recovery

ON_AXIS = 1e-6      # of the distance of two nodes: FE nodes so near to the line between are on it
EXPONENT = 1.5      # of stops at its ends
MEET = 1e-6         # of the length of a path: its pieces meet
ENDS = "refuse", "straight", "ground", "stop"


def path(model: Mechanism, name: str,
         on: str | Superelement | Node | Sequence[str | Superelement] | None = None,
         nodes: str | Sequence | None = None, points: ArrayLike | None = None, blend: float = 0.0,
         ends: str | tuple[str, str] = "refuse", stiffness: float | None = None,
         restitution: float = 0.5, at_speed: float = 1.0) -> Path:
    """A path along FE nodes of a body or of several ones, or a curve on a node or the ground.

    Between its nodes the path is a cubic spline of what the recovery of the body says of them, in
    second order where the body has geometric stiffening. Static modes of loads at some of its
    nodes (``paths=`` of `reduce` and `import_body`) make it accurate under slow loads; fast ones
    need vibrations that bend it.

    Parameters
    ----------
    name : str
    on : str, Superelement, Node, or sequence of superelements
        Superelements by name, in the order of the path, or a beam of `Model.beam`; or the node
        that carries a curve, by default the ground.
    nodes : str or sequence, optional
        Of a body: the name of a path that its reduction was given; two nodes of the model that it
        is on, whose connecting line is the path; or
        labels of FE nodes in order (numbers where they have no labels), two at least, which the
        recovery has. Of several bodies a sequence for each. By default the line between the two
        nodes of a body.
    points : (k, 3), planar (k, 2), optional
        Of a curve: points at the start, global axes [length].
    blend : float
        Of several bodies: length over which one hands over to the next, with two continuous
        derivatives [length]; 0 where bodies are welded, at hinges the length that a rail bridges.
    ends : {"refuse", "straight", "ground", "stop"} or two of these
        What comes before and behind the path: a run stops there, the path goes straight on with
        its body, or on the ground, as before and behind a bridge, or a buffer keeps points on the
        path. Ways before it are negative.
    stiffness, restitution, at_speed : float
        Of these buffers, see `Model.stop`: along each joint on the path.

    Returns
    -------
    Path
        With its `length` [length], the sum of the distances between its nodes at the start.

    Raises
    ------
    InputError
        A body without recovery or whose frame averages increments, FE nodes that are unknown or
        the same, pieces that do not meet, points that are no curve, or ends of another name.

    Examples
    --------
    >>> rail = model.path("rail", on="girder", nodes=("A", "B"))
    >>> cam = model.path("cam", on="wheel", points=curve)
    """
    what = f"path {inputs.name(name, 'name of the path')!r}"
    if name in model.paths:
        raise InputError(f"{what}: there is a path of this name already: give another one")
    both = _ends(what, ends)
    buffers = _buffers(what, both, stiffness, restitution, at_speed)
    carriers = _carriers(model, what, on)
    if carriers is None or isinstance(carriers, Node):
        if nodes is not None or points is None:
            raise InputError(f"{what} is on {_called(carriers)}: give its points=, and no nodes=, "
                             "which are FE nodes of a superelement")
        pieces = [_curve(model, what, carriers, points)]
    else:
        if points is not None:
            raise InputError(f"{what} is on a superelement: give nodes= of it, points= are those "
                             "of a curve on a node or the ground")
        pieces = _pieces(model, what, carriers, nodes)
    starts = [0.0, *accumulate(float(piece.ways[-1]) for piece in pieces)]
    made = Path(name, tuple(piece._replace(offset=start) for piece, start in zip(
        pieces, starts, strict=False)), inputs.number(blend, f"{what}: blend", least=0), both,
        starts[-1], buffers)
    _check_joined(what, made)
    made = _with_ground(model, what, made)
    model.paths[name] = made
    return made


def known_path(model: Mechanism, path: Path | str, what: str) -> Path:
    """A path of this model.

    Raises
    ------
    InputError
        None of this name, or one of another model.
    """
    if not isinstance(path, Path | str):
        raise inputs.refusal(f"{what}: path", path, "give a path of the model or its name")
    name = path.name if isinstance(path, Path) else path
    if name not in model.paths:
        raise unknown("path", name, model.paths, "the model has", "the model has no paths: make "
                      "one with model.path(...)")
    if isinstance(path, Path) and model.paths[name] is not path:
        raise InputError(f"{what}: path {name!r} is of another model: use that of this one")
    return model.paths[name]


def _ends(what: str, ends: object) -> tuple[str, str]:
    remedy = "give 'refuse', 'straight', 'ground' or 'stop', or two of these"
    both = (ends, ends) if isinstance(ends, str) else tuple(
        inputs.items(ends, f"{what}: ends", remedy))
    if len(both) != 2 or not all(isinstance(one, str) and one in ENDS for one in both):
        raise inputs.refusal(f"{what}: ends", ends, f"{remedy}: of the beginning and of the end")
    return both[0], both[1]


def _buffers(what: str, ends: tuple[str, str], stiffness: float | None, restitution: float,
             at_speed: float) -> dict[str, float | NDArray]:
    """Constants of the law of stops at the ends; none where there are no stops."""
    if "stop" in ends:
        return impact_constants(f"{what}: stop", restitution, at_speed, stiffness, EXPONENT)
    if stiffness is not None:
        raise InputError(f"{what} has no stop at its ends: leave stiffness= out, or give "
                         "ends='stop'")
    return {}


def _carriers(model: Mechanism, what: str, on: object) -> Node | list[Superelement] | None:
    """The node that carries a curve, none of the ground; or the bodies of a path."""
    if on is None:
        return None
    if isinstance(on, Node) or (isinstance(on, str) and on in model.nodes
                                and on not in model.bodies):
        node = known(model, on)
        for kind in ("position", "rotation"):
            dof_block(node, kind)
        return node
    if isinstance(on, str | Superelement):
        beam = next((one for one in model.beams if one.name == on and on not in model.bodies), None)
        on = [on] if beam is None else list(beam.parts)
    remedy = "give superelements in order, by name, a beam, or a node"
    bodies = [_body(model, what, one) for one in inputs.items(on, f"{what}: on", remedy)]
    if not bodies:
        raise inputs.refusal(f"{what}: on", on, remedy)
    for one in bodies:
        if bodies.count(one) > 1:
            raise InputError(f"{what}: superelement {one.name!r} is given twice: a path goes along "
                             "a body once")
    return bodies


def _body(model: Mechanism, what: str, one: object) -> Superelement:
    if not isinstance(one, str | Superelement):
        raise inputs.refusal(f"{what}: on", one, "give superelements or a node, by name")
    name = one if isinstance(one, str) else one.name
    if name not in model.bodies:
        if name in model.rigid_bodies:
            raise InputError(f"{what}: {name!r} is a rigid body: give the node that it is on, and "
                             "points=")
        raise unknown("superelement or node", name, [*model.bodies, *model.nodes], "the model has",
                      "the model has none")
    body = model.bodies[name]
    if isinstance(one, Superelement) and body is not one:
        raise InputError(f"{what}: superelement {name!r} is of another model: use that of this one")
    if body.reduced.recovery is None:
        raise InputError(f"{what}: superelement {name!r} has no recovery, so nothing is known of "
                         "its FE nodes: reduce it with recover=")
    if FRAMES[body.frame].traits.incremental:
        raise InputError(f"{what}: the frame {body.frame!r} of superelement {name!r} averages the "
                         "rotations of a step, so it does not follow the body exactly: give the "
                         "superelement another frame, such as 'converged_mean'")
    return body


def _called(node: Node | None) -> str:
    return "the ground" if node is None else f"node {node.name!r}"


def _curve(model: Mechanism, what: str, node: Node | None, points: ArrayLike) -> PathPiece:
    """A curve that a node carries, or a fixed one at its first point."""
    remedy = f"give two points or more, of {model.dimension} finite numbers each"
    given = np.array(inputs.reals(points, f"{what}: points", remedy), dtype=float)
    if given.ndim != 2 or given.shape[1] != model.dimension or len(given) < 2 or not np.isfinite(
            given).all():
        raise inputs.refusal(f"{what}: points", points, remedy)
    ways = _ways(what, given, [f"point {k}" for k in range(len(given))])
    if node is None:
        node = ground(model, Node(what, given[0], None, None))
    return PathPiece(node, (), given, ways, 0.0)


def _ways(what: str, points: NDArray, names: Sequence[str]) -> NDArray:
    """Lengths along chords between points."""
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    short = np.flatnonzero(~(steps > ON_AXIS * max(steps.sum(), 1e-300)))
    if len(short):
        k = int(short[0])
        raise InputError(f"{what}: {names[k]} and {names[k + 1]}, which follow each other, are at "
                         "the same place: leave one of them out")
    return np.concatenate([[0.0], np.cumsum(steps)])


def _pieces(model: Mechanism, what: str, bodies: list[Superelement], nodes: object
            ) -> list[PathPiece]:
    """Pieces on bodies, each in the direction of the path."""
    if len(bodies) == 1:
        return [_piece(model, what, bodies[0], nodes)]
    remedy = "give a sequence of nodes for each superelement, or leave it out"
    given = [None] * len(bodies) if nodes is None else list(inputs.items(
        nodes, f"{what}: nodes", remedy))
    if len(given) != len(bodies):
        raise InputError(f"{what} has {len(bodies)} superelements and nodes= {len(given)} "
                         f"sequences: {remedy}")
    pieces = [_piece(model, what, *one) for one in zip(bodies, given, strict=True)]
    if nodes is None:       # lines between nodes have no direction of their own
        pieces = _aligned(pieces)
    return pieces


def _aligned(pieces: list[PathPiece]) -> list[PathPiece]:
    """Pieces turned round where their other end is nearer to the piece before."""
    def apart(one: PathPiece, end: int, other: PathPiece, start: int) -> float:
        return float(np.linalg.norm(one.points[end] - other.points[start]))
    first, second = pieces[:2]
    if min(apart(first, 0, second, k) for k in (0, -1)) < min(
            apart(first, -1, second, k) for k in (0, -1)):
        pieces = [_turned(first), *pieces[1:]]
    for k in range(1, len(pieces)):
        if apart(pieces[k - 1], -1, pieces[k], -1) < apart(pieces[k - 1], -1, pieces[k], 0):
            pieces[k] = _turned(pieces[k])
    return pieces


def _turned(piece: PathPiece) -> PathPiece:
    return piece._replace(places=piece.places[::-1], points=piece.points[::-1],
                          ways=piece.ways[-1] - piece.ways[::-1])


def _piece(model: Mechanism, what: str, body: Superelement, nodes: object) -> PathPiece:
    """The piece of a path on a body."""
    recovery = body.reduced.recovery
    assert recovery is not None
    if isinstance(nodes, str):
        nodes = _named(what, body, recovery, nodes)
    first = body.reduced.position_nodes[0]
    points = body.nodes[first].point + recovery.points - body.reduced.coordinates[first]
    given = _two_nodes(model, what, body) if nodes is None else list(inputs.items(
        nodes, f"{what}: nodes", "give two nodes of the model, or labels of FE nodes in order"))
    if len(given) < 2:
        raise InputError(f"{what}: nodes= has {len(given)} of superelement {body.name!r}: give two "
                         "at least")
    if all(isinstance(one, str | Node) for one in given):
        places = _axis(model, what, body, points, given)
    else:
        places = [_labelled(what, body, recovery, one) for one in given]
    names = [f"FE node {recovery.called(place)} of {body.name!r}" for place in places]
    return PathPiece(body, tuple(places), points[places], _ways(what, points[places], names), 0.0)


def _named(what: str, body: Superelement, recovery: Recovery, name: str) -> list[int]:
    """Labels of the FE nodes of a path that the body has."""
    paths = body.reduced.paths
    if name not in paths:
        raise unknown(f"{what}: path of superelement {body.name!r},", name, paths, "the body has",
                      "the body has none: import it with --path, reduce it with paths=, or give "
                      "labels of FE nodes in order")
    return [recovery.called(recovery.place(int(node))) for node in paths[name]]


def _two_nodes(model: Mechanism, what: str, body: Superelement) -> list[Node]:
    ends = [body.nodes[k] for k in body.reduced.position_nodes]
    if len(ends) != 2:
        raise InputError(f"{what}: superelement {body.name!r} has {len(ends)} nodes with a "
                         "position: say which way the path goes by nodes=, two nodes or labels of "
                         "FE nodes in order")
    return ends


def _labelled(what: str, body: Superelement, recovery: Recovery, label: object) -> int:
    """Place of an FE node by its label."""
    number = inputs.integer(label, f"{what}: an FE node of superelement {body.name!r}")
    place = label_place(recovery, str(number))
    if place is None:
        raise InputError(f"{what}: superelement {body.name!r} has no FE node {number}, or its "
                         "recovery was not kept: reduce it with recover= that has all nodes of "
                         "the path")
    return place


def _axis(model: Mechanism, what: str, body: Superelement, points: NDArray,
          given: Sequence[str | Node]) -> list[int]:
    """FE nodes on the line between two nodes, in order."""
    ends = [known(model, one) for one in given]
    for end in ends:
        if end not in body.nodes:
            raise InputError(f"{what}: node {end.name!r} is no node of superelement "
                             f"{body.name!r}, which is on {', '.join(n.name for n in body.nodes)}")
    if len(ends) != 2 or ends[0] is ends[1]:
        raise InputError(f"{what}: nodes= are {', '.join(repr(end.name) for end in ends)}: give "
                         "two nodes of the model, between which the path is straight, or labels "
                         "of FE nodes in order")
    line = ends[1].point - ends[0].point
    length = float(np.linalg.norm(line))
    if not length > 0:
        raise InputError(f"{what}: nodes {ends[0].name!r} and {ends[1].name!r} are at the same "
                         "place: give labels of FE nodes in order")
    along = (points - ends[0].point) @ line / length
    off = np.linalg.norm(points - ends[0].point - np.outer(along, line / length), axis=1)
    near = ON_AXIS * length
    on_line = np.flatnonzero((off < near) & (along > -near) & (along < length + near))
    ordered = on_line[np.argsort(along[on_line], kind="stable")]
    kept = [int(k) for i, k in enumerate(ordered)
            if i == 0 or along[k] - along[ordered[i - 1]] > near]
    if len(kept) < 2 or along[kept[0]] > near or along[kept[-1]] < length - near:
        raise InputError(f"{what}: superelement {body.name!r} has no FE nodes on the line from "
                         f"{ends[0].name!r} to {ends[1].name!r}, or its recovery was not kept: "
                         "give labels of FE nodes in order")
    return kept


def _with_ground(model: Mechanism, what: str, path: Path) -> Path:
    """The path with straight pieces on the ground at its ends, as long as itself."""
    pieces = list(path.pieces)
    if path.ends[0] == "ground":
        of = curve(path, 0)
        begin = of(0.0)
        points = np.array([begin - path.length * _unit(of(0.0, 1)), begin])
        pieces.insert(0, _curve(model, what, None, points)._replace(offset=-path.length))
    if path.ends[1] == "ground":
        of, last = curve(path, len(path.pieces) - 1), float(path.pieces[-1].ways[-1])
        end = of(last)
        points = np.array([end, end + path.length * _unit(of(last, 1))])
        pieces.append(_curve(model, what, None, points)._replace(offset=path.length))
    return replace(path, pieces=tuple(pieces))


def _unit(vector: NDArray) -> NDArray:
    unit: NDArray = vector / np.linalg.norm(vector)
    return unit


def _check_joined(what: str, path: Path) -> None:
    """Refuse pieces that do not meet, and a blend that is longer than half of one."""
    for one, other in zip(path.pieces, path.pieces[1:], strict=False):
        gap = float(np.linalg.norm(one.points[-1] - other.points[0]))
        if gap > MEET * path.length:
            raise InputError(f"{what}: {other.carrier.name!r} begins {gap:.3g} away from the end "
                             f"of {one.carrier.name!r}: give pieces that meet")
    shortest = min(float(piece.ways[-1]) for piece in path.pieces)
    if path.blend > shortest / 2:
        raise InputError(f"{what}: blend is {path.blend:g}, and its shortest piece {shortest:g} "
                         "long: give half of this at most")
