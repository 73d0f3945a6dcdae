"""Straight beams as superelements."""

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
from sebody.fem import planar_beam, straight_beam
from sebody.fem.beam import section_axes
from sebody.fem.model import FEModel
from sebody.fem.section import AnySection, part_of
from sebody.model.arguments import known
from sebody.model.beam_damping import Damping, Times, damped, retardation_times
from sebody.model.bodies import superelement
from sebody.model.mechanism import Mechanism
from sebody.model.nodes import node
from sebody.model.parts import Beam, Node
from sebody.reduction import ReducedBody, craig_bampton
from sebody.reduction.held import vibration_shapes, with_held_modes

KEPT = 64       # bodies of beams that are kept for further models

OF_BODY = 20_000        # bytes of a superelement and its node


def beam(model: Mechanism, name: str, ends: tuple[Node | str, Node | str],
         section: AnySection, elements: int, bodies: int | None = None, modes: int = 0,
         up: ArrayLike | None = None, damping: Damping = 0.0,
         stiffening: bool | None = None, **placing: Any) -> list[Node]:
    """A straight beam of equal superelements; with one element each, a nonlinear beam.

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
    section : Section, StiffnessSection or function
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
        this frequency have the ratio.
    stiffening : bool, optional
        As of `superelement`; by default not with one finite element in each.
    **placing
        Arguments of `superelement`, such as ``frame``.

    Returns
    -------
    list of Node
        All nodes from end to end, named ``<name> 1`` and so on between them. Superelements are
        numbered in this way; a single body is called `name`.

    Raises
    ------
    InputError
        No element, elements that cannot be divided among the bodies, or names that are taken.
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
    if up is not None and model.planar:
        raise InputError(f"beam {name!r}: up is for beams in space, leave it out")
    if elements % bodies:
        raise InputError(undivided)
    length = float(np.linalg.norm(last.point - first.point))
    times = retardation_times(damping, name, model.planar, length, section)
    options = {"modes": modes, "up": up, "damping": damping, "stiffening": stiffening, **placing}
    step, each = (last.point - first.point) / bodies, elements // bodies
    if each == 1 and stiffening is None:
        stiffening = False
    nodes = [first, *(node(model, f"{name} {k}", first.point + k * step)
                      for k in range(1, bodies)), last]
    body, parts = None, []
    for k, span in enumerate(pairwise(nodes)):
        if body is None or callable(section):
            part = part_of(section, k / bodies, (k + 1) / bodies)
            body = _part(model, span, part, each, modes, up, times)
        parts.append(superelement(model, name if bodies == 1 else f"{name} {k + 1}", body, span,
                                  stiffening=stiffening, **placing))
    model.beams.append(Beam(name, tuple(nodes), section, elements, deepcopy(options), tuple(parts),
                            tuple(part.reduced for part in parts)))
    return nodes


def part_bodies(model: Mechanism, beam: Beam, section: AnySection,
                held: Sequence[NDArray] | None = None) -> list[ReducedBody]:
    """The bodies of a beam's superelements with another section.

    Parameters
    ----------
    held : sequence of (DOFs, modes), optional
        Of `part_shapes`: vibration modes that each keeps.
    """
    count = len(beam.parts)
    length = float(np.linalg.norm(beam.nodes[-1].point - beam.nodes[0].point))
    options = beam.options
    times = retardation_times(options["damping"], beam.name, model.planar, length, section)
    parts = [part_of(section, k / count, (k + 1) / count) for k in range(count)]
    each = beam.elements // count
    if held is None:
        return [_part(model, span, part, each, options["modes"], options["up"], times)
                for span, part in zip(pairwise(beam.nodes), parts, strict=True)]
    bodies = []
    for span, part, shapes in zip(pairwise(beam.nodes), parts, held, strict=True):
        turn, own = _line(model, span, options["up"])
        body = with_held_modes(_fe_model(model.planar, own, part, each), _ends(each), shapes)
        bodies.append(_turned(damped(body, times) if times else body, turn))
    return bodies


def part_models(model: Mechanism, beam: Beam) -> list[tuple[FEModel, NDArray]]:
    """FE models of a beam's superelements along x, and rotations from their axes to the model's."""
    count = len(beam.parts)
    made = []
    for k, span in enumerate(pairwise(beam.nodes)):
        turn, length = _line(model, span, beam.options["up"])
        part = part_of(beam.section, k / count, (k + 1) / count)
        made.append((_fe_model(model.planar, length, part, beam.elements // count), np.array(turn)))
    return made


def part_shapes(model: Mechanism, beam: Beam, section: AnySection) -> list[NDArray]:
    """Vibration modes of a beam's superelements with a section, along their own axes."""
    count, each = len(beam.parts), beam.elements // len(beam.parts)
    return [vibration_shapes(_fe_model(model.planar, _line(model, span, beam.options["up"])[1],
                                       part_of(section, k / count, (k + 1) / count), each),
                             _ends(each), beam.options["modes"])
            for k, span in enumerate(pairwise(beam.nodes))]


def _part(model: Mechanism, ends: Sequence[Node], section: AnySection, elements: int, modes: int,
          up: ArrayLike | None, times: Times) -> ReducedBody:
    """One superelement of a beam; beams that differ in place and direction alone share the work.

    Along its own axes stretching and bending are not mixed, so slender beams lose no digits.
    """
    turn, length = _line(model, ends, up)
    arguments = model.planar, length, section, elements, modes, times
    try:
        hash(arguments)
    except TypeError:       # a section of arrays, or input that is refused below
        return _turned(_straight.__wrapped__(*arguments), turn)
    return _placed(turn, *arguments)


def _line(model: Mechanism, ends: Sequence[Node], up: ArrayLike | None) -> tuple[tuple, float]:
    """Rows of the rotation from a beam's axes to those of the model, and its length."""
    line = np.zeros(3)
    line[:model.dimension] = ends[1].point - ends[0].point
    axes = section_axes(line, None if up is None else inputs.vector(up, "up", 3))
    turn = tuple(map(tuple, axes[:model.dimension, :model.dimension].T.tolist()))
    return turn, float(np.linalg.norm(line))


@lru_cache(maxsize=KEPT, typed=True)
def _placed(turn: tuple, *arguments: Any) -> ReducedBody:
    return _turned(_straight(*arguments), turn)


def _turned(body: ReducedBody, turn: tuple) -> ReducedBody:
    """A beam along x as it lies in the model; `turn` has the rows of a rotation matrix."""
    rotation = np.array(turn)
    return body if np.array_equal(rotation, np.eye(len(turn))) else body.rotated(rotation)


@lru_cache(maxsize=KEPT, typed=True)
def _straight(planar: bool, length: float, section: AnySection, elements: int, modes: int,
              times: Times) -> ReducedBody:
    """A beam along x, its section's y axis along y."""
    body = craig_bampton(_fe_model(planar, length, section, elements), _ends(elements), modes)
    return damped(body, times) if times else body


def _ends(elements: int) -> list[tuple[int, str]]:
    """The boundary of a beam: its end nodes."""
    return [(0, "full"), (elements, "full")]


def _fe_model(planar: bool, length: float, section: AnySection, elements: int) -> FEModel:
    """A beam along x, its section's y axis along y."""
    first, last = np.zeros((2, 2 if planar else 3))
    last[0] = length
    return (planar_beam(first, last, section, elements) if planar else
            straight_beam(first, last, section, elements, (0.0, 1.0, 0.0)))
