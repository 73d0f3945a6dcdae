"""Steps chosen by their local error, and output between them, for compiled code.

All steps may err alike, which for a given number of steps makes the sum of errors least. A new step
needs a new matrix, worth many iterations: steps stay until much is to be gained.
"""

import numpy as np

from sebody.engine.links import place_hanging
from sebody.engine.state import (
    CHOSEN,
    CORNER,
    CURRENT_STEP,
    GRID,
    HELD,
    ITERATIONS,
    LARGEST_ERROR,
    RECORDED,
    REJECTED,
    STEP,
    TIME,
)
from sebody.engine.vectors import copy
from sebody.kernels.abi import pointer_to
from sebody.kernels.layout import (
    A_PART,
    Q_PART,
    R_PART,
    RECORD_ITERATIONS,
    RECORD_T,
    RECORD_WORKS,
    V_PART,
)
from sebody.kernels.pipeline import compiled
from sebody.kernels.rotations import inverse_tangent_coefficients, turn

AIM = 0.5               # of the error that is allowed
GAIN = 1.4              # steps are lengthened by no less
LONGEST = 4.0           # and no more,
SHORT = 0.2             # and shortened by no more
PATIENCE = 10           # steps before the next lengthening, unless it is the longest
MEMORY = 0.99           # for the largest error, a step
FAR = 1e3               # steps
SHORTEST = 1e-9         # of an output interval


@compiled
def accurate(system, state, scheme):
    """Whether the error of a step is allowed; chooses the length of the next attempt.

    An increment misses ``|beta + (alpha_m - alpha_f)/2 - 1/6| h^3`` times the rate of the
    acceleration, which the change of the auxiliary one shows.
    """
    clock, control = state.clock, state.control
    h = clock[CURRENT_STEP]
    error = 0.0
    aux, old = pointer_to(state.aux), pointer_to(state.aux_old)
    strictness = pointer_to(state.strictness)
    for i in range(system.diagonal.size):
        e = abs(aux[i] - old[i]) * strictness[i]
        if e > error:
            error = e
    error *= abs(scheme.beta + 0.5 * (scheme.alpha_m - scheme.alpha_f) - 1.0 / 6.0) * h * h
    if not error <= 1.0:
        clock[CHOSEN] = h * max(SHORT, (AIM / error) ** (1.0 / 3.0))
        clock[LARGEST_ERROR] = AIM
        control[HELD] = 0
        control[REJECTED] += 1
        return False
    same = h / clock[CHOSEN]            # less than one before a corner
    largest = max(error / max(same * same * same, 1e-3), MEMORY * clock[LARGEST_ERROR])
    control[HELD] += 1
    gain = GAIN if control[HELD] >= PATIENCE else LONGEST
    if largest * gain * gain * gain <= AIM:
        factor = min(LONGEST, (AIM / max(largest, 1e-300)) ** (1.0 / 3.0))
        clock[CHOSEN] *= factor
        largest *= factor * factor * factor
        control[HELD] = 0
    clock[LARGEST_ERROR] = largest
    return True


@compiled
def choose_step(system, state):
    """The length of a step: as the error asks, but corners of the loads are met exactly."""
    clock, control = state.clock, state.control
    corners = system.corners
    while control[CORNER] < corners.size and corners[control[CORNER]] <= clock[TIME]:
        control[CORNER] += 1
    last, h = clock[CURRENT_STEP], clock[CHOSEN]
    if control[CORNER] < corners.size:
        left = corners[control[CORNER]] - clock[TIME]
        parts = np.ceil(left / h - 1e-6)
        if parts < FAR:         # equal parts share a matrix: rounding must not part them
            h = last if abs(parts * last - left) < 1e-9 * left else left / parts
    clock[CURRENT_STEP] = h


@compiled
def go_on(system, state):
    """Time after an accepted step."""
    clock, control = state.clock, state.control
    clock[TIME] += clock[CURRENT_STEP]
    if control[CORNER] < system.corners.size:
        corner = system.corners[control[CORNER]]
        if abs(clock[TIME] - corner) < 1e-6 * clock[CURRENT_STEP]:
            clock[TIME] = corner


@compiled
def write_between(system, state, record, last_grid):
    """Output on the grid within the last step."""
    clock, control = state.clock, state.control
    h = clock[CURRENT_STEP]
    while control[GRID] < last_grid:
        t = (control[GRID] + 1) * clock[STEP]
        if t > clock[TIME]:
            return
        control[GRID] += 1
        if control[GRID] % record.every[0] == 0:
            _write_row(system, state, record.rows[control[RECORDED]], record.at, t,
                       1.0 - (clock[TIME] - t) / h, h)
            control[RECORDED] += 1


@compiled
def _write_row(system, state, row, at, t, s, h):
    """The state at a share `s` of the last step: cubics through values and rates at its ends."""
    copy(state.now, row)
    row[RECORD_T], row[RECORD_ITERATIONS] = t, state.control[ITERATIONS]
    for k in range(state.works.size):
        early, late = state.powers_old[k], state.powers[k]
        row[RECORD_WORKS + k] -= h * ((1.0 - s) * early + 0.5 * (1.0 - s * s) * (late - early))
    total = state.q.size
    q, v, a = (row[at[Q_PART]:at[Q_PART] + total], row[at[V_PART]:at[V_PART] + total],
               row[at[A_PART]:at[A_PART] + total])
    R = row[at[R_PART]:at[R_PART] + state.R.size]
    for i in range(total):
        q[i] = _cubic(s, state.q_old[i], h * state.v_old[i], state.q[i], h * state.v[i])
        v[i] = _cubic(s, state.v_old[i], h * state.a_old[i], state.v[i], h * state.a[i])
        a[i] = state.a_old[i] + s * (state.a[i] - state.a_old[i])
        if system.is_multiplier[i] > 0.0:
            q[i] = state.q_old[i] + s * (state.q[i] - state.q_old[i])
    for r in range(system.rotation_at.size):
        i = system.rotation_at[r]
        x, y, z = state.dq[i], state.dq[i + 1], state.dq[i + 2]
        u, w, p = _rate_of_increment(x, y, z, state.v[i], state.v[i + 1], state.v[i + 2])
        q[i] = _cubic(s, 0.0, h * state.v_old[i], x, h * u)
        q[i + 1] = _cubic(s, 0.0, h * state.v_old[i + 1], y, h * w)
        q[i + 2] = _cubic(s, 0.0, h * state.v_old[i + 2], z, h * p)
        turn(pointer_to(state.R_old), 9 * r, q[i], q[i + 1], q[i + 2], pointer_to(R), 9 * r)
    if system.links.hanging.shape[0] > 0:
        place_hanging(system.links, q, v, a, R)


@compiled
def _cubic(s, start, rate, end, end_rate):
    """Hermite's cubic; rates are those by the share `s`."""
    d = end - start
    return start + s * (rate + s * (3.0 * d - 2.0 * rate - end_rate
                                    + s * (rate + end_rate - 2.0 * d)))


@compiled
def _rate_of_increment(x, y, z, p, q, r):
    """``T^-1`` of a rotation increment times an angular velocity."""
    e = inverse_tangent_coefficients(x * x + y * y + z * z)[0]
    u, v, w = y * r - z * q, z * p - x * r, x * q - y * p
    return (p + 0.5 * u + e * (y * w - z * v), q + 0.5 * v + e * (z * u - x * w),
            r + 0.5 * w + e * (x * v - y * u))
