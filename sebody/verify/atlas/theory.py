"""Theory of linear beams in floating frames that rotate or are compressed (unit beams).

A cantilever of unit length, mass and bending stiffness is cut into equal bodies, each linear in a
frame of its own that is rotated by phi from the undeformed axis. A point s along a body with
deflection v in the frame then moves by ``-s phi^2 / 2 - v phi`` along the axis, and the axial
inertia or load that works on this is all the geometric stiffness there is. Hermite cells inside
the bodies, every term of second order kept; nothing is shared with the kernels.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.polynomial.legendre import leggauss
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.linalg import eigh, eigvals
from scipy.optimize import brentq

CELLS = 24              # of the whole beam, or three a body
_POINTS, _WEIGHTS = leggauss(5)
POINTS, WEIGHTS = (_POINTS + 1) / 2, _WEIGHTS / 2


class Beam(NamedTuple):
    """Matrices of the free unknowns: deflection and slope of every node but the first."""

    stiffness: NDArray
    mass: NDArray
    spin: NDArray           # geometric stiffness of a unit angular velocity about the root
    spin_b: NDArray         # the same with the inertia of option B and no internal modes
    plane_b: NDArray        # with it in the plane of the spin, mass included: options A and B
    shortening: NDArray     # of the tip is ``w^T shortening w``, negative


def cantilever(bodies: int, frame: str) -> Beam:
    """Matrices for bodies whose frame follows the inboard ``node``, the ``chord`` or the ``mean``
    of the slopes at the ends.
    """
    cells = max(CELLS // bodies, 3)
    n, cell, length = 2 * (bodies * cells + 1), 1 / (bodies * cells), 1 / bodies
    K, M = _hermite_matrices(bodies * cells, cell)
    phi = _frame_slopes(bodies, cells, n, frame)
    ends = [np.zeros((n, n))]           # axial shift of the ends of the bodies
    spin, spin_b, plane_b = np.zeros((n, n)), np.zeros((n, n)), np.zeros((n, n))
    for i in range(bodies):
        at, p, x0 = 2 * i * cells, phi[i], i * length

        def shift(s, w, start=ends[-1], p=p, at=at):
            v = w - np.eye(len(p))[at] - s * p
            return start - 0.5 * s * np.outer(p, p) - 0.5 * (np.outer(v, p) + np.outer(p, v))
        for c in range(cells):
            for g, weight in zip(POINTS, WEIGHTS, strict=True):
                w, s = np.zeros(n), (c + g) * cell
                w[at + 2 * c:at + 2 * c + 4] = hermite(g * cell, cell)
                spin -= 2 * weight * cell * (x0 + s) * shift(s, w)
        ends.append(shift(length, np.eye(n)[at + 2 * cells]))
        s = POINTS * length
        work = (WEIGHTS * length * (x0 + s)) @ hermite(s, length).T
        spin_b -= 2 * (work[0] * ends[i] + work[2] * ends[i + 1])
        for node, k in ((at, 1), (at + 2 * cells, 3)):
            spin_b[node + 1, node + 1] += work[k]
        # velocities of the nodes in the axes of the frame, which are rotated by phi
        moves, lines = np.eye(n)[[at, at + 2 * cells]], np.array([1 - POINTS, POINTS])
        for X, k, move, end in zip((x0, x0 + length), (0, 2), moves, ends[i:], strict=True):
            plane_b -= work[k] * (2 * end + np.outer(p, move) + np.outer(move, p)
                                  - X * np.outer(p, p))
        across = moves - np.outer([x0, x0 + length], p)
        plane_b -= length * across.T @ (lines * WEIGHTS) @ lines.T @ across
    return Beam(*(A[2:, 2:] for A in (K, M, spin, spin_b, plane_b, ends[-1])))


def hermite(s, length):
    """Cubic shapes of deflection and slope at both ends."""
    x = np.asarray(s) / length
    return np.array([1 - 3 * x**2 + 2 * x**3, length * (x - 2 * x**2 + x**3),
                     3 * x**2 - 2 * x**3, length * (x**3 - x**2)])


def _hermite_matrices(count, h):
    K, M = np.zeros((2 * count + 2,) * 2), np.zeros((2 * count + 2,) * 2)
    s = POINTS * h
    shapes = hermite(s, h)
    bends = np.array([(12 * s / h - 6) / h**2, (6 * s / h - 4) / h, (6 - 12 * s / h) / h**2,
                      (6 * s / h - 2) / h])
    for c in range(count):
        part = slice(2 * c, 2 * c + 4)
        K[part, part] += h * (bends * WEIGHTS) @ bends.T
        M[part, part] += h * (shapes * WEIGHTS) @ shapes.T
    return K, M


def _frame_slopes(bodies, cells, n, frame):
    phi = np.zeros((bodies, n))
    for i in range(bodies):
        a, b = 2 * i * cells, 2 * (i + 1) * cells
        if frame == "node":
            phi[i, a + 1] = 1.0
        elif frame == "chord":
            phi[i, a], phi[i, b] = -bodies, bodies
        else:
            phi[i, a + 1] = phi[i, b + 1] = 0.5
    return phi


def flap(beam: Beam, eta: float, option_b: bool = False) -> float:
    """Lowest frequency out of the plane of the spin, zero where it is not stable."""
    spin = beam.spin_b if option_b else beam.spin
    return float(np.sqrt(max(eigh(beam.stiffness + eta**2 * spin, beam.mass,
                                  eigvals_only=True)[0], 0.0)))


def lag(eta: float) -> float:
    """Lowest frequency of a beam in the plane of the spin, whose tension stiffens it."""
    h = 1 / CELLS
    K, M = _hermite_matrices(CELLS, h)
    G, x = np.zeros_like(K), POINTS
    slopes = np.array([6 * (x * x - x) / h, 1 - 4 * x + 3 * x * x, 6 * (x - x * x) / h,
                       3 * x * x - 2 * x])
    for c in range(CELLS):
        part, tension = slice(2 * c, 2 * c + 4), (1 - ((c + x) * h)**2) / 2
        G[part, part] += h * (slopes * WEIGHTS * tension) @ slopes.T
    return float(np.sqrt(eigh((K + eta**2 * (G - M))[2:, 2:], M[2:, 2:], eigvals_only=True)[0]))


def divergence(beam: Beam, option_b: bool = False) -> float:
    """Spin at which the lowest motion in the plane diverges, infinite where none does."""
    inertia = -beam.plane_b if option_b else beam.mass - beam.spin
    largest = eigh(inertia, beam.stiffness, eigvals_only=True)[-1]
    return float(1 / np.sqrt(largest)) if largest > 0 else np.inf


def deflection_of_spin_up(beam: Beam, rate: Callable[[float], float],
                          second: Callable[[float], float], t_end: float,
                          shapes: int = 4) -> NDArray:
    """Deflection of the tip while the root turns from rest with a given rate and its derivative.

    Linear in the deflection w: ``M w'' + (K + W^2 (spin - M)) w = -W' M x`` with x the distance
    from the root, in the lowest vibrations of the beam at rest.
    """
    squares, modes = eigh(beam.stiffness, beam.mass, subset_by_index=(0, shapes - 1))
    distance = np.ones(len(beam.mass))          # slopes
    distance[::2] = np.arange(1, len(distance) // 2 + 1) / (len(distance) // 2)
    stiffening = modes.T @ (beam.spin - beam.mass) @ modes
    inertia = modes.T @ beam.mass @ distance

    def rates(t, state):
        q, velocity = state[:shapes], state[shapes:]
        return np.r_[velocity, -squares * q - rate(t)**2 * (stiffening @ q) - second(t) * inertia]
    times = np.linspace(0.0, t_end, 1001)
    solution = solve_ivp(rates, (0.0, t_end), np.zeros(2 * shapes), t_eval=times, rtol=1e-6,
                         atol=1e-8)
    return modes[-2] @ solution.y[:shapes]


def euler_load(beam: Beam) -> float:
    """Fixed-direction axial load that buckles the cantilever, infinite where none does."""
    largest = eigh(-2 * beam.shortening, beam.stiffness, eigvals_only=True)[-1]
    return float(1 / largest) if largest > 1e-6 else np.inf


def beck_load(beam: Beam, highest: float = 80.0) -> float:
    """Load that follows the tip and makes the cantilever flutter, infinite above `highest`."""
    follower = 2 * beam.shortening.copy()
    follower[-2, -1] += 1.0         # the load turns with the slope of the tip

    def stable(load):
        """Least distance of neighbouring frequencies, negative where they have met."""
        squares = eigvals(beam.stiffness + load * follower, beam.mass)
        squares = squares[np.argsort(squares.real)][:4]
        return -np.abs(squares.imag).max() if np.abs(squares.imag).max() > 1e-6 * np.abs(
            squares).max() else 1.0
    loads = np.linspace(1.0, highest, 160)
    bad = [load for load in loads if stable(load) < 0]
    if not bad:
        return np.inf
    return float(brentq(lambda load: np.sign(stable(load)), bad[0] - loads[1] + loads[0], bad[0],
                        xtol=1e-4))
