"""Flexible multibody dynamics with superelements (Cardona, 2000)."""

from .accuracy import simulate_within
from .errors import InputError, LimitWarning, SebodyError, SimulationError
from .integrator import Simulation, generalized_alpha, hht, simulate
from .model import Model
from .results import Result
from .tolerance import Tolerance

__all__ = ["InputError", "LimitWarning", "Model", "Result", "SebodyError", "Simulation",
           "SimulationError", "Tolerance", "generalized_alpha", "hht", "simulate",
           "simulate_within"]
