"""Ready control laws for `Model.controller`: PID, state feedback, filters, computed torque."""

from sebody.model.control.law import Law
from sebody.model.control.laws import computed_torque, lookup, pid, state_feedback
from sebody.model.control.linear_systems import discrete, linear, low_pass

__all__ = ["Law", "computed_torque", "discrete", "linear", "lookup", "low_pass", "pid",
           "state_feedback"]
