"""What a user runs: simulations, equilibria, small motion about a state, restarts."""

from typing import TYPE_CHECKING

from sebody.lazy import load_on_demand

if TYPE_CHECKING:
    from sebody.analysis.advice import Advice, Unreached, advise
    from sebody.analysis.campbell import Campbell, campbell
    from sebody.analysis.ensembles import (
        Ensemble,
        Outcome,
        Output,
        at_time,
        final,
        integral,
        maximum,
        minimum,
        rms,
    )
    from sebody.analysis.frequency import FrequencyResponse, frequency_response
    from sebody.analysis.limits import spin_limit
    from sebody.analysis.linearization import (
        Linearization,
        Modes,
        Vibrations,
        linearize,
        modes,
        vibrations,
    )
    from sebody.analysis.restart import resume, save_state
    from sebody.analysis.statics import equilibrium

__all__ = [
    "Advice",
    "Campbell",
    "Ensemble",
    "FrequencyResponse",
    "Linearization",
    "Modes",
    "Outcome",
    "Output",
    "Unreached",
    "Vibrations",
    "advise",
    "at_time",
    "campbell",
    "equilibrium",
    "final",
    "frequency_response",
    "integral",
    "linearize",
    "maximum",
    "minimum",
    "modes",
    "resume",
    "rms",
    "save_state",
    "spin_limit",
    "vibrations",
]

load_on_demand(__name__)
