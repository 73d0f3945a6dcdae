"""From an FE model, or a whole model, to a superelement: reduced matrices, checks, frame weights.
"""

from typing import TYPE_CHECKING

from sebody.basics.lazy import load_on_demand

if TYPE_CHECKING:
    from sebody.explore.assemblies.reducing import reduce_model
    from sebody.reduction.accuracy import Accuracy
    from sebody.reduction.appendage import appendage
    from sebody.reduction.body import ReducedBody
    from sebody.reduction.component import ComponentModes
    from sebody.reduction.craig_bampton import component_modes, craig_bampton
    from sebody.reduction.grounded import grounded_body
    from sebody.reduction.interfaces import MeanFace, RigidFace
    from sebody.reduction.methods import free_frequencies, reduce
    from sebody.reduction.path_loads import PathLoads
    from sebody.reduction.self_weight import grounded_from_fe, self_weight_stiffness
    from sebody.reduction.weights import body_weights, frame_weights

__all__ = [
    "Accuracy",
    "ComponentModes",
    "MeanFace",
    "PathLoads",
    "ReducedBody",
    "RigidFace",
    "appendage",
    "body_weights",
    "component_modes",
    "craig_bampton",
    "frame_weights",
    "free_frequencies",
    "grounded_body",
    "grounded_from_fe",
    "reduce",
    "reduce_model",
    "self_weight_stiffness",
]

load_on_demand(__name__)
