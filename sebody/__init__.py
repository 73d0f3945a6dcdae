"""Flexible multibody dynamics with superelements (Cardona, 2000)."""

from typing import TYPE_CHECKING

from sebody.basics.lazy import load_on_demand

if TYPE_CHECKING:
    from sebody.basics.errors import (
        InputError as InputError,
        Interrupted as Interrupted,
        LimitWarning as LimitWarning,
        SebodyError as SebodyError,
        SimulationError as SimulationError,
        WriteError as WriteError,
    )
    from sebody.basics.version import __version__ as __version__
    from sebody.model.histories import with_corners as with_corners
    from sebody.model.model import Model as Model
    from sebody.model.profiles import (
        harmonic as harmonic,
        piecewise as piecewise,
        ramp as ramp,
        rest_to_rest as rest_to_rest,
        spline as spline,
        trapezoidal as trapezoidal,
    )
    from sebody.model.surfaces import cylinder as cylinder, plane as plane, sphere as sphere
    from sebody.results.result import Result as Result
    from sebody.runs.accuracy import simulate_within as simulate_within
    from sebody.runs.phased_simulation import PhasedSimulation as PhasedSimulation
    from sebody.runs.schemes import generalized_alpha as generalized_alpha, hht as hht
    from sebody.runs.simulation import Simulation as Simulation
    from sebody.runs.tolerance import Tolerance as Tolerance
    from sebody.runs.whole_runs import simulate as simulate

load_on_demand(__name__)
