"""Searches for frames in lanes: they go on until every lane has its frame."""

import math

from sebody.compiler.decorators import compiled, in_lanes_of
from sebody.compiler.inside.lanes import every, some, spread, where
from sebody.kernels import frame_search
from sebody.kernels.dense import inverse_3
from sebody.kernels.frame_search import ROUNDING, wrapped
from sebody.kernels.lanes.rotations import NONE
from sebody.kernels.rotations import NEAR_PI, relative_log, relative_rotations, rotated


@in_lanes_of(frame_search.converged_mean)
def converged_mean(count, nodes, alpha, R, frame, psi):
    """See `frame_search.converged_mean`; 0 always, no number where there is no frame."""
    if count != 2:
        _search_mean(count, nodes, alpha, R, frame, psi, spread(0.0) == 0.0)
        return 0
    sought = _mean_of_two(nodes, alpha, R, frame, psi)
    if some(sought):
        a, b, c, d, e, f = psi[0], psi[1], psi[2], psi[3], psi[4], psi[5]
        _search_mean(2, nodes, alpha, R, frame, psi, sought)
        psi[0], psi[1], psi[2] = where(sought, psi[0], a), where(sought, psi[1], b), where(
            sought, psi[2], c)
        psi[3], psi[4], psi[5] = where(sought, psi[3], d), where(sought, psi[4], e), where(
            sought, psi[5], f)
    return 0


@compiled
def _search_mean(count, nodes, alpha, R, frame, psi, left):
    """Newton's iteration for some members; the others keep their frames."""
    for _ in range(30):
        relative_rotations(count, nodes, R, frame, psi)
        x = y = z = spread(0.0)
        for j in range(count):
            x += alpha[j] * psi[3 * j]
            y += alpha[j] * psi[3 * j + 1]
            z += alpha[j] * psi[3 * j + 2]
        left = left & ~(x * x + y * y + z * z < 1e-30)
        if not some(left):
            return
        x, y, z = frame_search.mean_step(count, alpha, psi, x, y, z)
        _rotate_some(left, frame, x, y, z)
        left = left & ~(x * x + y * y + z * z < 1e-16)
    relative_rotations(count, nodes, R, frame, psi)
    for k in range(3 * count):
        psi[k] = where(left, spread(NONE), psi[k])


@compiled
def _rotate_some(chosen, frame, x, y, z):
    a, b, c, d, e, f, g, h, i = rotated(frame, 0, x, y, z)
    frame[0], frame[1], frame[2] = (where(chosen, a, frame[0]), where(chosen, b, frame[1]),
                                    where(chosen, c, frame[2]))
    frame[3], frame[4], frame[5] = (where(chosen, d, frame[3]), where(chosen, e, frame[4]),
                                    where(chosen, f, frame[5]))
    frame[6], frame[7], frame[8] = (where(chosen, g, frame[6]), where(chosen, h, frame[7]),
                                    where(chosen, i, frame[8]))


@compiled
def _mean_of_two(nodes, alpha, R, frame, psi):
    """The closed form; returns the members whose mean it may not be, and which keep their frames.

    Members that have no numbers are not among them.
    """
    x, y, z, cosine = relative_log(R, 9 * nodes[0], R, 9 * nodes[1])
    p, q, r = alpha[1] * x, alpha[1] * y, alpha[1] * z
    a, b, c, d, e, f, g, h, i = rotated(R, 9 * nodes[0], p, q, r)
    near = a * frame[0] + b * frame[1] + c * frame[2] + d * frame[3] + e * frame[4] + f * frame[5]
    near = near + g * frame[6] + h * frame[7] + i * frame[8]
    psi[0], psi[1], psi[2] = -p, -q, -r
    psi[3], psi[4], psi[5] = alpha[0] * x, alpha[0] * y, alpha[0] * z
    sought = (cosine <= 0.0) | (near < 1.0)
    if some(sought):
        a, b, c = where(sought, frame[0], a), where(sought, frame[1], b), where(sought, frame[2], c)
        d, e, f = where(sought, frame[3], d), where(sought, frame[4], e), where(sought, frame[5], f)
        g, h, i = where(sought, frame[6], g), where(sought, frame[7], h), where(sought, frame[8], i)
    frame[0], frame[1], frame[2] = a, b, c
    frame[3], frame[4], frame[5] = d, e, f
    frame[6], frame[7], frame[8] = g, h, i
    return sought


@in_lanes_of(frame_search.best_fit)
def best_fit(count, fit, X, alpha, x, frame):
    """See `frame_search.best_fit`; no number in lanes where there is no frame."""
    cx = cy = cz = spread(0.0)
    for j in range(count):
        cx += alpha[j] * x[3 * j]
        cy += alpha[j] * x[3 * j + 1]
        cz += alpha[j] * x[3 * j + 2]
    left = spread(0.0) == 0.0
    found = ~left
    for _ in range(50):
        xx, xy, xz, yy, yz, zz, mx, my, mz = frame_search.fit_moments(
            count, fit, X, x, cx, cy, cz, frame)
        px, py, pz, definite = _fit_step(xx, xy, xz, yy, yz, zz, mx, my, mz)
        size = px * px + py * py + pz * pz
        _rotate_some(left, frame, px, py, pz)
        found = found | (left & definite & (size < 1e-16))
        left = left & ~found & (size < 16.0)
        if not some(left):
            break
    for k in range(9):
        frame[k] = where(found, frame[k], spread(NONE))
    return 0


@compiled
def _fit_step(xx, xy, xz, yy, yz, zz, mx, my, mz):
    """See `frame_search.best_fit`: Newton's step, one radian where J is not definite."""
    a, b, c = yy + zz, xx + zz, xx + yy
    det = a * (b * c - yz * yz) - xy * (xy * c + xz * yz) - xz * (xy * yz + b * xz)
    total = a + b + c
    definite = (a > 0.0) & (a * b > xy * xy) & (det > 1e-12 * total * total * total)
    p, q, r, s, t, u, v, w, z = inverse_3(a, -xy, -xz, -xy, b, -yz, -xz, -yz, c)
    x, y, z = p * mx + q * my + r * mz, s * mx + t * my + u * mz, v * mx + w * my + z * mz
    angle = math.sqrt(x * x + y * y + z * z)
    k, far = spread(1.0), angle > 1e-4
    if some(far):
        k = where(far, math.atan(angle) / angle, k)
    if every(definite):
        return k * x, k * y, k * z, definite
    size = math.sqrt(mx * mx + my * my + mz * mz)
    return (where(definite, k * x, mx / size), where(definite, k * y, my / size),
            where(definite, k * z, mz / size), definite)


@in_lanes_of(frame_search.planar_fit)
def planar_fit(count, fit, X, alpha, x, frame):
    """See `frame_search.planar_fit`; no number where all points are one."""
    along, across = frame_search.planar_moments(count, fit, X, alpha, x)
    size = math.hypot(along, across)
    frame[0] = frame[4] = along / size
    frame[3] = across / size
    frame[1] = -frame[3]
    return 0


@in_lanes_of(frame_search.mean_axes)
def mean_axes(positions, rotations, n, nodes, alpha, X, Gam, q, R, frame, psi):
    """See `frame_search.mean_axes`; no number in lanes where there is no frame."""
    mx = my = mz = spread(0.0)
    for k in range(3 * (positions + rotations), n):
        mx += Gam[3 * k] * q[k]
        my += Gam[3 * k + 1] * q[k]
        mz += Gam[3 * k + 2] * q[k]
    left = spread(0.0) == 0.0
    lost = ~left
    for _ in range(60):
        relative_rotations(rotations, nodes, R, frame, psi)
        x, y, z, a, b, c, d, e, f, g, h, i = frame_search.turn(
            positions, rotations, alpha, X, Gam, q, frame, psi)
        x, y, z = x + mx, y + my, z + mz
        newton = a * (e * i - f * h) + b * (f * g - d * i) + c * (d * h - e * g) > 0.1
        a, b, c, d, e, f, g, h, i = inverse_3(a, b, c, d, e, f, g, h, i)
        x, y, z = (where(newton, a * x + b * y + c * z, x),
                   where(newton, d * x + e * y + f * z, y),
                   where(newton, g * x + h * y + i * z, z))
        size = x * x + y * y + z * z
        lost = lost | (left & ~(size < 16.0))
        left = left & (size < 16.0) & ~(newton & (size < ROUNDING * ROUNDING))
        if not some(left):
            break
        _rotate_some(left, frame, x, y, z)
        left = left & ~(newton & (size < 1e-16))
        if not some(left):
            relative_rotations(rotations, nodes, R, frame, psi)
            break
    lost = lost | left
    if some(lost):
        for k in range(9):
            frame[k] = where(lost, spread(NONE), frame[k])
    return 0


@in_lanes_of(frame_search.planar_mean_axes)
def planar_mean_axes(positions, rotations, n, alpha, X, Gam, q, frame, psi):
    """See `frame_search.planar_mean_axes`; no number in lanes where there is no frame."""
    cx = cy = by_modes = spread(0.0)
    for j in range(positions):
        cx += alpha[j] * q[2 * j]
        cy += alpha[j] * q[2 * j + 1]
    first = 2 * positions
    for k in range(first + rotations, n):
        by_modes += Gam[k] * q[k]
    angle = math.atan2(frame[3], frame[0])
    left = spread(0.0) == 0.0
    turned = lost = ~left
    for attempt in range(60):
        cosine, sine = math.cos(angle), math.sin(angle)
        mean, slope = by_modes, spread(0.0)
        for j in range(positions):
            a, b = q[2 * j] - cx, q[2 * j + 1] - cy
            r, s = cosine * a + sine * b, cosine * b - sine * a
            mean += Gam[2 * j] * (r - X[2 * j]) + Gam[2 * j + 1] * (s - X[2 * j + 1])
            slope += Gam[2 * j + 1] * r - Gam[2 * j] * s
        for j in range(rotations):
            psi[j] = wrapped(q[first + j] - angle)
            lost = lost | (left & ~(math.cos(psi[j]) > NEAR_PI))
            mean += Gam[first + j] * psi[j]
            slope += Gam[first + j]
        newton = slope > 0.1
        step = where(newton, mean / slope, mean)
        lost = lost | (left & ~(abs(step) < 4.0))
        left = left & ~lost
        if attempt == 0:
            left = left & ~(newton & (abs(step) < ROUNDING))
        angle = where(left, angle + step, angle)
        turned = turned | left
        left = left & ~(newton & (abs(step) < 1e-8))
        if not some(left):
            break
    lost = lost | left
    if some(turned):
        cosine, sine = math.cos(angle), math.sin(angle)
        frame[0] = frame[4] = where(turned, cosine, frame[0])
        frame[3] = where(turned, sine, frame[3])
        for j in range(rotations):
            psi[j] = where(turned, wrapped(q[first + j] - angle), psi[j])
    for k in range(0, 4, 3):
        frame[k] = where(lost, spread(NONE), frame[k])
    frame[4] = frame[0]
    frame[1] = -frame[3]
    return 0


@in_lanes_of(frame_search.planar_relative_angles)
def planar_relative_angles(count, angles, frame, psi):
    """See `frame_search.planar_relative_angles`; no number where one is too near half a turn."""
    mean = math.atan2(frame[3], frame[0])
    for j in range(count):
        angle = wrapped(angles[j] - mean)
        psi[j] = where(math.cos(angle) > NEAR_PI, angle, spread(NONE))
    return 0
