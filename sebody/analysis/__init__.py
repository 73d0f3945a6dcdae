"""What a user runs: simulations, equilibria, small motion about a state, restarts."""

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
    "Linearization",
    "Modes",
    "Vibrations",
    "equilibrium",
    "linearize",
    "modes",
    "resume",
    "save_state",
    "spin_limit",
    "vibrations",
]
