"""Beams as superelements, straight or along an axis that curves and twists."""

from __future__ import annotations

from collections.abc import Sequence
from copy import deepcopy
from functools import lru_cache
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sebody.basics import inputs, memory
from sebody.basics.errors import InputError
from sebody.fem import Axis
from sebody.fem.model import FEModel
from sebody.fem.section_along import AnySection
from sebody.model.arguments import known
from sebody.model.beam_damping import Damping, Times, damped, retardation_times
from sebody.model.beam_pieces import AxisPiece, Course, Division, StraightPiece, divided
from sebody.model.bodies import superelement
from sebody.model.mechanism import Mechanism
from sebody.model.nodes import node
from sebody.model.parts import Beam, Node
from sebody.reduction.body import ReducedBody
from sebody.reduction.craig_bampton import craig_bampton
from sebody.reduction.held import vibration_shapes, with_held_modes

KEPT = 64       # bodies of beams that are kept for further models

OF_BODY = 20_000        # bytes of a superelement and its node


def beam(model: Mechanism, name: str, ends: tuple[Node | str, Node | str],
         section: AnySection, elements: int, bodies: int | None = None, modes: int = 0,
         up: ArrayLike | None = None, damping: Damping = 0.0,
         stiffening: bool | None = None, axis: Axis | None = None, divide: Division = "length",
         **placing: Any) -> list[Node]:
    """A beam of superelements; with one element each, a nonlinear beam.

    A superelement of one finite element, with the mean of its two rotations as frame, has the
    strain energy of Simo and Reissner's geometrically exact beam: strains of the chord are
    ``Gamma = R_m^T (x_b - x_a) / l - t`` with the rotation R_m half way between those of the nodes,
    and each node is rotated by half of ``log(R_a^T R_b)`` from R_m. The exact linear stiffness
    does not lock; with no shear factor in the section it is that of Euler and Bernoulli. So beams
    without modes and with as many bodies as elements are the nonlinear reference for
    superelements. They do not stiffen by default: what is of second order within an element
    would change its strain energy.

    Parameters
    ----------
    ends : two Nodes or str
        Full nodes at the ends of the axis.
    section : Section, StiffnessSection, GeneralSection, Stations or function
        One, or a function of the place along the beam, from 0 to 1, see `sebody.fem.straight_beam`.
    elements : int
        Finite elements from end to end.
    bodies : int, optional
        Superelements; as many as elements by default.
    modes : int
        Internal modes of each.
    up : (3,), optional
        Direction of the section's y axis, see `sebody.fem.straight_beam`.
    damping : float or (float, str or float)
        Part of critical damping of a mode of the whole beam, the same for any division: of
        ``(0.02, "clamped 1")`` the first one with the first end held, so ``free 1``, which a number
        alone means, with free ends, and ``hinged 1``; each of tension, torsion and bending in
        either plane by itself. Stresses follow the rates of strains (Kelvin and Voigt), so ratios
        grow with the frequency. With an angular frequency, ``(0.02, 35.0)``, all vibrations of
        this frequency have the ratio. Where tension, torsion and bending are coupled, by an axis or
        by sections, modes are those of the whole beam, ``free 1`` or ``clamped 1``, and all strains
        have one retardation time; sections with retardation times of their own damp by these.
    stiffening : bool, optional
        As of `superelement`; by default not with one finite element in each.
    axis : sebody.fem.Axis, optional
        From the first node, by a shift, to the last one; straight by default.
    divide : 'length', 'rotation' or (bodies + 1,)
        Superelements of equal length, or such that all turn equally under the force on the last
        node that moves it most, the first one held: where a beam is soft there are more of them.
        Or places of their ends, from 0 to 1.
    **placing
        Arguments of `superelement`, such as ``frame``; with an axis ``rotation``, which turns it
        into the model.

    Returns
    -------
    list of Node
        All nodes from end to end, named ``<name> 1`` and so on between them. Superelements are
        numbered in this way; a single body is called `name`.

    Raises
    ------
    InputError
        No element, elements that cannot be divided among the bodies, names that are taken, or an
        axis that does not fit the nodes.
    """
    inputs.name(name, "name of a beam")
    pair = inputs.items(ends, f"ends of beam {name!r}", "give two nodes")
    if len(pair) != 2:
        raise inputs.refusal(f"ends of beam {name!r}", ends, "give two nodes")
    first, last = (known(model, n) for n in pair)
    elements = inputs.integer(elements, "elements", least=1, remedy=f"beam {name!r} has "
                              f"{inputs.shown(elements)} elements: give a whole number >= 1")
    undivided = (f"beam {name!r}: {elements} elements cannot be divided among "
                 f"{inputs.shown(bodies)} bodies: give a multiple")
    bodies = elements if bodies is None else inputs.integer(bodies, "bodies", least=1,
                                                            remedy=undivided)
    memory.check(float(OF_BODY) * bodies, f"beam {name!r} of {bodies} bodies", "give fewer bodies")
    if elements % bodies:
        raise InputError(undivided)
    others = {key: value for key, value in placing.items() if axis is None or key != "rotation"}
    course = Course(model, (first, last), section, up, axis, placing.get("rotation"))
    course.check(name)
    places = divided(course, name, divide, elements, bodies)
    times = retardation_times(damping, name, course)
    options = {"modes": modes, "up": up, "damping": damping, "stiffening": stiffening,
               "axis": axis, "divide": divide, **placing}
    if elements == bodies:      # Simo and Reissner's strain energy, of stubby elements, too
        stiffening = False if stiffening is None else stiffening
        others.setdefault("frame", "converged_mean")
    points = course.points(places)
    nodes = [first, *(node(model, f"{name} {k}", points[k]) for k in range(1, bodies)), last]
    parts = []
    for k, (span, body) in enumerate(zip(
            pairwise(nodes), _bodies(course, places, elements // bodies, modes, times),
            strict=True)):
        parts.append(superelement(model, name if bodies == 1 else f"{name} {k + 1}", body, span,
                                  stiffening=stiffening, **others))
    model.beams.append(Beam(name, tuple(nodes), section, elements, deepcopy(options, {
        id(axis): axis}), tuple(parts), tuple(part.reduced for part in parts),
        tuple(places.tolist())))
    return nodes


def part_bodies(model: Mechanism, beam: Beam, section: AnySection,
                held: Sequence[NDArray] | None = None) -> list[ReducedBody]:
    """The bodies of a beam's superelements with another section.

    Parameters
    ----------
    held : sequence of (DOFs, modes), optional
        Of `part_shapes`: vibration modes that each keeps.
    """
    course = course_of(model, beam, section)
    times = retardation_times(beam.options["damping"], beam.name, course)
    each, places = beam.elements // len(beam.parts), np.array(beam.places)
    if held is None:
        return _bodies(course, places, each, beam.options["modes"], times)
    bodies = []
    for piece, shapes in zip(_pieces(course, places, each), held, strict=True):
        body = with_held_modes(piece.fe_model(), _ends(each), shapes)
        bodies.append(_turned(damped(body, times) if times else body, course.turn))
    return bodies


def part_models(model: Mechanism, beam: Beam) -> list[tuple[FEModel, NDArray]]:
    """FE models of a beam's superelements, and rotations from their axes to the model's."""
    course = course_of(model, beam, beam.section)
    return [(piece.fe_model(), np.array(course.turn)) for piece in _pieces(
        course, np.array(beam.places), beam.elements // len(beam.parts))]


def part_shapes(model: Mechanism, beam: Beam, section: AnySection) -> list[NDArray]:
    """Vibration modes of a beam's superelements with a section, along their own axes."""
    each = beam.elements // len(beam.parts)
    return [vibration_shapes(piece.fe_model(), _ends(each), beam.options["modes"])
            for piece in _pieces(course_of(model, beam, section), np.array(beam.places), each)]


def course_of(model: Mechanism, beam: Beam, section: AnySection) -> Course:
    """The whole way of a beam as built, with a section."""
    return Course(model, (beam.nodes[0], beam.nodes[-1]), section, beam.options["up"],
                  beam.options.get("axis"), beam.options.get("rotation"))


def _bodies(course: Course, places: NDArray, each: int, modes: int, times: Times
            ) -> list[ReducedBody]:
    """Bodies of the parts of a beam; those that differ in place and direction alone share the work.

    Along its own axes stretching and bending of a straight beam are not mixed, so slender ones
    lose no digits.
    """
    made: dict[int, ReducedBody] = {}
    for piece in (pieces := _pieces(course, places, each)):
        if id(piece) not in made:
            made[id(piece)] = _placed(course.turn, piece, modes, times)
    return [made[id(piece)] for piece in pieces]


def _pieces(course: Course, places: NDArray, each: int) -> list[StraightPiece | AxisPiece]:
    """The parts; straight ones that are equal but for rounding are the same."""
    pieces = [course.piece(a, b, each) for a, b in pairwise(places.tolist())]
    first = pieces[0]
    if isinstance(first, StraightPiece) and not callable(course.section):
        pieces = [first if isinstance(one, StraightPiece)
                  and abs(one.length - first.length) < 1e-12 * first.length else one
                  for one in pieces]
    return pieces


def _placed(turn: tuple, piece: StraightPiece | AxisPiece, modes: int, times: Times
            ) -> ReducedBody:
    try:
        return _kept(turn, piece, modes, times)
    except TypeError:       # a section that has no hash, or input that is refused below
        return _turned(_reduced.__wrapped__(piece, modes, times), turn)


@lru_cache(maxsize=KEPT, typed=True)
def _kept(turn: tuple, piece: StraightPiece | AxisPiece, modes: int, times: Times) -> ReducedBody:
    return _turned(_reduced(piece, modes, times), turn)


def _turned(body: ReducedBody, turn: tuple) -> ReducedBody:
    """A beam in its own axes as it lies in the model; `turn` has the rows of a rotation matrix."""
    rotation = np.array(turn)
    return body if np.array_equal(rotation, np.eye(len(turn))) else body.rotated(rotation)


@lru_cache(maxsize=KEPT, typed=True)
def _reduced(piece: StraightPiece | AxisPiece, modes: int, times: Times) -> ReducedBody:
    """A part of a beam in its own axes."""
    body = craig_bampton(piece.fe_model(), _ends(piece.elements), modes)
    return damped(body, times) if times else body


def _ends(elements: int) -> list[tuple[int, str]]:
    """The boundary of a beam: its end nodes."""
    return [(0, "full"), (elements, "full")]
