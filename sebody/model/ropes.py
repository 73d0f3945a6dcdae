"""Ropes over points and sheaves, and the sheaves and drums that they pass or end on."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.basics.spelling import unknown
from sebody.model import motions
from sebody.model.arguments import chosen_name, direction, dof_block, known, refuse_taken
from sebody.model.histories import Source
from sebody.model.mechanism import Mechanism
from sebody.model.nodes import ground
from sebody.model.parts import Attachment, DofBlock, Element, Joint, Motion, Node, positions
from sebody.model.rope_geometry import Span, spans_of
from sebody.model.rope_parts import ROPE, Rope, RopePlace, Sheave, Stretch
from sebody.model.time_functions import TimeFunction
from sebody.model.winches import motion_of_drive

Z = np.array([0.0, 0.0, 1.0])
SIDES = {"+": 1.0, "-": -1.0}


def sheave(model: Mechanism, name: str, node: Node | str, radius: float,
           axis: ArrayLike | str | None = None, inertia: float = 0.0,
           friction: float = 0.0) -> Sheave:
    """Sheave that ropes pass, or drum that they end on, with its centre on a node.

    Its axis turns with the node. Without inertia and friction a rope passes it without resistance;
    at the first or last place of a rope it is a drum, on which the rope is wound as the node turns
    about the axis. With inertia it turns in a bearing without friction on its node, and tensions on
    both sides differ by what accelerates it; no rope slips on it unless it has a coefficient of
    friction. Without inertia a sheave with friction is a pin or pulley that turns with its node.

    Parameters
    ----------
    name : str
        By which `rope` finds it.
    node : Node or str
        At the centre. If it keeps no rotation the axis stays as it is.
    radius : float
        Of the middle of the rope on it [length].
    axis : (3,) or 'x', 'y', 'z', optional
        In space; its direction says which sense is ``+``. In a plane it is z.
    inertia : float
        Moment of inertia about the axis, of what turns in the bearing [mass length^2]. Results are
        ``<name>.angle`` and ``<name>.rate``, relative to the node. Its mass is the node's.
    friction : float
        Coefficient mu against ropes that pass: of two tensions at its sides the larger one is at
        most ``e^(mu angle)`` times the smaller one, with the angle of contact, and exactly this
        where the rope slips. Where it sticks it moves with the sheave.

    Raises
    ------
    InputError
        A name that is taken, a radius that is no positive number, or no axis in space.

    Examples
    --------
    >>> model.sheave("head", "boom.tip", 0.2, axis="y")
    """
    name = inputs.name(name, "name of a sheave")
    what = f"sheave {name!r}"
    if name in model.sheaves:
        raise InputError(f"{what} is there already: give another name")
    refuse_taken(model, name, "sheave")
    a = known(model, node)
    dof_block(a, "position")
    radius = inputs.number(radius, f"{what}: radius", above=0.0)
    if model.planar:
        if axis is not None:
            raise InputError(f"{what}: in a plane the axis is normal to it: leave axis= out")
        along = Z
    elif axis is None:
        raise InputError(f"{what} has no axis: give axis=, the direction it turns about")
    else:
        along = direction(model, axis, what, a)
    inertia = inputs.number(inertia, f"{what}: inertia", least=0.0)
    friction = inputs.number(friction, f"{what}: friction", least=0.0)
    wheel = _wheel(model, name, a, along, inertia) if inertia else None
    model.sheaves[name] = Sheave(name, a, radius, along, wheel, friction)
    return model.sheaves[name]


def _wheel(model: Mechanism, name: str, node: Node, axis: NDArray, inertia: float) -> Element:
    """The inertia of a sheave, which turns by an unknown of its own."""
    angle = _hidden(f"{name}.angle", 0.0)
    model.loads.append(Element(
        chosen_name(model, None, f"wheel of {name}"), model.kind_of("rope_wheel"),
        positions(angle) + (_turning(model, node),),
        {"inertia": inertia, "n": axis[2:] if model.planar else axis}, hidden=angle.position))
    return model.loads[-1]


def rope(model: Mechanism, name: str, places: Sequence[Node | Sheave | str], stiffness: float,
         damping: float = 0.0, length: float | str | Source = None, pretension: float = 0.0,
         wrap: str = "+") -> Rope:
    """Rope from a point over points and sheaves to a last point: it only pulls.

    Its tension is ``T = E A e/m + c e'/m`` with the elongation e and the material m between its
    ends, and zero where it is slack; the part of the damping is at most that of the elongation.
    Points on the way are rings that it slides through without friction; sheaves may have some. It
    has no mass, and bends without resistance. Where it leaves and meets sheaves follows from the
    geometry at each time.

    Parameters
    ----------
    name : str
        Of its results, ``<name>.tension``, ``<name>.elongation``, ``<name>.length``.
    places : sequence of Node, Sheave or str
        In the order of the rope: nodes, or sheaves by name. The ends of the rope are fixed to the
        first and last; a sheave there is a drum.
    stiffness : float
        E A [force]: a rope of length L has the stiffness E A / L.
    damping : float
        c [force time].
    length : float, table, function, tuple of three functions, ready profile or str, optional
        Without force [length]; by default that of its way at the start, with `pretension`. A
        history is that of a winch at the first place, with results ``winch of <name>.thrust``,
        ``.power`` and ``.work``; one that begins at zero is added to the length at the start. The
        name of a drive along a way gives its motion. A winch by force is `actuator(..., rope=)`.
    pretension : float
        Tension at the start, in place of a length [force].
    wrap : str
        ``+`` where the rope passes a sheave counterclockwise about its axis, ``-`` where clockwise:
        one sign for all, or one for each sheave in the order of the rope, such as ``+-+``.

    Raises
    ------
    InputError
        Fewer than two places, places that coincide or sheaves that overlap, sheaves whose plane is
        not that of the rope, numbers that make no sense.

    Examples
    --------
    >>> model.rope("hoist", ("winch", "head", "hook"), stiffness=4e6, wrap="-")
    """
    what = f"rope {inputs.name(name, 'name of a rope')!r}"
    found = [_place(model, what, one) for one in inputs.items(
        places, f"{what}: places", "give nodes and names of sheaves")]
    if len(found) < 2:
        raise InputError(f"{what} has {len(found)} place{'s' * (len(found) != 1)}: give the nodes "
                         "and sheaves from its first point to its last")
    stiffness = inputs.number(stiffness, f"{what}: stiffness", above=0.0)
    damping = inputs.number(damping, f"{what}: damping", least=0.0)
    pretension = inputs.number(pretension, f"{what}: pretension", least=0.0)
    material, winch = _length(model, what, length, pretension)
    made, spans = spans_of(what, found, _signs(what, wrap, found))
    if winch is not None and made[0].sheave is not None:
        raise InputError(f"{what} has a history of its length and begins on a drum: give a node as "
                         "its first place, or turn the drum")
    way = sum(span.length for span in spans) + sum(
        abs(place.radius) * place.wrap for place in made[1:-1])
    wound = sum(abs(place.radius) * place.wrap for place in made[1:-1] if _holds(place))
    if material and not material > wound:
        raise InputError(f"{what} has the length {material:g}, and what is wound on its sheaves "
                         f"{wound:.6g}: give more")
    # of what is straight or free on sheaves, the part that is there without force
    free = (material - wound) / (way - wound) if material else 1.0 / (1.0 + pretension / stiffness)
    name = chosen_name(model, name, ROPE)
    numbers = {"stiffness": stiffness, "damping": damping}
    ends = [0, *(k for k, place in enumerate(made[1:-1], 1) if _holds(place)), len(made) - 1]
    angles = {k: _angles(name, k, made[k], k in ends[1:-1]) for k in ends}
    stretches: list[Stretch] = []
    grips: list[list[Element]] = []
    for k, (i, j) in enumerate(pairwise(ends)):
        called = name if len(ends) == 2 else f"{name}[{k}]"
        part = _Part(called, made[i:j + 1], spans[i:j], winch is not None and i == 0)
        stretches.append(_stretch(model, part, numbers | {
            "material": part.way * free}))
        grips.append(_grips(model, part, stretches[-1], (angles[i], angles[j])))
    equations = [one for stretch in stretches for one in (stretch.law, *stretch.spans)]
    equations += [one for both in grips for one in both]
    joint = Joint(name, tuple(equations), made[0].node, made[-1].node, None, ROPE)
    model.joints.append(joint)
    frictions = []
    for n, k in enumerate(ends):
        own = angles[k]
        if own is not None and own.slips:
            sides = (stretches[n - 1], grips[n - 1][-1]), (stretches[n], grips[n][0])
            frictions.append(_friction(model, joint, made[k], own, sides, numbers))
    model.loads += frictions
    given = None
    if winch is not None:
        place = stretches[0].law.attachments[1]
        given = place.dof_block
        given.motions.append(Motion(chosen_name(model, None, f"winch of {name}"), np.ones(1),
                                    winch, place))
    model.ropes[name] = Rope(name, tuple(made), tuple(stretches), given, tuple(frictions))
    return model.ropes[name]


class _Angles(NamedTuple):
    """Angles by which a rope on a sheave, and the sheave, have turned relative to its node."""

    rope: Attachment
    sheave: Attachment

    @property
    def slips(self) -> bool:
        """Tell whether the angles differ."""
        return self.rope is not self.sheave


class _Part(NamedTuple):
    """A part of a rope between places that hold it."""

    name: str
    places: list[RopePlace]
    spans: list[Span]
    winch: bool         # whether a winch is at its first end

    @property
    def arcs(self) -> list[float]:
        """Arcs on its sheaves at the start; none at the ends, which hold it."""
        return [0.0, *(abs(place.radius) * place.wrap for place in self.places[1:-1])]

    @property
    def way(self) -> float:
        """Its length at the start."""
        return sum(span.length for span in self.spans) + sum(self.arcs)


def _length(model: Mechanism, what: str, length: float | str | Source, pretension: float
            ) -> tuple[float, TimeFunction | None]:
    """The length of a rope at the start, zero by its way, and the history of its winch, if any."""
    if length is None:
        return 0.0, None
    history = None
    if isinstance(length, str):
        return 0.0, motion_of_drive(model, what, length).from_zero()
    if isinstance(length, TimeFunction) or callable(length) or isinstance(length, list | tuple):
        given = motions.history(length)
        length, history = float(given.at(0.0)[0]), given.from_zero()
        if length == 0.0:
            return 0.0, history
    length = inputs.number(length, f"{what}: length", above=0.0)
    if pretension:
        raise InputError(f"{what} has a length and a pretension: leave one of them out")
    return length, history


def _holds(place: RopePlace) -> bool:
    """Tell whether a place on the way of a rope holds it: a sheave with inertia or friction."""
    return place.sheave is not None and place.sheave.holds


def _place(model: Mechanism, what: str, place: Node | Sheave | str
           ) -> tuple[Node, Sheave | None]:
    if isinstance(place, Sheave):
        if model.sheaves.get(place.name) is not place:
            raise InputError(f"{what}: sheave {place.name!r} is of another model: use that of this "
                             "one")
        return place.node, place
    if isinstance(place, str) and place in model.sheaves and place not in model.nodes:
        return model.sheaves[place].node, model.sheaves[place]
    if isinstance(place, str) and place not in model.nodes:
        raise unknown("node or sheave", place, [*model.nodes, *model.sheaves],
                      f"{what}: the model has", f"{what}: the model has none")
    a = known(model, place)
    dof_block(a, "position")
    return a, None


def _signs(what: str, wrap: object, places: Sequence[tuple[Node, Sheave | None]]) -> list[float]:
    """The side on which the rope passes each place: 0 of points."""
    count = sum(sheave is not None for _, sheave in places)
    if not isinstance(wrap, str) or set(wrap) - set(SIDES) or len(wrap) not in (1, count):
        raise inputs.refusal(f"{what}: wrap", wrap, "give '+' or '-', or one of them for each of "
                             f"its {count} sheaves, such as '+-'")
    signs = iter(wrap * count if len(wrap) == 1 else wrap)
    return [0.0 if sheave is None else SIDES[next(signs)] for _, sheave in places]


def _hidden(name: str, value: float, fixed: bool = False) -> Node:
    """A node in no table of the model, whose position is one unknown."""
    block = DofBlock(name, np.array([value]), np.zeros(1), fixed)
    return Node(name, np.zeros(0), block, None)


def _stretch(model: Mechanism, part: _Part, constants: dict[str, float]) -> Stretch:
    """The equations of a part of a rope with one tension."""
    name, arcs = part.name, part.arcs
    lengths = _hidden(f"{name}.length", part.way)
    ends, given = [], {}
    for letter, end, place in zip("ab", ("first", "last"), (part.places[0], part.places[-1]),
                                  strict=True):
        winch = part.winch and letter == "a"
        ends.append(_hidden(f"{name}.{end} end", 0.0, fixed=place.sheave is None))
        given[f"given_{letter}"] = 1.0 * winch - (place.sheave is not None)
    law = Element(name, model.kind_of("rope"), positions(lengths, *ends), constants | given, 1,
                  hidden=lengths.position)
    count = len(part.spans)
    elements = [_span(model, name, span, law, arcs[k], (0 < k, k + 1 < count))
                for k, span in enumerate(part.spans)]
    return Stretch(law, tuple(elements))


def _span(model: Mechanism, name: str, span: Span, law: Element, arc: float,
          counted: tuple[bool, bool]) -> Element:
    """The equation of a span, which adds to that of the law; arcs are counted where they are free.
    """
    ends, directed = [span.a, span.b], span.direction
    flags = [float(one) for one in counted]
    radii = [span.a.radius, span.b.radius]
    if span.a.sheave is None and span.b.sheave is not None:     # seen from the sheave
        ends, flags, directed = ends[::-1], flags[::-1], -directed
        radii = [-radius for radius in radii[::-1]]
    on = [end for end in ends if end.sheave is not None]
    constants: dict[str, float | NDArray] = {"arc": arc}
    for letter, end, flag, radius in zip("ab", on, flags, radii, strict=False):
        constants |= {f"r_{letter}": radius, f"arc_{letter}": flag,
                      **_axes(model, letter, directed, end.normal)}
    kind = ("rope_line", "rope_end", "rope_span")[len(on)]
    return Element(name, model.kind_of(kind), positions(*(end.node for end in ends))
                   + tuple(_turning(model, end.node) for end in on), constants, 0, shares=law)


def _angles(name: str, k: int, place: RopePlace, passed: bool) -> _Angles | None:
    """The angles of place k of a rope, if it is a sheave; one angle where no rope slips on it."""
    if place.sheave is None:
        return None
    wheel = place.sheave.wheel
    turned = wheel.attachments[0] if wheel is not None else Attachment(
        _hidden(f"{name}.angle {k}", 0.0, fixed=True), "position")
    if not (passed and place.sheave.friction):
        return _Angles(turned, turned)
    return _Angles(Attachment(_hidden(f"{name}.angle {k}", 0.0), "position"), turned)


def _grips(model: Mechanism, part: _Part, stretch: Stretch, angles: Sequence[_Angles | None]
           ) -> list[Element]:
    """Equations of what sheaves at the ends of a part have taken up."""
    found, (places, spans) = [], part[1:3]
    for k, (place, other, span, sign) in enumerate((
            (places[0], places[1], spans[0], 1.0), (places[-1], places[-2], spans[-1], -1.0))):
        own = angles[k]
        if own is None:
            continue
        taken, radius = stretch.law.attachments[1 + k], sign * place.radius
        found.append(Element(
            part.name, model.kind_of("rope_grip"),
            positions(place.node, other.node) + (taken, own.rope, _turning(model, place.node)),
            {"r_a": radius, "r_b": sign * other.radius, "turn": sign * _along(place),
             **_axes(model, "a", sign * span.direction, place.normal)}, 1,
            hidden=taken.dof_block))
    return found


def _along(place: RopePlace) -> float:
    """Rope that a sheave takes towards the last place in a turn by one radian [length]."""
    assert place.sheave is not None
    return float(np.sign(place.normal @ place.sheave.axis)) * place.radius


def _friction(model: Mechanism, joint: Joint, place: RopePlace, angles: _Angles,
              sides: Sequence[tuple[Stretch, Element]], numbers: Mapping[str, float]) -> Element:
    """Friction between the stretches on both sides of a sheave, each with its grip there."""
    assert place.sheave is not None
    radius, coefficient = place.sheave.radius, place.sheave.friction
    before, after = (side.law for side, _ in sides)
    read = [one for both in zip(*((side.law, grip) for side, grip in sides), strict=True)
            for one in both]
    return Element(
        chosen_name(model, None, f"friction of {joint.name} on {place.sheave.name}"),
        model.kind_of("friction_rope"),
        (angles.rope, angles.sheave, *(side.law.attachments[n] for (side, _), order in zip(
            sides, ((0, 2, 1), (0, 1, 2)), strict=True) for n in order)),
        {"coefficient": coefficient, "static": coefficient, "speed": 0.0, "along": _along(place),
         "arm": radius, "wrap": place.wrap,
         "axial": numbers["stiffness"], "axial_damping": numbers["damping"], "settling": 0.0,
         "material_1": before.number("material"), "given_1": before.number("given_a"),
         "material_2": after.number("material"), "given_2": after.number("given_b")},
        hidden=angles.rope.dof_block, pressed_by=joint,
        reads=tuple(joint.constraints.index(one) for one in read), tuned={"settling": 1.0})


def _axes(model: Mechanism, letter: str, ray: NDArray, normal: NDArray) -> dict[str, NDArray]:
    """The axes in which a sheave sees directions: the ray, and in space what is across it."""
    if model.planar:
        return {f"e1_{letter}": ray[:2]}
    return {f"e1_{letter}": ray, f"e2_{letter}": np.cross(normal, ray)}


def _turning(model: Mechanism, node: Node) -> Attachment:
    """The rotation of a node; of the ground where it keeps none."""
    return Attachment(node if node.rotation is not None else ground(model, node), "rotation")
