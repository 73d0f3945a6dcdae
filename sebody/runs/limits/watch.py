"""Warnings of a run: states in which theory says that its model or its scheme is wrong.

Only few of the recorded states are checked, after the compiled loop, which is not slowed down.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sebody.assembly.motions import motions
from sebody.basics import inputs
from sebody.basics.warned import warn
from sebody.contract.layout import MOTION
from sebody.engine.state import Scheme
from sebody.model.mechanism import Mechanism
from sebody.model.numbering import Numbering, record_counts
from sebody.model.parts import Superelement
from sebody.quantities.reading import Motions
from sebody.results.motion import evaluated
from sebody.results.recording import Recording
from sebody.runs.limits.body_limits import (
    Finding,
    Limits,
    between_nodes,
    exceeded,
    flat,
    limits_of,
    local_rotations,
)
from sebody.runs.limits.quality import remarks
from sebody.runs.limits.spin_stability import divergence

STATES = 3000           # states of bodies that are checked in a piece of a run
FEWEST, MOST = 10, 200  # bounds of the recorded states these are taken from
NAMED = 3               # other bodies whose names a warning gives


class Watch:
    """Warnings of a run, each given once and kept in `messages`."""

    def __init__(self) -> None:
        self.messages: list[str] = []
        self._said: set[str] = set()
        self._groups: list[Motions] | None = None
        self._limits: dict[str, Limits] = {}

    def say(self, key: str, message: str) -> None:
        """Warn, unless that was said before."""
        if key not in self._said:
            self._said.add(key)
            self.messages.append(message)
            warn(message)

    def say_of_bodies(self, found: Iterable[Finding]) -> None:
        """Give one warning of a kind: of the worst of the bodies, with the names of others."""
        kinds: dict[str, list[Finding]] = {}
        for finding in found:
            kinds.setdefault(finding.kind, []).append(finding)
        for kind, findings in kinds.items():
            worst = max(findings, key=lambda finding: finding.excess)
            others = [f.body for f in findings if f.body != worst.body]
            self.say(kind, worst.message + _also(others))

    def start(self, bodies: dict[str, Superelement], scheme: Scheme, constrained: bool) -> None:
        """Give the warnings that are known before the first step."""
        undamped = scheme.gamma == 0.5 and scheme.alpha_f == scheme.alpha_m
        if constrained and undamped and not scheme.stabilized:
            self.say("scheme", "without numerical damping the multipliers of index-3 constraints "
                               "oscillate and grow after any disturbance: use rho 0.9, alpha "
                               "-0.05, or index=2")
        self.say_of_bodies(found for body in bodies.values() if (found := flat(body)))

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
            self._limits = limits_of(model.bodies.values())
        most = min(max(FEWEST, STATES // max(len(model.bodies), 1)), MOST)
        rows = rows[::-(-len(rows) // most)]
        findings: list[Finding] = []
        for group in self._groups:
            motion, _ = evaluated(group, rows, record_counts(numbering))
            parts = MOTION.slices(group.counts)
            y, spins = motion[:, :, parts["y"]], motion[:, :, parts["spin"]]
            psi = local_rotations(y, group.counts)
            local = np.linalg.norm(psi, axis=3).max(axis=(0, 2), initial=0.0)
            between = between_nodes(psi).max(axis=0)
            for k, name in enumerate(group.bodies):
                findings += exceeded(model.bodies[name], self._limits[name], y[:, k], spins[:, k],
                                     local[k], between[k], self._said)
        self.say_of_bodies(findings)

    def judge(self, run: Recording) -> tuple[str, ...]:
        """All warnings of a run up to now, with those of its energies and steps.

        Some of these may vanish while a run goes on: an energy that is small at first has larger
        relative errors.
        """
        now = remarks(run)
        for key, message in now.items():
            if key not in self._said:
                self._said.add(key)
                warn(message)
        return *self.messages, *now.values()


def spin_limit(body: Superelement, axis: ArrayLike | None) -> float:
    """Spin about an axis of the frame at which one body diverges, by its linearisation.

    In axes that spin with it the body has the stiffness ``S - W^2 D``, see
    `sebody.runs.limits.spin_stability`; one node stays where it is. The limit is the lowest that
    any node, held with the frame or by itself, gives. Of bodies without geometric stiffening it
    says when they fail: in bending, and with option B in torsion. Stiffened ones diverge where
    the structure does: slender ones at the critical speed of rotation about their own axis.

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
    planar = body.reduced.planar
    if axis is not None:
        axis = inputs.vector(axis, "axis", None if planar else 3)
        if not np.any(axis):
            raise inputs.refusal("axis", axis, "give its direction")
        axis = axis / np.linalg.norm(axis)
    return divergence(body, np.array([0.0, 0.0, 1.0]) if planar else axis)


def _also(others: list[str]) -> str:
    """The end of a warning that concerns more bodies."""
    if not others:
        return ""
    names = ", ".join(map(repr, others[:NAMED])) + ", ..." * (len(others) > NAMED)
    return (f" (also {names})" if len(others) == 1 else
            f" (also {len(others)} other bodies: {names})")
