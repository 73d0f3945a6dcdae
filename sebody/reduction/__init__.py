"""From an FE model, or a whole model, to a superelement: reduced matrices, checks, frame weights.
"""

from typing import TYPE_CHECKING

from sebody.basics.lazy import load_on_demand

if TYPE_CHECKING:
    from sebody.explore.assemblies.reducing import reduce_model as reduce_model
    from sebody.reduction.accuracy import Accuracy as Accuracy
    from sebody.reduction.appendage import appendage as appendage
    from sebody.reduction.body import ReducedBody as ReducedBody
    from sebody.reduction.component import ComponentModes as ComponentModes
    from sebody.reduction.craig_bampton import (
        component_modes as component_modes,
        craig_bampton as craig_bampton,
    )
    from sebody.reduction.grounded import grounded_body as grounded_body
    from sebody.reduction.interfaces import MeanFace as MeanFace, RigidFace as RigidFace
    from sebody.reduction.methods import free_frequencies as free_frequencies, reduce as reduce
    from sebody.reduction.path_loads import PathLoads as PathLoads
    from sebody.reduction.self_weight import (
        grounded_from_fe as grounded_from_fe,
        self_weight_stiffness as self_weight_stiffness,
    )
    from sebody.reduction.weights import (
        body_weights as body_weights,
        frame_weights as frame_weights,
    )

load_on_demand(__name__)
