"""Angles of rigid links in lanes: their cosines and sines are kept for all members together."""

import math

from sebody.compiler.decorators import in_lanes_of
from sebody.compiler.inside.lanes import some
from sebody.engine import links


@in_lanes_of(links.remember)
def remember(turns, first, angle):
    """See `links.remember`; of all members where one of them has another angle."""
    if some(turns[first] != angle):
        turns[first], turns[first + 1], turns[first + 2] = angle, math.cos(angle), math.sin(angle)
