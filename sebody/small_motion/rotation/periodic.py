"""Models whose matrices are constant in no axes: what turns and what stands is periodic.

Blades are told in multi-blade coordinates and all else that turns in standing axes, see `azimuths`.
Equal blades leave a ripple alone, of which the matrices are averaged over a revolution: after the
transformation, not before. Other rotors are periodic. Their multipliers of a revolution are the
eigenvalues of the product of the tangents of its steps (the monodromy matrix): of Gauss's method of
sixth order, which is stable for stiff motions, too, for ``x' = A(t) x`` with exact matrices.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cholesky, eigh, expm, lu_factor, lu_solve, null_space, solve_triangular

from sebody.basics.errors import InputError
from sebody.results.result import Result
from sebody.runs.rotating_frame import Spin, motion
from sebody.runs.simulation import Simulation
from sebody.small_motion.rotation.azimuths import (
    Base,
    Matrices,
    base_matrices,
    steady,
    substituted,
)
from sebody.small_motion.rotation.blades import Blades

SAMPLES = 16            # azimuths of a revolution; harmonics up to half of them are told apart
ENDED = 1e-8            # of the matrices: highest harmonics that are none
FEWEST, MOST = 32, 256     # steps of a revolution
FREE = 1e-3             # of the speed: exponents of a free turn
SETTLED = 1e-7          # change of exponents by halved steps, of their size or the speed
ROOT = np.sqrt(15.0)
PLACES = np.array([0.5 - ROOT / 10, 0.5, 0.5 + ROOT / 10])      # Gauss's method of three stages
WEIGHTS = np.array([5.0, 8.0, 5.0]) / 18
STAGES = np.array([[5 / 36, 2 / 9 - ROOT / 15, 5 / 36 - ROOT / 30],
                   [5 / 36 + ROOT / 24, 2 / 9, 5 / 36 - ROOT / 24],
                   [5 / 36 + ROOT / 30, 2 / 9 + ROOT / 15, 5 / 36]])


class Coordinates(NamedTuple):
    """Substitution of the unknowns, positions in global axes, by the azimuth."""

    base: Base
    blades: Blades | None

    @classmethod
    def of(cls, run: Simulation | Result, spin: Spin, blades: Blades | None) -> Coordinates:
        """Multi-blade coordinates of blades, standing axes of all else."""
        return cls(Base.of(run, spin), blades)

    def at(self, azimuth: float) -> tuple[NDArray, NDArray, NDArray]:
        """P and its derivatives by the azimuth."""
        base = self.base
        G = base.still
        P = expm(azimuth * np.where(np.outer(base.places, base.places), 0.0, G))
        P1, P2 = G @ P, G @ G @ P
        if self.blades is not None:
            own = self.blades.columns.ravel()
            place = np.ix_(own, own)
            turned = expm(azimuth * base.spatial[place])
            for whole, part in zip((P, P1, P2), self.blades.at(azimuth), strict=True):
                whole[own] = 0.0
                whole[:, own] = 0.0
                whole[place] = turned @ part
        return P, P1, P2


class Revolution(NamedTuple):
    """Matrices of a revolution in the coordinates above, as sums of harmonics."""

    mass: NDArray       # (SAMPLES, n, n) of what moves, likewise the next
    damping: NDArray
    stiffness: NDArray
    constraints: NDArray    # (m, n) at azimuth zero
    moving: NDArray         # (n,) which of the unknowns
    first: Matrices         # of all unknowns at azimuth zero

    @classmethod
    def of(cls, run: Simulation | Result, spin: Spin, own: Coordinates) -> Revolution:
        """That of a model, in a state that its turning part carries round."""
        free = run.numbering.free
        multipliers = np.flatnonzero(run.arrays_of_loop[0].is_multiplier[:free] > 0)
        moving = np.setdiff1d(np.arange(free), multipliers)
        rows: list[Matrices] = []
        constraints = []
        for k in range(SAMPLES):
            azimuth = 2.0 * np.pi * k / SAMPLES
            matrices = base_matrices(run, spin, azimuth)
            with steady(run, spin, azimuth):
                axes = motion(run)[:free].toarray()
            M, C, K = substituted(tuple(axes @ X @ axes.T for X in matrices),
                                  float(np.sqrt(spin.squared)), *own.at(azimuth))
            if k == 0:
                first = M, C, K
            inner = np.ix_(moving, moving)
            rows.append((M[inner], C[inner], K[inner]))
            constraints.append(K[np.ix_(multipliers, moving)])
        found = cls(*(np.array(X) for X in zip(*rows, strict=True)), constraints[0], moving, first)
        found._check(constraints)
        return found

    def _check(self, constraints: list[NDArray]) -> None:
        if len(self.constraints):
            free = null_space(self.constraints)
            lengths = np.maximum(np.linalg.norm(self.constraints, axis=1), 1e-300)[:, None]
            if max(np.abs(G @ free / lengths).max() for G in constraints) > 1e-8:
                raise InputError("joints hold what turns in directions that turn with it, and what "
                                 "stands in others: an analysis of a periodic motion needs joints "
                                 "that are alike at every azimuth, such as a revolute joint")
        last = max(np.abs(np.fft.fft(X, axis=0)[SAMPLES // 2 - 1:SAMPLES // 2 + 2]).max()
                   / np.abs(X).sum(axis=0).max() for X in (self.mass, self.damping, self.stiffness))
        if last > ENDED:
            raise InputError(f"the matrices change with the azimuth by {last:.2g} faster than "
                             f"{SAMPLES // 2} times a revolution, as by what counts turns or slips")

    def averaged(self) -> Matrices:
        """Averages over the revolution; constraints are those at azimuth zero."""
        found = [X.copy() for X in self.first]
        for whole, part in zip(found, (self.mass, self.damping, self.stiffness), strict=True):
            whole[np.ix_(self.moving, self.moving)] = part.mean(axis=0)
        return tuple(found)

    def ripple(self, speed: float) -> float:
        """Largest change over the revolution, of averages in their undamped modes.

        Raises
        ------
        InputError
            There are motions without mass.
        """
        scaled = _Scaled.of(self, speed)
        sizes = [scaled.rates**0, np.sqrt(scaled.rates), scaled.rates]
        return max(float((np.abs(X[1:]) / np.outer(size, size)).max(initial=0.0))
                   for X, size in zip(scaled.harmonics, sizes, strict=True))


class Exponents(NamedTuple):
    """Exponents of periodic motion ``sum_k c_k exp((value + i k W) t)``, the largest at k = 0."""

    values: NDArray     # (m,) complex, of one of each pair
    shapes: NDArray     # (unknowns, m) in the coordinates of the revolution
    rounding: NDArray   # (m,) how far the steps leave them open


def exponents(revolution: Revolution, speed: float) -> Exponents:
    """Exponents of a revolution; frequencies are those of the largest harmonic in standing axes.

    Raises
    ------
    InputError
        The exponents do not settle, or motions without mass.
    """
    scaled = _Scaled.of(revolution, speed)
    steps, last = FEWEST, _turned(scaled, speed, FEWEST)
    while True:
        steps *= 2
        now = _turned(scaled, speed, steps)
        order = [int(np.argmin(np.abs(last.values - one))) for one in now.values]
        change = np.abs(now.values - last.values[order])
        # rates of which steps see nothing, as of stretching, need not settle: `rounding` says so;
        # of the free turn, a double zero, rounding is its root
        low = (now.values.imag <= np.median(now.values.imag)) & (
            np.abs(now.values) > FREE * speed)
        size = np.maximum(np.abs(now.values), speed)
        if np.all(change[low] <= SETTLED * size[low]) or steps >= MOST:
            break
        last = now
    shapes = np.zeros((len(revolution.first[0]), len(now.values)), dtype=complex)
    shapes[revolution.moving] = scaled.shapes @ now.shapes
    return Exponents(now.values, shapes, change / 63.0 + 1e-13 * np.abs(now.values).max())


class _Scaled(NamedTuple):
    """Matrices in undamped modes of their averages: harmonics by fast Fourier transform."""

    harmonics: tuple[NDArray, NDArray, NDArray]     # (SAMPLES, r, r) each
    shapes: NDArray                                 # (n, r)
    rates: NDArray                                  # (r,) that scale displacements

    @classmethod
    def of(cls, revolution: Revolution, speed: float) -> _Scaled:
        N = (null_space(revolution.constraints) if len(revolution.constraints)
             else np.eye(len(revolution.moving)))
        own = revolution.mass, revolution.damping, revolution.stiffness
        M, K = (N.T @ X.mean(axis=0) @ N for X in own[::2])
        try:
            L = cholesky((M + M.T) / 2, lower=True)
        except np.linalg.LinAlgError as error:
            raise InputError("the model has motions without mass, which an analysis of a periodic "
                             "motion does not follow: give every node that moves mass and rotation "
                             "inertia") from error
        inner = solve_triangular(L, solve_triangular(L, K, lower=True).T, lower=True)
        squares, turns = eigh((inner + inner.T) / 2)
        shapes = N @ solve_triangular(L, turns, trans="T", lower=True)
        rates = np.maximum(np.sqrt(np.abs(squares)), speed)
        return cls(tuple(np.fft.fft(shapes.T @ X @ shapes, axis=0) / SAMPLES for X in own), shapes,
                   rates)

    def at(self, azimuth: float) -> NDArray:
        """A of ``x' = A x`` with ``x = (rate u, u')``."""
        waves = np.exp(1j * azimuth * np.fft.fftfreq(SAMPLES, 1.0 / SAMPLES))
        M, C, K = (np.tensordot(waves, X, axes=1).real for X in self.harmonics)
        r = len(self.rates)
        A = np.zeros((2 * r, 2 * r))
        A[:r, r:] = np.diag(self.rates)
        A[r:] = -np.linalg.solve(M, np.hstack([K / self.rates, C]))
        return A


def _turned(scaled: _Scaled, speed: float, steps: int) -> Exponents:
    """Exponents by so many steps."""
    period, r = 2.0 * np.pi / speed, len(scaled.rates)
    h, whole = period / steps, np.eye(2 * r)
    states = []
    for k in range(steps):
        states.append(whole)
        whole = _step([scaled.at(speed * h * (k + c)) for c in PLACES], h, whole)
    multipliers, vectors = np.linalg.eig(whole)
    values = np.log(multipliers) / period
    course = np.array([one @ vectors for one in states])        # (steps, 2 r, 2 r)
    times = h * np.arange(steps)
    course = course * np.exp(-values[None] * times[:, None])[:, None]
    places = course[:, :r] / scaled.rates[None, :, None]
    harmonics = np.fft.fft(places, axis=0) / steps
    shares = np.sum(np.abs(harmonics)**2, axis=1)
    # the mean frequency of the motion says which of the harmonics an alias is of
    rates = np.sum(places.conj() * course[:, r:], axis=(0, 1)).imag
    mean = rates / np.maximum(np.sum(np.abs(places)**2, axis=(0, 1)), 1e-300)
    largest = np.argmax(shares, axis=0)
    turns = largest + steps * np.round(((mean - values.imag) / speed - largest) / steps)
    found = values + 1j * speed * turns
    shapes = harmonics[largest, :, np.arange(len(values))].T
    upper = found.imag >= 0.0
    return Exponents(found[upper], shapes[:, upper], np.zeros(int(upper.sum())))


def _step(A: list[NDArray], h: float, x: NDArray) -> NDArray:
    """The states after a step of Gauss's method, by those before."""
    m = len(x)
    stages = np.eye(3 * m) - h * np.block([[STAGES[i, j] * A[i] for j in range(3)]
                                           for i in range(3)])
    rates = lu_solve(lu_factor(stages), np.vstack([one @ x for one in A]))
    return x + h * np.tensordot(WEIGHTS, rates.reshape(3, m, -1), axes=1)
