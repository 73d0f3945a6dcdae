"""Ready control laws for `Model.controller`, sampled and most of them continuous, too.

A law is a compiled function with numbers: parameters that depend on the period are made when the
controller is, with its period. Laws of matrices A, B, C, D are in `linear_systems`.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sebody.basics import inputs
from sebody.model.control.law import Flow, Law, constant

NONE = np.zeros(0)


def pid(kp: float, ki: float = 0.0, kd: float = 0.0, filter: float = 100.0,
        reference: float = 0.0, limit: float | tuple[float, float] | None = None) -> Law:
    """``u = kp e + ki I + kd D`` with ``e = r - y``, the integral I of e, the rate D of -y.

    With the period T they are ``I += T e`` and ``D = (D + N (y_last - y)) / (1 + N T)``;
    continuous ones ``I' = e`` and ``D = z' = N (-y - z)`` with states I, z. Where y is not zero at
    the start, give ``states=(0, -y)``: with z = 0 the rate is that of a jump from zero to y, and u
    begins with ``-kd N y``; runs warn of that. The integral rests while the output is cut off
    and the error would drive it further (anti-windup).

    Parameters
    ----------
    kp, ki, kd : float
        Gains.
    filter : float
        N, the cut-off frequency of the rate [1/time].
    reference : float
        r; a second input of the controller takes its place.
    limit : float or two floats, optional
        Largest size of u, or its least and largest value.

    Returns
    -------
    Law
        Of one or two inputs, y and r.
    """
    gains = [inputs.number(value, f"pid: {name}") for name, value in (
        ("kp", kp), ("ki", ki), ("kd", kd))]
    numbers = [*gains, inputs.number(filter, "pid: filter", above=0.0),
               inputs.number(reference, "pid: reference"), *_limits(limit, "pid: limit")]
    return Law("pid", _pid, (1, 2), 1, np.zeros(4),
               lambda period: np.array([period, *numbers]),
               Flow(_pid_flow, np.zeros(2), np.array(numbers), _pid_derivatives,
                    _pid_at_rest if numbers[2] else None), _check_pid)


def _pid_at_rest(y: NDArray) -> NDArray:
    return np.array([0.0, -y[0]])


def _check_pid(parameters: NDArray) -> None:
    """Refuse a filter that is not positive; a period comes first where there is one."""
    inputs.number(parameters[-4], "pid: filter", above=0.0)


def _pid(t, y, x, u, parameters):
    T, kp, ki, kd, N, r, least, most = parameters
    if y.size == 2:
        r = y[1]
    e = r - y[0]
    if x[3] == 0.0:         # before the first sample it was where it is
        x[2], x[3] = -y[0], 1.0
    integral = x[0] + T * e
    x[1] = (x[1] + N * (-y[0] - x[2])) / (1.0 + N * T)
    x[2] = -y[0]
    raw = kp * e + ki * integral + kd * x[1]
    u[0] = min(max(raw, least), most)
    if raw == u[0] or (raw - u[0]) * ki * e <= 0.0:
        x[0] = integral


def _pid_flow(t, y, x, rates, u, parameters):
    kp, ki, kd, N, r, least, most = parameters
    if y.size == 2:
        r = y[1]
    e = r - y[0]
    rates[1] = N * (-y[0] - x[1])
    raw = kp * e + ki * x[0] + kd * rates[1]
    u[0] = min(max(raw, least), most)
    rates[0] = e if raw == u[0] or (raw - u[0]) * ki * e <= 0.0 else 0.0


def _pid_derivatives(t, y, x, derivatives, parameters):
    kp, ki, kd, N, r, least, most = parameters
    n = y.size
    if n == 2:
        r = y[1]
    e = r - y[0]
    raw = kp * e + ki * x[0] + kd * N * (-y[0] - x[1])
    inside = least <= raw <= most
    if inside or (raw - min(max(raw, least), most)) * ki * e <= 0.0:
        derivatives[0, 0] = -1.0
    derivatives[1, 0], derivatives[1, n + 1] = -N, -N
    if inside:
        derivatives[2, 0], derivatives[2, n], derivatives[2, n + 1] = -kp - kd * N, ki, -kd * N
    if n == 2:
        derivatives[0, 1] = -derivatives[0, 0]
        derivatives[2, 1] = kp if inside else 0.0


def state_feedback(gain: ArrayLike, reference: ArrayLike | None = None,
                   offset: ArrayLike | None = None) -> Law:
    """``u = offset - K (y - r)``.

    Parameters
    ----------
    gain : (m, n)
        K, such as that of ``control.lqr`` times what makes states of measurements.
    reference : (n,), optional
        r, zeros by default: the values of the measurements in the state it was designed for.
    offset : (m,), optional
        Outputs there, zeros by default.
    """
    what, remedy = "state_feedback: gain", "give a row for each output, with a gain for each input"
    K = np.atleast_2d(inputs.reals(gain, what, remedy))
    if not K.size:
        raise inputs.refusal(what, gain, remedy)
    K = inputs.array(K, what, (None, None), remedy=remedy)
    m, n = K.shape
    r = np.zeros(n) if reference is None else inputs.vector(reference, "state_feedback: reference",
                                                            n)
    u0 = np.zeros(m) if offset is None else inputs.vector(offset, "state_feedback: offset", m)
    packed = constant(K, r, u0)
    return Law("state feedback", _feedback, (n,), m, NONE, packed,
               _without_states(_feedback, packed(0.0), _feedback_derivatives))


def _feedback_derivatives(t, y, x, derivatives, parameters):
    m, n = derivatives.shape
    for i in range(m):
        for j in range(n):
            derivatives[i, j] = -parameters[i * n + j]


def _feedback(t, y, x, u, parameters):
    n, m = y.size, u.size
    for i in range(m):
        u[i] = parameters[m * n + n + i]
        for j in range(n):
            u[i] -= parameters[i * n + j] * (y[j] - parameters[m * n + j])


def lookup(points: ArrayLike, values: ArrayLike) -> Law:
    """``u = f(y)`` by linear interpolation in a table, with its end values outside.

    Parameters
    ----------
    points : (n,)
        Ascending values of y.
    values : (n,)
        u there.
    """
    points = inputs.vector(points, "lookup: points")
    values = inputs.vector(values, "lookup: values", len(points))
    packed = constant(points, values)
    _check_lookup(packed(0.0))
    return Law("a lookup", _lookup, (1,), 1, NONE, packed, _without_states(_lookup, packed(0.0)),
               _check_lookup)


def _check_lookup(parameters: NDArray) -> None:
    """Refuse points that do not ascend."""
    points = parameters[:parameters.size // 2]
    if len(points) < 2 or not (np.diff(points) > 0).all():
        raise inputs.refusal("lookup: points", points, "give at least two that ascend")


def _lookup(t, y, x, u, parameters):
    n = parameters.size // 2
    u[0] = np.interp(y[0], parameters[:n], parameters[n:])


def computed_torque(dynamics: Callable[..., None], reference: Callable[..., None], joints: int,
                    kp: ArrayLike, kd: ArrayLike) -> Law:
    """``u = M(q) (a_r + kd (v_r - v) + kp (q_r - q)) + h(q, v)``: exact linearisation.

    Parameters
    ----------
    dynamics : callable
        ``dynamics(q, v, mass, bias)`` sets M (n, n) and the forces h (n,) of the arm as it is
        modelled, which holds ``M a + h = u``.
    reference : callable
        ``reference(t, q, v, a)`` sets the motion that is wanted.
    joints : int
        n: the inputs are n angles, then their n rates.
    kp, kd : float or (n,)
        Gains [1/time^2], [1/time].
    """
    n = inputs.integer(joints, "computed_torque: joints", least=1)
    gains = []
    for name, value in (("kp", kp), ("kd", kd)):
        what, remedy = f"computed_torque: {name}", f"give a number, or {n}, one for each joint"
        own = inputs.reals(value, what, remedy)
        if own.shape not in ((), (1,), (n,)) or not np.isfinite(own).all():
            raise inputs.refusal(what, value, remedy)
        gains.append(np.broadcast_to(own, n))
    for what, one in (("dynamics", dynamics), ("reference", reference)):
        inputs.function(one, f"computed_torque: {what}", "give a function")

    def law(t, y, x, u, parameters):
        n = u.size
        q, v, wanted = np.zeros(n), np.zeros(n), np.zeros(n)
        mass, bias = np.zeros((n, n)), np.zeros(n)
        reference(t, q, v, wanted)
        for i in range(n):
            wanted[i] += parameters[n + i] * (v[i] - y[n + i]) + parameters[i] * (q[i] - y[i])
        dynamics(y[:n], y[n:], mass, bias)
        for i in range(n):
            u[i] = bias[i]
            for j in range(n):
                u[i] += mass[i, j] * wanted[j]
    packed = constant(*gains)
    return Law("computed torque", law, (2 * n,), n, NONE, packed,
               _without_states(law, packed(0.0)))


def _without_states(function: Callable[..., None], parameters: NDArray,
                    derivatives: Callable[..., None] | None = None) -> Flow:
    """The continuous form of a law without states: the same."""
    def law(t, y, x, rates, u, parameters):
        function(t, y, x, u, parameters)
    return Flow(law, NONE, parameters, derivatives)


def _limits(limit: float | tuple[float, float] | None, what: str) -> tuple[float, float]:
    if limit is None:
        return -np.inf, np.inf
    if np.ndim(limit) == 0:
        most = inputs.number(limit, what, above=0.0)
        return -most, most
    least, most = inputs.vector(limit, what, 2)
    if not least < most:
        raise inputs.refusal(what, limit, "give the smaller number first")
    return float(least), float(most)
