"""Names that a user runs: simulations, equilibria, small motion about a state, restarts."""

from typing import TYPE_CHECKING

from sebody.basics.lazy import load_on_demand

if TYPE_CHECKING:
    from sebody.explore.advice import Advice as Advice, Unreached as Unreached, advise as advise
    from sebody.explore.ensembles import (
        Ensemble as Ensemble,
        Outcome as Outcome,
        Output as Output,
        at_time as at_time,
        final as final,
        integral as integral,
        maximum as maximum,
        minimum as minimum,
        rms as rms,
        soft_maximum as soft_maximum,
    )
    from sebody.explore.ensembles.gradients import Gradients as Gradients, gradients as gradients
    from sebody.explore.sizing import Sizing as Sizing, size_heights as size_heights
    from sebody.explore.sizing.height_stresses import BeamStress as BeamStress
    from sebody.gradients.calibration import Calibration as Calibration, calibrate as calibrate
    from sebody.gradients.contributions import contributions as contributions
    from sebody.gradients.designs import Design as Design, sections as sections
    from sebody.gradients.functions import ValueAndGradient as ValueAndGradient
    from sebody.gradients.gradient import Gradient as Gradient, gradient as gradient
    from sebody.gradients.ranking import (
        Contribution as Contribution,
        Contributions as Contributions,
    )
    from sebody.runs.limits.watch import spin_limit as spin_limit
    from sebody.runs.restart import resume as resume, save_state as save_state
    from sebody.runs.statics import equilibrium as equilibrium
    from sebody.small_motion.campbell import Campbell as Campbell, campbell as campbell
    from sebody.small_motion.critical_speeds import critical_speeds as critical_speeds
    from sebody.small_motion.crossings import Crossings as Crossings
    from sebody.small_motion.energy_gain import EnergyGain as EnergyGain, energy_gain as energy_gain
    from sebody.small_motion.frequency import (
        FrequencyResponse as FrequencyResponse,
        frequency_response as frequency_response,
    )
    from sebody.small_motion.linearization import (
        Linearization as Linearization,
        Modes as Modes,
        Vibrations as Vibrations,
        linearize as linearize,
        modes as modes,
        vibrations as vibrations,
    )
    from sebody.small_motion.participation import (
        EffectiveMasses as EffectiveMasses,
        effective_masses as effective_masses,
    )
    from sebody.small_motion.random_vibration import (
        RandomResponse as RandomResponse,
        random_response as random_response,
    )
    from sebody.small_motion.shock import (
        ShockSpectrum as ShockSpectrum,
        combined as combined,
        shock_spectrum as shock_spectrum,
    )
    from sebody.small_motion.state_space import StateSpace as StateSpace, state_space as state_space
    from sebody.small_motion.synchronous import (
        SynchronousResponse as SynchronousResponse,
        synchronous_response as synchronous_response,
    )

load_on_demand(__name__)
