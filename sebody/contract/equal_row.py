"""Index rows and scratch memory of equal bodies that are evaluated eight at a time.

Behind the index row of a superelement are the address of its kernel, that of the same kernel for
lanes, 3 or in a plane 2, where the constants begin that all of these bodies have in common, and
where the row TURN of this body does, `NOT_TURNED` if all are oriented alike at the start.
"""

from sebody.contract.counts import MEMBERS
from sebody.contract.layout import COEFFICIENTS, HEADER, Part, Row

OWN, IN_LANES, DIMENSION, IN_COMMON, TURNED = 5, 4, 3, 2, 1      # places from the end
BEHIND = 5                                                      # their number
NOT_TURNED = -1
TURN = Row("how a body is oriented at the start, from the axes of the constants in common", (
    Part("rotation", (9,), "row by row; in a plane about z"),
    Part("angle", (), "of it in a plane"),
))
ANGLE = TURN.first("angle")
FACTORS = COEFFICIENTS.size({})
ALIGNED = 8     # numbers of a vector, which begins at a multiple of its size


def room(width: int, rotations: int, own: int) -> int:
    """Scratch memory for bodies of some unknowns and rotations, whose kernel takes `own` of it."""
    gathered = 4 * width + 18 * rotations + 18 + TURN.size({}) + FACTORS + width * width + own
    return MEMBERS * gathered + HEADER + rotations + width + 2 * ALIGNED
