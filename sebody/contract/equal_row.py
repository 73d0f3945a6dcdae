"""Index rows and scratch memory of equal bodies that are evaluated eight at a time.

Behind the index row of a superelement are the address of its kernel, that of the same kernel for
lanes, and the number of its rotation matrices, none in a plane.
"""

from sebody.contract.counts import MEMBERS
from sebody.contract.layout import COEFFICIENTS, HEADER

OWN, IN_LANES, MATRICES, BEHIND = 3, 2, 1, 3        # places from the end; their number
FACTORS = COEFFICIENTS.size({})
ALIGNED = 8     # numbers of a vector, which begins at a multiple of its size


def room(width: int, rotations: int, own: int) -> int:
    """Scratch memory for bodies of some unknowns and rotations, whose kernel takes `own` of it."""
    gathered = 4 * width + 18 * rotations + 9 + FACTORS + width * width + own
    return MEMBERS * gathered + HEADER + rotations + width + 2 * ALIGNED
