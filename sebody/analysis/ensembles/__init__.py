"""Many runs of one model with other numbers."""

from sebody.analysis.ensembles.ensemble import Ensemble
from sebody.analysis.ensembles.outcome import Outcome
from sebody.analysis.ensembles.outputs import (
    Output,
    at_time,
    final,
    integral,
    maximum,
    minimum,
    rms,
)

__all__ = ["Ensemble", "Outcome", "Output", "at_time", "final", "integral", "maximum", "minimum",
           "rms"]
