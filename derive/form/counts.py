"""The counts and indices of kernels, by their names in the texts.

Counts of the boundary and of the modes are known beforehand in specialised kernels and read in
general ones; the others follow from them and from the sizes of a body.
"""

from sebody.contract import layout
from sebody.derive.form.functions import PADDED
from sebody.derive.form.whole import Agreed, Applied, Count, Whole, whole

POSITIONS, ROTATIONS = Count("N_POSITIONS"), Count("N_ROTATIONS")   # nodes that keep theirs
FIRST_ROTATION, FIRST_MODE = Count("ROTATIONS"), Count("MODES")     # among the local coordinates
WIDTH = Count("WIDTH")              # unknowns of a joint or load: coordinates, then multipliers

n = Count("n")                      # unknowns of a superelement
filled = Count("filled")            # leading rows and columns of S, M and C that are not diagonal
row = Count("row")                  # length of a row of scratch memory

# of options C and D
free = Count("free")                # local coordinates that determine the others
bound = Count("bound")              # local coordinates of the boundary
bound_free = Count("bound_free")    # those of the boundary among `free`
slaved = Count("slaved")            # coordinates that follow
N = Count("N")                      # free and slaved ones
resultants = Count("resultants")    # stress resultants of second order
stretching = Count("stretching")    # these, and the stiffness itself
damped = Count("damped")            # matrices of damping, or their columns: none of a body without
hn, hN = Count("hn"), Count("hN")   # columns of so many numbers, with their padding
deep = Count("deep")                # columns of local tangents, which reach to the frame

series = Count("series")            # columns of a series of loads on a body

# indices of loops
element, column = Count("element"), Count("column")
i, j, k, b, e, r = map(Count, "ijkber")
i3, j3 = Count("i3"), Count("j3")   # first coordinates of a position, of a rotation
first = Count("first")              # of an element's index row

# arguments
task, count, stride, width = map(Count, ("task", "count", "stride", "width"))


def agreed(name: str) -> Agreed:
    """A number of `sebody.contract.layout` by its name there."""
    return Agreed(name, getattr(layout, name))


def padded(size: Whole | int) -> Whole:
    """Length of a column of so many numbers: whole vectors."""
    return Applied(PADDED, (whole(size),))
