"""What rests in contact and is pushed by a load is not struck, and no step is too long for it.

The reference is Hunt and Crossley's law, integrated by SciPy.
"""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from sebody import Model, plane, simulate
from sebody.analysis import Ensemble, equilibrium, final

STIFFNESS, RESTITUTION, RATIO = 300.0, 0.5, -2.0
INERTIAS = 0.1, 0.2
AXIS = np.array([0.48, 0.64, 0.6])
STEP, END = 1e-3, 0.3
FLOOR, LOAD = 4e4, 2000.0


def damping(e=RESTITUTION):
    """c of the law whose restitution is e at a speed of one."""
    return brentq(lambda c: c * (1 + e) - np.log((1 + c) / (1 - c * e)), 1e-3, (1 - 1e-9) / e)


def sudden(t):
    """It sets in at once, between two steps."""
    return 0.0 if t < 0.0105 else 50.0


def to_and_fro(t):
    return 50.0 * math.sin(30.0 * t)


def geared(planar, torque):
    """Two wheels whose teeth have no play."""
    model = Model(planar=planar)
    axis = 1.0 if planar else AXIS
    for name, x, J in zip("ab", (0.0, 1.0), INERTIAS, strict=True):
        model.node(name, (x, 0.0) if planar else (x, 0.3, 0.1))
        model.rigid_body(f"wheel {name}", name, 1.0, J if planar else (J, J, J))
        model.revolute(name, name=f"shaft {name}", **({} if planar else {"axis": axis}))
    model.gear("shaft a", "shaft b", RATIO, stiffness=STIFFNESS, restitution=RESTITUTION,
               name="teeth")
    corners = [(0.0, 0.0), (0.0105, 0.0), (0.0105, 50.0), (1.0, 50.0)]
    model.torque("a", axis, corners if torque is sudden else torque, name="push")
    return model


def expected(torque):
    """Angles and rates of both wheels at the end."""
    c = damping()

    def rates(t, x):
        angle, rate = x[0] - RATIO * x[1], x[2] - RATIO * x[3]
        side = 1.0 if angle > 0 else -1.0
        push = side * max(STIFFNESS * abs(angle) * (1.0 + c * side * rate), 0.0)
        return [x[2], x[3], (torque(t) - push) / INERTIAS[0], RATIO * push / INERTIAS[1]]
    return solve_ivp(rates, (0.0, END), np.zeros(4), rtol=1e-10, atol=1e-12,
                     max_step=1e-3).y[:, -1]


@pytest.mark.parametrize("torque", [sudden, to_and_fro])
@pytest.mark.parametrize("planar", [True, False])
def test_teeth_without_play(planar, torque):
    """Runs stopped: at a sudden torque, and as soon as the teeth pushed the other way."""
    result = simulate(geared(planar, torque), STEP, END)
    rates = [np.atleast_1d(result[f"{name}.angular_velocity"][-1]) for name in "ab"]
    found = [rate[0] if planar else rate @ AXIS for rate in rates]
    # steps of a tenth of the teeth's angular frequency, 95 rad/s, whose phase they shorten
    assert found == pytest.approx(expected(torque)[2:], rel=5e-3)
    assert result.steps < 1.5 * END / STEP


def test_members_of_ensembles_take_the_same_steps():
    model = geared(True, to_and_fro)
    members = Ensemble(model, STEP).run({"teeth.ratio": np.full(9, RATIO)}, END,
                                        {"rate": final("a.angular_velocity")})
    alone = simulate(model, STEP, END)["a.angular_velocity"][-1]
    assert np.ravel(members["rate"]) == pytest.approx(np.full(9, alone), rel=1e-7)


def test_a_resting_ball_is_pressed():
    """A load that is switched on presses a ball that lies on a slope's floor; it comes to rest."""
    model = Model()
    up = np.array([0.36, -0.48, 0.8])
    model.gravity(-9.81 * up)
    model.node("ball", 0.1 * up)
    model.rigid_body("ball", "ball", 2.0, (0.01, 0.01, 0.01))
    model.contact("ball", on=plane(up), radius=0.1, stiffness=FLOOR, exponent=1.0,
                  restitution=RESTITUTION)
    model.fix("ball", "rotation")
    model.force("ball", -up, [(0.0, 0.0), (0.0105, 0.0), (0.0105, LOAD), (9.0, LOAD)])
    result = simulate(model, STEP, END, start=equilibrium(model))
    c, weight = damping(), 2.0 * 9.81

    def rates(t, x):
        push = max(FLOOR * -x[0] * (1.0 - c * x[1]), 0.0) if x[0] < 0 else 0.0
        return [x[1], (push - weight - LOAD) / 2.0]
    exact = solve_ivp(rates, (0.0105, END), [-weight / FLOOR, 0.0], rtol=1e-10, atol=1e-14,
                      max_step=1e-3, dense_output=True)
    t = result.t[result.t > 0.0105]
    depth = (result["ball.position"] @ up)[result.t > 0.0105] - 0.1
    assert np.abs(depth - exact.sol(t)[0]).max() < 0.05 * LOAD / FLOOR
