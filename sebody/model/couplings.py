"""Couplings of joints without elasticity: gears, screws, racks and pinions, pulleys."""

from __future__ import annotations

from typing import NamedTuple, Unpack

import numpy as np

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.model.acting import Acting
from sebody.model.arguments import chosen_name, known_joint
from sebody.model.frictions import turning
from sebody.model.mechanism import Mechanism
from sebody.model.parts import (
    COUPLING,
    SLIDES,
    TURNS,
    Attachment,
    Element,
    Joint,
    rotations,
)

COORDINATES = {"angle": TURNS, "displacement": SLIDES}     # as results name them


def couple(model: Mechanism, first: Joint | str, second: Joint | str, ratio: float,
           name: str | None = None, **acting: Unpack[Acting]) -> Joint:
    """Couple the angles or displacements of two joints: ``first = ratio x second``.

    An equation holds the ratio exactly; `gear` has elastic teeth and play. Angles and displacements
    are those of results, 0 at the start. Angles count turns, in space from step to step: of less
    than half a turn in one step.

    The coupling is that of its first coordinate to the second: of this one it has the axis, the
    nodes, and with ``<name>.torque`` or ``<name>.thrust`` what the coupling does to it. A
    displacement comes before an angle, so that the `ratio` is then turned over.

    Parameters
    ----------
    first, second : Joint or str
        Revolute, prismatic or cylindrical joints or sliders; of a cylindrical joint the name of its
        coordinate, ``"joint.angle"`` or ``"joint.displacement"``.
    ratio : float
        Of the first coordinate to the second [rad, length]; negative where they run against each
        other. ``<name>.ratio`` is a parameter of ensembles and gradients.
    name : str, optional
        By default ``coupling of <first> and <second>``.
    **acting
        `until`, `from_`, `breaks_at`, `release_when`: see `sebody.model.acting.Acting`. A coupling
        that locks counts both coordinates from there.

    Returns
    -------
    Joint

    Raises
    ------
    InputError
        A joint without an angle or displacement, one coordinate twice, or a ratio of zero.

    Examples
    --------
    >>> model.couple("left wheel", "right wheel", -2.0, name="gears")
    """
    one, other = (_coordinate(model, given) for given in (first, second))
    what = f"coupling of {one} and {other}"
    ratio = _not_zero(ratio, f"{what}: ratio", "the first coordinate for one of the second")
    if one.turns and not other.turns:
        one, other, ratio = other, one, 1.0 / ratio
    return _coupled(model, what, one, other, ratio, name)


def screw(model: Mechanism, joint: Joint | str, pitch: float, name: str | None = None,
          **acting: Unpack[Acting]) -> Joint:
    """Make a screw of a cylindrical joint: ``displacement = pitch x angle / (2 pi)``.

    A coupling without elasticity and friction, see `couple`; dry friction in the thread is
    `friction` in the joint.

    Parameters
    ----------
    joint : Joint or str
        A cylindrical joint.
    pitch : float
        Way of one turn [length]; negative of a left-handed thread.
    name : str, optional
        By default ``screw in <joint>``.
    **acting
        `until`, `from_`, `breaks_at`, `release_when`: see `sebody.model.acting.Acting`. A coupling
        that locks counts both coordinates from there.

    Returns
    -------
    Joint

    Raises
    ------
    InputError
        Another joint, or no pitch.

    Examples
    --------
    >>> model.screw("spindle", pitch=0.005, name="thread")
    """
    found = known_joint(model, joint, "screw")
    if found.kind != "cylindrical":
        raise InputError(f"screw: {found.name!r} is a {found.kind}: give a cylindrical joint")
    what = f"screw in {found.name}"
    lead = _not_zero(pitch, f"{what}: pitch", "the way of one turn") / (2.0 * np.pi)
    return _coupled(model, what, _Coordinate(found, "displacement"), _Coordinate(found, "angle"),
                    lead, name)


def rack(model: Mechanism, rack: Joint | str, pinion: Joint | str, radius: float,
         name: str | None = None, **acting: Unpack[Acting]) -> Joint:
    """Couple a rack, which slides, to a pinion, which turns: ``displacement = radius x angle``.

    A coupling without elasticity, see `couple`.

    Parameters
    ----------
    rack : Joint or str
        A prismatic or cylindrical joint or a slider.
    pinion : Joint or str
        A revolute or cylindrical joint.
    radius : float
        Pitch radius of the pinion [length]; negative where the rack runs against the angle.
    name : str, optional
        By default ``rack <rack> on <pinion>``.
    **acting
        `until`, `from_`, `breaks_at`, `release_when`: see `sebody.model.acting.Acting`. A coupling
        that locks counts both coordinates from there.

    Returns
    -------
    Joint

    Raises
    ------
    InputError
        A rack that does not slide, a pinion that does not turn, or no radius.

    Examples
    --------
    >>> model.rack("guide", "pinion", radius=0.02, name="teeth")
    """
    found = []
    for given, coordinate, word in ((rack, "displacement", "rack"), (pinion, "angle", "pinion")):
        joint = known_joint(model, given, word)
        if joint.kind not in COORDINATES[coordinate]:
            raise InputError(f"{word}: {joint.name!r} is a {joint.kind}, which has no "
                             f"{coordinate}: give a {', '.join(COORDINATES[coordinate])}")
        found.append(_Coordinate(joint, coordinate))
    what = f"rack {found[0].joint.name} on {found[1].joint.name}"
    radius = _not_zero(radius, f"{what}: radius", "that of the pinion")
    return _coupled(model, what, found[0], found[1], radius, name)


class _Coordinate(NamedTuple):
    """An angle or a displacement of a joint."""

    joint: Joint
    name: str

    @property
    def turns(self) -> bool:
        """An angle."""
        return self.name == "angle"

    @property
    def attachments(self) -> tuple[Attachment, ...]:
        """The attachments of an element that has this coordinate."""
        if self.turns:
            return rotations(self.joint.node, self.joint.to)
        return self.joint.way.attachments

    def constants(self, planar: bool) -> dict:
        """Constants of its kernel."""
        if not self.turns:
            return {"e": self.joint.way.direction, "start": self.joint.way.start}
        return {"rest": 0.0} if planar else turning(self.joint.own_axes)

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
        raise InputError(f"coupling: {joint.name!r} is a {joint.kind}, which has no angle or "
                         f"displacement: give a {', '.join(dict.fromkeys(TURNS + SLIDES))}")
    if asked is None and len(has) > 1:
        raise InputError(f"coupling: {joint.name!r} turns and slides: give "
                         f"{f'{joint.name}.angle'!r} or {f'{joint.name}.displacement'!r}")
    if asked is not None and asked not in has:
        raise InputError(f"coupling: {joint.name!r} is a {joint.kind}, which has no {asked}: "
                         f"give {f'{joint.name}.{has[0]}'!r}")
    return _Coordinate(joint, asked or has[0])


def _coupled(model: Mechanism, what: str, first: _Coordinate, second: _Coordinate, ratio: float,
             name: str | None) -> Joint:
    """Add the equation ``first - ratio second = 0``."""
    for one in (first, second):
        if one.joint.name in model.switches:
            raise InputError(f"{what}: {one.joint.name!r} acts "
                             f"{model.switches[one.joint.name].words()}, and without this joint "
                             f"there is no {one.name}: give the coupling until= and the like, and "
                             "let the joint act all the time")
    if first == second:
        raise InputError(f"{what}: give two coordinates")
    constants = {"ratio": ratio}
    for k, one in enumerate((first, second), 1):
        constants |= {f"{key}{k}": value for key, value in one.constants(model.planar).items()}
    places = [*first.attachments, *second.attachments]
    places.sort(key=lambda place: place.kind == "rotation")     # positions first, stable
    kind = "_".join("turn" if one.turns else "slide" for one in (first, second))
    joint, name = first.joint, chosen_name(model, name, what)
    equation = Element(name, model.kind_of(f"couple_{kind}"), tuple(places), constants, 1)
    made = Joint(name, (equation,), joint.node, joint.to, joint.own_axes, COUPLING)
    model.joints.append(made)
    return made


def _not_zero(value: float, what: str, meaning: str) -> float:
    value = inputs.number(value, what)
    if value == 0:
        raise InputError(f"{what} is 0: give {meaning}")
    return value
