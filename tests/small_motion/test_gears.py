"""Small motion of gears: teeth that carry no load have their stiffness; what softens is said."""

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.spatial.transform import Rotation

from sebody import Model, Simulation, simulate
from sebody.analysis import equilibrium, frequency_response, linearize, state_space, vibrations
from sebody.basics.errors import LimitWarning

TURN = Rotation.from_rotvec((0.4, -0.9, 0.3)).as_matrix()
INERTIAS, SHAFTS, RATIO = (2.0, 0.5, 1.5, 8.0), (4e3, 9e3), 3.0
M = np.diag([2.0, 0.5 + 1.5 / 9, 8.0])      # stiff teeth, angles of the first, second and last
K = np.array([[4e3, -4e3, 0.0], [-4e3, 4e3 + 1e3, -3e3], [0.0, -3e3, 9e3]])


def train(stiffness=1e9, planar=False, ratio=RATIO, **teeth):
    """Two inertias on a shaft, a gear, two inertias on another one."""
    model = Model(planar=planar)
    for k, J in enumerate(INERTIAS, 1):
        place = (float(k), 0.0) if planar else TURN @ (float(k), 0.0, 0.0)
        model.node(f"n{k}", place)
        model.rigid_body(f"b{k}", f"n{k}", 1.0, J if planar else TURN @ np.diag(
            (0.8 * J, 0.9 * J, J)) @ TURN.T)
        model.revolute(f"n{k}", **({} if planar else {"axis": TURN[:, 2]}), name=f"j{k}")
    for (a, b), k in zip(((1, 2), (3, 4)), SHAFTS, strict=True):
        model.torsion_spring(f"n{a}", k, to=f"n{b}")
    model.gear("j2", "j3", ratio=ratio, stiffness=stiffness, name="gear", **teeth)
    model.torque("n1", 1.0 if planar else TURN[:, 2], 0.0, name="motor")
    return model


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("planar", [False, True])
def test_teeth_without_load_hold(planar):
    """Frequencies, response and state space against three inertias and stiff teeth."""
    run = Simulation(train(planar=planar), 1e-4)
    assert linearize(run).contacts == {"gear": "presses"}
    exact = np.sqrt(np.maximum(eigh(K, M, eigvals_only=True), 0.0))
    omega = vibrations(run, 3).omega
    assert omega[1:] == pytest.approx((35.8436, 96.6449), rel=2e-6)
    assert omega == pytest.approx(exact, rel=1e-6, abs=1e-2)
    w = 30.0
    last = np.linalg.solve(K - w**2 * M, (1.0, 0.0, 0.0))[2]
    assert last == pytest.approx(-3.849e-4, rel=1e-4)
    angle = "n4.rotation" if planar else "j4.angle"
    found = frequency_response(run, "motor", angle, [w])[angle]
    assert np.ravel(found) == pytest.approx(last, rel=1e-5)
    system = state_space(run, ["motor"], [angle])
    assert system.response([w])[0, 0, 0] == pytest.approx(last, rel=1e-5)


def test_the_side_that_presses_makes_no_difference():
    """At rest as under a load of either sign, from an equilibrium."""
    def held(load):
        model = train(planar=True)
        model.torsion_spring("n4", 1e3, name="holds")
        model.torque("n1", 1.0, load, name="pull")
        return model
    alone = vibrations(Simulation(held(0.0), 1e-4)).omega
    for load in (50.0, -50.0):
        still = equilibrium(held(load), 1)
        assert linearize(still).contacts == {"gear": "presses"}
        assert vibrations(still).omega == pytest.approx(alone, rel=1e-6)


def test_play_is_open():
    """Inside its backlash a gear has no teeth, and `contacts` says so."""
    run = Simulation(train(backlash=0.01), 1e-4)
    assert linearize(run).contacts == {"gear": "open"}
    apart = [np.sqrt(k * (1 / a + 1 / b)) for k, (a, b) in zip(
        SHAFTS, (INERTIAS[:2], INERTIAS[2:]), strict=True)]
    assert vibrations(run).omega[2:] == pytest.approx(sorted(apart), rel=1e-9)
    stop = train()
    stop.stop("j1", upper=1.0, stiffness=1e4, exponent=1.0, name="end")
    assert linearize(Simulation(stop, 1e-4)).contacts == {"gear": "presses", "end": "open"}


def test_teeth_without_stiffness_at_rest_are_named():
    run = Simulation(train(exponent=1.5), 1e-4)
    with pytest.warns(LimitWarning, match="teeth of 'gear' carry no load, and with exponent 1.5 "
                                          "they have no stiffness without one"):
        linearize(run)


def test_default_teeth_that_soften_shafts_are_named():
    """By as much as the frequency is lower than with stiff teeth; not where they are stiff enough.
    """
    soft = vibrations(Simulation(train(None), 1e-3)).omega[1]
    percent = 100 * (1 - soft / np.sqrt(eigh(K, M, eigvals_only=True)[1]))
    assert 7.0 < percent < 7.5
    with pytest.warns(LimitWarning, match="stiffness of the teeth of 'gear' was not given and is "
                      r"what steps of 0.001 follow: it lowers the frequency 35.84 .* by 7.1 %; "
                      "give stiffness=, or shorter steps"):
        vibrations(Simulation(train(None), 1e-3))
    for model, h, said in ((train(None, backlash=0.01), 1e-3, 1), (train(None), 1e-4, 0),
                           (train(1e9), 1e-3, 0)):
        run = Simulation(model, h).run_to(2 * h)
        assert len([one for one in run.result().warnings if "shorter steps" in one]) == said


def test_a_motion_begins_without_a_blow():
    """Steps of teeth without play and load are those of a linear spring."""
    result = simulate(train(1e6, planar=True), 1e-3, 0.05)
    assert result.cuts == 0 and not result["gear.normal_force"].any()
