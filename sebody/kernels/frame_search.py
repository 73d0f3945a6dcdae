"""Searches for the rotation of a floating frame, called by superelement kernels.

Each returns a status: 0, HALF_TURN where a node is nearly 180 degrees off the frame,
or NO_FRAME where the search does not end.
"""

import math

from sebody.compiler.decorators import compiled
from sebody.contract.layout import HALF_TURN, NO_FRAME
from sebody.kernels.dense import inverse_3
from sebody.kernels.rotations import (
    NEAR_PI,
    inverse_tangent_coefficients,
    relative_log,
    relative_rotations,
    rotate,
    rotated,
)


@compiled
def converged_mean(count, nodes, alpha, R, frame, psi):
    """The rotation with ``sum alpha_j psi_j = 0``, by Newton from the frame of the last iterate."""
    if count == 2 and _mean_of_two(nodes, alpha, R, frame, psi):
        return 0
    for _ in range(30):
        if relative_rotations(count, nodes, R, frame, psi) != 0:
            return HALF_TURN
        x = y = z = 0.0
        for j in range(count):
            x += alpha[j] * psi[3 * j]
            y += alpha[j] * psi[3 * j + 1]
            z += alpha[j] * psi[3 * j + 2]
        if x * x + y * y + z * z < 1e-30:
            return 0
        x, y, z = mean_step(count, alpha, psi, x, y, z)
        rotate(frame, 0, x, y, z, frame, 0)
        if x * x + y * y + z * z < 1e-16:       # Newton: the error left is the square of the step
            return relative_rotations(count, nodes, R, frame, psi)
    return NO_FRAME


@compiled
def _mean_of_two(nodes, alpha, R, frame, psi):
    """Mean of two rotations: a point on the geodesic between them, in closed form.

    Returns False and changes nothing if the rotations, or the mean and the last frame, differ by
    more than a quarter turn: the nodes may be rotated against each other by more than half a turn,
    and then the mean is not on the shortest way between them.
    """
    x, y, z, cosine = relative_log(R, 9 * nodes[0], R, 9 * nodes[1])
    if not cosine > 0.0:
        return False
    p, q, r = alpha[1] * x, alpha[1] * y, alpha[1] * z
    a, b, c, d, e, f, g, h, i = rotated(R, 9 * nodes[0], p, q, r)
    if (a * frame[0] + b * frame[1] + c * frame[2] + d * frame[3] + e * frame[4] + f * frame[5]
            + g * frame[6] + h * frame[7] + i * frame[8] < 1.0):     # a quarter turn away
        return False
    frame[0], frame[1], frame[2] = a, b, c
    frame[3], frame[4], frame[5] = d, e, f
    frame[6], frame[7], frame[8] = g, h, i
    psi[0], psi[1], psi[2] = -p, -q, -r
    psi[3], psi[4], psi[5] = alpha[0] * x, alpha[0] * y, alpha[0] * z
    return True


@compiled
def mean_step(count, alpha, psi, x, y, z):
    """``B^-1 (x, y, z)`` with ``B = sum alpha_j T^-T(psi_j)``."""
    xx = xy = xz = yx = yy = yz = zx = zy = zz = 0.0
    for j in range(count):
        a, b, c = psi[3 * j], psi[3 * j + 1], psi[3 * j + 2]
        w, e = alpha[j], inverse_tangent_coefficients(a * a + b * b + c * c)[0]
        xx += w * (1 - e * (b * b + c * c))
        yy += w * (1 - e * (a * a + c * c))
        zz += w * (1 - e * (a * a + b * b))
        xy += w * (0.5 * c + e * a * b)
        yx += w * (e * a * b - 0.5 * c)
        xz += w * (e * a * c - 0.5 * b)
        zx += w * (0.5 * b + e * a * c)
        yz += w * (0.5 * a + e * b * c)
        zy += w * (e * b * c - 0.5 * a)
    xx, xy, xz, yx, yy, yz, zx, zy, zz = inverse_3(xx, xy, xz, yx, yy, yz, zx, zy, zz)
    return xx * x + xy * y + xz * z, yx * x + yy * y + yz * z, zx * x + zy * y + zz * z


@compiled
def weighted_mean(count, nodes, alpha, R, reference, frame, beta, psi):
    """The paper's mean (15)-(16) of the rotation increments since the reference frame."""
    if relative_rotations(count, nodes, R, reference, beta) != 0:
        return HALF_TURN
    x = y = z = 0.0
    for j in range(count):
        x += alpha[j] * beta[3 * j]
        y += alpha[j] * beta[3 * j + 1]
        z += alpha[j] * beta[3 * j + 2]
    rotate(reference, 0, x, y, z, frame, 0)
    return relative_rotations(count, nodes, R, frame, psi)


@compiled
def planar_mean(count, alpha, angles, frame, psi):
    """Weighted mean of angles; the frame is its rotation about z."""
    mean = 0.0
    for j in range(count):
        mean += alpha[j] * angles[j]
    for j in range(count):
        psi[j] = angles[j] - mean
    frame[0] = frame[4] = math.cos(mean)
    frame[3] = math.sin(mean)
    frame[1] = -frame[3]
    return 0

ROUNDING = 1e-15        # rad, of a rotation


@compiled
def best_fit(count, fit, X, alpha, x, frame):
    """The rotation with ``sum w_j X_j x R0^T (x_j - x0) = 0``, by Newton from the last iterate."""
    cx = cy = cz = 0.0
    for j in range(count):
        cx += alpha[j] * x[3 * j]
        cy += alpha[j] * x[3 * j + 1]
        cz += alpha[j] * x[3 * j + 2]
    for _ in range(50):
        xx, xy, xz, yy, yz, zz, mx, my, mz = fit_moments(count, fit, X, x, cx, cy, cz, frame)
        px, py, pz, definite = _fit_step(xx, xy, xz, yy, yz, zz, mx, my, mz)
        size = px * px + py * py + pz * pz
        if not size < 16.0:
            return NO_FRAME
        rotate(frame, 0, px, py, pz, frame, 0)
        if definite and size < 1e-16:       # Newton: the error left is the square of the step
            return 0
    return NO_FRAME


@compiled(forceinline=True)
def fit_moments(count, fit, X, x, cx, cy, cz, frame):
    """Sums ``S = sum w_j X_j r_j^T``, symmetric, and ``sum w_j X_j x r_j`` of turned points r_j."""
    mx = my = mz = xx = xy = xz = yy = yz = zz = 0.0
    for j in range(count):
        a, b, c = x[3 * j] - cx, x[3 * j + 1] - cy, x[3 * j + 2] - cz
        r = frame[0] * a + frame[3] * b + frame[6] * c
        s = frame[1] * a + frame[4] * b + frame[7] * c
        t = frame[2] * a + frame[5] * b + frame[8] * c
        w, u, v, z = fit[j], X[3 * j], X[3 * j + 1], X[3 * j + 2]
        mx += w * (v * t - z * s)
        my += w * (z * r - u * t)
        mz += w * (u * s - v * r)
        xx += w * u * r
        yy += w * v * s
        zz += w * z * t
        xy += 0.5 * w * (u * s + v * r)
        xz += 0.5 * w * (u * t + z * r)
        yz += 0.5 * w * (v * t + z * s)
    return xx, xy, xz, yy, yz, zz, mx, my, mz


@compiled
def _fit_step(xx, xy, xz, yy, yz, zz, mx, my, mz):
    """Rotation vector of a step towards the best fit, and whether the step is Newton's.

    ``J = tr(S) I - S`` is positive definite near the best fit. For an isotropic body the length of
    Newton's step is the tangent of the remaining angle, hence the arc tangent; where J is not
    definite (beyond a saddle), the step is one radian along the moment.
    """
    a, b, c = yy + zz, xx + zz, xx + yy
    det = a * (b * c - yz * yz) - xy * (xy * c + xz * yz) - xz * (xy * yz + b * xz)
    if a > 0.0 and a * b > xy * xy and det > 1e-12 * (a + b + c) ** 3:
        p, q, r, s, t, u, v, w, z = inverse_3(a, -xy, -xz, -xy, b, -yz, -xz, -yz, c)
        x, y, z = p * mx + q * my + r * mz, s * mx + t * my + u * mz, v * mx + w * my + z * mz
        angle = math.sqrt(x * x + y * y + z * z)
        k = math.atan(angle) / angle if angle > 1e-4 else 1.0
        return k * x, k * y, k * z, True
    size = math.sqrt(mx * mx + my * my + mz * mz)
    return mx / size, my / size, mz / size, False


@compiled
def planar_fit(count, fit, X, alpha, x, frame):
    """The rotation of best fit in a plane, in closed form."""
    along, across = planar_moments(count, fit, X, alpha, x)
    size = math.hypot(along, across)
    if not size > 0.0:
        return NO_FRAME
    frame[0] = frame[4] = along / size
    frame[3] = across / size
    frame[1] = -frame[3]
    return 0


@compiled(forceinline=True)
def planar_moments(count, fit, X, alpha, x):
    """Sums of the products of all points with their places in the body, along and across."""
    cx = cy = 0.0
    for j in range(count):
        cx += alpha[j] * x[2 * j]
        cy += alpha[j] * x[2 * j + 1]
    along = across = 0.0
    for j in range(count):
        a, b, w = x[2 * j] - cx, x[2 * j + 1] - cy, fit[j]
        along += w * (X[2 * j] * a + X[2 * j + 1] * b)
        across += w * (X[2 * j] * b - X[2 * j + 1] * a)
    return along, across


@compiled
def mean_axes(positions, rotations, n, nodes, alpha, X, Gam, q, R, frame, psi):
    """The rotation with ``sum Gam_i y_i = 0`` of all coordinates, by Newton from the last iterate.

    Gam is one of a rigid rotation, so the sum itself is a step that converges from afar.
    """
    mx = my = mz = 0.0
    for k in range(3 * (positions + rotations), n):
        mx += Gam[3 * k] * q[k]
        my += Gam[3 * k + 1] * q[k]
        mz += Gam[3 * k + 2] * q[k]
    for _ in range(60):
        if relative_rotations(rotations, nodes, R, frame, psi) != 0:
            return HALF_TURN
        x, y, z, a, b, c, d, e, f, g, h, i = turn(positions, rotations, alpha, X, Gam, q, frame,
                                                  psi)
        x, y, z = x + mx, y + my, z + mz
        newton = a * (e * i - f * h) + b * (f * g - d * i) + c * (d * h - e * g) > 0.1
        if newton:
            a, b, c, d, e, f, g, h, i = inverse_3(a, b, c, d, e, f, g, h, i)
            x, y, z = a * x + b * y + c * z, d * x + e * y + f * z, g * x + h * y + i * z
        size = x * x + y * y + z * z
        if not size < 16.0:
            return NO_FRAME
        if newton and size < ROUNDING * ROUNDING:   # the frame of this state was found before
            return 0
        rotate(frame, 0, x, y, z, frame, 0)
        if newton and size < 1e-16:         # Newton: the error left is the square of the step
            return relative_rotations(rotations, nodes, R, frame, psi)
    return NO_FRAME


@compiled(forceinline=True)
def turn(positions, rotations, alpha, X, Gam, q, frame, psi):
    """The nodes' part of the mean rotation, and its derivative by rows."""
    x, y, z, a, b, c, d, e, f, g, h, i = _turn_of_positions(positions, alpha, X, Gam, q, frame)
    u, v, w, aa, bb, cc, dd, ee, ff, gg, hh, ii = _turn_of_rotations(
        rotations, 9 * positions, Gam, psi)
    return (x + u, y + v, z + w, a + aa, b + bb, c + cc, d + dd, e + ee, f + ff, g + gg, h + hh,
            i + ii)


@compiled
def _turn_of_positions(count, alpha, X, Gam, q, frame):
    """Their part of the mean rotation; of its derivative, ``-sum Gam_j skew(r_j)`` by rows."""
    cx = cy = cz = 0.0
    for j in range(count):
        cx += alpha[j] * q[3 * j]
        cy += alpha[j] * q[3 * j + 1]
        cz += alpha[j] * q[3 * j + 2]
    x = y = z = xx = xy = xz = yx = yy = yz = zx = zy = zz = 0.0
    for j in range(count):
        a, b, c = q[3 * j] - cx, q[3 * j + 1] - cy, q[3 * j + 2] - cz
        r = frame[0] * a + frame[3] * b + frame[6] * c
        s = frame[1] * a + frame[4] * b + frame[7] * c
        t = frame[2] * a + frame[5] * b + frame[8] * c
        u, v, w, k = r - X[3 * j], s - X[3 * j + 1], t - X[3 * j + 2], 9 * j
        x += Gam[k] * u + Gam[k + 3] * v + Gam[k + 6] * w
        y += Gam[k + 1] * u + Gam[k + 4] * v + Gam[k + 7] * w
        z += Gam[k + 2] * u + Gam[k + 5] * v + Gam[k + 8] * w
        xx += Gam[k + 6] * s - Gam[k + 3] * t
        xy += Gam[k] * t - Gam[k + 6] * r
        xz += Gam[k + 3] * r - Gam[k] * s
        yx += Gam[k + 7] * s - Gam[k + 4] * t
        yy += Gam[k + 1] * t - Gam[k + 7] * r
        yz += Gam[k + 4] * r - Gam[k + 1] * s
        zx += Gam[k + 8] * s - Gam[k + 5] * t
        zy += Gam[k + 2] * t - Gam[k + 8] * r
        zz += Gam[k + 5] * r - Gam[k + 2] * s
    return x, y, z, xx, xy, xz, yx, yy, yz, zx, zy, zz


@compiled
def _turn_of_rotations(count, first, Gam, psi):
    """Their part of the mean rotation; of its derivative, ``sum Gam_j T^-T(psi_j)`` by rows."""
    x = y = z = xx = xy = xz = yx = yy = yz = zx = zy = zz = 0.0
    for j in range(count):
        a, b, c, k = psi[3 * j], psi[3 * j + 1], psi[3 * j + 2], first + 9 * j
        e = inverse_tangent_coefficients(a * a + b * b + c * c)[0]
        p, q, r = 1 - e * (b * b + c * c), 0.5 * c + e * a * b, e * a * c - 0.5 * b
        s, t, u = e * a * b - 0.5 * c, 1 - e * (a * a + c * c), 0.5 * a + e * b * c
        v, w, o = 0.5 * b + e * a * c, e * b * c - 0.5 * a, 1 - e * (a * a + b * b)
        x += Gam[k] * a + Gam[k + 3] * b + Gam[k + 6] * c
        y += Gam[k + 1] * a + Gam[k + 4] * b + Gam[k + 7] * c
        z += Gam[k + 2] * a + Gam[k + 5] * b + Gam[k + 8] * c
        xx += Gam[k] * p + Gam[k + 3] * s + Gam[k + 6] * v
        xy += Gam[k] * q + Gam[k + 3] * t + Gam[k + 6] * w
        xz += Gam[k] * r + Gam[k + 3] * u + Gam[k + 6] * o
        yx += Gam[k + 1] * p + Gam[k + 4] * s + Gam[k + 7] * v
        yy += Gam[k + 1] * q + Gam[k + 4] * t + Gam[k + 7] * w
        yz += Gam[k + 1] * r + Gam[k + 4] * u + Gam[k + 7] * o
        zx += Gam[k + 2] * p + Gam[k + 5] * s + Gam[k + 8] * v
        zy += Gam[k + 2] * q + Gam[k + 5] * t + Gam[k + 8] * w
        zz += Gam[k + 2] * r + Gam[k + 5] * u + Gam[k + 8] * o
    return x, y, z, xx, xy, xz, yx, yy, yz, zx, zy, zz


@compiled
def planar_mean_axes(positions, rotations, n, alpha, X, Gam, q, frame, psi):
    """The same rotation in a plane."""
    cx = cy = by_modes = 0.0
    for j in range(positions):
        cx += alpha[j] * q[2 * j]
        cy += alpha[j] * q[2 * j + 1]
    first = 2 * positions
    for k in range(first + rotations, n):
        by_modes += Gam[k] * q[k]
    angle = math.atan2(frame[3], frame[0])
    for attempt in range(60):
        cosine, sine = math.cos(angle), math.sin(angle)
        mean, slope = by_modes, 0.0
        for j in range(positions):
            a, b = q[2 * j] - cx, q[2 * j + 1] - cy
            r, s = cosine * a + sine * b, cosine * b - sine * a
            mean += Gam[2 * j] * (r - X[2 * j]) + Gam[2 * j + 1] * (s - X[2 * j + 1])
            slope += Gam[2 * j + 1] * r - Gam[2 * j] * s
        for j in range(rotations):
            psi[j] = wrapped(q[first + j] - angle)
            if not math.cos(psi[j]) > NEAR_PI:
                return HALF_TURN
            mean += Gam[first + j] * psi[j]
            slope += Gam[first + j]
        step = mean / slope if slope > 0.1 else mean
        if not abs(step) < 4.0:
            return NO_FRAME
        if slope > 0.1 and abs(step) < ROUNDING and attempt == 0:   # as it was found before
            return 0
        angle += step
        if slope > 0.1 and abs(step) < 1e-8:
            frame[0] = frame[4] = math.cos(angle)
            frame[3] = math.sin(angle)
            frame[1] = -frame[3]
            for j in range(rotations):
                psi[j] = wrapped(q[first + j] - angle)
            return 0
    return NO_FRAME


@compiled
def planar_relative_angles(count, angles, frame, psi):
    """Angles of the nodes in a frame, between -pi and pi."""
    mean = math.atan2(frame[3], frame[0])
    for j in range(count):
        psi[j] = wrapped(angles[j] - mean)
        if not math.cos(psi[j]) > NEAR_PI:
            return HALF_TURN
    return 0


@compiled
def wrapped(angle):
    """The angle less full turns, between -pi and pi."""
    return angle - 2.0 * math.pi * math.floor(angle / (2.0 * math.pi) + 0.5)
