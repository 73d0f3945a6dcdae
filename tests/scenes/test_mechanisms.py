"""Mechanisms against equations of their own: four-bars, squeezer, slider-crank, spin-up."""

import numpy as np
import pytest
from helpers import order
from scipy.integrate import solve_ivp

from sebody import Model, Simulation, generalized_alpha, simulate
from sebody.fem import planar_beam
from sebody.reduction.craig_bampton import component_modes
from sebody.scenes import four_bar, heavy_top, slider_crank, spin_up, squeezer, torque_free_body
from sebody.verify.outside.n_four_bar import rocker
from sebody.verify.outside.squeezer import CASE as SQUEEZED

UNDAMPED = generalized_alpha(1.0, 1e-10)


@pytest.mark.parametrize("loops", [2, 20])
def test_four_bars_at_ten_seconds(loops):
    """Through the flat configuration again and again; order 2 in place and velocity.

    What Newton's iteration leaves grows there by three orders: with 1e-8 to 7e-6, as much as steps
    of 2e-3 err by. So the order is that of longer steps and a sharper iteration.
    """
    angle, rate = rocker(np.array([10.0]), loops)[:, -1]
    place = np.array([np.cos(angle), np.sin(angle)])

    def errors(h, scheme):
        result = simulate(four_bar.build(loops).model, h, 10.0, scheme)
        assert result.numbering.free == 2 * loops + 1 + 2 * loops
        return (np.abs(result["B0.position"][-1] - place).max(),
                np.abs(result["B0.velocity"][-1] - rate * np.array([-place[1], place[0]])).max())

    steps = 8e-3, 4e-3, 2e-3
    places, rates = zip(*(errors(h, generalized_alpha(tolerance=1e-9)) for h in steps), strict=True)
    assert 1.85 < order(steps, places) < 2.15
    assert 1.85 < order(steps, rates) < 2.15
    place_error, rate_error = errors(5e-4, generalized_alpha())
    assert place_error < 5e-6 and rate_error < 5e-5


def test_velocities_that_follow_from_the_given_one():
    run = Simulation(four_bar.build(2).model, 2.5e-4)
    assert set(run.start.changed) == {"ground 1.rotation", "ground 2.rotation"}


def spatial_four_bar():
    """The same loop in space with four revolutes: three of its twelve equations are redundant."""
    model = Model()
    model.gravity((0.0, -9.81, 0.0))
    rod = (1.0 / 12.0, 1e-3, 1.0 / 12.0)
    for k in range(2):
        foot = model.node(f"ground {k}", (k, 0.0, 0.0))
        model.rigid_body(f"rocker {k}", foot, 1.0, rod, centre=(k, 0.5, 0.0))
        model.revolute(foot)
        model.attach(f"B{k}", (k, 1.0, 0.0), foot)
    left = model.node("coupler", (0.0, 1.0, 0.0), at="B0")
    model.rigid_body("coupler", left, 1.0, (1e-3, 1.0 / 12.0, 1.0 / 12.0), centre=(0.5, 1.0, 0.0))
    model.revolute("B0", to=left)
    right = model.attach("end", (1.0, 1.0, 0.0), left)
    model.revolute(right, to="B1", explicit=True)
    model.initial_velocity("ground 0", angular=(0.0, 0.0, -1.0))
    return model


def test_redundant_constraints_of_a_spatial_four_bar():
    """The motion is that of the plane; multipliers of least norm, and the run says so."""
    run = Simulation(spatial_four_bar(), 1e-3)
    assert run.start.redundant
    result = run.run_to(3.0).result()
    assert "redundant            constraints of " in result.summary()
    flat = simulate(four_bar.build(1).model, 1e-3, 3.0)
    assert np.abs(result["B0.position"][:, :2] - flat["B0.position"]).max() < 1e-4
    assert np.abs(result["B0.position"][:, 2]).max() < 1e-9
    assert result["constraints.position"].max() < 1e-9
    assert np.isfinite(result.rows).all()


def test_squeezer_against_the_test_set():
    """IVP test set, PSIDE at 1e-14: initial accelerations, angles and speeds at 0.03 s."""
    run = Simulation(squeezer.build().model, 1e-5)
    crank, link = (run.state.a[run.numbering.dof_blocks[run.model.nodes[n].rotation]]
                   for n in ("crank", "link"))
    # printed to 18 digits; solved for with a condition of 3e4 in units of the model
    assert crank == pytest.approx(14222.4439199541138706, rel=1e-10)
    assert link - crank == pytest.approx(-10666.8329399655854029, rel=1e-10)
    steps, errors, speeds = (2e-5, 1e-5, 5e-6), [], []
    for h in steps:
        found = SQUEEZED.measure(1e-6 / h, True)
        for worst, group in ((errors, "angles"), (speeds, "rates")):
            worst.append(max(one.difference(found[one.name]) for one in SQUEEZED.quantities
                             if one.group == group))
    assert errors[-1] < 1e-5 and speeds[-1] < 1e-4
    assert 1.7 < order(steps, errors) < 2.6


def deflections(bodies, modes, inertia=None):
    """Middle of the rod off the line from pin to slider, by the length of the rod."""
    scene = slider_crank.build(bodies, modes, inertia=inertia)
    result = simulate(scene.model, scene.h, scene.t_end)
    pin, slider = result["pin.position"], result["slider.position"]
    along = (slider - pin) / np.linalg.norm(slider - pin, axis=1)[:, None]
    normal = np.column_stack([-along[:, 1], along[:, 0]])
    if bodies == 1:
        return shape_of_the_middle(result, scene.model.bodies["rod"], along)
    middle = result[f"rod {bodies // 2}.position"]
    return ((middle - pin) * normal).sum(axis=1) / slider_crank.LENGTH


def shape_of_the_middle(result, body, along):
    """The finite element model's own shapes give what is inside a superelement."""
    n = slider_crank.ELEMENTS
    fe_model = planar_beam(body.nodes[0].point, body.nodes[1].point, slider_crank.SECTION, n)
    ends = np.concatenate([fe_model.dofs(k, what) for what in ("translation", "rotation")
                           for k in (0, n)])
    shapes = component_modes(fe_model.stiffness, fe_model.mass, ends, body.reduced.modes).basis
    row = shapes[fe_model.dofs(n // 2, "translation")[1]]
    chord = np.unwrap(np.arctan2(along[:, 1], along[:, 0]))
    turned = [result[f"{node}.rotation"] - chord for node in ("pin", "slider")]
    coordinates = np.column_stack([np.zeros((len(chord), 4)), *turned, result["rod.modes"]])
    return coordinates @ row / slider_crank.LENGTH


def linear_rod(t_end, dropped=0.0):
    """Chord frame, sine modes, no stiffening: what one linear body shows.

    Options A and B interpolate the velocity of the body from that of its boundary and drop
    ``Omega_0 x u`` of the deformation ``u``. Its momentum ``rho v . (Omega_0 x u)`` is a load
    ``rho Omega_0 x v`` across the rod, so with ``dropped=1`` the load of the rigid motion is not
    the acceleration of the axis but the rate of its components: less by spin times axial velocity.
    """
    L, r, W = slider_crank.LENGTH, slider_crank.RADIUS, slider_crank.SPEED
    section = slider_crank.SECTION
    k = np.arange(1, 6)
    omega = (k * np.pi / L)**2 * np.sqrt(section.youngs_modulus * section.inertia_z
                                         / (section.density * section.area))

    def rate(t, y):
        theta = W * t
        s = -r / L * np.sin(theta)
        c = np.sqrt(1 - s * s)
        spin = -r / L * W * np.cos(theta) / c
        second = (r / L * W * W * np.sin(theta) + spin**2 * s) / c
        push = -r * W * W * (-np.cos(theta) * s + np.sin(theta) * c)
        push -= dropped * spin * r * W * (-np.sin(theta) * c + np.cos(theta) * s)
        load = -(push * 2 / (k * np.pi) * (1 - np.cos(k * np.pi))
                 - second * 2 * L / (k * np.pi) * np.cos(k * np.pi))
        return np.r_[y[5:], load - (omega**2 - spin**2) * y[:5]]
    run = solve_ivp(rate, (0.0, t_end), np.zeros(10), max_step=1e-5, rtol=1e-8, atol=1e-12)
    return np.sin(k * np.pi / 2) @ run.y[:5] / L


def test_one_superelement_is_the_linear_rod_less_what_option_b_drops():
    """Within 2 % of that, 60 % off the complete linear rod."""
    t_end = slider_crank.build().t_end
    complete, of_b = linear_rod(t_end), linear_rod(t_end, 1.0)
    assert (complete.max(), complete.min()) == pytest.approx((0.018765, -0.018693), rel=2e-3)
    found = deflections(1, 5, "b")
    assert (found.max(), found.min()) == pytest.approx((of_b.max(), of_b.min()), rel=0.02)
    assert found.max() > 1.5 * complete.max()


def test_several_superelements_go_to_the_nonlinear_rod():
    """Extremes of a geometrically exact beam, within 3 %; more bodies come closer."""
    extremes = {}
    for bodies in (2, 4, 8):
        found = deflections(bodies, 0)
        extremes[bodies] = max(abs(found.max() / 0.015422 - 1), abs(found.min() / -0.015543 - 1))
    assert extremes[8] < 0.03
    assert extremes[8] < extremes[4] < extremes[2]


@pytest.mark.parametrize("case, deepest", [("kane", -0.53366), ("simo", -0.57392)])
def test_spin_up(case, deepest):
    """Eight bodies, converged mean frame: largest lag within 1 % of geometrically exact beams."""
    scene = spin_up.build(case)
    result = simulate(scene.model, scene.h, scene.t_end)
    length, speed = spin_up.CASES[case][:2]
    angle = np.array([spin_up.turning(speed)[0](t) for t in result.t])
    tip = result["tip.position"]
    lag = -tip[:, 0] * np.sin(angle) + tip[:, 1] * np.cos(angle)
    assert lag.min() == pytest.approx(deepest, rel=0.01)
    assert result.t[lag.argmin()] == pytest.approx(6.77, abs=0.05)


@pytest.mark.parametrize("scene, steps, t_end", [
    (four_bar, (2e-3, 1e-3, 5e-4), 2.0), (squeezer, (2e-5, 1e-5, 5e-6), 0.01),
    (heavy_top, (5e-4, 2.5e-4, 1.25e-4), 0.2), (torque_free_body, (0.02, 0.01, 0.005), 10.0),
    (slider_crank, (1e-5, 5e-6, 2.5e-6), 0.02), (spin_up, (2e-3, 1e-3, 5e-4), 2.0)])
def test_energy_balance_falls_with_the_square_of_the_step(scene, steps, t_end):
    """Kinetic, strain and potential energy less the work done, without numerical damping."""
    balances = [simulate(scene.build().model, h, t_end, UNDAMPED).energy_balance() for h in steps]
    assert order(steps, balances) > 1.7
