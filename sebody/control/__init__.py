"""Ready control laws for `Model.controller`: PID, state feedback, filters, computed torque."""

from sebody.control.law import Law
from sebody.control.laws import (
    computed_torque,
    discrete,
    linear,
    lookup,
    low_pass,
    pid,
    state_feedback,
)

__all__ = ["Law", "computed_torque", "discrete", "linear", "lookup", "low_pass", "pid",
           "state_feedback"]
