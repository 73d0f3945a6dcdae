"""What continuous controllers read in an iterate, and its derivatives by all unknowns.

Kinds of readings are those of sampled controllers, `sebody.engine.channels`.
"""

import numpy as np

from sebody.compiler.decorators import compiled
from sebody.contract.law_row import (
    ALONG,
    ANGLE,
    DOT,
    FIRST,
    FIRST_LOCAL,
    FLAT_ALONG,
    FLAT_RATE,
    HELD,
    IN_PLANE,
    INTO,
    ITS_RATE,
    KIND,
    OF_RATES,
    SECOND,
    SECOND_LOCAL,
    THIRD,
    THIRD_LOCAL,
    TURN,
    TURNED,
)
from sebody.kernels.ways import between, carried, turned, turning, way, way_rate


@compiled(forceinline=True)
def dot(x, first, c, place):
    """Product of three numbers and a vector, without what is multiplied by zero."""
    total = 0.0
    for i in range(3):
        if c[place + i] != 0.0:
            total += c[place + i]*x[first + i]
    return total


@compiled
def _back(R, first, c, place, i):
    """Component i of the transpose of a rotation matrix times a vector."""
    return R[first + i]*c[place] + R[first + 3 + i]*c[place + 1] + R[first + 6 + i]*c[place + 2]


@compiled(forceinline=True)
def _forth(R, first, c, place, i):
    """Component i of a rotation matrix times a vector."""
    return (R[first + 3*i]*c[place] + R[first + 3*i + 1]*c[place + 1]
            + R[first + 3*i + 2]*c[place + 2])


@compiled
def reading(row, c, q, R, v, frames, last):
    """What an input is in the iterate, without bias; `last` is an angle's last value."""
    kind, one, two = row[KIND], row[FIRST], row[SECOND]
    x = v if row[OF_RATES] == 1 else q
    if kind == HELD:
        return frames[one]
    if kind == DOT:             # c0 + e . x + f . y
        return c[0] + dot(x, one, c, 1) + dot(x, two, c, 4)
    if kind == TURNED:          # e . (R v)
        return sum3(_back(R, one, c, 1, 0)*v[two], _back(R, one, c, 1, 1)*v[two + 1],
                    _back(R, one, c, 1, 2)*v[two + 2])
    if kind == INTO:            # e . (R' x)
        return sum3(_forth(R, one, c, 1, 0)*x[two], _forth(R, one, c, 1, 1)*x[two + 1],
                    _forth(R, one, c, 1, 2)*x[two + 2])
    if kind == IN_PLANE:        # the same with an angle
        cosine, sine = np.cos(q[one]), np.sin(q[one])
        return (c[1]*(cosine*x[two] + sine*x[two + 1])
                + c[2]*(cosine*x[two + 1] - sine*x[two]))
    if kind == ALONG or kind == FLAT_ALONG:
        return c[0] + way(kind == FLAT_ALONG, q if kind == FLAT_ALONG else R, one,
                          (c[1], c[2], c[3]), q, two, row[THIRD])
    if kind == ITS_RATE or kind == FLAT_RATE:
        return way_rate(kind == FLAT_RATE, q if kind == FLAT_RATE else R, one,
                        (c[1], c[2], c[3]), q, two, row[THIRD], v, two, row[THIRD], row[TURN])
    return angle(R, one, two, c, last)


@compiled(forceinline=True)
def angle(R, one, two, c, last):
    """Angle of n of a body against n and m of another, or the ground; turns since `last` count."""
    along = across = 0.0
    for i in range(3):
        own = _forth(R, one, c, 1, i)
        along += own*(_forth(R, two, c, 4, i) if two >= 0 else c[4 + i])
        across += own*(_forth(R, two, c, 7, i) if two >= 0 else c[7 + i])
    found = np.arctan2(across, along)
    return found + 2.0*np.pi*np.floor((last - found)/(2.0*np.pi) + 0.5)


@compiled
def sum3(a, b, c):
    """Sum of three numbers."""
    return a + b + c


@compiled
def _turn(Y, local, T, first, x, y, z, factor):
    """Add the derivatives by a rotation's increment: those by the rotation times T."""
    for j in range(3):
        Y[local + j] += factor*(x*T[first + j] + y*T[first + 3 + j] + z*T[first + 6 + j])


@compiled
def _shift(planar, R, first, e, b, a, factor, Y):
    """Add the derivatives of ``(R e) . (x_b - x_a)`` by both points."""
    r = turned(planar, R, first, e[0], e[1], e[2])
    for i in range(2 if planar else 3):
        Y[b + i] += factor*r[i]
        Y[a + i] -= factor*r[i]


@compiled
def _spin(planar, Y, local, T, first, r, factor):
    """Add derivatives by a rotation of a body, those by an angle in a plane."""
    if planar:
        Y[local] += factor*r[2]
    else:
        _turn(Y, local, T, first, r[0], r[1], r[2], factor)


@compiled
def _vary_turned(row, c, R, v, T, c_q, c_v, Y):
    """d(R v) = R (dv + theta x v), and e . R (theta x v) = theta . (v x R'e)."""
    one, two, to = row[FIRST], row[SECOND], row[SECOND_LOCAL]
    a, b, d = _back(R, one, c, 1, 0), _back(R, one, c, 1, 1), _back(R, one, c, 1, 2)
    p, r, s = v[two], v[two + 1], v[two + 2]
    Y[to] += c_v*a
    Y[to + 1] += c_v*b
    Y[to + 2] += c_v*d
    _turn(Y, row[FIRST_LOCAL], T, one, r*d - s*b, s*a - p*d, p*b - r*a, c_q)


@compiled
def _vary_into(row, c, R, x, T, c_q, factor, Y):
    """d(R' x) = R' dx - theta x R' x."""
    one, two = row[FIRST], row[SECOND]
    p = R[one]*x[two] + R[one + 3]*x[two + 1] + R[one + 6]*x[two + 2]
    r = R[one + 1]*x[two] + R[one + 4]*x[two + 1] + R[one + 7]*x[two + 2]
    s = R[one + 2]*x[two] + R[one + 5]*x[two + 1] + R[one + 8]*x[two + 2]
    for i in range(3):
        Y[row[SECOND_LOCAL] + i] += factor*_forth(R, one, c, 1, i)
    _turn(Y, row[FIRST_LOCAL], T, one, c[2]*s - c[3]*r, c[3]*p - c[1]*s, c[1]*r - c[2]*p, c_q)


@compiled
def _vary_in_plane(row, c, q, x, c_q, factor, Y):
    """The same with an angle."""
    one, two, to = row[FIRST], row[SECOND], row[SECOND_LOCAL]
    cosine, sine = np.cos(q[one]), np.sin(q[one])
    Y[to] += factor*(c[1]*cosine - c[2]*sine)
    Y[to + 1] += factor*(c[1]*sine + c[2]*cosine)
    Y[row[FIRST_LOCAL]] += c_q*(c[1]*(cosine*x[two + 1] - sine*x[two])
                                - c[2]*(sine*x[two + 1] + cosine*x[two]))


@compiled
def _vary_way_rate(planar, row, c, q, R, v, T, c_q, c_v, Y):
    """Of the rate of a displacement along an axis that turns with a body."""
    one, two, at_one, at_two = row[FIRST], row[SECOND], row[FIRST_LOCAL], row[SECOND_LOCAL]
    e, A = (c[1], c[2], c[3]), q if planar else R
    f = carried(planar, v, row[TURN], e[0], e[1], e[2])
    d, w = between(planar, q, two, row[THIRD]), between(planar, v, two, row[THIRD])
    _shift(planar, A, one, e, at_two, row[THIRD_LOCAL], c_v, Y)
    _shift(planar, A, one, f, at_two, row[THIRD_LOCAL], c_q, Y)
    r, s = turning(planar, A, one, e, w), turning(planar, A, one, f, d)
    _spin(planar, Y, at_one, T, one, (r[0] + s[0], r[1] + s[1], r[2] + s[2]), c_q)
    r = turning(planar, A, one, e, d)       # by the angular velocity
    if planar:
        Y[at_one] += c_v*r[2]
    else:
        for i in range(3):
            Y[at_one + i] += c_v*r[i]


@compiled
def vary(row, c, q, R, v, T, c_q, c_v, Y):
    """Add the derivatives of an input by all unknowns."""
    kind, one, two = row[KIND], row[FIRST], row[SECOND]
    at_one, at_two = row[FIRST_LOCAL], row[SECOND_LOCAL]
    x = v if row[OF_RATES] == 1 else q
    factor = c_v if row[OF_RATES] == 1 else c_q
    if kind == DOT:
        for i in range(3):
            if c[1 + i] != 0.0:
                Y[at_one + i] += factor*c[1 + i]
            if c[4 + i] != 0.0:
                Y[at_two + i] += factor*c[4 + i]
    elif kind == TURNED:
        _vary_turned(row, c, R, v, T, c_q, c_v, Y)
    elif kind == INTO:
        _vary_into(row, c, R, x, T, c_q, factor, Y)
    elif kind == IN_PLANE:
        _vary_in_plane(row, c, q, x, c_q, factor, Y)
    elif kind == ALONG or kind == FLAT_ALONG:
        planar = kind == FLAT_ALONG
        e, A = (c[1], c[2], c[3]), q if planar else R
        _shift(planar, A, one, e, at_two, row[THIRD_LOCAL], c_q, Y)
        r = turning(planar, A, one, e, between(planar, q, two, row[THIRD]))
        _spin(planar, Y, at_one, T, one, r, c_q)
    elif kind == ITS_RATE or kind == FLAT_RATE:
        _vary_way_rate(kind == FLAT_RATE, row, c, q, R, v, T, c_q, c_v, Y)
    elif kind == ANGLE:         # about the axis n x m, which both bodies have
        a, b, d = (c[5]*c[9] - c[6]*c[8], c[6]*c[7] - c[4]*c[9], c[4]*c[8] - c[5]*c[7])
        _turn(Y, at_one, T, one, a, b, d, c_q)
        if two >= 0:
            _turn(Y, at_two, T, two, -a, -b, -d, c_q)
