"""The way of a point along an axis that turns with a body, its rate and derivatives.

With the axis e fixed in body a, of the rotation R, and the points of a and b,

    y = (R e) . d,  y' = (R e) . d' + (R (W x e)) . d,  d = x_b - x_a

W is the material angular velocity of a. In a plane R is an angle.
"""

import numpy as np

from sebody.compiler.decorators import compiled


@compiled
def turned(planar, R, first, x, y, z):
    """A vector fixed in a body, in global axes: R is at `first`, in a plane the angle."""
    if planar:
        c, s = np.cos(R[first]), np.sin(R[first])
        return c*x - s*y, s*x + c*y, 0.0
    return (R[first]*x + R[first + 1]*y + R[first + 2]*z,
            R[first + 3]*x + R[first + 4]*y + R[first + 5]*z,
            R[first + 6]*x + R[first + 7]*y + R[first + 8]*z)


@compiled
def carried(planar, v, turn, x, y, z):
    """Rate ``W x e`` of a vector fixed in a body, in its axes; W is at `turn`."""
    if planar:
        return -v[turn]*y, v[turn]*x, 0.0
    a, b, c = v[turn], v[turn + 1], v[turn + 2]
    return b*z - c*y, c*x - a*z, a*y - b*x


@compiled
def between(planar, x, b, a):
    """From the numbers at `a` to those at `b`."""
    return x[b] - x[a], x[b + 1] - x[a + 1], 0.0 if planar else x[b + 2] - x[a + 2]


@compiled
def dot(a, b):
    """Scalar product of two triples."""
    return a[0]*b[0] + a[1]*b[1] + a[2]*b[2]


@compiled
def way(planar, R, first, e, q, b, a):
    """The way y."""
    return dot(turned(planar, R, first, e[0], e[1], e[2]), between(planar, q, b, a))


@compiled
def way_rate(planar, R, first, e, q, b, a, v, v_b, v_a, turn):
    """Its rate y'; `v_b`, `v_a` and `turn` are places of velocities."""
    f = carried(planar, v, turn, e[0], e[1], e[2])
    return (dot(turned(planar, R, first, e[0], e[1], e[2]), between(planar, v, v_b, v_a))
            + way(planar, R, first, f, q, b, a))


@compiled
def turning(planar, R, first, e, d):
    """Derivative of ``(R e) . d`` by a rotation of the body, in its axes: ``e x (R' d)``."""
    if planar:
        r = turned(planar, R, first, -e[1], e[0], 0.0)
        return 0.0, 0.0, dot(r, d)
    x = R[first]*d[0] + R[first + 3]*d[1] + R[first + 6]*d[2]
    y = R[first + 1]*d[0] + R[first + 4]*d[1] + R[first + 7]*d[2]
    z = R[first + 2]*d[0] + R[first + 5]*d[1] + R[first + 8]*d[2]
    return e[1]*z - e[2]*y, e[2]*x - e[0]*z, e[0]*y - e[1]*x
