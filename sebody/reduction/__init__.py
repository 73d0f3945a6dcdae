"""From an FE model to a superelement: reduced matrices, their checks and frame weights."""

from sebody.reduction.body import ReducedBody
from sebody.reduction.boundary import RigidFace
from sebody.reduction.craig_bampton import ComponentModes, component_modes, craig_bampton
from sebody.reduction.weights import body_weights, frame_weights

__all__ = [
    "ComponentModes",
    "ReducedBody",
    "RigidFace",
    "body_weights",
    "component_modes",
    "craig_bampton",
    "frame_weights",
]
