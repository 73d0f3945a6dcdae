"""Equilibria and vibrations against closed solutions: roll-up, Euler, elastica, beams."""

from dataclasses import replace

import numpy as np
import pytest
from helpers import order
from scipy.integrate import solve_bvp, trapezoid

from sebody import InputError, Model, Simulation, SimulationError
from sebody.analysis import equilibrium, vibrations
from sebody.scenes.hinged_beam import SECTION

LENGTH = 100.0
EI = SECTION.youngs_modulus * SECTION.inertia_z
BERNOULLI = replace(SECTION, shear_factor=None)
SLENDER = replace(SECTION, area=SECTION.area * 1e3, density=SECTION.density / 1e3,
                  shear_factor=None)


def cantilever(elements, planar=True, section=SLENDER):
    d = 2 if planar else 3
    model = Model(planar=planar)
    ends = model.node("base", np.zeros(d)), model.node("tip", np.array([LENGTH, 0.0, 0.0])[:d])
    model.beam("beam", ends, section, elements)
    model.fix("base")
    return model


@pytest.mark.parametrize("planar", [True, False])
def test_a_moment_rolls_the_beam_up(planar):
    """2 pi EI / L closes a circle, exactly for any number of equal elements."""
    model = cantilever(10, planar)
    moment = 2 * np.pi * EI / LENGTH
    model.torque("tip", moment if planar else (0, 0, moment), follower=not planar)
    result = equilibrium(model, 20)
    d = 2 if planar else 3
    # chords of the elements: a regular polygon closes, too
    assert np.abs(result["tip.position"][-1]).max() < 1e-7 * LENGTH
    half = result["beam 5.position"][-1]
    polygon = LENGTH / 10 / np.sin(np.pi / 10)      # across from corner to corner
    assert half[1] == pytest.approx(polygon, rel=1e-6) and half[0] == pytest.approx(0, abs=1e-6)
    assert len(half) == d


def test_elastica_of_a_cantilever():
    """A fixed-direction load across the tip that bends it far: second order in the elements."""
    load = 5.0 * EI / LENGTH**2

    def rates(s, y):
        return np.array([y[1], -load * LENGTH**2 / EI * np.cos(y[0])])
    s = np.linspace(0, 1, 200)
    exact = solve_bvp(rates, lambda a, b: np.array([a[0], b[1]]), s,
                      np.array([s, 1 - s]), tol=1e-10, max_nodes=100000)
    fine = np.linspace(0, 1, 20001)
    angle = exact.sol(fine)[0]
    tip = LENGTH * np.array([trapezoid(np.cos(angle), fine), trapezoid(np.sin(angle), fine)])
    errors, counts = [], (4, 8, 16)
    for n in counts:
        model = cantilever(n)
        model.force("tip", (0.0, load))
        errors.append(np.abs(equilibrium(model)["tip.position"][-1] - tip).max())
    assert 1.8 < order(1 / np.array(counts), errors) < 2.3
    assert errors[-1] < 1e-3 * LENGTH


def test_euler_load():
    """The stiffness across the beam vanishes at pi^2 EI / (4 L^2)."""
    def lowest(share):
        model = cantilever(16)
        model.force("tip", (-share * np.pi**2 * EI / (4 * LENGTH**2), 0.0))
        result = equilibrium(model, 4, unstable="keep")
        run = Simulation(model, 1.0)
        run.state.now[:] = result.rows[-1]
        run.state.v[:] = 0.0
        return vibrations(run, 1).omega[0]**2
    shares = np.array([0.5, 0.8, 0.95])
    squares = np.array([lowest(s) for s in shares])
    critical = np.polyfit(squares, shares, 2)[-1]
    assert critical == pytest.approx(1.0, abs=3e-3)
    with pytest.raises(InputError, match="the state is not stable: the lowest square"):
        lowest(1.02)


def test_frequencies_of_a_cantilever():
    """Beta_n^2 sqrt(EI / rho A L^4) of Euler and Bernoulli's beam."""
    run = Simulation(cantilever(24, section=BERNOULLI), 0.01)
    run.state.a[:] = 0.0
    beta = np.array([1.8751040687, 4.6940911330, 7.8547574382])
    exact = beta**2 * np.sqrt(EI / (SECTION.density * SECTION.area * LENGTH**4))
    assert vibrations(run, 3).omega == pytest.approx(exact, rel=4e-3)   # rotary inertia


def test_vibrations_respect_joints():
    """A hinged beam in space: one rigid mode, then pinned-free bending."""
    model = cantilever(16, planar=False, section=SECTION)
    model.nodes["base"].rotation.fixed = False
    model.revolute("base")
    found = vibrations(Simulation(model, 0.01), 3).omega
    scale = np.sqrt(EI / (SECTION.density * SECTION.area * LENGTH**4))
    assert found[0] < 1e-4 * scale
    assert found[1:] / scale == pytest.approx([1.8751040687**2, 3.9266023120**2], rel=5e-3)


def test_gravity_sags_a_cantilever():
    """rho A g L^4 / (8 EI) for a small load."""
    model = cantilever(8, section=SECTION)
    model.gravity((0.0, -1e-3))
    sag = equilibrium(model, 1)["tip.position"][-1, 1]
    weight = 1e-3 * SECTION.density * SECTION.area
    assert sag == pytest.approx(-weight * LENGTH**4 / (8 * EI), rel=5e-3)


def test_a_mechanism_has_an_equilibrium_where_its_load_holds_it():
    """A hinged beam turns into the force; a torque that is too large turns it on and on."""
    model = cantilever(2)
    model.nodes["base"].rotation.fixed = False
    model.force("tip", (0.0, 1.0))
    tip = equilibrium(model)["tip.position"][-1]
    stretch = LENGTH / (SLENDER.youngs_modulus * SLENDER.area)
    assert tip == pytest.approx([0.0, LENGTH + stretch], abs=1e-9 * LENGTH)
    model.torque("tip", 10.0 * LENGTH)
    with pytest.raises(SimulationError, match="no equilibrium was found above 0 of the load"):
        equilibrium(model)


@pytest.mark.parametrize("point", [(0.0, 0.0, 0.0), (0.3, -2.0, 1.0)])
def test_a_lone_mass_rests_where_nothing_pulls_and_nowhere_else(point):
    """Also at the origin, where the model has no extent that corrections could be compared with."""
    for pull in (0.0, 1.0):
        model = Model()
        model.point_mass("mass", model.node("here", point, "translation"), 2.0)
        model.gravity((0.0, 0.0, -pull))
        if pull:
            with pytest.raises(SimulationError, match="no equilibrium was found above 0 of the "
                                                      "load: a load moves here.position, which is "
                                                      "free to move: hold it, or let something "
                                                      "resist this load"):
                equilibrium(model)
        else:
            assert equilibrium(model)["here.position"][-1] == pytest.approx(point)


def test_a_body_that_is_held_at_both_ends_sags():
    """Unknown are amplitudes of modes alone: rho A g L^4 / (384 EI), and the omitted modes."""
    model = Model(planar=True)
    ends = [model.node(name, x) for name, x in (("a", (3.0, 1.0)), ("b", (3.0, 101.0)))]
    model.beam("beam", ends, BERNOULLI, 16, 1, 8)
    for end in ends:
        model.fix(end)
    model.gravity((1e-3, 0.0))
    result = equilibrium(model, 2)
    body = model.bodies["beam"].reduced
    modes = result["beam.modes"][-1]
    deepest = np.abs(body.displacements(np.concatenate([np.zeros(6), modes]))[:, :2]).max()
    weight = 1e-3 * SECTION.density * SECTION.area
    # omitted modes have 1e-4 of the sag, elements of a consistent mass none
    assert deepest == pytest.approx(weight * LENGTH**4 / (384 * EI), rel=5e-4)


def test_wrong_steps_and_moving_states():
    with pytest.raises(InputError, match="steps is 0: give a whole number >= 1"):
        equilibrium(cantilever(2), 0)
    run = Simulation(cantilever(2), 0.01)
    run.state.v[0] = 1.0
    with pytest.raises(InputError, match="the state is not at rest: vibrations"):
        vibrations(run)


def test_a_share_of_the_load_is_a_share_of_the_centrifugal_force():
    """A mass on a spring: ``k (r - 1) = m W^2 r``, where W^2 grows with the share as loads do."""
    stiffness, mass, spin = 40.0, 2.0, 3.0
    model = Model(planar=True)
    model.node("hub", (0.0, 0.0), keeps="translation")
    model.fix("hub", "position")
    model.point_mass("ball", model.node("ball", (1.0, 0.0), keeps="translation"), mass)
    model.spring("ball", "hub", stiffness)
    result = equilibrium(model, 4, spin=spin)
    share = result.t
    assert share == pytest.approx([0.0, 0.25, 0.5, 0.75, 1.0])
    radius = stiffness / (stiffness - share * mass * spin**2)
    across = np.zeros(5)
    assert result["ball.position"] == pytest.approx(np.array([radius, across]).T, abs=1e-9)
    speed = np.sqrt(share) * spin * radius
    assert result["ball.velocity"] == pytest.approx(np.array([across, speed]).T, abs=1e-9)


def test_loads_and_weight_grow_together_to_those_of_the_time():
    """The balance of forces in every step; deflections, small ones, grow with the share."""
    model = cantilever(4, planar=False)
    force, g = np.array([3.0, -1.0, 2.0]), np.array([0.5, -2.0, 0.25])
    model.force("tip", force, [(0.0, 0.0), (2.0, 1.0)], name="push")
    model.force("base", -2.0 * force, [(0.0, 0.0), (2.0, 1.0)], name="on the support")
    model.gravity(g)
    mass = LENGTH * SLENDER.density * SLENDER.area
    for t, part in ((0.0, 0.0), (0.5, 0.25), (2.0, 1.0)):
        result = equilibrium(model, 3, t)
        share = result.t[:, None]
        carried = -share * (-part * force + mass * g)
        # residuals are small beside forces of the axial stiffness, EA = 4e9, times the tolerance
        assert result["base.reaction"] == pytest.approx(carried, abs=1e-5 * np.abs(carried).max())
        assert result["push.force"] == pytest.approx(share * part * force, abs=1e-12)
        deflection = result["tip.position"][:, 1]
        assert deflection == pytest.approx(result.t * deflection[-1], rel=1e-3)
