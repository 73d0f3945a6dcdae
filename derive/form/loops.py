"""Carriers of values, and the loops that go through them: homes of quantities and stages."""

from typing import NamedTuple

from sebody.derive.form import counts
from sebody.derive.form.whole import Count, Number, Whole

ELEMENT = "element"


class Loop(NamedTuple):
    """A loop over what carries one value each."""

    index: Count
    first: Whole
    end: Whole


class DofBlocks(NamedTuple):
    """Coordinates of nodes, in DOF blocks or pairs or alone, one node after the other."""

    index: Count
    count: Count            # of the nodes
    place: Count            # where those of a node begin
    begin: Whole            # where those of the first one do


DOF_BLOCKS = {
    "position": DofBlocks(counts.i, counts.POSITIONS, counts.i3, Number(0)),
    "rotation": DofBlocks(counts.j, counts.ROTATIONS, counts.j3, counts.FIRST_ROTATION),
}
LOOPS = {
    "position": Loop(counts.i, Number(0), counts.POSITIONS),
    "rotation": Loop(counts.j, Number(0), counts.ROTATIONS),
    "mode": Loop(counts.k, counts.FIRST_MODE, counts.n),
    "coordinate": Loop(counts.i, Number(0), counts.n),
    "shape": Loop(counts.i, Number(0), counts.N),           # of option C: free and slaved ones
    "slaved": Loop(counts.b, Number(0), counts.slaved),
    "resultant": Loop(counts.e, Number(0), counts.resultants),
}


def size_of(home: str, planar: bool) -> int:
    """Coordinates of a position or rotation."""
    return 1 if planar and home == "rotation" else 2 if planar else 3
