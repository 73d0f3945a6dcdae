"""Motion of a body's floating frame and of its reduced coordinates in recorded states.

Everything follows from the recorded positions, rotations, velocities and accelerations of the
body's nodes; the recorded frame is where the search for the rotation begins. Rates are the exact
derivatives of the definition of the frame. Frames that average the increments of a step have those
of the converged mean, which differ by terms of second order in the elastic rotations.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.assembly.numbering import stretch
from sebody.errors import InputError
from sebody.model.frames import FRAMES
from sebody.model.parts import Superelement
from sebody.results import rotations
from sebody.results.recording import Recording

ITERATIONS = 30
DONE = 1e-8         # of a step of Newton's iteration: the error left is its square
SERIES = 0.25       # squared angle below which closed forms lose digits


class BodyMotion(NamedTuple):
    """Frame and reduced coordinates of a body in n states; D is 3, in a plane 2.

    Velocities and accelerations are those in space, by components along the axes of the frame.
    """

    origin: NDArray             # (n, D) in global axes
    rotation: NDArray           # (n, D, D) from axes of the frame to global ones
    velocity: NDArray           # (n, D) of the origin
    spin: NDArray               # (n, 3), in a plane (n, 1)
    acceleration: NDArray       # (n, D) of the origin
    spin_rate: NDArray          # (n, 3), in a plane (n, 1)
    y: NDArray                  # (n, N) reduced coordinates, relative to the frame
    y_rate: NDArray             # (n, N)
    y_second: NDArray           # (n, N)


def body_motion(recording: Recording, body: Superelement, rows: slice | NDArray) -> BodyMotion:
    """Motion of a superelement in some of the recorded states.

    Raises
    ------
    InputError
        A recorded state in which the frame is not defined.
    """
    q, v, a = (recording.recorded(name)[rows] for name in "qva")
    places = [stretch(recording.numbering, t) for t in body.positions]
    turns = [stretch(recording.numbering, t) for t in body.rotations]
    first = recording.numbering.modes[body.name]
    modes = slice(first, first + body.body.modes)
    x, xd, xdd = (_nodes(values, places) for values in (q, v, a))
    angular, angular_rate = (_nodes(values, turns) for values in (v, a))
    parts = _Planar if recording.model.planar else _Spatial
    found = parts(recording, body, rows, turns, q)
    origin, velocity, acceleration = (body.alpha @ values for values in (x, xd, xdd))
    # of the nodes relative to the origin, in axes of the frame once it is known
    relative = [values - middle[:, None] for values, middle in (
        (x, origin), (xd, velocity), (xdd, acceleration))]
    points = body.body.coordinates[list(body.body.position_nodes)]
    X = points - body.alpha @ points
    found.locate(body, relative[0], X)
    R = found.rotation
    r, rd, rdd = (values @ R for values in relative)
    found.turn(body, X, r, rd, rdd, angular, angular_rate)
    spin, spin_rate = found.spin, found.spin_rate
    # rates of r seen in the frame: r' = rd - spin x r
    local_rate = rd - found.cross(spin, r)
    local_second = (rdd - found.cross(spin_rate, r) - found.cross(spin, found.cross(spin, r))
                    - 2 * found.cross(spin, local_rate))
    n = len(x)
    y, y_rate, y_second = (
        np.hstack([moved.reshape(n, -1), rotated.reshape(n, -1), values[:, modes]])
        for moved, rotated, values in ((r - X, found.psi, q), (local_rate, found.psi_rate, v),
                                      (local_second, found.psi_second, a)))
    return BodyMotion(origin, R, _turned_back(R, velocity), spin, _turned_back(R, acceleration),
                      spin_rate, y, y_rate, y_second)


def _nodes(values: NDArray, places: list[slice]) -> NDArray:
    """Values of some triplets, (n, triplets, size)."""
    if not places:
        return np.zeros((len(values), 0, 1))
    return np.stack([values[:, place] for place in places], axis=1)


def _turned_back(R: NDArray, vectors: NDArray) -> NDArray:
    return np.einsum("nji,nj->ni", R, vectors)


class _Planar:
    """The frame in a plane, where rotations are angles."""

    def __init__(self, recording: Recording, body: Superelement, rows: slice | NDArray,
                 turns: list[slice], q: NDArray):
        self._angles = _nodes(q, turns)[:, :, 0]

    @staticmethod
    def cross(spin: NDArray, vectors: NDArray) -> NDArray:
        """``spin x r``, (n, nodes, 2)."""
        return spin[:, None] * np.stack([-vectors[..., 1], vectors[..., 0]], axis=-1)

    def locate(self, body: Superelement, arms: NDArray, X: NDArray) -> None:
        """The rotation of the frame, and angles in it between -pi and pi."""
        if FRAMES[body.frame].traits.needs_rotations:
            angle = self._angles @ body.alpha_r
        else:
            angle = np.arctan2(_planar_moment(X, arms).sum(axis=1),
                               np.einsum("jk,njk->n", X, arms))
        c, s = np.cos(angle), np.sin(angle)
        self.rotation = np.stack([c, -s, s, c], axis=1).reshape(-1, 2, 2)
        psi = self._angles - angle[:, None]
        if not FRAMES[body.frame].traits.needs_rotations:
            psi = psi - 2 * np.pi * np.floor(psi / (2 * np.pi) + 0.5)
        self.psi = psi

    def turn(self, body: Superelement, X: NDArray, r: NDArray, rd: NDArray, rdd: NDArray,
             angular: NDArray, angular_rate: NDArray) -> None:
        """Rates of the frame, and of the angles in it."""
        if FRAMES[body.frame].traits.needs_rotations:
            spin, rate = angular[:, :, 0] @ body.alpha_r, angular_rate[:, :, 0] @ body.alpha_r
        else:
            inertia = np.einsum("jk,njk->n", X, r)
            spin = _planar_moment(X, rd).sum(axis=1) / inertia
            seen = rd - self.cross(spin[:, None], r)
            # r'' has no moment: the part of the spin's rate that rdd and the rest leave
            rest = rdd - 2 * self.cross(spin[:, None], seen) + spin[:, None, None]**2 * r
            rate = _planar_moment(X, rest).sum(axis=1) / inertia
        self.spin, self.spin_rate = spin[:, None], rate[:, None]
        self.psi_rate = angular[:, :, 0] - self.spin
        self.psi_second = angular_rate[:, :, 0] - self.spin_rate


def _planar_moment(X: NDArray, vectors: NDArray) -> NDArray:
    """``X_j x b_j``, (n, nodes)."""
    return X[:, 0] * vectors[..., 1] - X[:, 1] * vectors[..., 0]


class _Spatial:
    """The frame in space."""

    def __init__(self, recording: Recording, body: Superelement, rows: slice | NDArray,
                 turns: list[slice], q: NDArray):
        numbering, name = recording.numbering, body.name
        k = list(recording.model.bodies).index(name)
        self.rotation = recording.recorded("frames")[rows, 9 * k:9 * k + 9].reshape(-1, 3, 3)
        R = recording.recorded("R")[rows].reshape(len(q), -1, 3, 3)
        self._nodes = R[:, [numbering.rotations[id(t)] for t in body.rotations]]

    @staticmethod
    def cross(spin: NDArray, vectors: NDArray) -> NDArray:
        """``spin x r``, (n, nodes, 3)."""
        return np.cross(spin[:, None], vectors)

    def locate(self, body: Superelement, arms: NDArray, X: NDArray) -> None:
        """The rotation of the frame by Newton's iteration, and rotation vectors in it."""
        traits = FRAMES[body.frame].traits
        for _ in range(1 if traits.incremental else ITERATIONS):
            step = (self._mean_step(body) if traits.needs_rotations else
                    self._fit_step(X, arms @ self.rotation))
            self.rotation = self.rotation @ rotations.matrices(step)
            if not np.abs(step).max(initial=0.0) > DONE:
                break
        else:
            if not traits.incremental:
                raise InputError(f"the frame of body {body.name!r} is not defined in a recorded "
                                 "state")
        self.psi = self._logarithms()

    def _logarithms(self) -> NDArray:
        """``log(R0^T R_j)``, (n, nodes, 3)."""
        relative = self.rotation[:, None].transpose(0, 1, 3, 2) @ self._nodes
        if not relative.size:
            return np.zeros((len(relative), 0, 3))
        return rotations.vectors(relative.reshape(-1, 3, 3)).reshape(len(relative), -1, 3)

    def _mean_step(self, body: Superelement) -> NDArray:
        """Newton's step to ``sum alpha_j psi_j = 0``; the increment itself if it is averaged."""
        psi = self._logarithms()
        mean = body.alpha_r @ psi
        if FRAMES[body.frame].traits.incremental:
            return mean
        return _solved(_weighted_inverse(body.alpha_r, psi), mean)

    @staticmethod
    def _fit_step(X: NDArray, r: NDArray) -> NDArray:
        """Newton's step to ``sum X_j x r_j = 0``."""
        return _solved(_fit_matrix(X, r), np.cross(X, r).sum(axis=1))

    def turn(self, body: Superelement, X: NDArray, r: NDArray, rd: NDArray, rdd: NDArray,
             angular: NDArray, angular_rate: NDArray) -> None:
        """Rates of the frame, and of the rotation vectors in it.

        ``psi' = T^-1(psi) w`` with ``w = Omega_j - exp(-psi) Omega_0``, differentiated once more.
        """
        psi, alpha = self.psi, body.alpha_r
        if not FRAMES[body.frame].traits.needs_rotations:
            matrix = _fit_matrix(X, r)
            self.spin = _solved(matrix, np.cross(X, rd).sum(axis=1))
            seen = rd - self.cross(self.spin, r)
            rest = (rdd - 2 * self.cross(self.spin, seen)
                    - self.cross(self.spin, self.cross(self.spin, r)))
            self.spin_rate = _solved(matrix, np.cross(X, rest).sum(axis=1))
        else:
            matrix = _weighted_inverse(alpha, psi)
            self.spin = _solved(matrix, alpha @ _inverse_tangent(psi, angular))
        back = rotations.matrices(-psi.reshape(-1, 3)).reshape(*psi.shape, 3)
        carried = np.einsum("njkl,nl->njk", back, self.spin)        # exp(-psi) Omega_0
        w = angular - carried
        self.psi_rate = _inverse_tangent(psi, w)
        known = (_inverse_tangent_rate(psi, self.psi_rate, w)
                 + _inverse_tangent(psi, angular_rate + np.cross(w, carried)))
        if FRAMES[body.frame].traits.needs_rotations:
            self.spin_rate = _solved(matrix, alpha @ known)
        rotated = np.einsum("njkl,nl->njk", back, self.spin_rate)
        self.psi_second = known - _inverse_tangent(psi, rotated)


def _solved(matrices: NDArray, vectors: NDArray) -> NDArray:
    return np.linalg.solve(matrices, vectors[..., None])[..., 0]


def _fit_matrix(X: NDArray, r: NDArray) -> NDArray:
    """``sum X_j . r_j I - r_j X_j^T``, by which a spin has the moments ``X_j x (spin x r_j)``."""
    dyad = np.einsum("njk,jl->nkl", r, X)
    return np.trace(dyad, axis1=1, axis2=2)[:, None, None] * np.eye(3) - dyad


def _weighted_inverse(alpha: NDArray, psi: NDArray) -> NDArray:
    """``B = sum alpha_j T^-T(psi_j)``, by which the frame turns psi on the whole, (n, 3, 3)."""
    columns = [alpha @ _inverse_tangent(-psi, np.broadcast_to(axis, psi.shape))
               for axis in np.eye(3)]
    return np.stack(columns, axis=2)


def _inverse_tangent(psi: NDArray, w: NDArray) -> NDArray:
    """``T^-1(psi) w = w + psi x w / 2 + e psi x (psi x w)``."""
    e, _ = _coefficients(psi)
    rotated = np.cross(psi, w)
    return w + rotated / 2 + e * np.cross(psi, rotated)


def _inverse_tangent_rate(psi: NDArray, rate: NDArray, w: NDArray) -> NDArray:
    """The rate of ``T^-1(psi)`` as psi changes at `rate`, times w."""
    e, slope = _coefficients(psi)
    rotated = np.cross(psi, w)
    along = 2 * np.einsum("njk,njk->nj", psi, rate)[..., None]
    return (np.cross(rate, w) / 2 + slope * along * np.cross(psi, rotated)
            + e * (np.cross(rate, rotated) + np.cross(psi, np.cross(rate, w))))


def _coefficients(psi: NDArray) -> tuple[NDArray, NDArray]:
    """e of ``T^-1`` and its derivative by ``s = |psi|^2``: ``e = (1 - t/2 cot t/2) / s``."""
    s = np.einsum("njk,njk->nj", psi, psi)[..., None]
    far = np.where(s < SERIES, 1.0, s)
    t = np.sqrt(far)
    half = t / 2
    gap = 1 - half / np.tan(half)
    by_t = -0.5 / np.tan(half) + half / (2 * np.sin(half)**2)       # of the gap
    near = np.where(s < SERIES, s, 0.0)
    e = 1 / 12 + near * (1 / 720 + near * (1 / 30240 + near * (1 / 1209600 + near * (
        1 / 47900160 + near * (691 / 1307674368000 + near / 74724249600)))))
    slope = 1 / 720 + near * (1 / 15120 + near * (1 / 403200 + near * (1 / 11975040 + near * (
        691 / 261534873600 + near / 12454041600))))
    return (np.where(s < SERIES, e, gap / far),
            np.where(s < SERIES, slope, by_t / (2 * t * far) - gap / far**2))
