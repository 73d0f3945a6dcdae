"""Chains of links: against the equations of a double pendulum, and with every way to solve them."""

from dataclasses import replace

import numpy as np
import pytest
from helpers import order
from scipy.integrate import solve_ivp

from sebody import Simulation, generalized_alpha, simulate
from sebody.scenes import chain

FINE = generalized_alpha(0.9, 1e-11)


def double_pendulum(t, inertia, field=9.81):
    """Ends of two rods of length and mass one, `inertia` about their middles, from Lagrange."""
    own, last = inertia + 0.25, inertia + 0.25 + 1.0     # of the second and first absolute angle

    def rate(_, y):
        a, b, u, w = y
        c, s = 0.5 * np.cos(a - b), 0.5 * np.sin(a - b)
        force = [-s * w * w - 1.5 * field * np.cos(a), s * u * u - 0.5 * field * np.cos(b)]
        return [u, w, *np.linalg.solve([[last, c], [c, own]], force)]
    a, b = solve_ivp(rate, (0.0, t[-1]), [0.0] * 4, t_eval=t, rtol=1e-11, atol=1e-12).y[:2]
    elbow = np.array([np.cos(a), np.sin(a), 0 * a]).T
    return elbow, elbow + np.array([np.cos(b), np.sin(b), 0 * b]).T


def test_two_stiff_links_are_a_double_pendulum_at_second_order(monkeypatch):
    stiff = replace(chain.SECTION, youngs_modulus=100 * chain.SECTION.youngs_modulus)
    monkeypatch.setattr(chain, "SECTION", stiff)
    inertia = 1.0 / 12.0 + stiff.inertia_z / stiff.area

    def error(h):
        result = simulate(chain.build(links=2, modes=0).model, h, 1.0, FINE)
        elbow, tip = double_pendulum(result.t, inertia)
        return max(np.abs(result["joint 1.position"] - elbow).max(),
                   np.abs(result["tip.position"] - tip).max())
    steps = (0.002, 0.001, 0.0005)
    errors = [error(h) for h in steps]
    assert 1.8 < order(steps, errors) < 2.2    # links bend a little
    assert errors[2] < 2e-5


@pytest.fixture(scope="module")
def falling():
    """Sixteen links: more unknowns than are solved for by an inverse."""
    return simulate(chain.build(links=16).model, 0.01, 1.0)


def test_axes_of_the_joints_stay_together(falling):
    for k in range(1, 16):
        left, right = falling[f"joint {k}.rotation"], falling[f"base {k + 1}.rotation"]
        assert np.abs(left[:, :, 2] - right[:, :, 2]).max() < 1e-9
    assert np.abs(falling["tip.position"][:, 2]).max() < 1e-9


def test_energy_is_kept(falling):
    turned = falling["energy.kinetic"].max()
    assert turned > 500.0                       # of 16 links of 3.12 kg
    assert falling.energy_balance() < 2e-3


def test_reused_matrices_change_nothing_but_time(falling):
    """Tight tolerance asks for many more matrices, and gives the same motion."""
    other = simulate(chain.build(links=16).model, 0.01, 1.0, FINE)
    assert np.abs(falling["tip.position"] - other["tip.position"]).max() < 1e-6


def test_cost_of_memory_is_that_of_the_output():
    thin = simulate(chain.build(links=4).model, 0.01, 1.0, output_every=20)
    full = simulate(chain.build(links=4).model, 0.01, 1.0)
    assert thin.rows.shape[0] == 6 and full.rows.shape[0] == 101
    assert np.array_equal(thin.rows[:, 3:], full.rows[::20, 3:])


@pytest.fixture(scope="module")
def long():
    return Simulation(chain.build(links=400).model, 0.01).run_to(0.5)


def test_kept_forces_and_mixed_corrections_change_nothing_but_time(long):
    exact = simulate(chain.build(links=400).model, 0.01, 0.5, FINE)
    for place in ("joint 5.position", "joint 100.position", "tip.position"):
        assert np.abs(long.result()[place] - exact[place]).max() < 1e-6, place


def test_iterations_hardly_grow_with_the_length(falling, long):
    assert long.result().iterations_per_step < 1.25 * falling.iterations_per_step
    assert long.state.moved.mean() < 0.5        # where the last iteration had anything to do
