"""Couplings of joints without elasticity: gears, screws, racks and pinions, pulleys."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.model.arguments import chosen_name, known_joint
from sebody.model.frictions import turning
from sebody.model.gears import checked_ratio
from sebody.model.mechanism import Mechanism
from sebody.model.parts import SLIDES, TURNS, Attachment, Element, Joint, Way, rotations

COORDINATES = {"angle": TURNS, "displacement": SLIDES}     # as results name them
COUPLING = "couple"         # kind of these joints


def couple(model: Mechanism, first: Joint | str, second: Joint | str, ratio: float,
           name: str | None = None) -> Joint:
    """Couple two coordinates of joints by an equation: ``first = ratio x second``.

    Angles and ways are zero at the start, and have the signs of results. Angles count turns: in
    space from step to step, so in one step less than half a turn. `gear` has elastic teeth and
    backlash; this coupling has none. Its multiplier is the moment, or force, on the first
    coordinate.

    Parameters
    ----------
    first, second : Joint or str
        Revolute, prismatic or cylindrical joints or sliders; of a cylindrical joint the name of its
        coordinate, ``"joint.angle"`` or ``"joint.displacement"``.
    ratio : float
        Of the first coordinate to the second [rad, length]; negative where they run against each
        other.

    Raises
    ------
    InputError
        A joint without an angle or way, one coordinate twice, or a ratio of zero.

    Examples
    --------
    >>> model.couple("left wheel", "right wheel", -2.0)         # gears
    """
    one, other = (_coordinate(model, given) for given in (first, second))
    what = f"coupling of {one} and {other}"
    ratio = checked_ratio(what, ratio)
    return _coupled(model, what, one, other, ratio, name)


def screw(model: Mechanism, joint: Joint | str, pitch: float, name: str | None = None) -> Joint:
    """Make a screw of a cylindrical joint: ``displacement = pitch x angle / (2 pi)``.

    Parameters
    ----------
    joint : Joint or str
        A cylindrical joint.
    pitch : float
        Way of one turn [length]; negative of a left-handed thread.

    Raises
    ------
    InputError
        Another joint, or no pitch.
    """
    found = known_joint(model, joint, "screw")
    if found.kind != "cylindrical":
        raise InputError(f"screw: {found.name!r} is a {found.kind}: give a cylindrical joint")
    what = f"screw in {found.name!r}"
    lead = _not_zero(pitch, f"{what}: pitch", "the way of one turn") / (2.0 * np.pi)
    return _coupled(model, what, _Coordinate(found, "displacement"), _Coordinate(found, "angle"),
                    lead, name)


def rack(model: Mechanism, rack: Joint | str, pinion: Joint | str, radius: float,
         name: str | None = None) -> Joint:
    """Couple a rack, which slides, to a pinion, which turns: ``displacement = radius x angle``.

    Parameters
    ----------
    rack : Joint or str
        A prismatic or cylindrical joint or a slider.
    pinion : Joint or str
        A revolute or cylindrical joint.
    radius : float
        Pitch radius of the pinion [length]; negative where the rack runs against the angle.

    Raises
    ------
    InputError
        A rack that does not slide, a pinion that does not turn, or no radius.
    """
    found = []
    for given, coordinate, word in ((rack, "displacement", "rack"), (pinion, "angle", "pinion")):
        joint = known_joint(model, given, word)
        if joint.kind not in COORDINATES[coordinate]:
            raise InputError(f"{word}: {joint.name!r} is a {joint.kind}, which has no "
                             f"{coordinate}: give a joint that "
                             + ("slides" if word == "rack" else "turns"))
        found.append(_Coordinate(joint, coordinate))
    what = f"rack {found[0].joint.name!r} on pinion {found[1].joint.name!r}"
    radius = _not_zero(radius, f"{what}: radius", "that of the pinion")
    return _coupled(model, what, *found, radius, name)


class _Coordinate(NamedTuple):
    """An angle or a way of a joint."""

    joint: Joint
    name: str

    @property
    def turns(self) -> bool:
        """An angle."""
        return self.name == "angle"

    @property
    def attachments(self) -> tuple[Attachment, ...]:
        """Where an element that has this coordinate acts."""
        if self.turns:
            return rotations(self.joint.node, self.joint.to)
        return self.joint.way.attachments

    def constants(self, planar: bool, k: int) -> dict:
        """Constants of its kernel, as its k-th coordinate."""
        if not self.turns:
            way = self.joint.way
            return {f"e{k}": way.direction, f"start{k}": way.start}
        if planar:
            return {}
        across = turning(self.joint.own_axes)
        return {f"n{k}": across["n"], f"m{k}": across["m"]}

    def __str__(self) -> str:
        return f"{self.joint.name}.{self.name}"


def _coordinate(model: Mechanism, given: Joint | str) -> _Coordinate:
    """The coordinate of a joint, or the one that is named."""
    asked = None
    if isinstance(given, str) and not any(joint.name == given for joint in model.joints):
        owner, _, last = given.rpartition(".")
        if owner and last in COORDINATES:
            given, asked = owner, last
    joint = known_joint(model, given, "coupling")
    has = [name for name, kinds in COORDINATES.items() if joint.kind in kinds]
    if not has:
        raise InputError(f"coupling: {joint.name!r} is a {joint.kind}, which has no angle or way: "
                         f"give a {', '.join(dict.fromkeys(TURNS + SLIDES))} joint")
    if asked is None and len(has) > 1:
        raise InputError(f"coupling: {joint.name!r} turns and slides: give "
                         f"{f'{joint.name}.angle'!r} or {f'{joint.name}.displacement'!r}")
    if asked is not None and asked not in has:
        raise InputError(f"coupling: {joint.name!r} is a {joint.kind}, which has no {asked}: "
                         f"give {f'{joint.name}.{has[0]}'!r}")
    return _Coordinate(joint, asked or has[0])


def _coupled(model: Mechanism, what: str, first: _Coordinate, second: _Coordinate, ratio: float,
             name: str | None) -> Joint:
    """Add the equation ``first - ratio second = 0``; kernels have angles before ways."""
    if first == second:
        raise InputError(f"{what}: give two coordinates")
    pair = [(1.0, first), (-ratio, second)]
    pair.sort(key=lambda one: not one[1].turns)
    constants, places = {}, []
    for k, (factor, one) in enumerate(pair, 1):
        constants |= {f"f{k}": factor, **one.constants(model.planar, k)}
        places += one.attachments
    places.sort(key=lambda place: place.kind != "position")
    kind = model.kind_of(f"{COUPLING}_" + "_".join(
        "turn" if one.turns else "slide" for _, one in pair))
    name = chosen_name(model, name, what.replace("'", ""))
    equation = Element(name, kind, tuple(places), constants, 1)
    joint = first.joint
    made = Joint(name, (equation,), joint.node, joint.to, joint.own_axes, COUPLING)
    model.joints.append(made)
    return made


def _not_zero(value: float, what: str, meaning: str) -> float:
    value = inputs.number(value, what)
    if value == 0:
        raise InputError(f"{what} is 0: give {meaning}")
    return value
