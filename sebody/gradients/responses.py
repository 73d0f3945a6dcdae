"""Histories of quantities in a run, and how they change in simplified models."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from sebody.gradients.constrained import Change, Sweep
from sebody.gradients.followed import Followed
from sebody.gradients.gradient import Differentiated
from sebody.gradients.objectives import sensor_of
from sebody.gradients.sensors import RotationVector, put
from sebody.gradients.simplifications import Motion
from sebody.results.naming import look_up
from sebody.results.recording import Recording
from sebody.results.result import Result
from sebody.small_motion.moved_states import Moves, differences

Histories = dict[str, NDArray]


def linearized(one: Differentiated, models: Sequence[Sequence[Motion]], names: Sequence[str]
               ) -> tuple[Histories, Histories]:
    """Histories of quantities in the full model, and their changes, (n, ..., models).

    Parameters
    ----------
    models : sequence of sequences of Motion
        What each simplified model loses.

    Raises
    ------
    InputError
        A quantity does not exist, or has no derivatives.
    """
    history, run = one.history, one.run
    recording = Recording(run.model, run.numbering, run.system, run.state, history.states, 0.0)
    values = {name: np.asarray(look_up(recording, name), dtype=float) for name in names}
    changes = {name: np.zeros((*own.shape, len(models))) for name, own in values.items()}
    if not models:
        return values, changes
    responses = [Response(one, name, values[name].shape[1:]) for name in names]
    place = {int(event): k for k, event in enumerate(history.recorded)}

    def see(event: int, change: Change) -> None:
        if (k := place.get(event)) is not None:
            for response in responses:
                changes[response.name][k] = response.to(k, event, change)
    Sweep(run, one.course, models).go(see)
    return values, changes


class Response:
    """The response of a quantity to changes of a state.

    Motions of nodes and modes follow exactly; other quantities by differences along the changes,
    forces of elements by their exact matrices, with the forces that hold rigid bodies.
    """

    def __init__(self, one: Differentiated, name: str, shape: tuple[int, ...]):
        self.one, self.name, self.shape = one, name, shape
        self.sensor = sensor_of(one.run, name, shape, one.linear, one.history)

    def to(self, k: int, event: int, change: Change) -> NDArray:
        """Changes in a recorded state, (..., models)."""
        if isinstance(self.sensor, RotationVector) or (
                isinstance(self.sensor, Followed) and self.sensor.kinematic):
            rows = self.sensor.at(k, event)
            found = rows.motion @ change.motion + rows.rates @ change.rates + (
                rows.seconds @ change.seconds)
            return found.reshape(*self.shape, -1)
        linear, run = self.one.linear, self.one.run
        put(linear, self.one.history, event)
        G, V, W, U = linear.followers.motion(linear.state, dense=True)
        along = Moves((G @ change.motion).T, (G @ change.rates + V @ change.motion).T,
                      (G @ change.seconds + W @ change.rates + U @ change.motion).T)
        state = Result(run.model, run.numbering, linear.system, linear.state,
                       linear.state.now[None].copy(), 0.0)
        found = differences(state, [self.name], along, change.forces.T)[self.name]
        return np.moveaxis(found, 0, -1)
