"""Contents of a picture of a moving model: bodies, nodes, joints, contact surfaces and loads."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.basics.errors import InputError
from sebody.basics.units import Units
from sebody.model.gravity_fields import gravity_at
from sebody.model.mechanism import Mechanism
from sebody.model.shafts import is_unbalance
from sebody.pictures.arrows import Arrow, arrows
from sebody.pictures.contact_surfaces import ContactSurface, contact_surfaces, vertices_of
from sebody.pictures.drawn_bodies import DrawnBody, flexible, rigid, with_stress
from sebody.pictures.drawn_nodes import DrawnNode, drawn_nodes, extent
from sebody.pictures.glyphs import Link, Sign, links, signs
from sebody.pictures.palette import BODIES
from sebody.pictures.rope_lines import DrawnRope, drawn_ropes
from sebody.pictures.surface import spatial
from sebody.results.references import Welded
from sebody.results.result import Result

LOOKED_AT = 25, 200     # frames and stations of a body that what is seen is measured by
FLAT = 0.03             # share of the largest extent below which a motion is in a plane


class Entry(NamedTuple):
    """An entry in the list of bodies: a body, or all parts of a beam."""

    name: str
    rigid: bool
    colour: str
    bodies: list[int]       # of `Scenery.bodies`
    links: list[int]        # of `Scenery.links`


class Scenery(NamedTuple):
    """All that is drawn of a model, in F frames."""

    t: NDArray              # (F,)
    states: NDArray         # (F,) numbers of the recorded states
    bodies: list[DrawnBody]
    entries: list[Entry]
    nodes: dict[str, DrawnNode]
    links: list[Link]
    signs: list[Sign]
    contacts: list[ContactSurface]
    ropes: list[DrawnRope]
    arrows: list[Arrow]
    gravity: NDArray        # (3,)
    planar: bool
    up: NDArray             # (3,) up on the screen
    towards: NDArray        # (3,) from the middle to the eye
    floor: NDArray          # (3,) normal of the grid
    units: Units | None     # of the model

    @property
    def farthest(self) -> str:
        """The node that moves farthest; the first one if none does."""
        return max(self.nodes, key=lambda name: np.linalg.norm(
            np.ptp(self.nodes[name].position, axis=0)))


def scenery(result: Result, most: int, stressed: bool = False, reference: str | None = None
            ) -> Scenery:
    """The scenery of a result in at most so many of its recorded states, stresses if wanted.

    Parameters
    ----------
    reference : str, optional
        Node that displacements of its body, and of those welded to it, are measured from, or
        ``"frame"``, all from their floating frames; see `Welded.reference`.

    Raises
    ------
    InputError
        Fewer than two recorded states, no node that has a position, or a reference of no body.
    """
    if len(result.rows) < 2:
        raise InputError(f"the result holds {len(result.rows)} recorded state"
                         f"{'s' * (len(result.rows) != 1)}, too few for an animation: run the "
                         "model to a later time")
    states = thinned(len(result.rows), most)
    model, nodes = result.model, drawn_nodes(result, states)
    if not nodes:
        raise InputError("no node of the model has a position: there is nothing to animate")
    bodies = _bodies(result, states, extent(nodes), reference)
    if stressed:
        bodies = [with_stress(result, body, states) for body in bodies]
    bodies += [rigid(model, part, *nodes[part.attachments[0].node.name][1:])
               for part in model.rigid_bodies.values()
               if part.kind.endswith("rigid_body") and not is_unbalance(part)]
    drawn = {body.name for body in bodies}
    lines = links(model, set(nodes), drawn)
    return Scenery(result.t[states], states, bodies, _entries(model, bodies, lines), nodes, lines,
                   signs(model, set(nodes)), contact_surfaces(model, nodes, extent(nodes)),
                   drawn_ropes(result, states, nodes),
                   arrows(result, states, set(nodes), drawn),
                   spatial(gravity_at(model, 0.0)), model.planar,
                   *_view(model, nodes), result.units)


def thinned(count: int, most: int) -> NDArray:
    """Numbers of at most so many of the recorded states at even distances, the last included."""
    stride = -(-(count - 1) // max(most - 1, 1))
    return np.unique([*range(0, count, stride), count - 1])


def seen_places(drawn: Scenery) -> NDArray:
    """Places (n, 3) of what moves: nodes, and bodies and balls in some frames."""
    points = [node.position for node in drawn.nodes.values()]
    frames = np.unique(np.linspace(0, len(drawn.t) - 1, LOOKED_AT[0]).astype(int))
    points += [_stations(body, frames) for body in drawn.bodies]
    points += [vertices_of(one, drawn.nodes, k) for one in drawn.contacts
               if one.kind in ("ball", "gear") for k in frames]
    return np.concatenate(points)


def _stations(body: DrawnBody, frames: NDArray) -> NDArray:
    """Places of some points of a body without its deformation."""
    from scipy.spatial.transform import Rotation

    points = body.surface.points[::-(-len(body.surface.points) // LOOKED_AT[1])]
    turned = Rotation.from_quat(body.rotation[frames]).as_matrix() @ points.T
    return (body.origin[frames][:, None] + turned.transpose(0, 2, 1)).reshape(-1, 3)


def _bodies(result: Result, states: NDArray, size: float, reference: str | None
            ) -> list[DrawnBody]:
    """Flexible bodies with a surface, measured from the reference where they have it."""
    model, welded = result.model, Welded(result.model)
    measured = {body.name for body in model.bodies.values()
                if reference is not None and welded.has(body, reference)}
    if reference is not None and not measured:
        known = {node.name for body in model.bodies.values() for node in welded.candidates(body)}
        raise InputError(f"displacements cannot be measured from {reference!r}: give a node of a "
                         f"flexible body, "
                         f"{', '.join(sorted(known)) or 'of which there are none'}, or "
                         "'frame', the floating frame of each body")
    found = (flexible(result, body, states, size, welded,
                      reference if body.name in measured else None)
             for body in model.bodies.values())
    return [body for body in found if body is not None]


def _entries(model: Mechanism, bodies: list[DrawnBody], lines: list[Link]) -> list[Entry]:
    owner = {part.name: beam.name for beam in model.beams for part in beam.parts}
    entries: dict[str, Entry] = {}
    for kind, names in (("bodies", [body.name for body in bodies]),
                        ("links", [link.body for link in lines])):
        for k, part in enumerate(names):
            if part:
                name = owner.get(part, part)
                colour = BODIES[len(entries) % len(BODIES)]
                entry = entries.setdefault(name, Entry(name, name in model.rigid_bodies, colour,
                                                       [], []))
                getattr(entry, kind).append(k)
    return list(entries.values())


def _view(model: Mechanism, nodes: dict[str, DrawnNode]) -> tuple[NDArray, NDArray, NDArray]:
    """Up on the screen, where to look from, and the grid's normal: that of motions in a plane."""
    gravity = spatial(gravity_at(model, 0.0))
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
