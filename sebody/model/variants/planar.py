"""A planar model in the place of a spatial one that is symmetric about a plane."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from sebody.errors import InputError
from sebody.kernels.names import body_load_kind
from sebody.model.bodies import superelement
from sebody.model.frames import FRAMES
from sebody.model.mechanism import Mechanism
from sebody.model.parts import Connection, Element, Superelement
from sebody.model.plane import Plane
from sebody.model.variants.copying import Variant, load_name, unknowns
from sebody.model.variants.flat_elements import flat_element, flat_joint
from sebody.model.variants.flattening import Flattening
from sebody.reduction.plane import PlanarBody, planar_body
from sebody.reduction.summary import place

_SAME = 1e-9            # relative: directions and loads that differ by rounding
_ODD = 1e-6             # of a load on modes: what is out of the plane, see `reduction.plane`
_NORMAL = {"revolute", "planar"}    # joints whose axis is normal to the plane of motion


def planar(model: Mechanism) -> Variant:
    """The model in the plane in which its motion stays.

    It stays there where the reflection about the plane changes nothing: nodes and forces in the
    plane, joint axes and torques normal to it or, of sliding joints, in it, bodies whose matrices
    do not couple motion in the plane with motion out of it. Bodies keep the internal modes that
    move in the plane, those of one frequency turned where needed. Their displacements inside, and
    how beams were built, are not kept: divide a beam before.

    Parameters
    ----------
    model : Model
        Spatial.

    Returns
    -------
    Variant
        Its model's `plane` says where the planar coordinates are in space; of a planar run,
        ``model.plane.to_space("tip.position", result["tip.position"])`` is what the spatial one
        has.

    Raises
    ------
    InputError
        A planar model, or what is not symmetric about the plane: the first thing that was found.
    """
    if model.planar:
        raise InputError("the model is planar already")
    if not model.nodes:
        raise InputError("the model has no nodes, so it is in no plane")
    first = None
    for normal in _normals(model):
        plane = Plane.through(next(iter(model.nodes.values())).point, normal)
        try:
            made = _flat(model, plane)
        except InputError as error:
            first = first or InputError(
                f"the model is not symmetric about the plane through {place(plane.origin)} normal "
                f"to {place(plane.normal)}, so its motion leaves it: {error}")
        else:
            before, after = unknowns(model), unknowns(made)
            return Variant(made, f"the model is planar, normal to {place(plane.normal)}: {after} "
                                 f"instead of {before} unknowns")
    raise first


def _normals(model: Mechanism) -> Iterator[NDArray]:
    """Candidates for the normal of the plane: axes, then normals to all that is in the plane.

    Axes of drives come first and as they are: so angles count as their motions do.
    """
    driven = [joint.axes.columns[:, 0] for joint in model.joints if any(
        c.kind == "turn_drive" for c in joint.constraints)]
    axial = [joint.axes.columns[:, 0] for joint in model.joints if joint.kind in _NORMAL]
    axial += [one.direction for one in model.loads if "torque" in one.kind]
    inside = [node.point - next(iter(model.nodes.values())).point for node in model.nodes.values()]
    inside += [model.gravity_field]
    inside += [one.direction for one in model.loads if one.kind in ("force", "follower_force")]
    for triplet in model.triplets():
        own = [triplet.rate, *(motion.direction for motion in triplet.motions)]
        (axial if triplet.rotational else inside).extend(own)
    rows = [v / np.linalg.norm(v) for v in inside if np.any(v)]
    _, values, directions = np.linalg.svd(np.vstack([*rows, np.zeros((3, 3))]))
    around = np.eye(3) if values[1] <= _SAME * values[0] else ()     # all nodes are on a line
    found: list[NDArray] = []
    for unit in (*driven, *map(_upright, (*axial, directions[2], *around))):
        if np.any(unit) and all(np.abs(np.cross(unit, one)).max() > _SAME for one in found):
            found.append(unit)
            yield unit


def _upright(vector: NDArray) -> NDArray:
    """Unit vector along a line, its largest component positive; zero as it is."""
    largest = vector[np.argmax(np.abs(vector))]
    return vector / np.copysign(np.linalg.norm(vector), largest) if largest else vector


def _flat(model: Mechanism, plane: Plane) -> Mechanism:
    """The planar model, if all of the model is symmetric about the plane."""
    made, flat = type(model)(planar=True), Flattening(plane, model.size())
    made.plane = plane
    made.nodes = {name: flat.node(node) for name, node in model.nodes.items()}
    made.grounds = [flat.node(node) for node in model.grounds]
    made.gravity_field = flat.vector(model.gravity_field, "gravity")
    for triplet in model.triplets():
        flat.triplet(triplet).motions = [flat.motion(motion) for motion in triplet.motions]
    made.joints = [flat_joint(flat, joint) for joint in model.joints]
    joints = dict(zip(map(id, model.joints), made.joints, strict=True))
    made.rigid_bodies = {name: flat_element(flat, one) for name, one in model.rigid_bodies.items()}
    for load in model.loads:
        if load.mode is None and load.body is None:
            made.loads.append(flat_element(flat, load))
    made.connections = [
        Connection(one.kind, flat.node(one.node), one.to and flat.node(one.to),
                   one.joint and joints[id(one.joint)], one.spare) for one in model.connections]
    bodies = {name: _body(made, flat, body) for name, body in model.bodies.items()}
    made.loads = _in_order(model, made, bodies)
    made.own_names, made.default_names = set(model.own_names), model.default_names.copy()
    return made


def _body(made: Mechanism, flat: Flattening, old: Superelement) -> PlanarBody:
    """Put a superelement into the planar model."""
    what = f"superelement {old.name!r}"
    found = planar_body(old.body, flat.plane.axes, what)
    rates = found.modes.T @ old.mode_rates
    bound = [triplet.rate for triplet in (*old.positions, *old.rotations)]
    odd = np.concatenate([0.0 * v for v in bound] + [old.mode_rates - found.modes @ rates])
    every = np.concatenate([*bound, old.mode_rates])
    if odd @ old.body.mass @ odd > _ODD**2 * (every @ old.body.mass @ every):
        raise InputError(f"{what} has initial velocities of modes out of the plane")
    frame_node = (old.body.position_nodes[int(np.argmax(old.alpha))]
                  if FRAMES[old.frame].on_one_node else 0)
    invariants = found.body.invariants
    stiffening = old.stiffening and invariants is not None and invariants.stiffens
    new = superelement(made, old.name, found.body, [flat.node(node) for node in old.nodes],
                       frame=old.frame, inertia=old.inertia, frame_node=frame_node,
                       stiffening=stiffening)
    new.mode_rates = rates
    return found


def _in_order(model: Mechanism, made: Mechanism, bodies: dict[str, PlanarBody]) -> list[Element]:
    """All loads in their order, those on bodies and modes, too."""
    on_nodes, found = iter(made.loads), []
    for load in model.loads:
        if load.body is not None:
            found.append(_body_load(load, made.bodies[load.body.name], bodies[load.body.name]))
        elif load.mode is not None:
            found += _mode_forces(load, bodies[load.mode[0]])
        else:
            found.append(next(on_nodes))
    return found


def _body_load(load: Element, new: Superelement, found: PlanarBody) -> Element:
    own = load_name(load)
    if own in found.odd_loads:
        raise InputError(f"{load.name!r} has a part out of the plane")
    return Element(load.name, body_load_kind(FRAMES[new.frame].kernel, True), new.places,
                   {"P": new.body.loads[own]}, history=load.history, body=new)


def _mode_forces(load: Element, found: PlanarBody) -> list[Element]:
    """Forces on the planar modes that a spatial one is made of."""
    name, mode = load.mode
    parts = found.modes[mode]
    if not np.isclose(parts @ parts, 1.0, atol=_ODD):
        raise InputError(f"{load.name!r} acts on mode {mode} of superelement {name!r}, which moves "
                         "out of the plane")
    own = np.flatnonzero(np.abs(parts) > _SAME)
    return [Element(load.name if len(own) == 1 else f"{load.name} ({k + 1})", "mode_force", (),
                    {"factor": load.constants["factor"] * parts[m]}, history=load.history,
                    mode=(name, int(m))) for k, m in enumerate(own)]
