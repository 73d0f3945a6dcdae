"""What energy runs will gain: the theory, struck frames, warnings that name a step."""

import re
import warnings
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation
from struck_frames import (
    OVER,
    Struck,
    at_random,
    cross,
    energies,
    ring,
    t_frame,
    vibration,
)

from sebody import InputError, LimitWarning, Model, generalized_alpha, simulate
from sebody.analysis import energy_gain
from sebody.runs.limits.quality import increase

BLOW = [(0, 0), (0.003, 2.0), (0.008, -0.5), (0.01, 0)]
WALLS = np.array([(-1.0, 0.0, 0.2), (2.0, 0.3, 0.0), (0.4, 1.0, -0.7)])
PLACES = np.array([(0.1, 0.2, 0.1), (0.8, -0.1, 0.3)])
SPEEDS = np.array([(0.3, -0.8, 0.5), (-0.5, 0.6, 0.2)])
MASSES = np.array([1.0, 3.0])
# between points 0, 1 and walls 2 to 4: ends, stiffness, length without force
SPRINGS = [*((point, 2 + k, 20.0 * (1 + k), 0.6) for point in (0, 1) for k in range(3)),
           (0, 1, 40.0, 0.3)]


def net():
    """Two point masses on springs that stretch and turn far; the mass matrix is constant."""
    model = Model()
    places = np.vstack([PLACES, WALLS])
    nodes = [model.node(f"p{k}", place, "translation") for k, place in enumerate(places)]
    for wall in nodes[2:]:
        model.fix(wall, "position")
    for k in (0, 1):
        model.point_mass(f"m{k}", nodes[k], MASSES[k])
        model.initial_velocity(nodes[k], SPEEDS[k])
    for n, (start, end, stiffness, length) in enumerate(SPRINGS):
        model.spring(nodes[start], nodes[end], stiffness, length=length, name=f"s{n}")
    return model


def curvature(x, v):
    """v . K v of the springs, K the Hessian of their energy."""
    total = 0.0
    x, v = np.vstack([x, WALLS]), np.vstack([v, 0 * WALLS])
    for start, end, stiffness, length in SPRINGS:
        reach, rate = x[start] - x[end], v[start] - v[end]
        along = reach @ rate / np.linalg.norm(reach)
        share = length / np.linalg.norm(reach)
        total += stiffness * (along**2 + (1 - share) * (rate @ rate - along**2))
    return total


def test_the_trapezoidal_rule_keeps_an_energy_of_its_own():
    """H + h^2/12 (v . K v + a . M a) to the fourth order in h, H itself to the second."""
    ranges = []
    for h in (5e-3, 2.5e-3):
        run = simulate(net(), h, 3.0, generalized_alpha(1.0))
        x, v, a = (np.stack([run[f"p{k}.{what}"] for k in (0, 1)], axis=1)
                   for what in ("position", "velocity", "acceleration"))
        Q = (np.einsum("p,tpi,tpi->t", MASSES, a, a)
             + [curvature(*at) for at in zip(x, v, strict=True)])
        H = run["energy.kinetic"] + run["energy.strain"]
        ranges.append((np.ptp(H), np.ptp(H + h**2 / 12 * Q)))
    (coarse, own_coarse), (fine, own_fine) = ranges
    assert 3.6 < coarse / fine < 4.4
    assert 13.0 < own_coarse / own_fine < 20.0
    assert own_fine < 0.01 * fine


@pytest.mark.parametrize("tilt", [0.0, 2.1])
def test_a_single_oscillator(tilt):
    """Energy and frequency of what a load leaves, beside an integration by SciPy."""
    model, along = Model(planar=True), np.array([np.cos(tilt), np.sin(tilt)])
    wall, node = (model.node(*at, "translation") for at in (("wall", -along), ("mass", along)))
    model.fix(wall, "position")
    model.point_mass("mass", node, 2.0)
    model.spring(wall, node, 300.0)
    model.force(node, 30.0 * along, BLOW)
    found = energy_gain(model, 0.02)
    times, values = zip(*BLOW, strict=True)
    moved = solve_ivp(lambda t, y: [y[1], 15.0 * np.interp(t, times, values) - 150.0 * y[0]],
                      (0, 0.02), [0, 0], rtol=1e-10, atol=1e-14, max_step=1e-3).y[:, -1]
    assert_allclose(found.energy, moved[1]**2 + 150.0 * moved[0]**2, rtol=1e-6)
    assert_allclose(found.omega**2, 150.0)
    assert_allclose(found.at(0.01), 150.0 * 1e-4 / 6)
    assert_allclose(found.at(found.step(3e-4)), 3e-4)


@pytest.mark.parametrize(("struck", "step"), [
    (cross(), 1e-3), (t_frame(), 5e-4), (ring(), 1e-3), (at_random(10), 1e-3),
    (at_random(6), 5e-4), (at_random(12), 1e-3)])
def test_struck_frames_gain_what_is_predicted(struck, step):
    """Up to twice as much within the linear range; the energy is that of nonlinear beams."""
    size, found = vibration(struck), energy_gain(struck.model(), OVER)
    assert 0.9 < found.energy / size < 1.45
    run = energies(struck.model(), step, size, 0.6)
    assert run.gain < 2.0 * found.at(step)
    assert max(run.gain, run.loss) > 0.1 * found.at(step)


def test_the_prediction_knows_neither_place_nor_units():
    """The same T turned, elsewhere, in mm, t and s, with its nodes in another order."""
    struck, there = t_frame(4), Rotation.from_rotvec([0.5, 1.1, -0.3]).as_matrix()
    forces = struck.blows()
    order = [2, 0, 1]
    moved = Struck(
        1e3 * (struck.points @ there.T + [3.0, -2.0, 1.0]), struck.members,
        [struck.kept[k] for k in order], 4,
        replace(struck.section, area=1e2, inertia_y=8e2, inertia_z=8e2, torsion=1.6e3,
                                youngs_modulus=7e4, density=2.7e-9),
        tuple(there @ struck.spin), forces[order] @ there.T)
    here, elsewhere = (energy_gain(one.model(), OVER) for one in (struck, moved))
    assert_allclose(elsewhere.omega, here.omega, rtol=1e-6)
    assert_allclose(elsewhere.energy, 1e3 * here.energy, rtol=1e-6)


def test_a_run_says_below_which_step_energy_stays():
    def run(step):
        with warnings.catch_warnings(record=True) as told:
            warnings.simplefilter("always", LimitWarning)
            simulate(cross().model(), step, 0.6)
        return [said for one in told if (said := str(one.message)).startswith("energy")]
    message, = run(1e-3)
    assert message.startswith("energy grows by 0.004")
    assert "energy_gain predicts it" in message
    step = float(re.search(r"below a step of (\S+) the gain", message)[1])
    assert 3e-4 < step < 7e-4
    assert run(0.6 / np.ceil(0.6 / (0.8 * step))) == []


def test_gain_counts_from_where_work_ended():
    work = np.array([0.0, 1.0, 3.0, 3.0, 3.0, 3.0, 4.0])
    energy = np.array([5.0, 6.0, 8.5, 8.1, 8.4, 8.9, 30.0])
    assert increase(energy, work, from_lowest=False) == pytest.approx(0.4)
    assert increase(energy, work) == pytest.approx(0.8)


def test_what_cannot_be_predicted_is_refused():
    with pytest.raises(InputError, match=r"until.*0\.0"):
        energy_gain(cross(0).model(), 0.0)
    with pytest.raises(InputError, match="give a sebody.Model"):
        energy_gain(cross(0), 0.01)
    still = t_frame(0)._replace(spin=(0.0, 0.0, 0.0), forces=np.zeros((3, 3)))
    with pytest.raises(InputError, match="nothing vibrates at t = 0.01: give the model loads"):
        energy_gain(still.model(), 0.01)
