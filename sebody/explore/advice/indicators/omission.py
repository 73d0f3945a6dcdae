"""Error by internal modes that are left out."""

from math import inf

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigh

from sebody.explore.advice.forms import Form, Part
from sebody.explore.advice.indicators.coordinates import flat, nodal
from sebody.explore.advice.indicators.propagated import Force, propagated
from sebody.explore.advice.indicators.recorded import Recorded
from sebody.explore.advice.indicators.vibration import detuned
from sebody.reduction.body import ReducedBody

COUPLED = 0.2       # of squared frequencies, by which the first of a cantilever is off
RESOLVED = 1.5      # largest angle of an oscillator in a recorded step: above, it answers at once


def omission(recorded: Recorded, part: Part, form: Form) -> float:
    """Error if a form keeps so few modes.

    Each mode left out is an oscillator, ``m y'' + k y = -M_yB a_B - p``, driven by the recorded
    accelerations of the boundary. Its inertia force ``M_By y''`` is missing there. The inertia that
    it would add, by its strain energy relative to that of the boundary's deformation, changes the
    period of the vibration. The relative error of a frequency is a fifth of its square over that
    of the first omitted mode, as for a cantilever of one body without modes.
    """
    whole = recorded.nodes(part)
    shifts, turns = (0.0 * one for one in recorded.deformation(whole)[:2])
    added, kept, force, slowest = 0.0, 0.0, Force(), inf
    for nodes, body in recorded.bodies(part, form.bodies):
        if form.modes >= body.modes:
            continue
        deformation = recorded.deformation(nodes)
        n = len(body.stiffness) - body.modes
        left = slice(n + form.modes, None)
        coupling, k, m = body.mass[:n, left], *(np.diag(A)[left] for A in (
            body.stiffness, body.mass))
        slowest = min(slowest, float(np.sqrt((k / m).min())))
        y = _answers(-recorded.accelerations(nodes, body) @ coupling, k, m, recorded.interval)
        inertia = recorded.rate(recorded.rate(y))
        forces = inertia @ coupling.T
        one, other = nodal(body, inertia @ _given_way(body, coupling, y, inertia))
        force = force.with_(Force.of(body, forces))
        places = [whole.index(node) for node in nodes]
        shifts[:, places] += one
        turns[:, places] += other
        u = flat(body, deformation.shifts, deformation.turns)
        u = u - u.mean(axis=0)
        kept += float(np.einsum("ni,ij,nj->n", u, body.stiffness[:n, :n], u).mean())
        added += float(((y - y.mean(axis=0))**2 @ k).mean())
    off = [min(COUPLED * (omega / slowest)**2, 1.0) for omega in recorded.frequencies]
    if added == 0.0:
        return max(off, default=0.0)
    return max([propagated(recorded, part, shifts, turns, force)
                + detuned(recorded, part, min(added / max(kept, 1e-300) / 2, 1.0)), *off])


def _given_way(body: ReducedBody, coupling: NDArray, y: NDArray, inertia: NDArray) -> NDArray:
    """Displacements of the boundary by unit accelerations of the modes, (j, boundary).

    By the vibrations of the boundary alone, which answer as ``1 / (frequency^2 + of the mode^2)``:
    as springs to slow motion, as masses to fast one.
    """
    n = len(coupling)
    squares, shapes = eigh(body.stiffness[:n, :n], body.mass[:n, :n])
    own = np.sqrt((inertia**2).mean(axis=0) / np.maximum((y**2).mean(axis=0), 1e-300))
    parts = shapes.T @ coupling / (np.maximum(squares, 0.0)[:, None] + np.maximum(own, 1e-300))
    return (shapes @ parts).T


def _answers(p: NDArray, k: NDArray, m: NDArray, dt: float) -> NDArray:
    """Oscillators driven by histories (n, j), from rest in balance; quick ones answer at once."""
    from scipy.signal import lfilter  # takes half a second to import

    y = p / k
    for j, angle in enumerate(np.sqrt(k / m) * dt):
        if angle < RESOLVED:        # exact for a drive that is constant in each step
            y[:, j] = lfilter([0.0, 1.0 - np.cos(angle), 1.0 - np.cos(angle)],
                              [1.0, -2.0 * np.cos(angle), 1.0], y[:, j] - y[0, j]) + y[0, j]
    return y
