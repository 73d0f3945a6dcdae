"""Fields inside a superelement: what its FE nodes do in the recorded states."""

from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sebody import inputs
from sebody.errors import InputError
from sebody.results.motion import BodyMotion, body_motion
from sebody.results.recording import Recording

AXES = "global", "body"


class Field:
    """Displacements, velocities and accelerations of the FE nodes of a superelement.

    A field is computed for the state asked for, a history for the node asked for: see `at`.
    States are chosen by their number among the recorded ones (negative: from the end) or by `t`,
    which takes the nearest recorded state; the last one by default.

    Vectors are those in space, by components along the global axes or, with ``axes="body"``,
    along the axes of the body's floating frame.

    Parameters
    ----------
    recording : Recording
        A Result, as a rule.
    name : str
        Of the superelement.

    Raises
    ------
    InputError
        No such superelement, or one without the shapes of an FE model.
    """

    def __init__(self, recording: Recording, name: str):
        bodies = recording.model.bodies
        name = inputs.choice(name, "superelement", bodies) if bodies else _no_bodies(name)
        if bodies[name].body.recovery is None:
            raise InputError(f"body {name!r} is made of reduced matrices alone, so it knows "
                             "nothing of what is inside: reduce its FE model with craig_bampton, "
                             "or give its ReducedBody recovery=, the shapes of the FE nodes")
        if not len(recording.rows):
            raise InputError("the result has no recorded state: run the model first")
        self.name = name
        self._recording = recording
        self._body = bodies[name]
        self._recovery = self._body.body.recovery

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
        reduced = self._body.body
        held = reduced.coordinates[list(reduced.position_nodes)]
        return self._recovery.points - self._body.alpha @ held

    @cached_property
    def amplitudes(self) -> NDArray:
        """Amplitudes of the `shapes` in all recorded states, (n, N)."""
        return self._body.body.with_followers(self.motion.y)

    def shapes(self) -> NDArray:
        """Displacements of all FE nodes of unit amplitudes, in body axes, (N, nodes, D)."""
        return self._recovery.displacement(np.eye(self.amplitudes.shape[1]))

    def position(self, step: int | None = None, t: float | None = None,
                 axes: str = "global") -> NDArray:
        """Places of all FE nodes, (nodes, D); in body axes from the origin of the frame."""
        return self.places(self._state(step, t), None, axes)[0]

    def displacement(self, step: int | None = None, t: float | None = None,
                     axes: str = "global") -> NDArray:
        """Displacements of all FE nodes from the undeformed body, which moves with the frame."""
        return self.displacements(self._state(step, t), None, axes)[0]

    def velocity(self, step: int | None = None, t: float | None = None,
                 axes: str = "global") -> NDArray:
        """Velocities of all FE nodes, (nodes, D)."""
        return self.velocities(self._state(step, t), None, axes)[0]

    def acceleration(self, step: int | None = None, t: float | None = None,
                     axes: str = "global") -> NDArray:
        """Accelerations of all FE nodes, (nodes, D)."""
        return self.accelerations(self._state(step, t), None, axes)[0]

    def at(self, node: int, axes: str = "global") -> "FieldPoint":
        """Histories of one FE node.

        Raises
        ------
        InputError
            No such node.
        """
        return FieldPoint(self, self.node(node), axes)

    # of several states and nodes: (states, nodes, D)

    def places(self, states: ArrayLike, nodes: ArrayLike | None = None,
               axes: str = "global") -> NDArray:
        """Places of some nodes in some states, given by their numbers."""
        states = np.asarray(states)
        local = self._from_origin(states, nodes)
        if inputs.choice(axes, "axes", AXES) == "body":
            return local
        return self.motion.origin[states][:, None] + self._global(states, local)

    def displacements(self, states: ArrayLike, nodes: ArrayLike | None = None,
                      axes: str = "global") -> NDArray:
        """Displacements from the undeformed body, which moves with the frame."""
        states = np.asarray(states)
        return self._in(axes, states, self._recovery.displacement(self.amplitudes[states], nodes))

    def rotations(self, states: ArrayLike, nodes: ArrayLike | None = None) -> NDArray:
        """Rotation vectors of nodes in the frame, (states, nodes, 3), in a plane (.., 1)."""
        return self._recovery.rotation(self.amplitudes[np.asarray(states)], nodes)

    def velocities(self, states: ArrayLike, nodes: ArrayLike | None = None,
                   axes: str = "global") -> NDArray:
        """``v_0 + Omega_0 x r + r'`` in axes of the frame, r from its origin."""
        states = np.asarray(states)
        spin = self.motion.spin[states]
        local = (self.motion.velocity[states][:, None]
                 + _cross(spin, self._from_origin(states, nodes))
                 + self._recovery.displacement(self._rates[states], nodes))
        return self._in(axes, states, local)

    def accelerations(self, states: ArrayLike, nodes: ArrayLike | None = None,
                      axes: str = "global") -> NDArray:
        """``a_0 + Omega_0' x r + Omega_0 x (Omega_0 x r) + 2 Omega_0 x r' + r''`` likewise."""
        states, motion = np.asarray(states), self.motion
        spin, r = motion.spin[states], self._from_origin(states, nodes)
        rate = self._recovery.displacement(self._rates[states], nodes)
        local = (motion.acceleration[states][:, None] + _cross(motion.spin_rate[states], r)
                 + _cross(spin, _cross(spin, r) + 2 * rate)
                 + self._recovery.displacement(self._seconds[states], nodes))
        return self._in(axes, states, local)

    def state(self, step: int | None = None, t: float | None = None) -> int:
        """Number of a recorded state, from 0.

        Raises
        ------
        InputError
            No such state, or both `step` and `t`.
        """
        times, last = self.t, len(self.t) - 1
        if step is not None and t is not None:
            raise InputError("step and t both choose a state: give one of them")
        if t is not None:
            t = inputs.number(t, "t", least=times[0], most=times[-1])
            return int(np.argmin(np.abs(times - t)))
        if step is None:
            return last
        step = inputs.integer(step, "step", least=-last - 1, most=last,
                              remedy=f"the recorded states are 0 to {last}")
        return step % (last + 1)

    def node(self, node: int) -> int:
        """Number of an FE node, from 0.

        Raises
        ------
        InputError
            No such node.
        """
        return inputs.integer(node, f"node of body {self.name!r}", least=0, most=self.count - 1,
                              remedy=f"its FE model has nodes 0 to {self.count - 1}")

    def _state(self, step: int | None, t: float | None) -> NDArray:
        return np.array([self.state(step, t)])

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
        invariants = self._body.body.invariants
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


class FieldPoint:
    """Histories of one FE node of a superelement, (n, D): a row of the field for each state."""

    def __init__(self, field: Field, node: int, axes: str):
        self._field, self._nodes = field, np.array([node])
        self._axes = inputs.choice(axes, "axes", AXES)
        self._states = np.arange(len(field.t))

    @property
    def position(self) -> NDArray:
        """Place; in body axes from the origin of the frame."""
        return self._field.places(self._states, self._nodes, self._axes)[:, 0]

    @property
    def displacement(self) -> NDArray:
        """Displacement from the undeformed body, which moves with the frame."""
        return self._field.displacements(self._states, self._nodes, self._axes)[:, 0]

    @property
    def rotation(self) -> NDArray:
        """Rotation vector in the frame, (n, 3), in a plane (n, 1); (n, 0) if nodes have none."""
        return self._field.rotations(self._states, self._nodes)[:, 0]

    @property
    def velocity(self) -> NDArray:
        """Velocity."""
        return self._field.velocities(self._states, self._nodes, self._axes)[:, 0]

    @property
    def acceleration(self) -> NDArray:
        """Acceleration."""
        return self._field.accelerations(self._states, self._nodes, self._axes)[:, 0]


def _cross(spin: NDArray, vectors: NDArray) -> NDArray:
    """``spin x r`` of spins (n, 3), in a plane (n, 1), and vectors (n, k, D)."""
    if vectors.shape[2] == 2:
        return spin[:, None] * np.stack([-vectors[..., 1], vectors[..., 0]], axis=-1)
    return np.cross(spin[:, None], vectors)


def _no_bodies(name: str) -> str:
    raise InputError(f"the model has no superelement, so there is no field of {name!r}: rigid "
                     "bodies have histories of their nodes alone")
