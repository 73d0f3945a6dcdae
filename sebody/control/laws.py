"""Ready control laws for `Model.controller`, sampled and most of them continuous, too.

A law is a compiled function with numbers: parameters that depend on the period are made when the
controller is, with its period.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sebody import inputs
from sebody.control.law import Flow, Law, constant
from sebody.errors import InputError

NONE = np.zeros(0)


def pid(kp: float, ki: float = 0.0, kd: float = 0.0, filter: float = 100.0,
        reference: float = 0.0, limit: float | tuple[float, float] | None = None) -> Law:
    """``u = kp e + ki I + kd D`` with ``e = r - y``, the integral I of e, the rate D of -y.

    With the period T they are ``I += T e`` and ``D = (D + N (y_last - y)) / (1 + N T)``;
    continuous ones ``I' = e`` and ``D = z' = N (-y - z)`` with states I, z, where z is -y at the
    start if the rate is none (``states=(0, -y)``). The integral rests while the output is cut off
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
               Flow(_pid_flow, np.zeros(2), np.array(numbers), _pid_derivatives))


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
    K = inputs.array(np.atleast_2d(gain), "state_feedback: gain", (None, None))
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


def discrete(A: ArrayLike, B: ArrayLike, C: ArrayLike, D: ArrayLike) -> Law:
    """``u = C x + D y``, then ``x = A x + B y``: a linear system in discrete time, as it is.

    Parameters
    ----------
    A, B, C, D : (k, k), (k, n), (m, k), (m, n)
        Such as a compensator by python-control with the controller's period.
    """
    matrices = _matrices("discrete", A, B, C, D)
    k, (m, n) = len(matrices[0]), matrices[3].shape
    return Law("a discrete system", _discrete, (n,), m, np.zeros(k), constant(*matrices))


def linear(A: ArrayLike, B: ArrayLike, C: ArrayLike, D: ArrayLike) -> Law:
    """``x' = A x + B y``, ``u = C x + D y``: a linear system in continuous time.

    Parameters
    ----------
    A, B, C, D : (k, k), (k, n), (m, k), (m, n)
        Such as a compensator or an observer by python-control.
    """
    matrices = _matrices("linear", A, B, C, D)
    k, (m, n) = len(matrices[0]), matrices[3].shape
    return Law("a linear system", _only_continuous, (n,), m, np.zeros(k), _needs_no_period(
        "linear"), _linear_flow(matrices))


def _linear_flow(matrices: list[NDArray]) -> Flow:
    A, B, C, D = matrices
    return Flow(_linear, np.zeros(len(A)), constant(np.block([[B, A], [D, C]]))(0.0),
                _linear_derivatives)


def _linear(t, y, x, rates, u, parameters):
    n, k, m = y.size, x.size, u.size
    for i in range(k + m):
        row, total = i * (n + k), 0.0
        for j in range(n):
            total += parameters[row + j] * y[j]
        for j in range(k):
            total += parameters[row + n + j] * x[j]
        if i < k:
            rates[i] = total
        else:
            u[i - k] = total


def _linear_derivatives(t, y, x, derivatives, parameters):
    rows, columns = derivatives.shape
    for i in range(rows):
        for j in range(columns):
            derivatives[i, j] = parameters[i * columns + j]


def _only_continuous(t, y, x, u, parameters):
    u[0] = np.nan


def _needs_no_period(name: str) -> Callable[[float], NDArray]:
    def refuse(period: float) -> NDArray:
        raise InputError(f"{name} is a law in continuous time and was given the period {period:g}: "
                         "leave out period=, or give discrete(A, B, C, D) for it")
    return refuse


def _matrices(law: str, A: ArrayLike, B: ArrayLike, C: ArrayLike, D: ArrayLike) -> list[NDArray]:
    A, D = (np.atleast_2d(inputs.array(np.atleast_2d(X), f"{law}: {name}", (None, None)))
            for name, X in (("A", A), ("D", D)))
    k, (m, n) = len(A), D.shape
    return [inputs.array(np.reshape(X, shape) if np.size(X) == shape[0] * shape[1] else X,
                         f"{law}: {name}", shape)
            for name, X, shape in (("A", A, (k, k)), ("B", B, (k, n)), ("C", C, (m, k)),
                                   ("D", D, (m, n)))]


def _discrete(t, y, x, u, parameters):
    k, n, m = x.size, y.size, u.size
    A, B = parameters[:k * k], parameters[k * k:k * k + k * n]
    C, D = parameters[k * (k + n):k * (k + n + m)], parameters[k * (k + n + m):]
    for i in range(m):
        u[i] = 0.0
        for j in range(k):
            u[i] += C[i * k + j] * x[j]
        for j in range(n):
            u[i] += D[i * n + j] * y[j]
    after = np.zeros(k)
    for i in range(k):
        for j in range(k):
            after[i] += A[i * k + j] * x[j]
        for j in range(n):
            after[i] += B[i * n + j] * y[j]
    for i in range(k):
        x[i] = after[i]


def low_pass(frequency: float, order: int = 2) -> Law:
    """Butterworth's low-pass filter of one signal; sampled by Tustin's rule.

    Parameters
    ----------
    frequency : float
        Cut-off frequency in cycles per unit of time, below half of the sampling frequency.
    order : int
    """
    frequency = inputs.number(frequency, "low_pass: frequency", above=0.0)
    order = inputs.integer(order, "low_pass: order", least=1, most=10)

    def packed(period: float) -> NDArray:
        from scipy.signal import butter, tf2ss  # takes 0.2 s to import

        if not 2.0 * frequency * period < 1.0:
            raise InputError(f"low_pass: frequency is {frequency:g}, and the period {period:g} "
                             f"samples it with {1 / period:g}: give less than half of this")
        return constant(*tf2ss(*butter(order, 2.0 * frequency * period)))(period)

    return Law("a low-pass filter", _discrete, (1,), 1, np.zeros(order), packed,
               _linear_flow(_butterworth(frequency, order)))


def _butterworth(frequency: float, order: int) -> list[NDArray]:
    """Butterworth's filter in continuous time, as sections in series.

    Of a pair of poles ``w^2 / (s^2 + 2 c w s + w^2)``, of a real one ``w / (s + w)``.
    """
    w = 2.0 * np.pi * frequency
    A, B = np.zeros((order, order)), np.zeros((order, 1))
    before, k = -1, 0       # the state that a section gets; the input for the first
    for pair in range(order // 2):
        c = np.sin(np.pi * (2 * pair + 1) / (2 * order))
        A[k, k], A[k, k + 1], A[k + 1, k] = -2.0 * c * w, -w, w
        (B if before < 0 else A)[k, max(before, 0)] = w
        before, k = k + 1, k + 2
    if order % 2:
        A[k, k] = -w
        (B if before < 0 else A)[k, max(before, 0)] = w
    return [A, B, np.eye(order)[-1:], np.zeros((1, 1))]


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
    if len(points) < 2 or not (np.diff(points) > 0).all():
        raise inputs.refusal("lookup: points", points, "give at least two that ascend")
    packed = constant(points, values)
    return Law("a lookup", _lookup, (1,), 1, NONE, packed, _without_states(_lookup, packed(0.0)))


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
    gains = [np.broadcast_to(inputs.reals(value, f"computed_torque: {name}",
                                          f"give a number or {n}"), n)
             for name, value in (("kp", kp), ("kd", kd))]
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
