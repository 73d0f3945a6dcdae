"""Motion of the FE nodes of a superelement in recorded states: kinematics, many states at once."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.basics.vectors import cross
from sebody.results.body_loads import load_amplitudes
from sebody.results.motion import BodyMotion, body_motion
from sebody.results.recording import Recording
from sebody.results.references import Welded, undeformed
from sebody.results.stresses import Stresses

AXES = "global", "body"


class FieldStates:
    """Fields of a superelement in some states, given by their numbers: (states, nodes, D).

    See `sebody.results.field.Field` for axes.
    """

    def __init__(self, recording: Recording, name: str):
        bodies = recording.model.bodies
        name = inputs.choice(name, "superelement", bodies) if bodies else _no_bodies(name)
        recovery = bodies[name].reduced.recovery
        if recovery is None:
            raise InputError(f"body {name!r} has reduced matrices only, so fields inside it are "
                             "unknown: reduce its FE model, by craig_bampton or "
                             "import_body, or give its ReducedBody recovery=, the shapes of the "
                             "FE nodes")
        if not len(recording.rows):
            raise InputError("the result has no recorded state: run the model first")
        self.name = name
        self._recording = recording
        self._body = bodies[name]
        self._recovery = recovery
        self._stresses: dict[bool, Stresses] = {}

    @property
    def t(self) -> NDArray:
        """Times of the recorded states [time]."""
        return self._recording.recorded("t")[:, 0]

    @property
    def count(self) -> int:
        """Number of FE nodes."""
        return len(self._recovery.coordinates)

    @cached_property
    def motion(self) -> BodyMotion:
        """The floating frame, and the reduced coordinates in it, in all recorded states."""
        return body_motion(self._recording, self._body, slice(None))

    @cached_property
    def points(self) -> NDArray:
        """FE nodes of the undeformed body in its floating frame, (nodes, D)."""
        reduced = self._body.reduced
        held = reduced.coordinates[list(reduced.position_nodes)]
        return self._recovery.points - self._body.alpha @ held

    @cached_property
    def amplitudes(self) -> NDArray:
        """Amplitudes of the `shapes` in all recorded states, (n, N)."""
        return self._body.reduced.with_followers(self.motion.y)

    def shapes(self) -> NDArray:
        """Displacements of all FE nodes of unit amplitudes, in body axes, (N, nodes, D)."""
        return self._recovery.displacement(np.eye(self.amplitudes.shape[1]))

    def shapes_at(self, node: int) -> NDArray:
        """The same of one node, (N, D)."""
        return self._recovery.displacement(np.eye(self.amplitudes.shape[1]), [node])[:, 0]

    def places(self, states: ArrayLike, nodes: ArrayLike | None = None,
               axes: str = "global") -> NDArray:
        """Places of some nodes in some states, given by their numbers."""
        states = np.asarray(states)
        local = self._from_origin(states, nodes)
        if inputs.choice(axes, "axes", AXES) == "body":
            return local
        return self.motion.origin[states][:, None] + self._global(states, local)

    def displacements(self, states: ArrayLike, nodes: ArrayLike | None = None,
                      axes: str = "global", reference: str | None = None) -> NDArray:
        """Displacements from the undeformed body, which moves with the reference.

        With ``axes="body"`` components are along the axes of this undeformed body.
        """
        states = np.asarray(states)
        node = self._welded.reference(self._body, reference)
        moved = self._recovery.displacement(self.amplitudes[states], nodes)
        if node is None:
            return self._in(axes, states, moved)
        motion = self.motion
        still = undeformed(self._recording, self._body, motion.rotation[states],
                           motion.origin[states], node, states)
        points = self.points if nodes is None else self.points[np.asarray(nodes)]
        moved = points + moved - still.places(points)
        if inputs.choice(axes, "axes", AXES) == "body":
            return moved @ still.rotation
        return self._global(states, moved)

    def rotations(self, states: ArrayLike, nodes: ArrayLike | None = None) -> NDArray:
        """Rotation vectors of nodes in the frame, (states, nodes, 3), in a plane (.., 1)."""
        return self._recovery.rotation(self.amplitudes[np.asarray(states)], nodes)

    def velocities(self, states: ArrayLike, nodes: ArrayLike | None = None,
                   axes: str = "global") -> NDArray:
        """``v_0 + Omega_0 x r + r'`` in axes of the frame, r from its origin."""
        states = np.asarray(states)
        spin = self.motion.spin[states][:, None]
        local = (self.motion.velocity[states][:, None]
                 + cross(spin, self._from_origin(states, nodes))
                 + self._recovery.displacement(self._rates[states], nodes))
        return self._in(axes, states, local)

    def accelerations(self, states: ArrayLike, nodes: ArrayLike | None = None,
                      axes: str = "global") -> NDArray:
        """``a_0 + Omega_0' x r + Omega_0 x (Omega_0 x r) + 2 Omega_0 x r' + r''`` likewise."""
        states, motion = np.asarray(states), self.motion
        spin, r = motion.spin[states][:, None], self._from_origin(states, nodes)
        rate = self._recovery.displacement(self._rates[states], nodes)
        local = (motion.acceleration[states][:, None] + cross(motion.spin_rate[states][:, None], r)
                 + cross(spin, cross(spin, r) + 2 * rate)
                 + self._recovery.displacement(self._seconds[states], nodes))
        return self._in(axes, states, local)

    def stresses(self, static: bool = True) -> Stresses:
        """Stresses of the body.

        Raises
        ------
        InputError
            A body whose FE model has no stress operator.
        """
        static = inputs.flag(static, "static")
        if static not in self._stresses:
            loads = load_amplitudes(self._recording, self._body, self.motion) if static else None
            self._stresses[static] = Stresses(self._body, self.motion,
                                              self._recording.gravity, loads)
        return self._stresses[static]

    def number(self, place: int) -> int:
        """Number in the FE model of the node at a place in fields."""
        return self._recovery.number(place)

    @cached_property
    def _welded(self) -> Welded:
        return Welded(self._recording.model)

    @cached_property
    def _rates(self) -> NDArray:
        y, rate = self.motion.y, self.motion.y_rate
        return np.hstack([rate, self._products(y, rate)])

    @cached_property
    def _seconds(self) -> NDArray:
        y, rate, second = self.motion.y, self.motion.y_rate, self.motion.y_second
        return np.hstack([second, self._products(rate, rate) + self._products(y, second)])

    def _products(self, left: NDArray, right: NDArray) -> NDArray:
        """``left . Q_b right`` of the coordinates that follow in second order, (n, b)."""
        invariants = self._body.reduced.invariants
        if invariants is None:
            return np.zeros((len(left), 0))
        return np.einsum("ni,bij,nj->nb", left, invariants.Q, right, optimize=True)

    def _from_origin(self, states: NDArray, nodes: ArrayLike | None) -> NDArray:
        points = self.points if nodes is None else self.points[np.asarray(nodes)]
        return points + self._recovery.displacement(self.amplitudes[states], nodes)

    def _in(self, axes: str, states: NDArray, local: NDArray) -> NDArray:
        if inputs.choice(axes, "axes", AXES) == "body":
            return local
        return self._global(states, local)

    def _global(self, states: NDArray, local: NDArray) -> NDArray:
        return local @ self.motion.rotation[states].transpose(0, 2, 1)


def _no_bodies(name: str) -> str:
    raise InputError(f"the model has no superelement, so there is no field of {name!r}: rigid "
                     "bodies have results at their nodes only")
