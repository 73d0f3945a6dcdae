"""Rotors of beam elements in NumPy alone: matrices across the shaft, to compare models with.

Coordinates of a node are the displacements along two directions across and the slopes of these,
(u, u', v, v'). Shapes of Timoshenko's beam are those of a cantilever under forces and moments at
its ends; matrices are integrals of them by Gauss's quadrature.
"""

from typing import NamedTuple

import numpy as np
from rotor_models import RHO, E, G


class Disc(NamedTuple):
    """A disc at a node, with its inertia about the axis and across it."""

    node: int
    mass: float
    polar: float
    across: float

    @classmethod
    def of(cls, node, outer, width, inner=0.05):
        mass = np.pi * (outer**2 - inner**2) / 4 * width * RHO
        squares = outer**2 + inner**2
        return cls(node, mass, mass * squares / 8, mass * (3 * squares / 4 + width**2) / 12)


def shapes(length, shear, s):
    """Deflection and rotation at places s of a beam by the four coordinates of its ends, (4,)."""
    # deflections are cubics w with w' - shear length^2 w''' / 12 as the rotation
    powers = np.array([[1, x, x**2, x**3] for x in (0.0, length)])
    slopes = np.array([[0, 1, 2 * x, 3 * x**2 + shear * length**2 / 2] for x in (0.0, length)])
    inverse = np.linalg.inv(np.vstack([powers[0], slopes[0], powers[1], slopes[1]]))
    w = np.array([1, s, s**2, s**3]) @ inverse
    turn = np.array([0, 1, 2 * s, 3 * s**2 + shear * length**2 / 2]) @ inverse
    bend = np.array([0, 0, 2, 6 * s]) @ inverse
    return w, turn, bend, turn - np.array([0, 1, 2 * s, 3 * s**2]) @ inverse


def element(length, outer, inner):
    """Mass, gyroscopic and stiffness matrices of a plane, (4, 4) each."""
    area, inertia = np.pi / 4 * (outer**2 - inner**2), np.pi / 64 * (outer**4 - inner**4)
    nu, m2 = E / (2 * G) - 1, (inner / outer)**2
    factor = (6 * (1 + nu) * (1 + m2)**2
              / ((7 + 6 * nu) * (1 + m2)**2 + (20 + 12 * nu) * m2))         # Cowper's, of tubes
    shear = 12 * E * inertia / (factor * G * area * length**2)
    M, polar, K = np.zeros((4, 4)), np.zeros((4, 4)), np.zeros((4, 4))
    for point, weight in zip(*np.polynomial.legendre.leggauss(5), strict=True):
        w, turn, bend, slid = shapes(length, shear, length * (1 + point) / 2)
        weight *= length / 2
        M += weight * RHO * (area * np.outer(w, w) + inertia * np.outer(turn, turn))
        polar += weight * RHO * 2 * inertia * np.outer(turn, turn)
        K += weight * (E * inertia * np.outer(bend, bend)
                       + factor * G * area * np.outer(slid, slid))
    return M, polar, K


class Rotor:
    """Matrices of a shaft with discs, in bearings of 2 x 2 stiffness and damping."""

    def __init__(self, lengths, outer, discs, bearings, inner=0.0):
        n = 4 * (len(lengths) + 1)
        self.M, self.polar, self.K, self.C = (np.zeros((n, n)) for _ in range(4))
        for k, length in enumerate(lengths):
            M, polar, K = element(length, outer, inner)
            for first in (0, 2):
                at = [4 * k + first, 4 * k + first + 1, 4 * k + first + 4, 4 * k + first + 5]
                self.M[np.ix_(at, at)] += M
                self.K[np.ix_(at, at)] += K
            one, other = ([4 * k + i, 4 * k + i + 1, 4 * k + i + 4, 4 * k + i + 5] for i in (0, 2))
            self.polar[np.ix_(one, other)] += polar
            self.polar[np.ix_(other, one)] -= polar
        for disc in discs:
            at = 4 * disc.node
            self.M[range(at, at + 4), range(at, at + 4)] += (disc.mass, disc.across) * 2
            self.polar[at + 1, at + 3] += disc.polar
            self.polar[at + 3, at + 1] -= disc.polar
        for node, stiffness, damping in bearings:
            at = np.ix_([4 * node, 4 * node + 2], [4 * node, 4 * node + 2])
            self.K[at] += stiffness
            self.C[at] += damping

    def values(self, speed):
        """Eigenvalues with positive imaginary parts, by ascending size."""
        n = len(self.M)
        rates = -np.linalg.solve(self.M, np.hstack([self.K, self.C + speed * self.polar]))
        found = np.linalg.eigvals(np.block([[np.zeros((n, n)), np.eye(n)], [rates]]))
        found = found[found.imag > 1e-6]
        return found[np.argsort(np.abs(found))]

    def critical_speeds(self, count):
        """Lowest real parts of roots of ``omega = W``, by fixed points of each frequency."""
        found = []
        for k in range(count):
            speed = 0.0
            for _ in range(60):
                speed = np.sort(self.values(speed).imag)[k]
            found.append(speed)
        return np.sort(found)

    def response(self, speed, pushes):
        """Amplitudes (nodes, 2) to ``m r W^2 (1, -i) exp(i phase)`` at nodes."""
        f = np.zeros(len(self.M), dtype=complex)
        for node, size, phase in pushes:
            f[[4 * node, 4 * node + 2]] += speed**2 * size * np.exp(1j * phase) * np.array([1, -1j])
        A = self.K - speed**2 * self.M + 1j * speed * (self.C + speed * self.polar)
        return np.linalg.solve(A, f).reshape(-1, 2, 2)[:, :, 0]
