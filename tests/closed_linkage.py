"""Motion of the Bricard linkage from its joint angles alone, with one degree of freedom."""

from itertools import pairwise

import numpy as np
from everyday import CUBE, GRAVITY
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline
from scipy.spatial.transform import Rotation

RODS = np.diff(CUBE, axis=0)
AXES = np.array([np.cross(a, b) for a, b in pairwise((RODS[-1], *RODS))])
STEP = 0.08             # between configurations, in the joint angles; cubic splines leave 3e-7
REACH = -6.4, 0.4       # of the motion, in the joint angles: it starts at rest and turns back there


def chain(angles: NDArray) -> tuple[NDArray, NDArray, NDArray]:
    """Joints, rods and axes of five rods by their joint angles."""
    turned, points, rods, axes = Rotation.identity(), [CUBE[0]], [], []
    for k, angle in enumerate(angles):
        axes.append(turned.apply(AXES[k]))
        turned = turned * Rotation.from_rotvec(angle * AXES[k])
        rods.append(turned.apply(RODS[k]))
        points.append(points[-1] + rods[-1])
    axes.append(turned.apply(AXES[5]))
    return np.array(points), np.array(rods), np.array(axes)


def closure(angles: NDArray) -> tuple[NDArray, NDArray]:
    """What is missing to a closed loop, and its derivative: last joint and last axis."""
    points, _, axes = chain(angles)
    missing = np.concatenate([points[5] - CUBE[5], axes[5] - AXES[5]])
    derivative = [np.concatenate([np.cross(axes[k], points[5] - points[k]),
                                  np.cross(axes[k], axes[5])]) for k in range(5)]
    return missing, np.array(derivative).T


def inertia_and_height(angles: NDArray, rates: NDArray) -> tuple[float, float]:
    """Twice the kinetic energy of five slender rods, and the sum of their centres' heights."""
    points, rods, axes = chain(angles)
    spins = np.cumsum(rates[:, None] * axes[:5], axis=0)
    ends = np.cumsum(np.cross(spins, rods), axis=0)
    begins = np.vstack([np.zeros(3), ends[:-1]])
    centres = (begins + ends) / 2.0
    turning = np.cross(spins, rods)
    return (float((centres**2).sum() + (turning**2).sum() / 12.0),
            float((points[:-1, 1] + points[1:, 1]).sum() / 2.0))


def curve(count: int) -> NDArray:
    """Closed configurations, one STEP apart, on one side of the start."""
    angles, tangent = np.zeros(5), None
    found = []
    for _ in range(abs(count) + 1):
        for _ in range(5):
            missing, derivative = closure(angles)
            angles = angles - np.linalg.pinv(derivative, rcond=1e-6) @ missing
        new = np.linalg.svd(closure(angles)[1])[2][-1]
        new *= np.sign(count) * np.sign(new[0]) if tangent is None else np.sign(new @ tangent)
        found.append(angles)
        tangent, angles = new, angles + STEP * new
    return np.array(found)


def bricard(times: NDArray) -> NDArray:
    """Place of the fourth joint after a start from rest in the cube, gravity along -y."""
    below, above = (round(extent / STEP) for extent in REACH)
    angles = np.vstack([curve(below)[:0:-1], curve(above)])
    s = np.arange(below, above + 1) * STEP
    place = CubicSpline(s, angles)
    values = np.array([inertia_and_height(q, v) for q, v in zip(angles, place(s, 1), strict=True)])
    inertia, height = CubicSpline(s, values[:, 0]), CubicSpline(s, values[:, 1])

    def rate(_, y):
        return [y[1], -(inertia(y[0], 1) * y[1]**2 / 2.0 + GRAVITY * height(y[0], 1))
                / inertia(y[0])]
    run = solve_ivp(rate, (0.0, times[-1]), [0.0, 0.0], t_eval=times, rtol=1e-10, atol=1e-12)
    assert s[0] < run.y[0].min() and run.y[0].max() < s[-1]
    return np.array([chain(place(x))[0][3] for x in run.y[0]])
