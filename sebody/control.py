"""Ready control laws for `Model.controller`: PID, state feedback, filters, computed torque."""

from typing import TYPE_CHECKING

from sebody.basics.lazy import load_on_demand

if TYPE_CHECKING:
    from sebody.model.control.law import Law as Law
    from sebody.model.control.laws import (
        computed_torque as computed_torque,
        lookup as lookup,
        pid as pid,
        state_feedback as state_feedback,
    )
    from sebody.model.control.linear_systems import (
        discrete as discrete,
        linear as linear,
        low_pass as low_pass,
    )

load_on_demand(__name__)
