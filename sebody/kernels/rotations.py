"""Maps of SO(3) for compiled code: exp, log, tangent operator and the series behind them.

Rotation matrices are nine numbers in row-major order.
"""

import math

from sebody.compiler.decorators import compiled

NEAR_PI = -0.98     # cosine beyond which the logarithm of a relative rotation is refused
SMALL = 0.25        # square of an angle below which nested series are used
SMALL_SINE = 0.09   # square of a sine, likewise


@compiled
def stumpff(k, s):
    """``c_k(s) = sum_j (-s)^j / (k + 2j)!``; 24 terms serve ``0 <= s <= 10`` to rounding."""
    term = 1.0
    for j in range(2, k + 1):
        term /= j
    total = term
    for j in range(24):
        term *= -s / ((k + 2 * j + 1) * (k + 2 * j + 2))
        total += term
        if abs(term) < 1e-17 * abs(total):
            break
    return total


@compiled(forceinline=True)
def polynomial(x, x2, a, b, c, d, e, f, g, h):
    """``a + b x + ... + h x^7`` by pairs (Estrin): each product waits for three, not for seven."""
    return (a + b * x + x2 * (c + d * x)) + x2 * x2 * (e + f * x + x2 * (g + h * x))


@compiled
def stumpff_23(s):
    """``c_2, c_3``: nested series for small arguments, closed forms where these are exact."""
    return stumpff_23_small(s) if s < SMALL else stumpff_23_large(s)


@compiled
def stumpff_23_small(s):
    """`stumpff_23` by nested series."""
    s2 = s * s
    c2 = polynomial(-s, s2, 1 / 2, 1 / 24, 1 / 720, 1 / 40320, 1 / 3628800, 1 / 479001600,
                    1 / 87178291200, 1 / 20922789888000)
    c3 = polynomial(-s, s2, 1 / 6, 1 / 120, 1 / 5040, 1 / 362880, 1 / 39916800, 1 / 6227020800,
                    1 / 1307674368000, 1 / 355687428096000)
    return c2, c3


@compiled
def stumpff_23_large(s):
    """`stumpff_23` in closed form."""
    t = math.sqrt(s)
    half = math.sin(0.5 * t)
    return 2.0 * half * half / s, (t - math.sin(t)) / (s * t)


@compiled
def stumpff_2345(s):
    """``c_2, c_3, c_4, c_5``."""
    c4, c5 = stumpff(4, s), stumpff(5, s)
    return 0.5 - s * c4, 1.0 / 6.0 - s * c5, c4, c5


@compiled
def stumpff_1_to_7(s):
    """``c_1`` to ``c_7``: the last two from series, the others by ``c_k = 1/k! - s c_k+2``."""
    if s < SMALL:
        c6, c7 = stumpff_67_small(s)
    else:
        c6, c7 = stumpff(6, s), stumpff(7, s)
    return stumpff_before_67(s, c6, c7)


@compiled
def stumpff_67_small(s):
    """``c_6, c_7`` by nested series."""
    c6 = 1 / 720 - s * (1 / 40320 - s * (1 / 3628800 - s * (1 / 479001600 - s * (
        1 / 87178291200 - s * (1 / 20922789888000)))))
    c7 = 1 / 5040 - s * (1 / 362880 - s * (1 / 39916800 - s * (1 / 6227020800 - s * (
        1 / 1307674368000 - s * (1 / 355687428096000)))))
    return c6, c7


@compiled
def stumpff_before_67(s, c6, c7):
    """All of `stumpff_1_to_7`, of the last two."""
    c4, c5 = 1 / 24 - s * c6, 1 / 120 - s * c7
    c2, c3 = 1 / 2 - s * c4, 1 / 6 - s * c5
    return 1 - s * c3, c2, c3, c4, c5, c6, c7


@compiled
def inverse_tangent_coefficients(s):
    """``e`` and ``de/ds`` of ``T^-1 = I + skew/2 + e skew^2``, ``e = (c_3 - 2 c_4)/(2 c_2)``."""
    return inverse_tangent_small(s) if s < SMALL else inverse_tangent_large(s)


@compiled
def inverse_tangent_small(s):
    """`inverse_tangent_coefficients` by series in Bernoulli numbers, B_2k / (2k)!."""
    s2 = s * s
    e = polynomial(s, s2, 1 / 12, 1 / 720, 1 / 30240, 1 / 1209600, 1 / 47900160,
                   691 / 1307674368000, 1 / 74724249600, 3617 / 10670622842880000)
    d = polynomial(s, s2, 1 / 720, 1 / 15120, 1 / 403200, 1 / 11975040, 691 / 261534873600,
                   1 / 12454041600, 25319 / 10670622842880000,
                   8 * 43867 / 5109094217170944000)
    return e, d


@compiled
def inverse_tangent_large(s):
    """`inverse_tangent_coefficients` from Stumpff's functions."""
    c2, c3, c4, c5 = stumpff_2345(s)
    c6 = stumpff(6, s)
    top = c3 - 2.0 * c4
    d_top = 0.5 * (3.0 * c5 - c4) - (4.0 * c6 - c5)
    d_c2 = 0.5 * (2.0 * c4 - c3)
    return top / (2.0 * c2), (d_top - top * d_c2 / c2) / (2.0 * c2)


@compiled
def inverse_tangent_second(s):
    """``d^2 e/ds^2`` of `inverse_tangent_coefficients`."""
    return inverse_tangent_second_small(s) if s < SMALL else inverse_tangent_second_large(s)


@compiled
def inverse_tangent_second_small(s):
    """`inverse_tangent_second` by a series in Bernoulli numbers."""
    return 1 / 15120 + s * (1 / 201600 + s * (1 / 3991680 + s * (691 / 65383718400 + s * (
        1 / 2490808320 + s * (25319 / 1778437140480000 + s * (
            56 * 43867 / 5109094217170944000 + s * (
                72 * 174611 / 802857662698291200000)))))))


@compiled
def inverse_tangent_second_large(s):
    """`inverse_tangent_second` from Stumpff's functions."""
    c2, c3, c4, c5 = stumpff_2345(s)
    c6, c7, c8 = stumpff(6, s), stumpff(7, s), stumpff(8, s)
    d_c2, d_c3 = 0.5 * (2.0 * c4 - c3), 0.5 * (3.0 * c5 - c4)
    d_c4, d_c5, d_c6 = 0.5 * (4.0 * c6 - c5), 0.5 * (5.0 * c7 - c6), 0.5 * (6.0 * c8 - c7)
    e = (c3 - 2.0 * c4) / (2.0 * c2)
    d_e = 0.5 * (d_c3 - 2.0 * d_c4 - 2.0 * e * d_c2) / c2
    dd_top = 0.5 * (3.0 * d_c5 - d_c4) - (4.0 * d_c6 - d_c5)
    return (0.5 * dd_top - 0.5 * (2.0 * d_c4 - d_c3) * e - 2.0 * d_c2 * d_e) / c2


@compiled(fastmath=False)      # for the time loop
def tangent_operator(x, y, z):
    """``T(psi)``, row by row: ``Omega = T(psi) psidot``."""
    c2, c3 = stumpff_23(x * x + y * y + z * z)
    return (1 - c3 * (y * y + z * z), c2 * z + c3 * x * y, c3 * x * z - c2 * y,
            c3 * x * y - c2 * z, 1 - c3 * (x * x + z * z), c2 * x + c3 * y * z,
            c2 * y + c3 * x * z, c3 * y * z - c2 * x, 1 - c3 * (x * x + y * y))


@compiled(forceinline=True)
def exp_map(x, y, z):
    """Rotation matrix of a rotation vector, row by row."""
    s = x * x + y * y + z * z
    c2, c3 = stumpff_23(s)
    c1 = 1.0 - s * c3
    return (1 - c2 * (y * y + z * z), c2 * x * y - c1 * z, c2 * x * z + c1 * y,
            c2 * x * y + c1 * z, 1 - c2 * (x * x + z * z), c2 * y * z - c1 * x,
            c2 * x * z - c1 * y, c2 * y * z + c1 * x, 1 - c2 * (x * x + y * y))


@compiled(forceinline=True)
def log_map(xx, xy, xz, yx, yy, yz, zx, zy, zz):
    """Rotation vector of a rotation matrix less than `NEAR_PI` from half a turn, and its cosine."""
    x, y, z = 0.5 * (zy - yz), 0.5 * (xz - zx), 0.5 * (yx - xy)
    cosine = 0.5 * (xx + yy + zz - 1.0)
    s2 = x * x + y * y + z * z
    if cosine > 0.0 and s2 < SMALL_SINE:
        ratio = angle_by_sine_small(s2)
    else:
        ratio = angle_by_sine_large(s2, cosine)
    return ratio * x, ratio * y, ratio * z, cosine


@compiled
def angle_by_sine_small(s2):
    """``t / sin t`` in powers of ``sin^2 t``."""
    s4 = s2 * s2
    s8 = s4 * s4
    return (polynomial(s2, s4, 1.0, 1 / 6, 3 / 40, 5 / 112, 35 / 1152, 63 / 2816, 231 / 13312,
                       143 / 10240)
            + s8 * s8 * polynomial(s2, s4, 6435 / 557056, 12155 / 1245184, 46189 / 5505024,
                                   88179 / 12058624, 676039 / 104857600, 1300075 / 226492416,
                                   5014575 / 973078528, 9694845 / 2080374784))


@compiled
def angle_by_sine_large(s2, cosine):
    """``t / sin t`` of an angle between a right one and half a turn, or not small."""
    sine = math.sqrt(s2)
    return math.atan2(sine, cosine) / sine


@compiled(forceinline=True)
def rotated(R, first, x, y, z):
    """``R exp(psi)`` of the rotation that begins at `first` of R, row by row."""
    a, b, c, d, e, f, g, h, i = exp_map(x, y, z)
    k, m, n = R[first], R[first + 1], R[first + 2]
    p, q, r = R[first + 3], R[first + 4], R[first + 5]
    s, t, u = R[first + 6], R[first + 7], R[first + 8]
    return (k * a + m * d + n * g, k * b + m * e + n * h, k * c + m * f + n * i,
            p * a + q * d + r * g, p * b + q * e + r * h, p * c + q * f + r * i,
            s * a + t * d + u * g, s * b + t * e + u * h, s * c + t * f + u * i)


@compiled
def rotate(R, first, x, y, z, out, to):
    """``out = R exp(psi)``: the rotation at `first` of R, rotated, to `to` of out."""
    (out[to], out[to + 1], out[to + 2], out[to + 3], out[to + 4], out[to + 5], out[to + 6],
     out[to + 7], out[to + 8]) = rotated(R, first, x, y, z)


@compiled(forceinline=True)
def relative_log(A, first, B, second):
    """Rotation vector and cosine of ``A^T B`` of two stored rotations."""
    a0, a1, a2, a3, a4, a5, a6, a7, a8 = (
        A[first], A[first + 1], A[first + 2], A[first + 3], A[first + 4], A[first + 5],
        A[first + 6], A[first + 7], A[first + 8])
    b0, b1, b2, b3, b4, b5, b6, b7, b8 = (
        B[second], B[second + 1], B[second + 2], B[second + 3], B[second + 4], B[second + 5],
        B[second + 6], B[second + 7], B[second + 8])
    return log_map(a0 * b0 + a3 * b3 + a6 * b6, a0 * b1 + a3 * b4 + a6 * b7,
                   a0 * b2 + a3 * b5 + a6 * b8, a1 * b0 + a4 * b3 + a7 * b6,
                   a1 * b1 + a4 * b4 + a7 * b7, a1 * b2 + a4 * b5 + a7 * b8,
                   a2 * b0 + a5 * b3 + a8 * b6, a2 * b1 + a5 * b4 + a8 * b7,
                   a2 * b2 + a5 * b5 + a8 * b8)


@compiled
def relative_rotations(count, nodes, R, frame, psi):
    """``psi_j = log(R0^T R_j)``; returns 1 where one is too near half a turn."""
    for j in range(count):
        psi[3 * j], psi[3 * j + 1], psi[3 * j + 2], cosine = relative_log(
            frame, 0, R, 9 * nodes[j])
        if not cosine > NEAR_PI:
            return 1
    return 0
