"""Small finite element models: a stand-in for an FE program in examples and tests."""

from typing import TYPE_CHECKING

from sebody.basics.lazy import load_on_demand

if TYPE_CHECKING:
    from sebody.fem.axis import Axis as Axis
    from sebody.fem.beam import (
        beam_along as beam_along,
        frame as frame,
        planar_beam as planar_beam,
        straight_beam as straight_beam,
    )
    from sebody.fem.general_section import GeneralSection as GeneralSection, Stations as Stations
    from sebody.fem.hexahedron import hexahedral_block as hexahedral_block
    from sebody.fem.model import FEModel as FEModel
    from sebody.fem.section import Section as Section, StiffnessSection as StiffnessSection
    from sebody.fem.shapes import (
        circle as circle,
        i_profile as i_profile,
        rectangle as rectangle,
        tube as tube,
    )
    from sebody.fem.stress import (
        SolidStress as SolidStress,
        StressModes as StressModes,
        solid_stress as solid_stress,
    )

load_on_demand(__name__)
