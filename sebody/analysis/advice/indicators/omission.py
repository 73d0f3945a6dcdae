"""What internal modes that are left out would have done."""

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

from sebody.analysis.advice.forms import Form, Part
from sebody.analysis.advice.indicators.carried import carried
from sebody.analysis.advice.indicators.recorded import Recorded
from sebody.analysis.advice.indicators.vibration import detuned
from sebody.reduction import ReducedBody

RESOLVED = 1.5      # largest angle of an oscillator in a recorded step: above, it answers at once


def omission(recorded: Recorded, part: Part, form: Form) -> float:
    """Error if a form keeps so few modes.

    Each mode left out is an oscillator, ``m y'' + k y = -M_yB a_B - p``, driven by the recorded
    accelerations of the boundary. Its momentum and its inertia force ``M_By y''`` are missing at
    the boundary: the body moves by the first, and is bent by the second as its stiffness allows.
    The inertia that it would add, by its strain energy relative to that of the boundary's
    deformation, changes the period of the vibration.
    """
    shifts, turns, added = [], [], []
    for nodes, body in recorded.bodies(part, form.bodies):
        if form.modes >= body.modes:
            continue
        found = recorded.deformation(nodes)
        n = len(body.stiffness) - body.modes
        left = slice(n + form.modes, None)
        coupling, k, m = body.mass[:n, left], *(np.diag(A)[left] for A in (
            body.stiffness, body.mass))
        y = _answers(-recorded.accelerations(nodes, body) @ coupling, k, m, recorded.interval)
        bent = np.linalg.pinv(body.stiffness[:n, :n], rcond=1e-12, hermitian=True)
        rigid = body.rigid_modes_about(body.centre_of_mass)[:n]
        moved = rigid @ np.linalg.solve(rigid.T @ body.mass[:n, :n] @ rigid, rigid.T @ coupling)
        off = y @ moved.T + recorded.rate(recorded.rate(y)) @ (bent @ coupling).T
        one, other = boundary(body, off)
        shifts.append(one)
        turns.append(other)
        u = flat(body, found.shifts, found.turns)
        whole = np.einsum("ni,ij,nj->n", u, body.stiffness[:n, :n], u).mean()
        added.append(float((y**2 @ k).mean() / max(whole, 1e-300)))
    if not shifts:
        return 0.0
    return (carried(recorded, part, np.concatenate(shifts, axis=1), np.concatenate(turns, axis=1))
            + detuned(recorded, part, min(max(added) / 2, 1.0)))


def _answers(p: NDArray, k: NDArray, m: NDArray, dt: float) -> NDArray:
    """Oscillators driven by histories (n, j), from rest in balance; quick ones answer at once."""
    y = p / k
    for j, angle in enumerate(np.sqrt(k / m) * dt):
        if angle < RESOLVED:        # exact for a drive that is constant in each step
            y[:, j] = lfilter([0.0, 1.0 - np.cos(angle), 1.0 - np.cos(angle)],
                              [1.0, -2.0 * np.cos(angle), 1.0], y[:, j] - y[0, j]) + y[0, j]
    return y


def flat(body: ReducedBody, shifts: NDArray, turns: NDArray) -> NDArray:
    """Displacements and rotations of nodes, (n, k, .), as boundary coordinates of a body."""
    n = len(shifts)
    return np.hstack([shifts[:, list(body.position_nodes)].reshape(n, -1),
                      turns[:, list(body.rotation_nodes)].reshape(n, -1)])


def boundary(body: ReducedBody, coordinates: NDArray) -> tuple[NDArray, NDArray]:
    """The inverse of `flat`: (n, k, d) and (n, k, 3 or 1), zero where a body keeps none."""
    n, nodes, d = len(coordinates), len(body.keeps), body.coordinates.shape[1]
    r, first = (1, 2 * len(body.position_nodes)) if d == 2 else (3, 3 * len(body.position_nodes))
    shifts, turns = np.zeros((n, nodes, d)), np.zeros((n, nodes, r))
    shifts[:, list(body.position_nodes)] = coordinates[:, :first].reshape(n, -1, d)
    turns[:, list(body.rotation_nodes)] = coordinates[:, first:].reshape(n, -1, r)
    return shifts, turns
