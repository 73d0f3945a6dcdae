"""Maps of SO(3) in lanes: series for all, then closed forms in the lanes beyond their range.

So the bits of a member do not depend on its neighbours. Where a search has no answer the lane gets
what is no number, and its forces are none: the loop sees that, and the other lanes go on.
"""

import math

from sebody.compiler.decorators import in_lanes_of
from sebody.compiler.inside.lanes import chosen_in, every, number_of, spread, where, with_number
from sebody.contract.counts import MEMBERS
from sebody.kernels import rotations
from sebody.kernels.rotations import NEAR_PI, SMALL, SMALL_SINE

NONE = math.nan


@in_lanes_of(rotations.stumpff)
def stumpff(k, s):
    """See `rotations.stumpff`."""
    total = spread(0.0)
    for member in range(MEMBERS):
        total = with_number(total, member, rotations.stumpff(k, number_of(s, member)))
    return total


@in_lanes_of(rotations.stumpff_23)
def stumpff_23(s):
    """See `rotations.stumpff_23`."""
    c2, c3 = rotations.stumpff_23_small(s)
    small = s < SMALL
    if not every(small):
        for member in range(MEMBERS):
            if not chosen_in(small, member):
                x, y = rotations.stumpff_23_large(number_of(s, member))
                c2, c3 = with_number(c2, member, x), with_number(c3, member, y)
    return c2, c3


@in_lanes_of(rotations.stumpff_1_to_7)
def stumpff_1_to_7(s):
    """See `rotations.stumpff_1_to_7`."""
    c6, c7 = rotations.stumpff_67_small(s)
    small = s < SMALL
    if not every(small):
        for member in range(MEMBERS):
            if not chosen_in(small, member):
                own = number_of(s, member)
                c6 = with_number(c6, member, rotations.stumpff(6, own))
                c7 = with_number(c7, member, rotations.stumpff(7, own))
    return rotations.stumpff_before_67(s, c6, c7)


@in_lanes_of(rotations.inverse_tangent_coefficients)
def inverse_tangent_coefficients(s):
    """See `rotations.inverse_tangent_coefficients`."""
    e, d = rotations.inverse_tangent_small(s)
    small = s < SMALL
    if not every(small):
        for member in range(MEMBERS):
            if not chosen_in(small, member):
                x, y = rotations.inverse_tangent_large(number_of(s, member))
                e, d = with_number(e, member, x), with_number(d, member, y)
    return e, d


@in_lanes_of(rotations.inverse_tangent_second)
def inverse_tangent_second(s):
    """See `rotations.inverse_tangent_second`."""
    e = rotations.inverse_tangent_second_small(s)
    small = s < SMALL
    if not every(small):
        for member in range(MEMBERS):
            if not chosen_in(small, member):
                e = with_number(e, member,
                                rotations.inverse_tangent_second_large(number_of(s, member)))
    return e


@in_lanes_of(rotations.log_map)
def log_map(xx, xy, xz, yx, yy, yz, zx, zy, zz):
    """See `rotations.log_map`."""
    x, y, z = 0.5 * (zy - yz), 0.5 * (xz - zx), 0.5 * (yx - xy)
    cosine = 0.5 * (xx + yy + zz - 1.0)
    s2 = x * x + y * y + z * z
    small = (cosine > 0.0) & (s2 < SMALL_SINE)
    ratio = rotations.angle_by_sine_small(s2)
    if not every(small):
        for member in range(MEMBERS):
            if not chosen_in(small, member):
                ratio = with_number(ratio, member, rotations.angle_by_sine_large(
                    number_of(s2, member), number_of(cosine, member)))
    return ratio * x, ratio * y, ratio * z, cosine


@in_lanes_of(rotations.relative_rotations)
def relative_rotations(count, nodes, R, frame, psi):
    """See `rotations.relative_rotations`; 0 always, no number where one is too near half a turn."""
    for j in range(count):
        x, y, z, cosine = rotations.relative_log(frame, 0, R, 9 * nodes[j])
        refused = where(cosine > NEAR_PI, spread(0.0), spread(NONE))
        psi[3 * j], psi[3 * j + 1], psi[3 * j + 2] = x + refused, y + refused, z + refused
    return 0
