"""Loads that jump while friction slides, returns, and a wave in a rod that meets a wall."""

import numpy as np
import pytest
from contact_models import G, anchored, block
from scipy.optimize import brentq

from sebody import Model, Tolerance, plane, simulate, simulate_within
from sebody.fem import StiffnessSection, planar_beam
from sebody.model.profiles import piecewise
from sebody.reduction import craig_bampton

JUMPS = 0.05123, 0.09876        # of the normal force and of the force along the way, on no grid
LIFT, PUSH, MU, SPRING, SPEED = 5.0, 3.0, 0.3, 100.0, 3.0


def sliding(planar):
    """A block on a spring, on a rail that presses; the loads jump while it slides."""
    model = anchored(block(planar, speed=SPEED), SPRING, 0.0)
    up, along = np.eye(model.dimension)[1], np.eye(model.dimension)[0]
    model.gravity(-G * up)
    model.force("block", up, piecewise((0.0, 0.0), (JUMPS[0], LIFT)), name="lift")
    model.force("block", along, piecewise((0.0, 0.0), (JUMPS[1], PUSH)), name="push")
    model.friction("slide", MU, name="dry")
    return model


def exact_way(times):
    """Places at some times: pieces of a harmonic motion between jumps and returns."""
    w, t, x, v, found = np.sqrt(SPRING), 0.0, 0.0, SPEED, np.full(len(times), np.nan)
    while t < times[-1]:
        force, normal = PUSH * (t >= JUMPS[1]), G - LIFT * (t >= JUMPS[0])
        way = np.sign(v if v else force - SPRING * x)
        centre = (force - MU * normal * way) / SPRING
        a, b = x - centre, v / w
        angle = np.arctan2(b, a) % np.pi        # of the next return
        back = t + (angle if v else np.pi) / w
        until = min([one for one in (*JUMPS, back) if one > t])
        inside = (times >= t) & (times <= until)
        turned = w * (times[inside] - t)
        found[inside] = centre + a * np.cos(turned) + b * np.sin(turned)
        turned = w * (until - t)
        x = centre + a * np.cos(turned) + b * np.sin(turned)
        v = 0.0 if until == back else w * (b * np.cos(turned) - a * np.sin(turned))
        t = until
        assert v or abs(PUSH * (t >= JUMPS[1]) - SPRING * x) > MU * normal      # slides on
    return found


@pytest.mark.parametrize("planar", [True, False])
def test_loads_jump_while_friction_slides(planar):
    """Of second order at fixed steps, though the normal force jumps, too, and friction with it."""
    exact, errors = exact_way(np.linspace(0.0, 0.14, 15)), []
    for h in (2e-3, 1e-3, 5e-4):
        x = simulate(sliding(planar), h, 0.14)["block.position"][::round(0.01 / h), 0]
        errors.append(np.abs(x - exact).max())
    assert errors[0] < 1e-5
    assert 3.6 < errors[0] / errors[1] < 4.4 and 3.6 < errors[1] / errors[2] < 4.4


def test_loads_jump_at_variable_steps():
    """Within the tolerance of a whole run, the root mean square over it."""
    exact = exact_way(np.linspace(0.0, 0.14, 15))
    for tolerance in (1e-4, 1e-5):
        result = simulate_within(sliding(True), 1e-2, 0.14, Tolerance(tolerance))
        errors = result["block.position"][:, 0] - exact
        assert np.sqrt(np.mean(errors**2)) < tolerance      # of the extent, which is one


def test_returns_are_known_to_a_step():
    """A return within a step changes friction at its end: an error of first order, below 0.1 h."""
    exact = exact_way(np.linspace(0.0, 0.5, 51))
    for h in (2e-3, 5e-4):
        x = simulate(sliding(True), h, 0.5)["block.position"][::round(0.01 / h), 0]
        assert np.abs(x - exact).max() < 0.15 * h


def rod(modes, stiffness=50.0, elements=32):
    """A rod of unit length, mass and wave speed that flies end-on against a wall, in any direction.

    Nothing bends: its bending frequencies are far above the axial ones.
    """
    way, speed = np.array([np.cos(0.3), np.sin(0.3)]), 0.01
    section = StiffnessSection(1.0, 1e5, 1e5, 1.0, 1.0, 0.0, 0.0, 0.0)
    fe = planar_beam((0.0, 0.0), way, section, elements)
    model = Model(planar=True)
    ends = model.node("tail", (0.0, 0.0)), model.node("head", way)
    model.superelement("rod", craig_bampton(fe, [(0, "full"), (elements, "full")], modes), ends)
    for end in ends:
        model.initial_velocity(end, speed * way)
    model.contact("head", on=plane(-way, 1.0001 * way), stiffness=stiffness, exponent=1.0,
                  restitution=1.0, at_speed=speed, name="wall")
    return model, way, speed


def test_a_rod_stays_at_a_wall_until_its_wave_is_back():
    """Contact for ``2 L/c + x EA/(c k)`` with ``(1 + x) exp(-x) = 1/2``, and no wave is left.

    By modes: a body with few of them is a spring with a mass at its end, and leaves too early.
    """
    exact, errors = 2.0 + brentq(lambda x: (1 + x) * np.exp(-x) - 0.5, 1.0, 2.0) / 50.0, []
    for modes in (0, 4, 24):
        model, way, speed = rod(modes)
        result = simulate(model, 2e-3, 2.5)
        pressing = result["t"][result["wall.normal_force"] > 1e-9]
        errors.append(abs(pressing[-1] - pressing[0] - exact) / exact)
        back = result["momentum"][-1][:2] @ way / speed
    assert errors[0] > 0.1 and errors[1] < 0.03 and errors[2] < 0.02
    assert back == pytest.approx(-1.0, abs=0.02)
