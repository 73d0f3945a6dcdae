"""Ready control laws for `Model.controller`: PID, state feedback, filters, computed torque."""

from typing import TYPE_CHECKING

from sebody.basics.lazy import load_on_demand

if TYPE_CHECKING:
    from sebody.model.control.law import Law
    from sebody.model.control.laws import computed_torque, lookup, pid, state_feedback
    from sebody.model.control.linear_systems import discrete, linear, low_pass

__all__ = ["Law", "computed_torque", "discrete", "linear", "lookup", "low_pass", "pid",
           "state_feedback"]

load_on_demand(__name__)
