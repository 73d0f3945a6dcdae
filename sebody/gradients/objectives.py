"""Objectives: their values, and their derivatives by the states of a run.

Values are those of an `Ensemble`. Of each quantity the derivative by a state is needed where the
objective looks at it, by the tape of the quantity: see `followed`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.gradients.history import History
from sebody.gradients.linear import Linear
from sebody.gradients.node_stresses import history_of, node_stress
from sebody.gradients.segments import Segments
from sebody.gradients.sensors import Sensor, rotation_vector, rows_over, smoothly
from sebody.gradients.sweeps import Bars
from sebody.results.naming import look_up
from sebody.results.recording import Recording
from sebody.runs.outputs import Fold, Output, forms, outputs_of
from sebody.runs.simulation import Simulation
from sebody.small_motion.moved_states import ADDED_UP, UNMOVED

SEAM = 1e-6         # of the largest value: a quantity that differs more in a state is another turn
EXTREMES = "maximum", "minimum"
Objectives = Mapping[str, Output] | Sequence[Output] | Output


def checked(given: Objectives, t_end: float) -> dict[str, Output]:
    """Objectives by name.

    Raises
    ------
    InputError
        None, something else, or one without a derivative.
    """
    if isinstance(given, Output):
        given = [given]
    if isinstance(given, Sequence) and not isinstance(given, str):
        given = {f"{one.kind} of {one.quantity}" if isinstance(one, Output) else str(k): one
                 for k, one in enumerate(given)}
    if not isinstance(given, Mapping) or not given:
        raise inputs.refusal("objectives", given, "give a dict such as {'tip': "
                             "final('tip.position')}, of what final, at_time, integral, rms and "
                             "soft_maximum return")
    found = outputs_of(given, t_end)
    for name, one in found.items():
        if one.kind in EXTREMES:
            raise InputError(f"objective {name!r} is a {one.kind}, which has no derivative where "
                             "another state takes over: give soft_maximum, or at_time at the time "
                             "of the extreme value")
        if one.kind == "history":
            raise InputError(f"objective {name!r} is a history: give final, at_time, integral, rms "
                             f"or soft_maximum of {one.quantity!r}")
        if one.quantity in UNMOVED or one.quantity.endswith(ADDED_UP):
            raise InputError(f"objective {name!r}: {one.quantity!r} is no function of a state: "
                             "give the integral of a power, or of another quantity")
    return found


class Folded:
    """Values of all objectives, of a run that is run through for this.

    Parameters
    ----------
    outputs : mapping
    segments : Segments

    Attributes
    ----------
    times : (states,)
    values : list of ndarray
        Of each objective, with the shape of its quantity.
    labels : list of str
        Names of all components.
    """

    def __init__(self, outputs: Mapping[str, Output], segments: Segments):
        self.outputs, run = outputs, segments.run
        if not self._folded(segments):
            segments.join()
            self._folded(segments)
        self.values = [np.asarray(fold.value()) for fold in self._folds.values()]
        self.value = np.concatenate([value.ravel() for value in self.values])
        self.labels = [label for name, value in zip(outputs, self.values, strict=True)
                       for label in labels_of(name, value.shape)]
        self.kinematic = all(form.kinematic for form in forms(run, outputs).values())

    def _folded(self, segments: Segments) -> bool:
        """Fold values; tell whether they go on between segments, unlike angles beyond a turn."""
        run, times = segments.run, []
        last: dict[str, NDArray] = {}
        self._folds: dict[str, Fold] = {}
        for history in segments.run_through():
            run.watch.look(run.model, run.numbering, history.states)
            times.append(history.times)
            found = values_of(self.outputs, run, history)
            for name, one in self.outputs.items():
                before, own = found[one.quantity]
                if before is not None and not np.allclose(
                        before, last[name], SEAM, SEAM * np.abs(own).max(initial=0.0)):
                    return False
                last[name] = own[-1]
                if name not in self._folds:
                    self._folds[name] = Fold(one, own.shape[1:])
                self._folds[name].add(history.times, own)
        self.times = np.concatenate(times)
        return True


def values_of(outputs: Mapping[str, Output], run: Simulation, history: History
              ) -> dict[str, tuple[NDArray | None, NDArray]]:
    """Values of each quantity in the state before a segment, if there is one, and in its own."""
    before = history.past is not None
    rows = history.rows[np.concatenate([[0], history.recorded])] if before else history.states
    recording = Recording(run.model, run.numbering, run.system, run.state, rows, 0.0)
    found = {}
    for quantity in {one.quantity for one in outputs.values()}:
        values = _history(recording, quantity)
        found[quantity] = values[0] if before else None, values[before:]
    return found


class Looked(NamedTuple):
    """The times at which an objective looks at its quantity, and its derivative by the quantity."""

    sensor: Sensor
    seeds: NDArray          # (recorded states, components, outputs)
    columns: slice          # of all outputs


class Seen:
    """All objectives of a run, in a segment of it.

    Parameters
    ----------
    whole : Folded
    run : Simulation
    history : History
    linear : Linear
    """

    def __init__(self, whole: Folded, run: Simulation, history: History, linear: Linear):
        self.whole, self.history, self.free = whole, history, linear.free
        self.place = {int(event): k for k, event in enumerate(history.recorded)}
        self.looked: list[Looked] = []
        sensors: dict[str, Sensor] = {}
        first, found = 0, values_of(whole.outputs, run, history)
        for (name, one), value in zip(whole.outputs.items(), whole.values, strict=True):
            own = found[one.quantity][1]
            if one.quantity not in sensors:
                sensors[one.quantity] = sensor_of(run, one.quantity, own.shape[1:], linear, history)
            seeds = _seeds(name, one, whole.times, _first_state(history), own, value)
            self.looked.append(Looked(sensors[one.quantity], seeds,
                                      slice(first, first + value.size)))
            first += value.size
        any_of = np.any([one.seeds.any(axis=(1, 2)) for one in self.looked], axis=0)
        self.acting = set(history.recorded[any_of].tolist())

    def at(self, event: int) -> Bars | None:
        """Derivatives of all objectives by the state that an event leaves."""
        if event not in self.acting:
            return None
        found, _ = self.of_events(event, event)
        return Bars(*(part.T for part in found[0].transpose(1, 0, 2)))

    def of_events(self, first: int, last: int) -> tuple[NDArray, NDArray]:
        """The same of some events, (events, m, 3, n), and which of them have any, (events,)."""
        found = np.zeros((last + 1 - first, len(self.whole.value), 3, self.free))
        acting = np.array([event in self.acting for event in range(first, last + 1)])
        for one in self.looked:
            events = [event for event in range(first, last + 1)
                      if event in self.acting and one.seeds[self.place[event]].any()]
            states = [self.place[event] for event in events]
            for part, rows in enumerate(rows_over(one.sensor, states, events) if events else ()):
                found[np.array(events) - first, one.columns, part] += np.einsum(
                    "ecn,ecm->emn", rows, one.seeds[states])
        return found, acting

    def explicit(self, made: Simulation, rows: NDArray) -> NDArray:
        """Sums of all quantities, with the weights that they have in objectives here, (m,).

        Of a model with other numbers, the motion being that of rows.
        """
        recording = Recording(made.model, made.numbering, made.system, made.state, rows, 0.0)
        return np.concatenate([np.einsum("kcm,kc->m", seen.seeds, history_of(
            seen.sensor, recording, one.quantity).reshape(len(rows), -1)) for one, seen in zip(
                self.whole.outputs.values(), self.looked, strict=True)])


def _first_state(history: History) -> int:
    return history.past.recorded if history.past is not None else 0


def _history(recording: Recording, quantity: str) -> NDArray:
    return np.asarray(look_up(recording, quantity), dtype=float)


def labels_of(name: str, shape: tuple[int, ...]) -> list[str]:
    """Names of the components of an objective."""
    return [name + "".join(f"[{i}]" for i in place) for place in np.ndindex(shape)]


def sensor_of(run: Simulation, quantity: str, shape: tuple[int, ...], linear: Linear,
              history: History) -> Sensor:
    """Sensor of a quantity."""
    if run.system.regularized[0] and ".multipliers" in quantity:
        raise InputError(f"{quantity!r}: the model has redundant constraints, whose multipliers "
                         "are not unique and have no derivative: give force or moment of the joint")
    if (vector := rotation_vector(run, quantity, linear, history)) is not None:
        return vector
    if (stress := node_stress(run, quantity, linear, history)) is not None:
        return stress
    return smoothly(run, quantity, int(np.prod(shape, initial=1.0)), linear, history)


def _seeds(name: str, one: Output, t: NDArray, first: int, values: NDArray, value: NDArray
           ) -> NDArray:
    """Derivatives of an objective by its quantity, (states, components, outputs).

    In some states, the first of which is number `first` of all, whose times are t.
    """
    flat = values.reshape(len(values), -1)
    if one.norm:
        length = np.sqrt((flat**2).sum(axis=1))
        own = _weights(name, one, t, first, length[:, None], value.reshape(1))
        if (own[length == 0] != 0).any():
            raise InputError(f"objective {name!r}: the length of {one.quantity} is zero in a "
                             "state, where it has no derivative: give its components")
        return (own / np.where(length > 0, length, 1.0)[:, None])[:, None] * flat[:, :, None]
    own = _weights(name, one, t, first, flat, value.ravel())
    return own[:, :, None] * np.eye(flat.shape[1])


def _weights(name: str, one: Output, t: NDArray, first: int, x: NDArray, value: NDArray) -> NDArray:
    """Derivatives by the quantity's components, each of its own, (states, components)."""
    if one.kind in ("final", "at"):
        return np.tile(_at(t, one.time)[first:first + len(x), None], x.shape[1])
    trapezoids = np.zeros(len(t))
    trapezoids[1:] += np.diff(t) / 2
    trapezoids[:-1] += np.diff(t) / 2
    own = trapezoids[first:first + len(x), None]
    if one.kind == "integral":
        return np.tile(own, x.shape[1])
    if (value == 0).any():
        raise InputError(f"objective {name!r} is zero, where it has no derivative: give integral "
                         "or final")
    share = own / (t[-1] - t[0])
    if one.kind == "rms":
        return share * x / value
    return share * np.sign(x) * (np.abs(x) / value) ** (one.power - 1)


def _at(t: NDArray, time: float | None) -> NDArray:
    """Weights of all states in the value at a time, or at the end."""
    found = np.zeros(len(t))
    if time is None:
        found[-1] = 1.0
        return found
    k = int(np.searchsorted(t, time * (1 - 1e-12)))
    part = 1.0 if k == 0 or t[k] <= time else (time - t[k - 1]) / (t[k] - t[k - 1])
    found[k] = part
    if part < 1.0:
        found[k - 1] = 1.0 - part
    return found
