"""Models with friction and contact, and their exact motions by other means than sebody."""

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from sebody import Model

G = 9.81


def restitution(cv):
    """Restitution of Hunt and Crossley's law: ``c v (1 + e) = ln((1 + c v)/(1 - c v e))``."""
    return brentq(lambda e: cv * (1 + e) - np.log((1 + cv) / (1 - cv * e)), 0.2, 1 - 1e-9,
                  xtol=1e-15)


def block(planar=True, mass=1.0, speed=0.0, axis=(1.0, 0.0, 0.0)):
    """A body that slides along an axis of the ground."""
    model = Model(planar=planar)
    axis = np.array(axis)[:model.dimension]
    model.node("block", np.zeros(model.dimension))
    model.rigid_body("body", "block", mass, 0.1 if planar else (0.1, 0.2, 0.3))
    model.prismatic("block", axis, name="slide")
    model.initial_velocity("block", speed * axis)
    return model


def anchored(model, stiffness, stretch):
    """The block on a spring that is stretched by so much at the start."""
    wall = -np.eye(model.dimension)[0]
    model.fix(model.node("wall", wall, keeps="translation"), "position")
    model.spring("wall", "block", stiffness, length=1.0 - stretch)
    return model


def bar(planar=True, angle=np.pi / 3, joint="revolute", axis=(0.0, 0.0, 1.0), explicit=False):
    """A bar of 1 kg on a hinge, its centre half a metre away; the angle is from below."""
    model = Model(planar=planar)
    centre = 0.5 * np.array([np.sin(angle), -np.cos(angle), 0.0])[:model.dimension]
    model.node("pin", np.zeros(model.dimension))
    model.rigid_body("bar", "pin", 1.0, 1 / 12 if planar else (1 / 12,) * 3, centre=centre)
    if joint == "revolute":
        model.revolute("pin", axis=axis, explicit=explicit, name="hinge")
    else:
        model.spherical("pin", name="hinge")
    model.gravity((0.0, -G, 0.0)[:model.dimension])
    return model


def angle_of(result, node="pin"):
    """Angle of a node about z, turns counted."""
    R = result[f"{node}.rotation"]
    return R if R.ndim == 1 else np.unwrap(np.arctan2(R[:, 1, 0], R[:, 0, 0]))


def pendulum_with_journal(angle=np.pi / 3, lever=0.02, turns=3):
    """Turning points (t, angle) of the bar whose hinge has the friction moment ``lever |N|``.

    From turning point to turning point, the reaction solved for at every time.
    """
    m, l, J = 1.0, 0.5, 1 / 12 + 0.25       # noqa: E741

    def acceleration(th, om, s):
        a = -m * G * l * np.sin(th) / J
        for _ in range(60):
            across, along = m * (l * a + G * np.sin(th)), m * (l * om * om + G * np.cos(th))
            N = np.hypot(along, across)
            d = (J * a + m * G * l * np.sin(th) + s * lever * N) / (J + s * lever * m * l
                                                                    * across / N)
            a -= d
            if abs(d) < 1e-15 * (1 + abs(a)):
                break
        return a
    t, found = 0.0, []
    for _ in range(turns):
        s = -np.sign(np.sin(angle))

        def stopped(t, y):
            return y[1]
        stopped.terminal, stopped.direction = True, -s
        d = 1e-7
        a = acceleration(angle, 0.0, s)
        run = solve_ivp(lambda t, y, s=s: [y[1], acceleration(y[0], y[1], s)], (t + d, t + 9.0),
                        [angle + 0.5 * a * d * d, a * d], method="DOP853", rtol=1e-11, atol=1e-13,
                        events=stopped)
        t, angle = run.t_events[0][0], run.y_events[0][0][0]
        found.append((t, angle))
    return np.array(found)


def turning_points(t, x):
    """Extremes of a sampled history between its samples, by parabolas: (t, value)."""
    inner = np.flatnonzero((np.diff(x)[:-1] * np.diff(x)[1:]) < 0) + 1
    found = []
    for k in inner:
        a, b, c = x[k - 1:k + 2]
        h, s = t[1] - t[0], 0.5 * (a - c) / (a - 2 * b + c)
        found.append((t[k] + s * h, b - 0.25 * (a - c) * s))
    return np.array(found)
