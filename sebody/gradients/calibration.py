"""Numbers of a model from measured histories: Gauss and Newton by exact derivatives."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import cast
from warnings import WarningMessage, catch_warnings, simplefilter

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import least_squares

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.basics.warned import warn
from sebody.engine.state import Scheme
from sebody.gradients.gradient import Differentiated, fitting, stacked
from sebody.gradients.node_stresses import history_of
from sebody.gradients.objectives import checked, sensor_of
from sebody.gradients.parameters import Column
from sebody.gradients.point import Point
from sebody.gradients.sensors import Sensor
from sebody.gradients.slopes import Slopes
from sebody.gradients.support import refuse_model
from sebody.gradients.sweeps import forward
from sebody.model.model import Model
from sebody.model.variants.copying import copied
from sebody.results.naming import look_up
from sebody.results.recording import Recording
from sebody.runs.outputs import at_time
from sebody.runs.simulation import Simulation

EPS = 1e-12         # of the end of the run: times of measurements that are beyond it by rounding


@dataclass(frozen=True, eq=False)
class Calibration:
    """Numbers of a model that fit measurements best.

    Attributes
    ----------
    parameters : tuple of str
    value : (p,)
        In the order of the parameters: factors count from 1.
    covariance : (p, p)
        Of the values, for independent errors of the measurements, as large as what is left of them.
    residual : float
        Root of the mean square of what is left, each quantity over its deviation.
    predicted : dict
        The quantities at the times of the measurements.
    runs : int
    """

    parameters: tuple[str, ...]
    value: NDArray
    covariance: NDArray
    residual: float
    predicted: dict[str, NDArray]
    runs: int

    @property
    def deviation(self) -> NDArray:
        """Standard deviations of the values, (p,)."""
        return np.sqrt(np.diag(self.covariance))

    def __repr__(self) -> str:
        each = ", ".join(f"{name} {value:.6g} +- {error:.2g}" for name, value, error in zip(
            self.parameters, self.value, self.deviation, strict=True))
        return f"<Calibration: {each}; residual {self.residual:.3g}>"


def calibrate(model: Model, h: float, measured: Mapping[str, ArrayLike],
              parameters: Sequence[str], deviations: Mapping[str, float] | None = None,
              scheme: Scheme | None = None) -> Calibration:
    """Fit numbers of a model to measured histories, by Gauss and Newton with exact derivatives.

    One run and one forward sweep with a column for each number give the residuals and their
    derivatives; `scipy.optimize.least_squares` does the rest. The model is copied.

    Parameters
    ----------
    model : Model
        Its own numbers are the first guess.
    h : float
        Fixed step [time].
    measured : mapping
        Of each quantity, by name as in ``result[quantity]``, rows (t, value) or (t, x, y, z); times
        of different quantities may differ, values between steps are linear.
    parameters : sequence of str
        As of `gradient`.
    deviations : mapping, optional
        Standard deviation of the measurements of each quantity: weights. By default all are alike.
    scheme : Scheme, optional

    Raises
    ------
    InputError
        Wrong names or shapes, fewer measurements than numbers, numbers that measurements do not
        depend on.
    SimulationError
        A run fails.
    """
    inputs.instance(model, "model", Model, "give a sebody.Model")
    h = inputs.number(h, "h", above=0)
    if deviations is not None and not isinstance(deviations, Mapping):
        raise inputs.refusal("deviations", deviations, "give a dict of quantities and numbers")
    data = _checked(measured, deviations or {})
    model = cast(Model, copied(model))      # which is changed for moments
    refuse_model(model)
    point = Point(model, parameters)
    count = sum(one.values.size for one in data.values())
    if count < len(point.base):
        raise InputError(f"{count} measured numbers cannot determine {len(point.base)} parameters: "
                         "give more measurements or fewer parameters")
    fit = _Fit(model, h, data, point, fitting(scheme))
    bounds = np.array([[next((b for b in (c.handle.above, c.handle.least) if b is not None),
                             -np.inf) for c in point.columns],
                       [np.inf if c.handle.most is None else c.handle.most
                        for c in point.columns]])
    try:
        found = least_squares(fit.residuals, point.base, fit.jacobian, x_scale="jac",
                              bounds=bounds, xtol=1e-10, ftol=1e-12, gtol=1e-12)
        return fit.judged(found.x)
    finally:
        for one in fit.said:
            warn(one.message, one.category)


@dataclass(frozen=True)
class _Measured:
    times: NDArray
    values: NDArray         # (times, components)
    deviation: float


def _checked(measured: Mapping[str, ArrayLike], deviations: Mapping[str, float]
             ) -> dict[str, _Measured]:
    remedy = "give a dict of quantities and rows (t, value)"
    if not isinstance(measured, Mapping) or not measured:
        raise inputs.refusal("measured", measured, remedy)
    if unknown := set(deviations) - set(measured):
        raise InputError(f"deviations are given of {', '.join(sorted(unknown))}, which is not "
                         "among the measured quantities: leave it out")
    found = {}
    for name, rows in measured.items():
        rows = inputs.array(rows, f"measured {name!r}", (None, None), remedy=remedy)
        if rows.shape[1] < 2 or not len(rows) or (rows[:, 0] < 0).any():
            raise InputError(f"measured {name!r} has shape {rows.shape}, or times before 0: "
                             "give rows (t, value) with times from 0 on")
        deviation = inputs.number(deviations.get(name, 1.0), f"deviation of {name!r}", above=0)
        found[name] = _Measured(rows[:, 0], rows[:, 1:], deviation)
    checked([at_time(name, 0.0) for name in found], 0.0)
    return found


class _Fit:
    """Residuals and their derivatives, run by run."""

    def __init__(self, model: Model, h: float, data: Mapping[str, _Measured], point: Point,
                 scheme: Scheme):
        self.model, self.h, self.data, self.point, self.scheme = model, h, data, point, scheme
        last = max(one.times.max() for one in data.values())
        self.t_end = h * max(1, int(np.ceil(last / h * (1 - EPS) - 1e-9)))
        self.runs = 0
        self._x: NDArray | None = None
        self.said: list[WarningMessage] = []

    def residuals(self, x: NDArray) -> NDArray:
        self._look(x)
        return np.concatenate([((self._values[name] - one.values) / one.deviation).ravel()
                               for name, one in self.data.items()])

    def jacobian(self, x: NDArray) -> NDArray:
        self._look(x)
        return np.concatenate([self._slopes[name].reshape(-1, len(x)) / one.deviation
                               for name, one in self.data.items()])

    def _look(self, x: NDArray) -> None:
        if self._x is not None and np.array_equal(x, self._x):
            return
        with self.point.at(x) as columns, catch_warnings(record=True) as self.said:
            simplefilter("always")      # those of the last run are said when the fit ends
            self._values, self._slopes = self._followed(columns)
        self._x, self.runs = x.copy(), self.runs + 1

    def _followed(self, columns: list[Column]) -> tuple[dict[str, NDArray], dict[str, NDArray]]:
        """Quantities at the times of measurements, and their derivatives."""
        one = Differentiated(self.model, self.h, self.t_end, self.scheme)
        histories = self._histories(one.run, one.history.states)
        sensors: dict[str, Sensor] = {
            name: sensor_of(one.run, name, values.shape[1:], one.linear, one.history)
            for name, values in histories.items()}

        def flat(made: Simulation, rows: NDArray) -> NDArray:
            recording = Recording(made.model, made.numbering, made.system, made.state, rows, 0.0)
            return np.concatenate([history_of(sensor, recording, name).ravel()
                                   for name, sensor in sensors.items()])
        slopes = Slopes(self.model, one.run, one.history, flat, one.course)
        each = [slopes.of(column) for column in columns]
        explicit = np.stack([slope.objectives for slope in each], axis=1)
        ends = np.cumsum([values.size for values in histories.values()])[:-1]
        found = {name: part.reshape(len(one.history.recorded), -1, len(each)) for name, part in zip(
            histories, np.split(explicit, ends), strict=True)}
        place = {int(event): k for k, event in enumerate(one.history.recorded)}

        def see(first: int, states: NDArray) -> None:
            for event, moved in enumerate(states, first):
                if (k := place.get(event)) is None:
                    continue
                for name, sensor in sensors.items():
                    for rows, of in zip(sensor.at(k, event), moved, strict=True):
                        found[name][k] += rows @ of
        forward(one.course, *stacked(each), see)
        t = one.history.times
        return ({name: _between(t, histories[name], of.times) for name, of in self.data.items()},
                {name: _between(t, found[name], of.times) for name, of in self.data.items()})

    def _histories(self, run: Simulation, rows: NDArray) -> dict[str, NDArray]:
        recording = Recording(run.model, run.numbering, run.system, run.state, rows, 0.0)
        found = {}
        for name, one in self.data.items():
            values = np.asarray(look_up(recording, name), dtype=float).reshape(len(rows), -1)
            if values.shape[1] != one.values.shape[1]:
                raise InputError(f"measured {name!r} has {one.values.shape[1]} numbers at a time, "
                                 f"the quantity {values.shape[1]}: give rows (t, value) with all "
                                 "of them, or a component such as .x")
            found[name] = values
        return found

    def judged(self, x: NDArray) -> Calibration:
        """Result, with its covariance."""
        residuals, J = self.residuals(x), self.jacobian(x)
        scale = np.linalg.norm(J, axis=0)
        if (scale == 0).any():
            raise InputError("the measurements do not depend on "
                             f"{self.point.labels[int(np.argmin(scale))]}: leave it out")
        sizes = np.linalg.svd(J / scale, compute_uv=False)
        if sizes[-1] < 1e-10 * sizes[0]:
            raise InputError("the measurements cannot tell the parameters "
                             f"{', '.join(self.point.labels)} apart: leave some out or measure "
                             "more quantities")
        free = max(len(residuals) - len(x), 1)
        inverse = np.linalg.inv((J / scale).T @ (J / scale)) / np.outer(scale, scale)
        return Calibration(tuple(self.point.labels), x, inverse * (residuals @ residuals) / free,
                           float(np.sqrt(np.mean(residuals**2))), dict(self._values), self.runs)


def _between(t: NDArray, values: NDArray, times: NDArray) -> NDArray:
    """Values at some times, linear between the states."""
    k = np.clip(np.searchsorted(t, times, side="right"), 1, len(t) - 1)
    part = ((times - t[k - 1]) / (t[k] - t[k - 1])).reshape(-1, *[1] * (values.ndim - 1))
    return values[k - 1] + part * (values[k] - values[k - 1])
