"""Many runs of one model with other numbers."""

from sebody.explore.ensembles.ensemble import Ensemble
from sebody.explore.ensembles.outcome import Outcome
from sebody.runs.outputs import (
    Output,
    at_time,
    final,
    integral,
    maximum,
    minimum,
    rms,
    soft_maximum,
)

__all__ = ["Ensemble", "Outcome", "Output", "at_time", "final", "integral", "maximum", "minimum",
           "rms", "soft_maximum"]
