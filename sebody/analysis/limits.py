"""Warnings of a run: states in which theory says that its model or its scheme is wrong.

Only few of the recorded states are checked, after the compiled loop, which is not slowed down.
"""

from __future__ import annotations

import warnings
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sebody import inputs
from sebody.analysis.quality import remarks
from sebody.analysis.softening import cautious_limit, divergence, first_frequency, reach
from sebody.analysis.thresholds import FAST, FLAT, LINEAR
from sebody.assembly.numbering import Numbering
from sebody.engine.state import Scheme
from sebody.errors import LimitWarning
from sebody.kernels.layout import RECORD
from sebody.model.mechanism import Mechanism
from sebody.model.parts import Superelement
from sebody.results.recording import Recording, record_counts

STATES = 3000           # states of bodies that are checked in a piece of a run
FEWEST, MOST = 10, 200  # bounds of the recorded states these are taken from


class Watch:
    """Warnings of a run, each given once and kept in `messages`."""

    def __init__(self) -> None:
        self.messages: list[str] = []
        self._said: set[str] = set()
        self._groups: tuple[list[Group], list[Placed]] | None = None

    def say(self, key: str, message: str) -> None:
        """Warn, unless the same was said before."""
        if key not in self._said:
            self._said.add(key)
            self.messages.append(message)
            warnings.warn(message, LimitWarning, stacklevel=4)

    def start(self, bodies: dict[str, Superelement], scheme: Scheme, constrained: bool) -> None:
        """Give the warnings that are known before the first step."""
        undamped = scheme.gamma == 0.5 and scheme.alpha_f == scheme.alpha_m
        if constrained and undamped and not scheme.stabilized:
            self.say("scheme", "without numerical damping the multipliers of index-3 constraints "
                               "oscillate and grow with every disturbance: use rho 0.9, alpha "
                               "-0.05, or index=2")
        for name, body in bodies.items():
            if body.frame == "positions" and _spread(body) < FLAT:
                self.say(f"flat {name}", f"nodes of body {name!r} lie nearly on a line (spread "
                         f"{_spread(body):.1e} of their length): its frame turns about it with "
                         "every small deflection; keep a rotation and take another frame, or a "
                         "node off the line")

    def look(self, model: Mechanism, numbering: Numbering, rows: NDArray) -> None:
        """Compare recorded states with the limits of every body.

        Parameters
        ----------
        rows : (n, numbers of `layout.RECORD`)
        """
        if not len(rows):
            return
        if self._groups is None:
            self._groups = _grouped(model, numbering)
        most = min(max(FEWEST, STATES // max(len(model.bodies), 1)), MOST)
        rows = rows[::-(-len(rows) // most)]
        parts = RECORD.slices(record_counts(numbering))
        rotated, placed = self._groups
        found = [(group, _spins_of_positions(model.planar, group, rows, parts))
                 for group in placed]
        for group in rotated:
            local, spins = _motion(model.planar, group, rows, parts)
            found.append((group, spins))
            for k in np.flatnonzero(local > LINEAR):
                name = group.bodies[k].name
                self.say(f"turn {name}", f"local rotation {local[k]:.2g} rad of body {name!r} "
                         f"exceeds the linear range, {LINEAR} rad: divide it")
        for group, spins in found:
            speeds = np.linalg.norm(spins, axis=2)
            for k in np.flatnonzero(speeds.max(axis=0) > group.least):
                row = int(np.argmax(speeds[:, k]))
                self._compare(group.bodies[k], spins[row, k], speeds[row, k])

    def judge(self, run: Recording) -> tuple[str, ...]:
        """All warnings of a run as far as it has come, with those of its energies and steps.

        These may pass while a run goes on: an energy that is small at first is kept to less well.
        """
        now = remarks(run)
        for key, message in now.items():
            if key not in self._said:
                self._said.add(key)
                warnings.warn(message, LimitWarning, stacklevel=3)
        return *self.messages, *now.values()

    def _compare(self, body: Superelement, spin: NDArray, speed: float) -> None:
        keys = f"spin {body.name}", f"fast {body.name}"
        if keys[0] in self._said:
            return
        axis = np.array([0.0, 0.0, 1.0]) if body.body.planar else spin / speed
        felt, limit = speed * reach(body, axis), divergence(body, axis)
        if felt > limit:
            self.say(keys[0], f"spin {speed:.3g} rad/s is above the limit {limit:.3g} of body "
                     f"{body.name!r}, whose stiffness does not grow with it: {_remedy(body)}")
        elif keys[1] not in self._said and felt > FAST * min(limit, first_frequency(body)):
            self.say(keys[1], f"body {body.name!r} spins at {speed:.3g} rad/s, more than a quarter "
                     f"of {_compared(limit, first_frequency(body))}: its stiffness does not grow "
                     "with the spin, and frequencies are off by a per cent and more; "
                     f"{_remedy(body)}")


class Group(NamedTuple):
    """Bodies with the same number of moving rotations, m each."""

    bodies: list[Superelement]
    frames: NDArray         # (b,) numbers of their frames
    places: NDArray         # (b, m) first coordinates of the rotations
    rotations: NDArray      # (b, m) numbers of the rotation matrices, in space
    weights: NDArray        # (b, m) frame weights of the rotations
    least: NDArray          # (b,) spins below which nothing is compared


class Placed(NamedTuple):
    """Bodies whose frames follow their positions, the same number of them, p."""

    bodies: list[Superelement]
    frames: NDArray         # (b,) numbers of their frames
    places: NDArray         # (b, p) first coordinates of the positions
    least: NDArray          # (b,) spins below which nothing is compared


def _grouped(model: Mechanism, numbering: Numbering) -> tuple[list[Group], list[Placed]]:
    rotated: dict[int, list] = {}
    placed: dict[int, list] = {}
    limits: dict[tuple, float] = {}
    for k, body in enumerate(model.bodies.values()):
        parts = [(numbering.triplets[id(t)], numbering.rotations.get(id(t), 0), weight)
                 for t, weight in zip(body.rotations, body.alpha_r, strict=True)
                 if id(t) in numbering.triplets]
        key = id(body.body), body.frame, body.inertia, body.stiffening, tuple(body.alpha_r)
        if key not in limits:
            limits[key] = np.inf if body.stiffening else FAST * cautious_limit(body)
        least = limits[key]
        if body.frame == "positions":
            places = [numbering.triplets[id(t)] for t in body.positions]
            placed.setdefault(len(places), []).append((body, k, places, least))
            least = np.inf
        if parts:
            rotated.setdefault(len(parts), []).append((body, k, *zip(*parts, strict=True), least))
    return ([Group(list(bodies), *map(np.array, columns))
             for bodies, *columns in (zip(*rows, strict=True) for rows in rotated.values())],
            [Placed(list(bodies), *map(np.array, columns))
             for bodies, *columns in (zip(*rows, strict=True) for rows in placed.values())])


def spin_limit(body: Superelement, axis: ArrayLike | None) -> float:
    """Spin about an axis of the frame at which one body diverges, by its linearisation.

    In axes that spin with it the body has the stiffness ``S - W^2 D``, see
    `sebody.analysis.softening`; one node stays where it is. The limit is the lowest that any node,
    held with the frame or by itself, gives. Of bodies without geometric stiffening it says when
    they fail: in bending, and with option B in torsion. Stiffened ones diverge where the structure
    does: slender ones at the critical speed of rotation about their own axis.

    Parameters
    ----------
    axis : (3,) or None
        Direction; None for a lower bound over all axes.

    Raises
    ------
    InputError
        No superelement, or no direction.
    """
    inputs.instance(body, "body", Superelement, "give a superelement of a model")
    planar = body.body.planar
    if axis is not None:
        axis = inputs.vector(axis, "axis", None if planar else 3)
        if not np.any(axis):
            raise inputs.refusal("axis", axis, "give its direction")
        axis = axis / np.linalg.norm(axis)
    return divergence(body, np.array([0.0, 0.0, 1.0]) if planar else axis)


def _remedy(body: Superelement) -> str:
    """What to do about a spin."""
    if body.body.invariants is None:
        return "divide it in two, or reduce it from an FE model with its mass"
    if body.inertia != "c":
        return "divide it in two, or take inertia='c'"
    if body.body.invariants.stiffens:
        return "divide it in two, or let it stiffen with stiffening=True"
    return "divide it in two, or give its FE model a geometric stiffness"


def _compared(limit: float, first: float) -> str:
    """What a fast spin is compared with."""
    if first < limit:
        return f"{first:.3g}, the body's first frequency with one node held"
    return f"{limit:.3g}, where it diverges"


def _spread(body: Superelement) -> float:
    """Second largest extent of the nodes that keep a position, of the largest."""
    points = body.body.coordinates[list(body.body.position_nodes)]
    extents = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)
    return float(extents[1] / extents[0]) if len(extents) > 1 and extents[0] > 0 else 0.0


def _motion(planar: bool, group: Group, rows: NDArray, parts: dict) -> tuple[NDArray, NDArray]:
    """Largest local rotations, (b,), and spins of the frames in their own axes, (n, b, 3 or 1)."""
    n, shape = len(rows), group.places.shape
    frames = rows[:, parts["frames"]].reshape(n, -1, 3, 3)[:, group.frames]
    v = rows[:, parts["v"]]
    if planar:
        angles = np.arctan2(frames[..., 1, 0], frames[..., 0, 0])
        turns = rows[:, parts["q"]][:, group.places] - angles[..., None]
        local = np.abs(np.angle(np.exp(1j * turns)))
        return local.max(axis=(0, 2)), (group.weights * v[:, group.places]).sum(axis=2)[..., None]
    R = rows[:, parts["R"]].reshape(n, -1, 3, 3)[:, group.rotations]
    relative = np.swapaxes(frames, 2, 3)[:, :, None] @ R
    cosines = (np.trace(relative, axis1=3, axis2=4) - 1.0) / 2.0
    local = np.arccos(np.clip(cosines, -1.0, 1.0))
    rates = v[:, group.places[..., None] + np.arange(3)].reshape(n, *shape, 3, 1)
    spins = (group.weights[..., None] * (relative @ rates)[..., 0]).sum(axis=2)
    return local.max(axis=(0, 2)), spins


def _spins_of_positions(planar: bool, group: Placed, rows: NDArray, parts: dict) -> NDArray:
    """Spins of frames of best fit in their own axes, (n, b, 3 or 1).

    Of a body that moves as the nodes do, by the moment of their velocities about their mean.
    """
    n, d = len(rows), 2 if planar else 3
    at = group.places[..., None] + np.arange(d)
    frames = rows[:, parts["frames"]].reshape(n, -1, 3, 3)[:, group.frames, :d, :d]
    arms, rates = ((x - x.mean(axis=2, keepdims=True)) @ frames
                   for x in (rows[:, parts[name]][:, at] for name in ("q", "v")))
    if planar:
        moments = arms[..., 0] * rates[..., 1] - arms[..., 1] * rates[..., 0]
        return (moments.sum(axis=2) / (arms**2).sum(axis=(2, 3)))[..., None]
    moments = np.cross(arms, rates).sum(axis=2)
    squares = np.swapaxes(arms, 2, 3) @ arms
    inertia = np.trace(squares, axis1=2, axis2=3)[..., None, None] * np.eye(3) - squares
    return (np.linalg.pinv(inertia) @ moments[..., None])[..., 0]
