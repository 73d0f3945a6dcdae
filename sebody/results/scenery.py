"""What a picture of a moving model shows: bodies, nodes, links and signs of joints, with poses."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.errors import InputError
from sebody.fem.stress import von_mises
from sebody.model.mechanism import Mechanism
from sebody.model.parts import Element, Node, Superelement
from sebody.results.motion import body_motion
from sebody.results.result import Result
from sebody.results.signs import Link, Sign, links, signs
from sebody.results.surface import Surface, box, surface_of

NEGLIGIBLE = 1e-7       # of the model's extent: smaller displacements by an amplitude are left out
THINNEST = 0.004        # of the model's extent: half of a section, smaller ones are drawn larger
STRESSES = 1_000_000    # stresses of nodes in frames that are computed
FLAT = 0.03             # share of the largest extent below which a motion is in a plane
SLENDER = 0.1           # width of a planar rigid body over its length


class DrawnBody(NamedTuple):
    """A body with a surface; rigid ones have no amplitudes."""

    name: str
    surface: Surface
    origin: NDArray         # (frames, 3)
    rotation: NDArray       # (frames, 4) quaternions, the real part last
    amplitudes: NDArray     # (frames, N)
    stress: NDArray | None = None   # (some frames at even distances, stations), von Mises


class DrawnNode(NamedTuple):
    """A node with a position."""

    name: str
    position: NDArray       # (frames, 3)
    rotation: NDArray | None        # (frames, 4)


class Scenery(NamedTuple):
    """All that is drawn of a model, in F frames."""

    t: NDArray              # (F,)
    states: NDArray         # (F,) numbers of the recorded states
    bodies: list[DrawnBody]
    nodes: dict[str, DrawnNode]
    links: list[Link]
    signs: list[Sign]
    up: NDArray             # (3,) up on the screen
    towards: NDArray        # (3,) from the middle to the eye
    floor: NDArray          # (3,) normal of the grid

    @property
    def farthest(self) -> str:
        """The node that moves farthest; the first one if none does."""
        return max(self.nodes, key=lambda name: np.linalg.norm(
            np.ptp(self.nodes[name].position, axis=0)))


def scenery(result: Result, most: int, stressed: bool = False) -> Scenery:
    """The scenery of a result in at most so many of its recorded states, stresses if wanted.

    Raises
    ------
    InputError
        Fewer than two recorded states, or no node that has a position.
    """
    if len(result.rows) < 2:
        raise InputError(f"the result holds {len(result.rows)} recorded state"
                         f"{'s' * (len(result.rows) != 1)}, which make no animation: run the "
                         "model to a later time")
    states = thinned(len(result.rows), most)
    model = result.model
    nodes = {node.name: drawn for node in (*model.nodes.values(), *model.grounds)
             if (drawn := _node(result, node, states)) is not None}
    if not nodes:
        raise InputError("no node of the model has a position: there is nothing to animate")
    size = extent(nodes)
    bodies = [body for part in model.bodies.values()
              if (body := _flexible(result, part, states, size)) is not None]
    if stressed:
        bodies = [body._replace(stress=_stress(result, body, states)) for body in bodies]
    bodies += [_rigid(model, part, nodes) for part in model.rigid_bodies.values()
               if part.kind.endswith("rigid_body")]
    return Scenery(result.t[states], states, bodies, nodes,
                   links(model, set(nodes), {body.name for body in bodies}),
                   signs(model, set(nodes)), *_view(model, nodes))


def vertices(body: DrawnBody, frame: int, scale: float = 1.0) -> NDArray:
    """Vertices of a body in a frame, (vertices, 3), deformed `scale` times as much as it is."""
    surface, amplitudes = body.surface, scale * body.amplitudes[frame]
    points = surface.points + np.tensordot(amplitudes, surface.moves, 1)
    turns = np.tensordot(amplitudes, surface.turns, 1)[surface.stations]
    from scipy.spatial.transform import Rotation

    local = points[surface.stations] + Rotation.from_rotvec(turns).apply(surface.offsets)
    return body.origin[frame] + Rotation.from_quat(body.rotation[frame]).apply(local)


def thinned(count: int, most: int) -> NDArray:
    """Numbers of at most so many of the recorded states at even distances, the last included."""
    stride = -(-(count - 1) // max(most - 1, 1))
    return np.unique([*range(0, count, stride), count - 1])


def extent(nodes: dict[str, DrawnNode]) -> float:
    """Largest extent of the nodes in any frame; of a single one, of its path."""
    places = np.stack([node.position for node in nodes.values()], axis=1)
    size = np.linalg.norm(np.ptp(places, axis=1), axis=1).max()
    path = np.linalg.norm(np.ptp(places.reshape(-1, 3), axis=0))
    return float(size if size > 0 else path if path > 0 else 1.0)


def _node(result: Result, node: Node, states: NDArray) -> DrawnNode | None:
    if node.position is None:
        return None
    if node.name not in result.model.nodes:         # of the ground
        return DrawnNode(node.name, np.tile(_spatial(node.point), (len(states), 1)), None)
    known = result.numbering.triplets
    if id(node.position) not in known:
        return None
    rotated = node.rotation is not None and id(node.rotation) in known
    return DrawnNode(node.name, _spatial(result[f"{node.name}.position"][states]),
                     quaternions(result[f"{node.name}.rotation"][states]) if rotated else None)


def quaternions(rotations: NDArray) -> NDArray:
    """Quaternions (n, 4), the real part last, of matrices (n, 3, 3) or (n, 2, 2), or of angles."""
    from scipy.spatial.transform import Rotation

    if rotations.ndim == 3 and rotations.shape[1] == 2:
        rotations = np.arctan2(rotations[:, 1, 0], rotations[:, 0, 0])
    if rotations.ndim == 1:
        return np.stack([np.zeros_like(rotations), np.zeros_like(rotations),
                         np.sin(rotations / 2), np.cos(rotations / 2)], axis=1)
    return Rotation.from_matrix(rotations).as_quat()


def _flexible(result: Result, body: Superelement, states: NDArray, size: float
              ) -> DrawnBody | None:
    """A superelement with cells; None for others, of which links are drawn."""
    recovery = body.body.recovery
    if recovery is None or not recovery.cells:
        return None
    motion = body_motion(result, body, states)
    amplitudes = body.body.with_followers(motion.y)
    surface = surface_of(recovery, amplitudes.shape[1])
    if surface is None:
        return None
    held = body.alpha @ body.body.coordinates[list(body.body.position_nodes)]
    half = np.linalg.norm(surface.offsets, axis=1).max()
    larger = max(1.0, THINNEST * size / half) if half > 0 else 1.0
    surface = surface._replace(points=surface.points - _spatial(held),
                               offsets=larger * surface.offsets)
    reach = np.abs(surface.moves).max(axis=(1, 2)) * np.abs(amplitudes).max(axis=0)
    kept = reach > NEGLIGIBLE * size
    surface = surface._replace(moves=surface.moves[kept], turns=surface.turns[kept])
    return DrawnBody(body.name, surface, _spatial(motion.origin), quaternions(motion.rotation),
                     amplitudes[:, kept])


def _stress(result: Result, body: DrawnBody, states: NDArray) -> NDArray | None:
    """Von Mises's stress at the stations, of fewer frames where there are many nodes."""
    if not result.model.bodies[body.name].body.recovery.stress:
        return None
    field = result.field(body.name)
    stresses = field.stresses(True)
    stride = max(1, -(-len(states) * field.count // STRESSES))
    chosen, surface = states[::stride], body.surface
    found = np.zeros((len(chosen), len(surface.points)))
    for first in range(0, len(chosen), stresses.states_at_once):
        some = slice(first, first + stresses.states_at_once)
        nodes = np.nan_to_num(von_mises(stresses.at_nodes(chosen[some])))
        one, other = nodes[:, surface.nodes[:, 0]], nodes[:, surface.nodes[:, 1]]
        found[some] = one + surface.shares * (other - one)
    return found


def _rigid(model: Mechanism, body: Element, nodes: dict[str, DrawnNode]) -> DrawnBody:
    """A box with the mass and inertia of a rigid body, about its centre of mass; in a plane a bar.
    """
    constants = body.constants
    node = nodes[body.places[0].node.name]
    mass, centre = constants["mass"], _spatial(np.asarray(constants["mc"]) / constants["mass"])
    if model.planar:
        length = np.sqrt(12 * max(constants["J_zz"] / mass - centre @ centre, 0.0))
        sides = length * np.array([1.0, SLENDER, SLENDER])
        axes = _along(model, body.places[0].node, centre)
    else:
        J = np.array([[constants[f"J_{min(a, b)}{max(a, b)}"] for b in "xyz"] for a in "xyz"])
        J = J / mass - (centre @ centre * np.eye(3) - np.outer(centre, centre))
        moments, axes = np.linalg.eigh(J)
        sides = np.sqrt(np.maximum(6 * (moments.sum() - 2 * moments), 0.0))
    frames = len(node.position)
    rotation = node.rotation if node.rotation is not None else np.tile([0, 0, 0, 1.0], (frames, 1))
    return DrawnBody(body.name, box(sides, centre, axes), node.position, rotation,
                     np.zeros((frames, 0)))


def _along(model: Mechanism, node: Node, centre: NDArray) -> NDArray:
    """Axes of a bar: from its centre to the farthest of the nodes it is linked to."""
    places = [_spatial(c.node.point - node.point) - centre for c in model.connections
              if c.to is node and c.kind == "position"] + [-centre]
    way = max(places, key=np.linalg.norm)
    size = np.linalg.norm(way)
    c, s = way[:2] / size if size > 0 else (1.0, 0.0)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def _view(model: Mechanism, nodes: dict[str, DrawnNode]) -> tuple[NDArray, NDArray, NDArray]:
    """Up on the screen, where to look from, and the grid's normal: that of motions in a plane."""
    gravity = _spatial(np.asarray(model.gravity_field))
    weight = np.linalg.norm(gravity)
    if model.planar:
        return np.eye(3)[1], np.eye(3)[2], np.eye(3)[2]
    places = np.concatenate([node.position for node in nodes.values()])
    extents = np.ptp(places, axis=0)
    normal = int(np.argmin(extents))
    if extents[normal] <= FLAT * extents.max():
        side = np.eye(3)[normal] * (-1.0 if normal == 1 else 1.0)
        up = -gravity / weight if weight > 0 else np.eye(3)[1 if normal == 2 else 2]
        if abs(up @ side) < 0.5:
            return (up, side + 0.45 * np.cross(up, side) + 0.35 * up,
                    up if weight > 0 else side)
    up = -gravity / weight if weight > 0 else np.eye(3)[2]
    across = np.cross(up, np.eye(3)[np.argmin(np.abs(up))])
    across /= np.linalg.norm(across)
    return up, across + 0.6 * np.cross(up, across) + 0.55 * up, up


def _spatial(vectors: NDArray) -> NDArray:
    """Vectors with z = 0 where they are of a plane."""
    if vectors.shape[-1] == 3:
        return vectors
    return np.concatenate([vectors, np.zeros((*vectors.shape[:-1], 1))], axis=-1)
