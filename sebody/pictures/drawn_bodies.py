"""Bodies of a picture: surfaces that move, with what they are coloured by."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from sebody.fem.stress import von_mises
from sebody.model.mechanism import Mechanism
from sebody.model.parts import Element, Node, Superelement
from sebody.pictures.surface import box, spatial, surface_of
from sebody.pictures.surface_parts import Surface
from sebody.reduction.recovery import Recovery
from sebody.results.motion import BodyMotion, body_motion
from sebody.results.references import Chord, Undeformed, Welded, undeformed
from sebody.results.result import Result

NEGLIGIBLE = 1e-5       # of the largest displacement by an amplitude: smaller ones are left out
ROUNDING = 1e-13        # of the model's extent: smaller ones are none
THINNEST = 0.004        # of the model's extent: half of a section, smaller ones are drawn larger
STRESSES = 1_000_000    # stresses of nodes in frames that are computed
SLENDER = 0.1           # width of a planar rigid body over its length


class HeldNode(NamedTuple):
    """A node of a body, and its motion in a flexible one: columns of amplitudes, -1 for none."""

    name: str
    point: NDArray                          # (3,) of the undeformed body, from its origin
    position: tuple[int, int, int] = (-1, -1, -1)   # displacement seen from the floating frame
    rotation: tuple[int, int, int] = (-1, -1, -1)   # rotation vector likewise
    full: bool = True                       # whether the body keeps its rotation


class DrawnBody(NamedTuple):
    """A body with a surface; rigid ones have no amplitudes."""

    name: str
    surface: Surface
    start: NDArray          # (3,) origin of the undeformed body at the start
    origin: NDArray         # (frames, 3)
    rotation: NDArray       # (frames, 4) quaternions, the real part last
    amplitudes: NDArray     # (frames, N)
    nodes: tuple[HeldNode, ...] = ()
    reference: tuple[str, ...] = ()     # node that displacements are measured from, two of a chord
    still: Undeformed | None = None     # the undeformed body there, in every frame
    stress: NDArray | None = None       # (some frames at even distances, stations), von Mises
    stride: int = 1                     # frames from one of these to the next
    labels: NDArray | None = None       # (stations,) of FE nodes, plus 1; 0 between two of them

    @property
    def rigid(self) -> bool:
        """Tell whether it has no FE nodes, and so no displacements of its own."""
        return self.labels is None


def vertices(body: DrawnBody, frame: int, scale: float = 1.0) -> NDArray:
    """Vertices of a body in a frame, (vertices, 3), deformed `scale` times as much as it is."""
    surface, amplitudes = body.surface, body.amplitudes[frame]
    moved = np.tensordot(amplitudes, surface.moves, 1)
    turned = Rotation.from_rotvec(np.tensordot(amplitudes, surface.turns, 1))
    base, still = surface.points, Rotation.identity()
    if body.still is not None:
        base = body.still.places(surface.points)[frame]
        still = Rotation.from_matrix(body.still.rotation[frame])
    places = base + scale * (surface.points + moved - base)
    local = surface.weights @ places
    if np.any(surface.offsets):
        relative = Rotation.from_rotvec(scale * (still.inv() * turned).as_rotvec())
        local = local + (still * relative[surface.weights.indices]).apply(surface.offsets)
    return body.origin[frame] + Rotation.from_quat(body.rotation[frame]).apply(local)


def flexible(result: Result, body: Superelement, states: NDArray, size: float, welded: Welded,
             reference: str | None = None) -> DrawnBody | None:
    """A superelement with cells; None for others, of which links are drawn."""
    recovery = body.reduced.recovery
    if recovery is None or not recovery.cells:
        return None
    motion = body_motion(result, body, states)
    amplitudes = body.reduced.with_followers(motion.y)
    surface = surface_of(recovery, amplitudes.shape[1])
    if surface is None:
        return None
    held = body.alpha @ body.reduced.coordinates[list(body.reduced.position_nodes)]
    half = np.linalg.norm(surface.offsets, axis=1).max()
    larger = max(1.0, THINNEST * size / half) if half > 0 else 1.0
    surface = surface._replace(points=surface.points - spatial(held),
                               offsets=larger * surface.offsets)
    reach = np.abs(surface.moves).max(axis=(1, 2)) * np.abs(amplitudes).max(axis=0)
    seen = reach > max(NEGLIGIBLE * reach.max(initial=0.0), ROUNDING * size)
    surface = surface._replace(moves=surface.moves[seen], turns=surface.turns[seen])
    node = welded.reference(body, reference)
    still = None if node is None else _still(result, body, motion, node, states)
    start = spatial(body.alpha @ [body.nodes[i].point for i in body.reduced.position_nodes])
    return DrawnBody(body.name, surface, start, spatial(motion.origin),
                     quaternions(motion.rotation), amplitudes[:, seen], _held(body, start, seen),
                     _names(node), still, labels=_labels(recovery, surface))


def quaternions(rotations: NDArray) -> NDArray:
    """Quaternions (n, 4), the real part last, of matrices (n, 3, 3) or (n, 2, 2), or of angles."""
    if rotations.ndim == 3 and rotations.shape[1] == 2:
        rotations = np.arctan2(rotations[:, 1, 0], rotations[:, 0, 0])
    if rotations.ndim == 1:
        return np.stack([np.zeros_like(rotations), np.zeros_like(rotations),
                         np.sin(rotations / 2), np.cos(rotations / 2)], axis=1)
    return Rotation.from_matrix(rotations).as_quat()


def with_stress(result: Result, body: DrawnBody, states: NDArray) -> DrawnBody:
    """The body with von Mises's stress at its stations, in fewer frames where it has many nodes."""
    if not result.model.bodies[body.name].reduced.recovery.stress:
        return body
    field = result.field(body.name)
    stresses = field.stresses(True)
    stride = max(1, -(-len(states) * field.count // STRESSES))
    chosen, surface = states[::stride], body.surface
    values = np.zeros((len(chosen), len(surface.points)))
    for first in range(0, len(chosen), stresses.states_at_once):
        some = slice(first, first + stresses.states_at_once)
        nodes = np.nan_to_num(von_mises(stresses.at_nodes(chosen[some])))
        one, other = nodes[:, surface.nodes[:, 0]], nodes[:, surface.nodes[:, 1]]
        values[some] = one + surface.shares * (other - one)
    return body._replace(stress=values, stride=stride)


def rigid(model: Mechanism, body: Element, position: NDArray, rotation: NDArray | None
          ) -> DrawnBody:
    """A box with the mass and inertia of a rigid body, about its centre of mass; in a plane a bar.

    Parameters
    ----------
    position, rotation : (frames, 3), (frames, 4)
        Of its node.
    """
    constants = body.constants
    mass, centre = constants["mass"], spatial(np.asarray(constants["mc"]) / constants["mass"])
    if model.planar:
        length = np.sqrt(12 * max(constants["J_zz"] / mass - centre @ centre, 0.0))
        sides = length * np.array([1.0, SLENDER, SLENDER])
        axes = _along(model, body.attachments[0].node, centre)
    else:
        J = np.array([[constants[f"J_{min(a, b)}{max(a, b)}"] for b in "xyz"] for a in "xyz"])
        J = J / mass - (centre @ centre * np.eye(3) - np.outer(centre, centre))
        moments, axes = np.linalg.eigh(J)
        sides = np.sqrt(np.maximum(6 * (moments.sum() - 2 * moments), 0.0))
    frames = len(position)
    rotation = rotation if rotation is not None else np.tile([0, 0, 0, 1.0], (frames, 1))
    node = body.attachments[0].node
    return DrawnBody(body.name, box(sides, centre, axes), spatial(node.point), position, rotation,
                     np.zeros((frames, 0)), (HeldNode(node.name, np.zeros(3)),))


def _held(body: Superelement, start: NDArray, kept: NDArray) -> tuple[HeldNode, ...]:
    """Nodes of a body, whose amplitudes are numbered as they are kept."""
    number = np.where(kept, np.cumsum(kept) - 1, -1).tolist()
    reduced = body.reduced
    D, size = (2, 1) if reduced.planar else (3, 3)
    firsts = {i: D * k for k, i in enumerate(reduced.position_nodes)}
    turns = {i: D * len(firsts) + size * k for k, i in enumerate(reduced.rotation_nodes)}
    nodes = []
    for i, first in firsts.items():
        position = [*number[first:first + D], -1][:3]
        turn = number[turns[i]:turns[i] + size] if i in turns else [-1] * size
        nodes.append(HeldNode(body.nodes[i].name, spatial(body.nodes[i].point) - start,
                              tuple(position), tuple([-1, -1, *turn][-3:]), i in turns))
    return tuple(nodes)


def _labels(recovery: Recovery, surface: Surface) -> NDArray:
    """Labels of stations, numbers of FE nodes where there are none, plus 1; 0 between nodes."""
    places = np.arange(len(recovery.coordinates)) if recovery.nodes is None else recovery.nodes
    names = (places if recovery.labels is None else np.asarray(recovery.labels)) + 1
    own = np.where(surface.shares == 1, surface.nodes[:, 1], surface.nodes[:, 0])
    return np.where(np.isin(surface.shares, (0, 1)), names[own], 0)


def _still(result: Result, body: Superelement, motion: BodyMotion, at: Node | Chord,
           states: NDArray) -> Undeformed:
    """The undeformed body at a node or on a chord in space, in a plane too."""
    drawn = undeformed(result, body, motion.rotation, motion.origin, at, states)
    if not result.model.planar:
        return drawn
    rotation = np.tile(np.eye(3), (len(states), 1, 1))
    rotation[:, :2, :2] = drawn.rotation
    return Undeformed(rotation, spatial(drawn.shift))


def _names(reference: Node | Chord | None) -> tuple[str, ...]:
    """Names of the nodes of a reference."""
    if reference is None:
        return ()
    nodes = reference if isinstance(reference, Chord) else (reference,)
    return tuple(node.name for node in nodes)


def _along(model: Mechanism, node: Node, centre: NDArray) -> NDArray:
    """Axes of a bar: from its centre to the farthest of the nodes it is linked to."""
    places = [spatial(c.node.point - node.point) - centre for c in model.connections
              if c.to is node and c.kind == "position"] + [-centre]
    way = max(places, key=np.linalg.norm)
    size = np.linalg.norm(way)
    c, s = way[:2] / size if size > 0 else (1.0, 0.0)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
