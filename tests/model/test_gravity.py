"""Gravity from the reduced mass: free fall, a falling pendulum, work against the potential."""

from dataclasses import replace

import numpy as np
import pytest
from helpers import order
from scipy.integrate import solve_ivp

from sebody import InputError, Model, generalized_alpha, simulate
from sebody.fem import planar_beam, straight_beam
from sebody.reduction import craig_bampton
from sebody.scenes import chain
from sebody.scenes.hinged_beam import SECTION

FIELD = np.array([0.3, -9.81, 1.1])
END = np.array([60.0, 50.0, 20.0])


def free_beam(planar=False):
    """A beam that nothing holds."""
    d = 2 if planar else 3
    end = END[:d]
    fe_model = (planar_beam if planar else straight_beam)(np.zeros(d), end, SECTION, 8)
    model = Model(planar=planar)
    nodes = [model.node("base", np.zeros(d)), model.node("tip", end)]
    model.superelement("beam", craig_bampton(fe_model, [(0, "full"), (8, "full")], 4), nodes)
    model.gravity(FIELD[:d])
    return model


@pytest.mark.parametrize("planar", [False, True])
def test_free_fall_does_not_deform(planar):
    d = 2 if planar else 3
    result = simulate(free_beam(planar), 0.01, 1.0)
    fall = 0.5 * FIELD[:d] * result.t[:, None]**2
    assert np.abs(result["tip.position"] - END[:d] - fall).max() < 1e-9
    # deflections within the tolerance, 1e-8 of the increments, count with their square
    assert result["energy.strain"].max() < 1e-12 * result["energy.kinetic"].max()
    assert np.allclose(result["momentum"][:, :d],
                       SECTION.density * SECTION.area * np.linalg.norm(END[:d])
                       * result.t[:, None] * FIELD[:d], rtol=1e-9, atol=1e-9)


def test_turning_body_falls_on_a_parabola():
    """The centre of mass, half way between the ends of a stiff beam, feels gravity alone."""
    model = free_beam()
    model.rigid_velocity((1.0, 2.0, 3.0), (0.02, -0.01, 0.015))
    result = simulate(model, 0.01, 1.0)
    middle = (result["base.position"] + result["tip.position"]) / 2
    start = np.array([1.0, 2.0, 3.0]) + np.cross((0.02, -0.01, 0.015), END / 2)
    exact = END / 2 + start * result.t[:, None] + 0.5 * FIELD * result.t[:, None]**2
    assert np.abs(middle - exact).max() < 1e-3


def test_potential_is_that_of_the_centre_of_mass():
    result = simulate(free_beam(), 0.01, 0.5)
    mass = SECTION.density * SECTION.area * np.linalg.norm(END)
    middle = (result["base.position"] + result["tip.position"]) / 2
    # the reduced mass has the rounding of its condensation, EPS times a condition of 5e3
    assert np.allclose(result["energy.potential"], -mass * middle @ FIELD,
                       rtol=5e3 * np.finfo(float).eps)


def test_energy_balance_of_a_falling_pendulum_falls_with_the_square_of_the_step():
    def balance(h):
        scene = chain.build(links=1)
        return simulate(scene.model, h, 0.5, generalized_alpha(1.0, 1e-10)).energy_balance()
    steps = (0.004, 0.002, 0.001)
    assert order(steps, [balance(h) for h in steps]) > 1.8


def test_a_stiff_link_swings_like_a_rigid_body_at_second_order(monkeypatch):
    """Released from the horizontal; angle against the rigid body's own equation."""
    stiff = replace(chain.SECTION, youngs_modulus=100 * chain.SECTION.youngs_modulus)
    monkeypatch.setattr(chain, "SECTION", stiff)
    inertia = 1.0 / 3.0 + stiff.inertia_z / stiff.area       # of one kilogram, about the hinge

    def error(h):
        result = simulate(chain.build(links=1, modes=0).model, h, 1.5,
                          generalized_alpha(0.9, 1e-11))
        exact = solve_ivp(lambda t, y: [y[1], -0.5 * 9.81 * np.cos(y[0]) / inertia], (0, 1.5),
                          [0.0, 0.0], t_eval=result.t, rtol=1e-10, atol=1e-12).y[0]
        tip = result["tip.position"]
        return np.abs(np.unwrap(np.arctan2(tip[:, 1], tip[:, 0])) - exact).max()
    steps = (0.002, 0.001, 0.0005)
    errors = [error(h) for h in steps]
    assert 1.9 < order(steps, errors) < 2.1
    assert errors[2] < 2e-5


def test_bad_gravity_is_refused():
    with pytest.raises(InputError, match="gravity is .*: give 3 finite numbers"):
        Model().gravity((0.0, -9.81))
    with pytest.raises(InputError, match="gravity is .*: give 2 finite numbers"):
        Model(planar=True).gravity((0.0, np.nan))
