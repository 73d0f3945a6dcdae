"""Flexible multibody dynamics with superelements (Cardona, 2000)."""

from .errors import InputError, SebodyError, SimulationError
from .integrator import Simulation, generalized_alpha, hht, simulate
from .model import Model
from .results import Result

__all__ = ["InputError", "Model", "Result", "SebodyError", "Simulation", "SimulationError",
           "generalized_alpha", "hht", "simulate"]
