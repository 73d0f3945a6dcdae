"""What a run is warned of: states in which theory says that its model or its scheme is wrong.

Checked on few of the recorded states, after the compiled loop: it costs the loop nothing.
"""

import warnings
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigh, null_space

from .errors import LimitWarning
from .state import Scheme, recorded_parts

if TYPE_CHECKING:
    from .integrator import Simulation
    from .model import Superelement

LINEAR = 0.3            # rad, local rotation up to which stiffness is linear, see README
SAMPLES = 100           # states of a stretch of a run that are looked at
FLAT = 1e-3             # smallest to largest spread of nodes that a frame can live on


class Watch:
    """Warnings of a run, each given once and kept in `messages`."""

    def __init__(self) -> None:
        self.messages: list[str] = []
        self._said: set[str] = set()
        self._limits: dict[tuple, float] = {}

    def say(self, key: str, message: str) -> None:
        """Warn, unless the same was said before."""
        if key not in self._said:
            self._said.add(key)
            self.messages.append(message)
            warnings.warn(message, LimitWarning, stacklevel=4)

    def start(self, bodies: dict[str, "Superelement"], scheme: Scheme, constrained: bool) -> None:
        """What is known before the first step."""
        undamped = scheme.gamma == 0.5 and scheme.alpha_f == scheme.alpha_m
        if constrained and undamped and not scheme.stabilized:
            self.say("scheme", "without numerical damping the multipliers of index-3 constraints "
                               "oscillate and grow with every disturbance: use rho 0.9, alpha "
                               "-0.05, or index=2")
        for name, body in bodies.items():
            spread = _spread(body)
            if body.frame == "positions" and spread < FLAT:
                self.say(f"flat {name}", f"nodes of body {name!r} lie nearly on a line (spread "
                         f"{spread:.1e} of their length): its frame turns about it with every "
                         "small deflection; keep a rotation and take another frame, or a node "
                         "off the line")

    def look(self, run: "Simulation", rows: NDArray) -> None:
        """Compare recorded states with the limits of every body."""
        if not len(rows) or not run.model.bodies:
            return
        rows = rows[::max(1, len(rows) // SAMPLES)]
        parts = recorded_parts(run.numbering.total, len(run.numbering.rotations),
                               len(run.model.bodies), len(run.numbering.histories))
        for k, (name, body) in enumerate(run.model.bodies.items()):
            frames = rows[:, parts["frames"]].reshape(len(rows), -1, 9)[:, k].reshape(-1, 3, 3)
            turned, spins = _motion(run, rows, parts, body, frames)
            if turned > LINEAR and f"turn {name}" not in self._said:
                self.say(f"turn {name}", f"local rotation {turned:.2g} rad of body {name!r} "
                         f"exceeds the linear range, {LINEAR} rad: divide it")
            if f"spin {name}" not in self._said:
                self._watch_spin(name, body, spins)

    def _watch_spin(self, name: str, body: "Superelement", spins: NDArray) -> None:
        speed = np.linalg.norm(spins, axis=1)
        fastest = int(np.argmax(speed))
        if speed[fastest] > self._least(name, body):
            limit = spin_limit(body, spins[fastest] / speed[fastest])
            if speed[fastest] > limit:
                self.say(f"spin {name}", f"spin {speed[fastest]:.3g} rad/s is above the limit "
                         f"{limit:.3g} of body {name!r}, whose stiffness does not grow with it: "
                         "divide it in two")

    def _least(self, name: str, body: "Superelement") -> float:
        """A lower bound of the limit for any axis: stiffness against all inertia."""
        key = id(body.body), body.frame
        if key not in self._limits:
            self._limits[key] = spin_limit(body, None)
        return self._limits[key]


def spin_limit(body: "Superelement", axis: NDArray | None) -> float:
    """Spin about an axis of the frame at which one linear body diverges.

    With options A and B the kinetic energy of a steady spin W is that of the velocities
    ``W axis x x`` of the nodes, so deflections feel the stiffness ``S - W^2 A^T M A`` with
    ``A = skew(axis)`` at positions. What the frame follows does not deflect, and one node is the
    pivot: the worst one.

    Parameters
    ----------
    axis : (3,) or None
        Unit vector; None for the smallest value that any axis could have.
    """
    reduced = body.body
    planar, count = reduced.planar, len(reduced.position_nodes)
    d, size = (2, 1) if planar else (3, 3)
    n = reduced.stiffness.shape[0]
    turn = np.zeros((n, n))
    if axis is None:
        turn[:d * count, :d * count] = np.eye(d * count)
    else:
        own = (np.array([[0.0, -1.0], [1.0, 0.0]]) if planar else
               np.cross(np.eye(3), axis).T)
        for i in range(count):
            turn[d * i:d * i + d, d * i:d * i + d] = own
    inertia = turn.T @ reduced.mass @ turn
    lowest = np.inf
    for pivot in range(count):
        held = np.zeros((d + size, n))
        held[:d, d * pivot:d * pivot + d] = np.eye(d)
        for j, weight in enumerate(body.alpha_r):
            first = d * count + size * j
            held[d:, first:first + size] = weight * np.eye(size)
        if body.frame == "positions":
            held[d:] = _fit(reduced)
        free = null_space(held)
        largest = eigh(free.T @ inertia @ free, free.T @ reduced.stiffness @ free,
                       eigvals_only=True)[-1]
        lowest = min(lowest, 1 / np.sqrt(largest) if largest > 0 else np.inf)
    return float(lowest)


def _fit(reduced) -> NDArray:
    """Turn of the best fit by small deflections, rows of ``sum X_j x u_j``."""
    points = reduced.coordinates[list(reduced.position_nodes)]
    points = points - points.mean(axis=0)
    rows = np.zeros((3, reduced.stiffness.shape[0]))
    for j, X in enumerate(points):
        rows[:, 3 * j:3 * j + 3] = np.cross(np.eye(3), X).T
    return rows


def _spread(body: "Superelement") -> float:
    """Second largest extent of the nodes that keep a position, of the largest."""
    points = body.body.coordinates[list(body.body.position_nodes)]
    extents = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)
    return float(extents[1] / extents[0]) if len(extents) > 1 and extents[0] > 0 else 0.0


def _motion(run: "Simulation", rows: NDArray, parts: dict, body: "Superelement",
            frames: NDArray) -> tuple[float, NDArray]:
    """Largest local rotation, and the spin of the frame in its own axes, (n, 3) or (n, 1)."""
    q, v = rows[:, parts["q"]], rows[:, parts["v"]]
    numbering = run.numbering
    triplets = [t for t in body.rotations if id(t) in numbering.triplets]
    if not triplets:
        return 0.0, np.zeros((len(rows), 1))
    weights = dict(zip(map(id, body.rotations), body.alpha_r, strict=True))
    turned, spins = 0.0, 0.0
    for triplet in triplets:
        at = numbering.triplets[id(triplet)]
        if run.model.planar:
            frame = np.arctan2(frames[:, 1, 0], frames[:, 0, 0])
            local = np.abs(np.angle(np.exp(1j * (q[:, at] - frame))))
            spins = spins + weights[id(triplet)] * v[:, at:at + 1]
        else:
            k = numbering.rotations[id(triplet)]
            R = rows[:, parts["R"]][:, 9 * k:9 * k + 9].reshape(-1, 3, 3)
            relative = np.einsum("nji,njk->nik", frames, R)
            trace = np.clip((np.trace(relative, axis1=1, axis2=2) - 1) / 2, -1.0, 1.0)
            local = np.arccos(trace)
            spins = spins + weights[id(triplet)] * np.einsum("nij,nj->ni", relative,
                                                             v[:, at:at + 3])
        turned = max(turned, float(local.max()))
    return turned, spins
