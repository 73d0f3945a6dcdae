"""Flexible multibody dynamics with superelements (Cardona, 2000)."""

from typing import TYPE_CHECKING

from sebody.basics.lazy import load_on_demand

if TYPE_CHECKING:
    from sebody.basics.errors import (
        InputError,
        Interrupted,
        LimitWarning,
        SebodyError,
        SimulationError,
        WriteError,
    )
    from sebody.basics.version import __version__ as __version__
    from sebody.model.histories import with_corners
    from sebody.model.model import Model
    from sebody.model.profiles import harmonic, piecewise, ramp, rest_to_rest, spline, trapezoidal
    from sebody.model.surfaces import cylinder, plane, sphere
    from sebody.results.result import Result
    from sebody.runs.accuracy import simulate_within
    from sebody.runs.phased_simulation import PhasedSimulation
    from sebody.runs.schemes import generalized_alpha, hht
    from sebody.runs.simulation import Simulation
    from sebody.runs.tolerance import Tolerance
    from sebody.runs.whole_runs import simulate

__all__ = ["InputError", "Interrupted", "LimitWarning", "Model", "PhasedSimulation", "Result",
           "SebodyError", "Simulation", "SimulationError", "Tolerance", "WriteError", "cylinder",
           "generalized_alpha", "harmonic", "hht", "piecewise", "plane", "ramp", "rest_to_rest",
           "simulate", "simulate_within", "sphere", "spline", "trapezoidal", "with_corners"]

load_on_demand(__name__)
