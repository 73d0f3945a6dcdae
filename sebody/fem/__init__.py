"""Small finite element models: a stand-in for an FE program in examples and tests."""

from sebody.fem.beam import frame, planar_beam, straight_beam
from sebody.fem.hexahedron import hexahedral_block
from sebody.fem.model import FEModel
from sebody.fem.section import Section, StiffnessSection
from sebody.fem.shapes import circle, i_profile, rectangle, tube
from sebody.fem.stress import SolidStress, StressModes, solid_stress

__all__ = ["FEModel", "Section", "SolidStress", "StiffnessSection", "StressModes", "circle",
           "frame", "hexahedral_block", "i_profile", "planar_beam", "rectangle", "solid_stress",
           "straight_beam", "tube"]
