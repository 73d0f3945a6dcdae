"""Warnings of a run: states in which theory says that its model or its scheme is wrong.

Only few of the recorded states are checked, after the compiled loop, which is not slowed down.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sebody import inputs
from sebody.analysis.quality import remarks
from sebody.analysis.softening import cautious_limit, divergence, first_frequency, reach
from sebody.analysis.thresholds import BENT, FAST, FLAT, LINEAR, OFF_LINE
from sebody.assembly.motions import Motions, motions
from sebody.assembly.numbering import Numbering
from sebody.engine.state import Scheme
from sebody.errors import LimitWarning
from sebody.kernels.layout import MOTION, Counts
from sebody.model.frames import FRAMES
from sebody.model.mechanism import Mechanism
from sebody.model.parts import Superelement
from sebody.results.motion import evaluated
from sebody.results.recording import Recording, record_counts

STATES = 3000           # states of bodies that are checked in a piece of a run
FEWEST, MOST = 10, 200  # bounds of the recorded states these are taken from


class Watch:
    """Warnings of a run, each given once and kept in `messages`."""

    def __init__(self) -> None:
        self.messages: list[str] = []
        self._said: set[str] = set()
        self._groups: list[Motions] | None = None
        self._least: dict[str, float] = {}
        self._off_line: dict[str, bool] = {}

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
                               "oscillate and grow after any disturbance: use rho 0.9, alpha "
                               "-0.05, or index=2")
        for name, body in bodies.items():
            follows = not FRAMES[body.frame].traits.needs_rotations
            if follows and not body.body.planar and _spread(body) < FLAT:
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
            self._groups = motions(model, numbering, model.bodies.values())
            self._least = _least_spins(model.bodies.values())
            self._off_line = {name: _off_line(body) for name, body in model.bodies.items()}
        most = min(max(FEWEST, STATES // max(len(model.bodies), 1)), MOST)
        rows = rows[::-(-len(rows) // most)]
        for group in self._groups:
            found, _ = evaluated(group, rows, record_counts(numbering))
            parts = MOTION.slices(group.counts)
            local = _local_rotations(found[:, :, parts["y"]], group.counts).max(axis=0)
            spins = found[:, :, parts["spin"]]
            speeds = np.linalg.norm(spins, axis=2)
            for k, name in enumerate(group.bodies):
                if local[k] > LINEAR:
                    self.say(f"turn {name}", f"local rotation {local[k]:.2g} rad of body {name!r} "
                             f"exceeds the linear range, {LINEAR} rad: divide the body")
                if local[k] > BENT and self._off_line[name]:
                    self.say(f"bent {name}", f"local rotation {local[k]:.2g} rad of body {name!r}, "
                             "whose frame follows the rotations of its nodes while its mass is off "
                             f"their line (limit {BENT} rad): its inertia depends too much on how "
                             "it is bent, and energy may grow; keep the position of a node off the "
                             "line, such as a corner, or divide the body")
                if speeds[:, k].max() > self._least[name]:
                    row = int(np.argmax(speeds[:, k]))
                    self._compare(model.bodies[name], spins[row, k], speeds[row, k])

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
                     f"{body.name!r}, whose stiffness does not grow with spin: {_remedy(body)}")
        elif keys[1] not in self._said and felt > FAST * min(limit, first_frequency(body)):
            self.say(keys[1], f"body {body.name!r} spins at {speed:.3g} rad/s, more than a quarter "
                     f"of {_compared(limit, first_frequency(body))}: its stiffness does not grow "
                     "with the spin, and frequencies are wrong by 1 % or more; "
                     f"{_remedy(body)}")


def _least_spins(bodies: Iterable[Superelement]) -> dict[str, float]:
    """Spins below which nothing is compared, by body."""
    limits: dict[tuple, float] = {}
    found = {}
    for body in bodies:
        key = id(body.body), body.frame, body.inertia, body.stiffening, tuple(body.alpha_r)
        if key not in limits:
            limits[key] = np.inf if body.stiffening else FAST * cautious_limit(body)
        found[body.name] = limits[key]
    return found


def _local_rotations(y: NDArray, counts: Counts) -> NDArray:
    """Largest rotation of a node against its frame, (states, bodies), from local coordinates."""
    first, turns = counts["D"] * counts["N_POSITIONS"], counts["turns"]
    psi = y[..., first:first + turns * counts["N_ROTATIONS"]].reshape(*y.shape[:2], -1, turns)
    return np.linalg.norm(psi, axis=3).max(axis=2, initial=0.0)


def _off_line(body: Superelement) -> bool:
    """Whether a body of option C has its frame on rotations, and its mass off the nodes' line."""
    if body.inertia != "c" or body.frame == "positions" or len(body.positions) < 2:
        return False
    reduced = body.body
    points = reduced.coordinates[list(reduced.position_nodes)]
    middle = points.mean(axis=0)
    _, extents, axes = np.linalg.svd(points - middle)
    if reduced.planar:          # what is known of the mass off a line is its centre
        off = abs(axes[1] @ (reduced.centre_of_mass - middle))
    else:
        off = np.sqrt(axes[0] @ reduced.invariants.about(middle).J0 @ axes[0] / reduced.total_mass)
    return bool(off > OFF_LINE * np.ptp((points - middle) @ axes[0]))


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
