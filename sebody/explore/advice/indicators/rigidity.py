"""The deformation that a rigid body lacks."""

from sebody.explore.advice.forms import Form, Part
from sebody.explore.advice.indicators.propagated import propagated
from sebody.explore.advice.indicators.recorded import Recorded
from sebody.explore.advice.indicators.vibration import first_frequency


def rigidity(recorded: Recorded, part: Part, form: Form) -> float:
    """Error if a part is rigid: all of its recorded deformation.

    Of a frequency: its square over that of the first frequency with a node held.
    """
    (_, body), *_ = recorded.bodies(part, 1)
    first = first_frequency(body)
    return max([propagated(recorded, part, *recorded.deformation(recorded.nodes(part))[:2]),
                *(min((omega / first)**2, 1.0) for omega in recorded.frequencies)])
