"""The parts of a model, and the forms each of them may take."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from sebody.basics.errors import InputError
from sebody.generated.options import INERTIA_OPTIONS
from sebody.model.frames import FRAMES
from sebody.model.mechanism import Mechanism
from sebody.model.parts import Beam, Superelement
from sebody.model.variants import divide
from sebody.reduction.body import ReducedBody

DIVISIONS = (1, 2, 4, 8)
MOST_MODES = {True: 4, False: 8}        # of a whole beam, at least: planar or not
MOST_BODIES = 64                        # of a beam that is merged
FEWEST_ELEMENTS = 16                    # of a whole beam: two of each body of eight


class Form(NamedTuple):
    """Form in which a part of a model is built."""

    rigid: bool
    bodies: int         # superelements of a beam from end to end
    modes: int          # internal ones of each
    inertia: str
    stiffening: bool
    frame: str

    @classmethod
    def first(cls, part: "Part") -> "Form":
        """One body without modes: what a rigid part is compared with."""
        return part.detailed._replace(bodies=1, modes=0)

    def poorer(self, other: "Form") -> bool:
        """Tell whether no option of this form is more detailed than that of another."""
        return self.rigid or (
            not other.rigid and self.bodies <= other.bodies and self.modes <= other.modes
            and _rank(self) <= _rank(other)
            and self.stiffening <= other.stiffening)


def _rank(form: Form) -> int:
    """Rank of the inertia option: a higher one describes more of the motion."""
    return INERTIA_OPTIONS[form.inertia].rank


@dataclass(frozen=True, eq=False)
class Part:
    """A beam that `Model.beam` has built, or a superelement of another kind.

    Parameters
    ----------
    name : str
    beam : Beam, optional
        How it was built; None of a superelement.
    body : ReducedBody
        That of the first superelement, as given.
    given, detailed : Form
    forms : tuple of Form
        All, in no order; that of the reference model and the given one are among them.
    elements : int
        Finite elements of a beam in all forms.
    """

    name: str
    beam: Beam | None
    body: ReducedBody
    given: Form
    detailed: Form
    forms: tuple[Form, ...]
    elements: int = 0

    @property
    def planar(self) -> bool:
        """Tell whether it is in a plane."""
        return self.body.planar

    def superelements(self, form: Form) -> list[str]:
        """Names of its superelements in a form."""
        if form.bodies == 1:
            return [self.name]
        return [f"{self.name} {k}" for k in range(1, form.bodies + 1)]


def parts_of(model: Mechanism, pinned: Iterable[str] = (),
             inside: Mapping[str, int] | None = None) -> list[Part]:
    """The parts of a model, beams first in the place of their superelements.

    Parameters
    ----------
    pinned : iterable of str
        Names of nodes and superelements that quantities refer to: beams that own one of them are
        not divided anew.
    inside : mapping of str to int, optional
        Beams whose inside is asked for by places in so many finite elements: these are divided, as
        long as the places stay nodes, but not rigid.
    """
    owners: dict[str, Beam] = {}
    pinned, inside = set(pinned), inside or {}
    for beam in model.beams:
        asked = beam.name in inside and _elements(beam) % inside[beam.name] == 0
        if _divisible(model, beam, pinned - (
                {part.name for part in beam.parts} if asked else set())):
            owners |= {part.name: beam for part in beam.parts}
    parts: dict[str, Part] = {}
    for name, body in model.bodies.items():
        beam = owners.get(name)
        if beam is None:
            parts[name] = _of_body(name, body, name in pinned)
        elif beam.name not in parts:
            parts[beam.name] = _of_beam(beam, beam.name in inside)
    return list(parts.values())


def alike(parts: list[Part]) -> list[list[int]]:
    """Places of parts, those together that have like bodies and may take the same forms."""
    groups: dict[tuple, list[int]] = {}
    for k, part in enumerate(parts):
        body = part.body
        key = (part.given, part.detailed, frozenset(part.forms), part.elements,
               f"{body.total_mass:.6e}", f"{np.trace(body.stiffness):.6e}")
        groups.setdefault(key, []).append(k)
    return list(groups.values())


def _divisible(model: Mechanism, beam: Beam, pinned: set[str]) -> bool:
    own = {node.name for node in beam.nodes[1:-1]} | {part.name for part in beam.parts}
    if own & pinned or len(beam.parts) > MOST_BODIES:
        return False
    try:
        divide(model, beam.name, 1, FEWEST_ELEMENTS)
    except InputError:
        return False
    return True


def _of_beam(beam: Beam, asked: bool) -> Part:
    """A beam; one whose inside is asked for is not rigid."""
    first = beam.parts[0]
    planar = first.reduced.planar
    given = _given(first, len(beam.parts))
    most = max(MOST_MODES[planar], first.reduced.modes * given.bodies)
    options = _options(first)
    forms, many = set() if asked else {_rigid(given)}, given.bodies > max(DIVISIONS)
    for bodies in DIVISIONS:
        if many and given.bodies % bodies:      # bodies of the reference model are merged
            continue
        least = -(-most // bodies)
        forms |= {Form(False, bodies, modes, *option)
                  for modes in _counts(least + (least % 2 and not planar)) for option in options}
    forms.add(given)
    detailed = given if many else max(
        (f for f in forms if not f.rigid and f.bodies == max(DIVISIONS)),
        key=lambda f: (_rank(f), f.stiffening, f.modes))
    return Part(beam.name, beam, first.reduced, given, detailed, tuple(forms), _elements(beam))


def _elements(beam: Beam) -> int:
    """Finite elements of a beam in all forms: some for each of the most bodies."""
    if len(beam.parts) > max(DIVISIONS):
        return beam.elements
    return max(FEWEST_ELEMENTS, -(-beam.elements // max(DIVISIONS)) * max(DIVISIONS))


def _of_body(name: str, body: Superelement, asked: bool) -> Part:
    """A body; one whose inside is asked for is not rigid."""
    given, most = _given(body, 1), body.reduced.modes
    forms = {Form(False, 1, modes, *option) for modes in _counts(most)
             for option in _options(body)} | {given} | (set() if asked else {_rigid(given)})
    detailed = max((f for f in forms if not f.rigid),
                  key=lambda f: (_rank(f), f.stiffening, f.modes))
    return Part(name, None, body.reduced, given, detailed, tuple(forms))


def _given(body: Superelement, bodies: int) -> Form:
    return Form(False, bodies, body.reduced.modes, body.inertia, body.stiffening, body.frame)


def _rigid(given: Form) -> Form:
    return Form(True, 1, 0, "frame_axes", False, given.frame)


def _counts(most: int) -> list[int]:
    """Numbers of modes that are tried: none, powers of two, all."""
    return sorted({0, *(2**k for k in range(most.bit_length()) if 2**k < most), most})


def _options(body: Superelement) -> list[tuple[str, bool, str]]:
    """Inertia, stiffening and frame that the part may have."""
    frame = body.frame if not FRAMES[body.frame].traits.incremental else "converged_mean"
    options = [("material", False, frame)]
    invariants = body.reduced.invariants
    if invariants is None:
        return [*options, ("rigid_part", False, frame)]
    options.append(("floating_field", False, frame))
    return [*options, ("floating_field", True, frame)] if invariants.stiffens else options
