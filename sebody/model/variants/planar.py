"""A planar model in the place of a spatial one that is symmetric about a plane."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.basics.errors import InputError
from sebody.contract.names import body_load_kind
from sebody.model.bodies import superelement
from sebody.model.frames import FRAMES
from sebody.model.mechanism import Mechanism
from sebody.model.parts import Connection, Element, Superelement
from sebody.model.plane import Plane
from sebody.model.spring_laws import unpacked
from sebody.model.switching import refuse_switches
from sebody.model.variants.copying import Variant, checked, load_name, unknowns
from sebody.model.variants.flat_beams import flat_beams
from sebody.model.variants.flat_bodies import flat_bodies
from sebody.model.variants.flat_contacts import flat_point_contact
from sebody.model.variants.flat_control import add_control
from sebody.model.variants.flat_elements import check_joints, flat_element, flat_joint
from sebody.model.variants.flat_ropes import flat_ropes
from sebody.model.variants.flattening import Flattening
from sebody.reduction.plane import PlanarBody
from sebody.reduction.summary import place

_SAME = 1e-9            # relative: directions and loads that differ by rounding
_ODD = 1e-6             # of a load on modes: what is out of the plane, see `reduction.plane`
_NORMAL = {"revolute", "planar"}    # joints whose axis is normal to the plane of motion


def planar(model: Mechanism) -> Variant:
    """The model in the plane in which its motion stays.

    It stays there where the reflection about the plane changes nothing: nodes and forces in the
    plane, joint axes and torques normal to it or, of sliding joints, in it, bodies whose matrices
    do not couple motion in the plane with motion out of it. Bodies keep the internal modes that
    move in the plane, those of one frequency turned where needed. Displacements and stresses inside
    are kept of bodies all of whose FE nodes are in the plane, and beams may be divided anew.

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
        A planar model, a joint without a planar form, a path, what is not symmetric about
        the plane (the first thing that was found), or no planar kernel for a body.
    """
    if checked(model).planar:
        raise InputError("the model is planar already")
    refuse_switches(model)
    if not model.nodes:
        raise InputError("the model has no nodes, so it has no plane")
    for path in model.paths:
        raise InputError(f"path {path!r} has no planar form: build the model with "
                         "Model(planar=True)")
    check_joints(model)
    refused: InputError | None = None
    for normal in _normals(model):
        plane = Plane.through(next(iter(model.nodes.values())).point, normal)
        try:
            flat_model = _Flat.of(model, Flattening(plane, model.size()))
        except InputError as error:
            refused = refused or InputError(
                f"the model is not symmetric about the plane through {place(plane.origin)} normal "
                f"to {place(plane.normal)}, so its motion leaves it: {error}")
        else:
            made = _built(model, flat_model)    # sensors of other quantities are refused here
            before, after = sum(unknowns(model)), sum(unknowns(made))
            return Variant(made, f"the model is planar, normal to {place(plane.normal)}: {after} "
                                 f"instead of {before} unknowns{_of_bushings(model)}")
    assert refused is not None      # there is at least one normal
    raise refused


def _of_bushings(model: Mechanism) -> str:
    """Bushings' terms that are not the same in the plane."""
    names = [one.name for one in model.loads
             if one.kind in ("bushing", "bearing") and np.any(one.constants["kt"])
             or one.kind == "table_bushing" and any(
                 unpacked(one.vector(f"forcet{k}")).behind.any() for k in (1, 2, 3))]
    return f"; moments of {', '.join(names)} follow angles, in space their sines" if names else ""


def _normals(model: Mechanism) -> Iterator[NDArray]:
    """Candidates for the normal of the plane: axes, then normals to all that is in the plane.

    Axes of drives come first and as they are: so angles count as their motions do.
    """
    driven = [joint.axis for joint in model.joints if any(
        c.kind == "turn_drive" for c in joint.constraints)]
    axial = [joint.axis for joint in model.joints if joint.kind in _NORMAL]
    axial += [sheave.axis for sheave in model.sheaves.values()]
    axial += [one.direction for one in model.loads if "torque" in one.kind]
    inside = [node.point - next(iter(model.nodes.values())).point for node in model.nodes.values()]
    inside += [model.gravity_field, *(one.direction for one in model.gravity_courses)]
    inside += [one.direction for one in model.loads if one.kind in ("force", "follower_force")]
    for dof_block in model.dof_blocks():
        if dof_block.start.size == 1:       # a length of a rope
            continue
        own = [dof_block.rate, *(motion.direction for motion in dof_block.motions)]
        (axial if dof_block.rotational else inside).extend(own)
    rows = [v / np.linalg.norm(v) for v in inside if np.any(v)]
    _, values, directions = np.linalg.svd(np.vstack([*rows, np.zeros((3, 3))]))
    around = np.eye(3) if values[1] <= _SAME * values[0] else ()     # all nodes are on a line
    normals: list[NDArray] = []
    for unit in (*driven, *map(_upright, (*axial, directions[2], *around))):
        if np.any(unit) and all(np.abs(np.cross(unit, one)).max() > _SAME for one in normals):
            normals.append(unit)
            yield unit


def _upright(vector: NDArray) -> NDArray:
    """Unit vector along a line, its largest component positive; zero as it is."""
    largest = vector[np.argmax(np.abs(vector))]
    return vector / np.copysign(np.linalg.norm(vector), largest) if largest else vector


class _Flat(NamedTuple):
    """Parts of a model that are symmetric about a plane."""

    flat: Flattening
    model: Mechanism                    # planar, without superelements and loads
    bodies: dict[str, PlanarBody]
    rates: dict[str, NDArray]           # of the modes
    loads: dict[Element, list[Element]]    # of each load but those on bodies

    @classmethod
    def of(cls, model: Mechanism, flat: Flattening) -> _Flat:
        """All of a model.

        Raises
        ------
        InputError
            What is not symmetric.
        """
        made = type(model)(planar=True, units=model.units)
        made.plane = flat.plane
        made.nodes = {name: flat.node(node) for name, node in model.nodes.items()}
        made.grounds = [flat.node(node) for node in model.grounds]
        made.gravity_field = flat.vector(model.gravity_field, "gravity")
        made.gravity_courses = [replace(one, direction=flat.vector(one.direction, one.name))
                                for one in model.gravity_courses]
        for dof_block in model.dof_blocks():
            flat.dof_block(dof_block).motions = [flat.motion(motion)
                                                 for motion in dof_block.motions]
        made.joints = [flat_joint(flat, joint) for joint in model.joints]
        made.rigid_bodies = {name: flat_element(flat, one)
                             for name, one in model.rigid_bodies.items()}
        joints = dict(zip(model.joints, made.joints, strict=True))
        made.connections = [
            Connection(one.kind, flat.node(one.node), one.to and flat.node(one.to),
                       one.joint and joints[one.joint], one.spare)
            for one in model.connections]
        on_nodes = {load: [flat_element(flat, load)] for load in model.loads
                    if load.mode is None and load.body is None and load.law is None
                    and load.point is None}
        for load in model.loads:
            # a kernel that reads multipliers has their numbers in its name
            made_of, joint = on_nodes.get(load, [None])[0], load.pressed_by
            if made_of is not None and joint is not None and (
                    load.reads is not None or made_of.kind[-1].isdecimal()):
                made_of.pressed_by, made_of.reads = joints[joint], load.reads
        bodies = flat_bodies(model, flat.plane.axes)
        rates = {name: _rates(body, bodies[name]) for name, body in model.bodies.items()}
        for load in model.loads:
            if load.mode is not None:
                on_nodes[load] = _mode_forces(load, bodies[load.mode[0]])
            elif load.body is not None and load_name(load) in bodies[load.body.name].odd_loads:
                raise InputError(f"{load.name!r} has a part out of the plane")
        return cls(flat, made, bodies, rates, on_nodes)


def _rates(old: Superelement, found: PlanarBody) -> NDArray:
    """Initial velocities of the planar modes."""
    rates = found.modes.T @ old.mode_rates
    bound = [dof_block.rate for dof_block in (*old.positions, *old.rotations)]
    odd = np.concatenate([0.0 * v for v in bound] + [old.mode_rates - found.modes @ rates])
    every = np.concatenate([*bound, old.mode_rates])
    if odd @ old.reduced.mass @ odd > _ODD**2 * (every @ old.reduced.mass @ every):
        raise InputError(f"superelement {old.name!r} has initial velocities of modes out of the "
                         "plane")
    return rates


def _mode_forces(load: Element, found: PlanarBody) -> list[Element]:
    """Forces on the planar modes that a spatial one is made of."""
    assert load.mode is not None
    name, mode = load.mode
    parts = found.modes[mode]
    if not np.isclose(parts @ parts, 1.0, atol=_ODD):
        raise InputError(f"{load.name!r} acts on mode {mode} of superelement {name!r}, which moves "
                         "out of the plane")
    own = np.flatnonzero(np.abs(parts) > _SAME)
    return [Element(load.name if len(own) == 1 else f"{load.name} ({k + 1})", "mode_force", (),
                    {"factor": load.constants["factor"] * parts[m]},
                    time_function=load.time_function,
                    mode=(name, int(m))) for k, m in enumerate(own)]


def _built(model: Mechanism, flat_model: _Flat) -> Mechanism:
    """The planar model, with superelements and all loads in their order."""
    made = flat_model.model
    for old in model.bodies.values():
        _add_body(made, old, flat_model)
    for load in model.loads:
        if load.law is not None:
            continue
        if load.point is not None:
            made.loads.append(flat_point_contact(flat_model.flat, load,
                                                 made.bodies[load.point.body.name]))
        elif load.body is None:
            made.loads += flat_model.loads[load]
        else:
            body = made.bodies[load.body.name]
            made.loads.append(Element(
                load.name, body_load_kind(FRAMES[body.frame].kernel, True), body.attachments,
                {"P": body.reduced.loads[load_name(load)]}, time_function=load.time_function,
                body=body))
    flat_ropes(flat_model.flat, model, made)
    add_control(model, made, flat_model.bodies)
    made.own_names, made.default_names = set(model.own_names), model.default_names.copy()
    made.beams = flat_beams(model, made, flat_model.flat)
    return made


def _add_body(made: Mechanism, old: Superelement, flat_model: _Flat) -> None:
    body = flat_model.bodies[old.name].body
    frame_node = (old.reduced.position_nodes[int(np.argmax(old.alpha))]
                  if FRAMES[old.frame].on_one_node else 0)
    stiffening = old.stiffening and body.invariants is not None and body.invariants.stiffens
    new = superelement(made, old.name, body, [flat_model.flat.node(node) for node in old.nodes],
                       frame=old.frame, inertia=old.inertia, frame_node=frame_node,
                       stiffening=stiffening)
    new.mode_rates = flat_model.rates[old.name]
