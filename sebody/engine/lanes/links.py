"""Angles of rigid links in lanes: cosines and sines of members whose angle changes."""

import math

from sebody.compiler.decorators import in_lanes_of
from sebody.compiler.inside.lanes import some, where
from sebody.engine import links


@in_lanes_of(links.remember)
def remember(turns, first, angle):
    """See `links.remember`."""
    changed = turns[first] != angle
    if some(changed):
        turns[first] = angle
        turns[first + 1] = where(changed, math.cos(angle), turns[first + 1])
        turns[first + 2] = where(changed, math.sin(angle), turns[first + 2])
