"""The deformation that a rigid body lacks."""

from sebody.analysis.advice.forms import Form, Part
from sebody.analysis.advice.indicators.carried import carried
from sebody.analysis.advice.indicators.recorded import Recorded


def rigidity(recorded: Recorded, part: Part, form: Form) -> float:
    """Error if a part is rigid: all of its recorded deformation."""
    return carried(recorded, part, *recorded.deformation(recorded.nodes(part))[:2])
