"""Beams as they were built, in a plane of symmetry: so they can be divided anew there."""

from dataclasses import replace
from typing import cast

import numpy as np

from sebody.fem.beam import section_axes
from sebody.fem.section import StiffnessSection
from sebody.fem.section_along import AnySection, section_at
from sebody.model.beams import course_of
from sebody.model.mechanism import Mechanism
from sebody.model.parts import Beam
from sebody.model.variants.flattening import Flattening

_SAME = 1e-9            # relative: stiffnesses that are the same but for rounding


def flat_beams(model: Mechanism, made: Mechanism, flat: Flattening) -> list[Beam]:
    """The beams of a planar model, without those that changed since they were built.

    Nor those along an axis or of coupled sections, which cannot be built in a plane.

    Parameters
    ----------
    model, made : Mechanism
        Spatial and planar.
    """
    beams = []
    for beam in model.beams:
        if course_of(model, beam, beam.section).coupled:
            continue
        if all(model.bodies.get(part.name) is part and part.reduced is body
               for part, body in zip(beam.parts, beam.bodies, strict=True)):
            parts = tuple(made.bodies[part.name] for part in beam.parts)
            options = {**beam.options, "up": None, "modes": max(p.reduced.modes for p in parts)}
            beams.append(Beam(beam.name, tuple(flat.node(node) for node in beam.nodes),
                              _flat_section(beam, flat), beam.elements, options, parts,
                              tuple(part.reduced for part in parts), beam.places))
    return beams


def _flat_section(beam: Beam, flat: Flattening) -> AnySection:
    """A section that bends in the plane about its z axis."""
    line = beam.nodes[-1].point - beam.nodes[0].point
    _, y, z = section_axes(line, beam.options["up"])
    if z @ flat.plane.normal > 1.0 - _SAME:
        return beam.section

    def turned(place: float) -> StiffnessSection:
        own = cast(StiffnessSection, section_at(beam.section, place))   # coupled ones are left out
        return _turned(own, abs(y @ flat.plane.normal))
    if callable(beam.section):
        return turned
    return turned(0.0)


def _turned(section: StiffnessSection, part: float) -> StiffnessSection:
    """A section whose y axis has this part along the normal: 1, 0, or any of an equal section.

    What is seen of it, outline and fibres, has axes that are not these.
    """
    section = replace(section, outline=None, fibres=())
    if part < np.sqrt(0.5):
        return section
    return replace(section, bending_y=section.bending_z, bending_z=section.bending_y,
                   inertia_y=section.inertia_z, inertia_z=section.inertia_y,
                   shear_y=section.shear_z, shear_z=section.shear_y)
