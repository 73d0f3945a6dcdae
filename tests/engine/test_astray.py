"""Steps that are too long do not converge far from where the motion leads."""

import numpy as np
import pytest

from sebody import Model, simulate
from sebody.engine.newton import strayed
from sebody.engine.state import GAP
from sebody.fem import rectangle
from sebody.runs.failures import explained
from sebody.runs.simulation import Simulation

MODULUS, HEIGHT, WIDTH, LENGTH = 2.1e11, 0.01, 0.02, 1.0
TURN = 0.4


def _clamped(load: float, modes: int) -> Model:
    """A clamped steel beam of eight stiffening bodies, loaded at once, turned in the plane."""
    along, across = np.array([np.cos(TURN), np.sin(TURN)]), np.array([-np.sin(TURN), np.cos(TURN)])
    model = Model(planar=True)
    root = model.node("root", (3.0, -1.0))
    tip = model.node("tip", root.point + LENGTH * along)
    model.beam("beam", (root, tip), rectangle(HEIGHT, WIDTH, MODULUS, 0.3, 7800.0), elements=24,
               bodies=8, modes=modes, inertia="floating_field", stiffening=True)
    model.fix(root)
    model.force(tip, -load * across)
    return model


@pytest.mark.filterwarnings("ignore::sebody.LimitWarning")     # of steps that are too long
@pytest.mark.parametrize("h", [0.01, 0.005])
@pytest.mark.parametrize("modes", [0, 2])
def test_a_load_at_once_bends_a_stiff_beam_twice_as_far_as_at_rest(h, modes):
    """Its first period is 0.12 s; axial waves have 0.7 ms, on which the iteration went astray."""
    load = 100.0
    result = simulate(_clamped(load, modes), h, 0.3)
    across = np.array([-np.sin(TURN), np.cos(TURN)])
    stiffness = 3.0 * MODULUS * WIDTH * HEIGHT**3 / 12.0 / LENGTH**3
    shift = -(result["tip.position"] - result["tip.position"][0]) @ across
    # all of the load is not in the first mode, bending is not quite linear, steps are long
    assert shift.max() == pytest.approx(2.0 * load / stiffness, rel=0.05)
    assert shift.min() > -0.05 * shift.max()


@pytest.mark.parametrize(("share", "far"), [(0.45, False), (-0.55, True)])
def test_steps_that_end_half_a_size_from_where_their_rates_led_have_strayed(share, far):
    """A change of an acceleration by ``1 / (beta h^2)`` moves its coordinate by one."""
    simulation = Simulation(_clamped(100.0, 2), 0.01)
    system, state, scheme = simulation.system, simulation.state, simulation.scheme
    i, state.clock.current_step = int(np.argmax(system.magnitude)), 0.01
    state.aux[i] = state.aux_old[i] + share * system.magnitude[i] / (scheme.beta * 0.01**2)
    assert bool(strayed(system, state, scheme)) == far


@pytest.mark.parametrize("mass", [True, False])
def test_only_what_moves_no_mass_is_said_to_move_none(mass):
    simulation = Simulation(_clamped(100.0, 2), 0.01)
    system, state, numbering = simulation.system, simulation.state, simulation.numbering
    worst = numbering.names.index("mode 0 of beam 2")
    state.residual[:] = 0.0
    state.residual[worst] = 1e30
    state.control.reason = GAP
    if not mass:
        system.inertias[worst] = 0.0
    told = explained(simulation.model, system, state, numbering)
    assert ("which moves no mass" in told) is not mass
    assert ("Newton's iteration did not converge" in told) is mass
    assert "mode 0 of beam 2" in told or mass
