"""Small finite element models: a stand-in for an FE program in examples and tests."""

from sebody.fem.beam import Section, frame, planar_beam, straight_beam
from sebody.fem.hexahedron import hexahedral_block
from sebody.fem.model import FEModel

__all__ = ["FEModel", "Section", "frame", "hexahedral_block", "planar_beam", "straight_beam"]
