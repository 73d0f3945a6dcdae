"""Predicted errors of forms of parts, from the recorded reference run; nothing here runs."""

from sebody.analysis.advice.forms import Form, Part
from sebody.analysis.advice.indicators.linearity import linearity
from sebody.analysis.advice.indicators.omission import omission
from sebody.analysis.advice.indicators.recorded import Recorded
from sebody.analysis.advice.indicators.rigidity import rigidity
from sebody.analysis.advice.indicators.stiffening import stiffening

INDICATORS = {"modes": omission, "division": linearity, "stiffening": stiffening}


def contributions(recorded: Recorded, part: Part, form: Form) -> dict[str, float]:
    """Relative errors of the quantities that a form makes, by indicator.

    What the richest form does, too, is no error: the reference has it.
    """
    if form.rigid:
        return {"rigid": rigidity(recorded, part)}
    found = {name: of(recorded, part, form) for name, of in INDICATORS.items()}
    return {name: error for name, error in found.items() if error > 0.0}
