"""Small finite element models: a stand-in for an FE program in examples and tests."""

from sebody.fem.axis import Axis
from sebody.fem.beam import beam_along, frame, planar_beam, straight_beam
from sebody.fem.general_section import GeneralSection, Stations
from sebody.fem.hexahedron import hexahedral_block
from sebody.fem.model import FEModel
from sebody.fem.section import Section, StiffnessSection
from sebody.fem.shapes import circle, i_profile, rectangle, tube
from sebody.fem.stress import SolidStress, StressModes, solid_stress

__all__ = ["Axis", "FEModel", "GeneralSection", "Section", "SolidStress", "Stations",
           "StiffnessSection", "StressModes", "beam_along", "circle", "frame",
           "hexahedral_block", "i_profile", "planar_beam", "rectangle", "solid_stress",
           "straight_beam", "tube"]
