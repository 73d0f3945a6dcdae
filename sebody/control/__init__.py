"""Ready control laws for `Model.controller`: PID, state feedback, filters, computed torque."""

from sebody.control.law import Law
from sebody.control.laws import computed_torque, lookup, pid, state_feedback
from sebody.control.linear_systems import discrete, linear, low_pass

__all__ = ["Law", "computed_torque", "discrete", "linear", "lookup", "low_pass", "pid",
           "state_feedback"]
