"""Objectives: their values, and their derivatives by the states of a run.

Values are those of an `Ensemble`. Of each quantity the derivative by a state is needed where the
objective looks at it: positions, velocities and accelerations of nodes and amplitudes of modes are
coordinates themselves, anything else is differentiated in the state that is held, forces of
elements by their exact matrices.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody import inputs
from sebody.assembly.numbering import Numbering, coordinates
from sebody.errors import InputError
from sebody.explore.ensembles.outputs import Fold, Output, outputs_of
from sebody.gradients.history import History
from sebody.gradients.linear import Linear
from sebody.gradients.sensors import Coordinates, Evaluated, Sensor
from sebody.gradients.sweeps import Bars
from sebody.model.model import Model
from sebody.results.naming import AXES, look_up
from sebody.results.recording import Recording
from sebody.runs.simulation import Simulation
from sebody.small_motion.moved_states import ADDED_UP, UNMOVED

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


class Looked(NamedTuple):
    """Where an objective looks at its quantity, and the derivative of the one by the other."""

    sensor: Sensor
    seeds: NDArray          # (recorded states, components, outputs)
    columns: slice          # of all outputs


class Seen:
    """All objectives of a run.

    Parameters
    ----------
    outputs : mapping
    run : Simulation
    history : History
    linear : Linear
    """

    def __init__(self, outputs: Mapping[str, Output], run: Simulation, history: History,
                 linear: Linear):
        self.outputs, self.history, self.free = outputs, history, linear.free
        self.place = {int(event): k for k, event in enumerate(history.recorded)}
        recording = Recording(run.model, run.numbering, run.system, run.state, history.states, 0.0)
        self.looked: list[Looked] = []
        self.labels: list[str] = []
        values, sensors = [], {}
        for name, one in outputs.items():
            found = _history(recording, one.quantity)
            own = _folded(one, history.times, found)
            seeds = _seeds(name, one, history.times, found, own)
            if one.quantity not in sensors:
                sensors[one.quantity] = sensor_of(run, one.quantity, found.shape[1:], linear,
                                                  history)
            first = len(self.labels)
            self.labels += _labels(name, own)
            self.looked.append(Looked(sensors[one.quantity], seeds,
                                      slice(first, len(self.labels))))
            values.append(own.ravel())
        self.value = np.concatenate(values)
        any_of = np.any([one.seeds.any(axis=(1, 2)) for one in self.looked], axis=0)
        self.acting = set(history.recorded[any_of].tolist())

    def at(self, event: int) -> Bars | None:
        """Derivatives of all objectives by the state that an event leaves."""
        k = self.place.get(event)
        found = None
        for one in self.looked if k is not None else ():
            if not one.seeds[k].any():
                continue
            found = found or Bars(*(np.zeros((self.free, len(self.value))) for _ in range(3)))
            for own, bar in zip(found, one.sensor.at(k, event), strict=True):
                own[:, one.columns] += bar.T @ one.seeds[k]
        return found

    def of_events(self, first: int, last: int) -> tuple[NDArray, NDArray]:
        """The same of some events, (events, m, 3, n), and which of them have any, (events,)."""
        found = np.zeros((last + 1 - first, len(self.value), 3, self.free))
        acting = np.zeros(len(found), dtype=bool)
        for e in range(len(found)):
            bars = self.at(first + e) if first + e in self.acting else None
            if bars is not None:
                acting[e] = True
                for c, bar in enumerate(bars):
                    found[e, :, c] = bar.T
        return found, acting

    def explicit(self, made: Simulation, rows: NDArray) -> NDArray:
        """Values of all objectives with other numbers in the model, the motion being that of rows.
        """
        recording = Recording(made.model, made.numbering, made.system, made.state, rows, 0.0)
        return np.concatenate([_folded(one, self.history.times, _history(
            recording, one.quantity)).ravel() for one in self.outputs.values()])


def _history(recording: Recording, quantity: str) -> NDArray:
    return np.asarray(look_up(recording, quantity), dtype=float)


def _folded(output: Output, t: NDArray, values: NDArray) -> NDArray:
    fold = Fold(output, values.shape[1:])
    fold.add(t, values)
    found = fold.value()
    assert found is not None
    return np.asarray(found)


def _labels(name: str, value: NDArray) -> list[str]:
    return [name + "".join(f"[{i}]" for i in place) for place in np.ndindex(value.shape)]


def sensor_of(run: Simulation, quantity: str, shape: tuple[int, ...], linear: Linear,
            history: History) -> Sensor:
    if run.system.regularized[0] and ".multipliers" in quantity:
        raise InputError(f"{quantity!r}: the model has redundant constraints, whose multipliers "
                         "are not unique and have no derivative: give force or moment of the joint")
    found = _coordinates(run.numbering, run.model, quantity)
    if found is None:
        return Evaluated(run, quantity, int(np.prod(shape, initial=1.0)), linear, history)
    return Coordinates(*found, linear, history)


def _coordinates(numbering: Numbering, model: Model, quantity: str
                 ) -> tuple[str, list[int]] | None:
    """What of which coordinates a quantity is, if it is nothing else."""
    owner, _, what = quantity.rpartition(".")
    component: int | None = None
    if what in AXES or what.isdigit():
        component = AXES.index(what) if what in AXES else int(what)
        owner, _, what = owner.rpartition(".")
    node, rates = model.nodes.get(owner), {"position": "q", "velocity": "v", "acceleration": "a"}
    if node is not None and what in rates and node.position in numbering.dof_blocks:
        found = coordinates(numbering, node.position)
    elif owner in numbering.modes and what == "modes":
        first = numbering.modes[owner]
        rates, found = {"modes": "q"}, list(range(first, first + model.bodies[owner].reduced.modes))
    else:
        return None
    return rates[what], found if component is None else found[component:component + 1]


def _seeds(name: str, one: Output, t: NDArray, values: NDArray, value: NDArray) -> NDArray:
    """Derivatives of an objective by its quantity, (states, components, outputs)."""
    flat = values.reshape(len(t), -1)
    if one.norm:
        length = np.sqrt((flat**2).sum(axis=1))
        own = _weights(name, one, t, length[:, None], value.reshape(1))
        if (own[length == 0] != 0).any():
            raise InputError(f"objective {name!r}: the length of {one.quantity} is zero in a "
                             "state, where it has no derivative: give its components")
        return (own / np.where(length > 0, length, 1.0)[:, None])[:, None] * flat[:, :, None]
    own = _weights(name, one, t, flat, value.ravel())
    return own[:, :, None] * np.eye(flat.shape[1])


def _weights(name: str, one: Output, t: NDArray, x: NDArray, value: NDArray) -> NDArray:
    """Derivatives by the quantity's components, each of its own, (states, components)."""
    found = np.zeros_like(x)
    if one.kind == "final":
        found[-1] = 1.0
        return found
    if one.kind == "at":
        k = int(np.searchsorted(t, one.time * (1 - 1e-12)))
        part = 1.0 if k == 0 or t[k] <= one.time else (one.time - t[k - 1]) / (t[k] - t[k - 1])
        found[k] = part
        if part < 1.0:
            found[k - 1] = 1.0 - part
        return found
    trapezoids = np.zeros(len(t))
    trapezoids[1:] += np.diff(t) / 2
    trapezoids[:-1] += np.diff(t) / 2
    if one.kind == "integral":
        found += trapezoids[:, None]
        return found
    if (value == 0).any():
        raise InputError(f"objective {name!r} is zero, where it has no derivative: give integral "
                         "or final")
    share = trapezoids[:, None] / (t[-1] - t[0])
    if one.kind == "rms":
        return share * x / value
    return share * np.sign(x) * (np.abs(x) / value) ** (one.power - 1)
