"""Names that a user runs: simulations, equilibria, small motion about a state, restarts."""

from typing import TYPE_CHECKING

from sebody.basics.lazy import load_on_demand

if TYPE_CHECKING:
    from sebody.explore.advice import Advice, Unreached, advise
    from sebody.explore.ensembles import (
        Ensemble,
        Outcome,
        Output,
        at_time,
        final,
        integral,
        maximum,
        minimum,
        rms,
        soft_maximum,
    )
    from sebody.explore.ensembles.gradients import Gradients, gradients
    from sebody.explore.sizing import Sizing, size_heights
    from sebody.explore.sizing.height_stresses import BeamStress
    from sebody.gradients.calibration import Calibration, calibrate
    from sebody.gradients.contributions import contributions
    from sebody.gradients.designs import Design, sections
    from sebody.gradients.functions import ValueAndGradient
    from sebody.gradients.gradient import Gradient, gradient
    from sebody.gradients.ranking import Contribution, Contributions
    from sebody.runs.limits.watch import spin_limit
    from sebody.runs.restart import resume, save_state
    from sebody.runs.statics import equilibrium
    from sebody.small_motion.campbell import Campbell, campbell
    from sebody.small_motion.critical_speeds import critical_speeds
    from sebody.small_motion.crossings import Crossings
    from sebody.small_motion.energy_gain import EnergyGain, energy_gain
    from sebody.small_motion.frequency import FrequencyResponse, frequency_response
    from sebody.small_motion.linearization import (
        Linearization,
        Modes,
        Vibrations,
        linearize,
        modes,
        vibrations,
    )
    from sebody.small_motion.participation import EffectiveMasses, effective_masses
    from sebody.small_motion.random_vibration import RandomResponse, random_response
    from sebody.small_motion.shock import ShockSpectrum, combined, shock_spectrum
    from sebody.small_motion.state_space import StateSpace, state_space
    from sebody.small_motion.synchronous import SynchronousResponse, synchronous_response

__all__ = [
    "Advice",
    "BeamStress",
    "Calibration",
    "Campbell",
    "Contribution",
    "Contributions",
    "Crossings",
    "Design",
    "EffectiveMasses",
    "EnergyGain",
    "Ensemble",
    "FrequencyResponse",
    "Gradient",
    "Gradients",
    "Linearization",
    "Modes",
    "Outcome",
    "Output",
    "RandomResponse",
    "ShockSpectrum",
    "Sizing",
    "StateSpace",
    "SynchronousResponse",
    "Unreached",
    "ValueAndGradient",
    "Vibrations",
    "advise",
    "at_time",
    "calibrate",
    "campbell",
    "combined",
    "contributions",
    "critical_speeds",
    "effective_masses",
    "energy_gain",
    "equilibrium",
    "final",
    "frequency_response",
    "gradient",
    "gradients",
    "integral",
    "linearize",
    "maximum",
    "minimum",
    "modes",
    "random_response",
    "resume",
    "rms",
    "save_state",
    "sections",
    "shock_spectrum",
    "size_heights",
    "soft_maximum",
    "spin_limit",
    "state_space",
    "synchronous_response",
    "vibrations",
]

load_on_demand(__name__)
