"""Ropes of a spatial model in a plane of symmetry."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from sebody.model.mechanism import Mechanism
from sebody.model.parts import Element, Joint
from sebody.model.rope_parts import Rope, Sheave, Stretch
from sebody.model.variants.flattening import Flattening

ROPE_KINDS = "rope", "rope_line", "rope_end", "rope_span", "rope_grip"
NORMAL = np.array([0.0, 0.0, 1.0])


def rope_equation(flat: Flattening, joint: Joint, one: Element) -> Element:
    """An equation of a rope in the plane; what it shares with others is added by `sharing`.

    Raises
    ------
    InputError
        A sheave whose axis is not normal to the plane.
    """
    constants: dict[str, float | NDArray] = {}
    for name, value in one.constants.items():
        if name.startswith("e1_"):
            letter = name[-1]
            ray, across = one.vector(name), one.vector(f"e2_{letter}")
            flat.axial(np.cross(ray, across), f"the axis of a sheave of {joint.name!r}")
            constants[name] = flat.vector(ray, f"{joint.name!r}")
        elif not name.startswith("e2_"):
            constants[name] = value
    sides = {name: _side(flat, one, name[-1]) for name in constants if name.startswith("r_")}
    constants |= {name: one.number(name) * side for name, side in sides.items()}
    hidden = None if one.hidden is None else flat.dof_block(one.hidden)
    return Element(one.name, f"planar_{one.kind}", tuple(flat.place(p) for p in one.attachments),
                   constants, one.multipliers, one.time_function, hidden=hidden)


def flat_wheel(flat: Flattening, one: Element) -> tuple[str, dict]:
    """Kind and constants of the inertia of a sheave in the plane."""
    side = flat.axial(one.vector("n"), f"the axis of {one.name!r}")
    return "planar_rope_wheel", {"inertia": one.number("inertia"), "n": np.array([side])}


def _side(flat: Flattening, one: Element, letter: str) -> float:
    """The sign that a radius takes where its sheave is seen from the other side."""
    seen = letter if f"e1_{letter}" in one.constants else "a"
    normal = np.cross(one.vector(f"e1_{seen}"), one.vector(f"e2_{seen}"))
    return float(np.sign(flat.plane.normal @ normal))


def sharing(joint: Joint, equations: Sequence[Element]) -> list[Element]:
    """The equations of a rope in the plane, which share multipliers as those in space do."""
    made = dict(zip(joint.constraints, equations, strict=True))
    for old, new in made.items():
        new.shares = None if old.shares is None else made[old.shares]
    return list(equations)


def flat_ropes(flat: Flattening, model: Mechanism, made: Mechanism) -> None:
    """Add sheaves and ropes, whose equations are there already."""
    joints = {joint.name: joint for joint in made.joints}
    for sheave in model.sheaves.values():
        wheel = None if sheave.wheel is None else next(
            load for load in made.loads if load.name == sheave.wheel.name)
        made.sheaves[sheave.name] = Sheave(
            sheave.name, flat.node(sheave.node), sheave.radius,
            float(np.sign(flat.plane.normal @ sheave.axis)) * NORMAL, wheel, sheave.friction)
    for rope in model.ropes.values():
        old = next(joint for joint in model.joints if joint.name == rope.name)
        of = dict(zip(old.constraints, joints[rope.name].constraints, strict=True))
        places = [place._replace(
            node=flat.node(place.node), normal=NORMAL,
            radius=place.radius * float(np.sign(flat.plane.normal @ place.normal)),
            sheave=None if place.sheave is None else made.sheaves[place.sheave.name])
            for place in rope.places]
        stretches = tuple(Stretch(of[one.law], tuple(of[span] for span in one.spans))
                          for one in rope.stretches)
        rubbing = {load.name: load for load in made.loads}
        made.ropes[rope.name] = Rope(
            rope.name, tuple(places), stretches,
            None if rope.winch is None else flat.dof_block(rope.winch),
            tuple(rubbing[one.name] for one in rope.frictions))
