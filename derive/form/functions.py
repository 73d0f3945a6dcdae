"""Functions of the runtime that kernels call, and what each does with its operands.

Calls are checked against this table where they are made. What a call reads and writes, what a
target imports or declares, and how a product is transposed follow from here.
"""

from enum import Enum, auto
from typing import NamedTuple


class Use(Enum):
    """Uses of an operand by a function."""

    READ = auto()           # an array
    WRITE = auto()          # an array; its numbers before do not matter
    ADD = auto()            # an array that is read and written
    SCRATCH = auto()        # an array whose numbers matter to nobody else
    WHOLE = auto()          # a whole number
    REAL = auto()           # a real number

    @property
    def of_array(self) -> bool:
        """Tell if the operand is an array."""
        return self not in (Use.WHOLE, Use.REAL)


class Gives(Enum):
    """Kinds of results of a function."""

    NOTHING = auto()
    STATUS = auto()         # a whole number: OK, or why the kernel ends here
    WHOLE = auto()
    REALS = auto()          # one or more


class Function(NamedTuple):
    """A function of a module in `sebody.kernels`."""

    module: str
    name: str
    gives: Gives
    operands: tuple[tuple[str, Use], ...]


def _function(module: str, name: str, gives: Gives = Gives.NOTHING, /, **operands: Use) -> Function:
    return Function(module, name, gives, tuple(operands.items()))


READ, WRITE, ADD, SCRATCH, WHOLE, REAL = Use
_SIZES = {"rows": WHOLE, "columns": WHOLE}
_BOUND = {"bound": WHOLE, "bound_free": WHOLE, "free": WHOLE}

PADDED = _function("abi", "padded", Gives.WHOLE, n=WHOLE)
OPAQUE = _function("abi", "opaque", Gives.WHOLE, number=WHOLE)
PACKED_ROOM = _function("packed_products", "packed_room", Gives.WHOLE, count=WHOLE, **_SIZES)

# products
TABLE_LAW = _function("tables", "table_law", Gives.REALS, table=READ, u=REAL, order=WHOLE)
COLUMNS_TIMES = _function("dense", "columns_times", A=READ, x=READ, out=WRITE, **_SIZES)
COLUMNS_TIMES_ALL = _function("dense", "columns_times_all", A=READ, x=READ, y=READ, z=READ,
                              of_x=WRITE, of_y=WRITE, of_z=WRITE, **_SIZES)
ARROW_TIMES = _function("dense", "arrow_times", A=READ, x=READ, out=WRITE, n=WHOLE, filled=WHOLE)
BLOCK_TIMES = _function("dense", "block_times", A=READ, x=READ, out=WRITE, **_SIZES, height=WHOLE)
ADD_BLOCK_TIMES = _function("dense", "add_block_times", A=READ, x=READ, out=ADD, **_SIZES,
                            height=WHOLE)
ADD_BLOCKS_TIMES = _function("dense", "add_blocks_times", A=READ, x=READ, B=READ, y=READ, out=ADD,
                             **_SIZES, of_B=WHOLE, height=WHOLE)
ROWS_TIMES = _function("dense", "rows_times", A=READ, x=READ, out=WRITE, **_SIZES, height=WHOLE)
ADD_ROWS_TIMES = _function("dense", "add_rows_times", A=READ, x=READ, out=ADD, **_SIZES,
                           height=WHOLE)
CLEAR = _function("dense", "clear", row=WRITE, count=WHOLE)
INVERSE_3 = _function("dense", "inverse_3", Gives.REALS, **dict.fromkeys("abcdefghi", REAL))
PACKED_TIMES = _function("packed_products", "packed_times", matrices=READ, x=READ, out=WRITE,
                         count=WHOLE)
ADD_PACKED_TIMES = _function("packed_products", "add_packed_times", matrices=READ, x=READ, out=ADD)
PACKED_TIMES_BOTH = _function("packed_products", "packed_times_both", matrices=READ, x=READ,
                              y=READ, of_x=WRITE, of_y=WRITE, count=WHOLE)
COUPLINGS_TIMES = _function("packed_products", "couplings_times", matrices=READ, x=READ, y=READ,
                            out=WRITE, count=WHOLE)
ADD_PACKED = _function("packed_products", "add_packed", matrices=READ, factors=READ, out=ADD,
                       height=WHOLE)
ADD_COUPLINGS = _function("packed_products", "add_couplings", matrices=READ, factors=READ,
                          scales=SCRATCH, of_x=ADD, of_y=ADD, products=WHOLE, size=WHOLE,
                          height=WHOLE)

# coordinates that determine the others, and those that follow them
TO_FREE = _function("packed_products", "to_free", y=READ, axes=READ, order=READ, moved=SCRATCH,
                    z=WRITE, **_BOUND, end=WHOLE)
FROM_FREE = _function("packed_products", "from_free", z=READ, back=READ, order=READ,
                      moved=SCRATCH, y=WRITE, **_BOUND)
ALL_TO_FREE = _function("coordinates", "all_to_free", y=READ, yd=READ, ydd=READ, axes=READ,
                        order=READ, moved=SCRATCH, z=WRITE, zd=WRITE, zdd=WRITE, **_BOUND,
                        end=WHOLE)
FOLLOW = _function("coordinates", "follow", Zq=READ, Zd=READ, z=ADD, zd=ADD, zdd=ADD, free=WHOLE,
                   slaved=WHOLE, height=WHOLE)
FOLLOW_CHANGES = _function("coordinates", "follow_changes", Zq=READ, Zd=READ, Za=READ, dz=READ,
                           dzd=ADD, dzdd=ADD, free=WHOLE, slaved=WHOLE, height=WHOLE)

# rotations, and searches for that of a frame: from the one of the last iterate, where it is read
INVERSE_TANGENT = _function("rotations", "inverse_tangent_coefficients", Gives.REALS, s=REAL)
INVERSE_TANGENT_SECOND = _function("rotations", "inverse_tangent_second", Gives.REALS, s=REAL)
STUMPFF_2345 = _function("rotations", "stumpff_2345", Gives.REALS, s=REAL)
STUMPFF_1_TO_7 = _function("rotations", "stumpff_1_to_7", Gives.REALS, s=REAL)
RELATIVE_ROTATIONS = _function("rotations", "relative_rotations", Gives.STATUS, count=WHOLE,
                               nodes=READ, R=READ, frame=READ, psi=WRITE)
RELATIVE_ANGLES = _function("frame_search", "planar_relative_angles", Gives.STATUS, count=WHOLE,
                            angles=READ, frame=READ, psi=WRITE)
CONVERGED_MEAN = _function("frame_search", "converged_mean", Gives.STATUS, count=WHOLE, nodes=READ,
                           alpha=READ, R=READ, frame=ADD, psi=WRITE)
WEIGHTED_MEAN = _function("frame_search", "weighted_mean", Gives.STATUS, count=WHOLE, nodes=READ,
                          alpha=READ, R=READ, reference=READ, frame=WRITE, beta=WRITE, psi=WRITE)
PLANAR_MEAN = _function("frame_search", "planar_mean", Gives.STATUS, count=WHOLE, alpha=READ,
                        angles=READ, frame=WRITE, psi=WRITE)
BEST_FIT = _function("frame_search", "best_fit", Gives.STATUS, count=WHOLE, fit=READ, X=READ,
                     alpha=READ, x=READ, frame=ADD)
MEAN_AXES = _function("frame_search", "mean_axes", Gives.STATUS, positions=WHOLE, rotations=WHOLE,
                      n=WHOLE, nodes=READ, alpha=READ, X=READ, Gam=READ, q=READ, R=READ, frame=ADD,
                      psi=WRITE)
PLANAR_MEAN_AXES = _function("frame_search", "planar_mean_axes", Gives.STATUS, positions=WHOLE,
                             rotations=WHOLE, n=WHOLE, alpha=READ, X=READ, Gam=READ, q=READ,
                             frame=ADD, psi=WRITE)
PLANAR_FIT = _function("frame_search", "planar_fit", Gives.STATUS, count=WHOLE, fit=READ, X=READ,
                       alpha=READ, x=READ, frame=WRITE)

# places on paths: of a point and of what moves it
PATH_PLACE = _function("paths", "path_place", Gives.STATUS, path=READ, s=REAL, y=READ,
                       n=WHOLE, dimension=WHOLE, head=WRITE, shapes=WRITE, slopes=WRITE,
                       bends=WRITE)
PATH_DIRECTION = _function("paths", "path_direction", Gives.STATUS, path=READ, s=REAL, y=READ,
                           n=WHOLE, head=WRITE, shapes=WRITE, slopes=WRITE, bends=WRITE,
                           section=WRITE)
PATH_LOADS = _function("paths", "path_loads", path=READ, s=REAL, y=READ, n=WHOLE, dimension=WHOLE,
                       head=WRITE, shapes=WRITE, slopes=SCRATCH, bends=WRITE, head_1=SCRATCH,
                       shapes_1=SCRATCH, bends_1=SCRATCH)
PATH_CHANGE = _function("paths", "path_change", path=READ, bends=READ, dy=READ, n=WHOLE,
                        dimension=WHOLE, changes=WRITE)
