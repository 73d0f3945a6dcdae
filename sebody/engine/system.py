"""A model as flat arrays: what the compiled loop runs on."""

from dataclasses import dataclass

from numpy.typing import NDArray

from sebody.engine.arrays import Arrays
from sebody.engine.links import Links


@dataclass(frozen=True, eq=False)
class System(Arrays):
    """A model as arrays: constant during a run."""

    # batches of equal elements: kernel, count, index stride, unknowns an element, and where the
    # batch starts in index, g and J
    address: NDArray
    count: NDArray
    stride: NDArray
    width: NDArray
    at_index: NDArray
    at_g: NDArray
    at_J: NDArray
    first_joint: NDArray    # (1,) first batch that is none of superelements
    first_power: NDArray    # (1,) first batch of what does work: loads, dampers, drives
    index: NDArray
    constants: NDArray
    g_unknown: NDArray      # unknown of every entry of the element forces
    J_entry: NDArray        # entry of the matrix of every entry of the element matrices
    rows: NDArray           # row and column of every entry of the matrix, dense by columns or in
    columns: NDArray        # the blocks of a sparse elimination
    diagonal: NDArray       # entry on the diagonal of each unknown
    padding: NDArray        # entries with ones: diagonal of free slots
    block_starts: NDArray   # pattern of the elimination, see sebody.engine.elimination
    block_rows: NDArray
    block_diagonal: NDArray
    slot_unknowns: NDArray  # unknown of every slot, of free ones the number of unknowns
    is_multiplier: NDArray  # 1.0 for multipliers, by coordinate, and zeros for padding
    rotation_at: NDArray    # first unknown of each rotation
    turned: NDArray         # (k, 2) first unknown and frame of free positions solved in body axes
    turned_blocks: NDArray  # (k, 5) positions whose rows and columns in an element matrix are in
                            # other axes: start, width, row, frame of the unknown, of the matrix
    summands: NDArray       # (elements, 5) start and width of the element matrix, first and end in
                            # turned_blocks, number among those with links or -1
    linked: NDArray         # (1,) 1 where bodies that turn against each other are coupled
    dimension: NDArray      # (1,) coordinates of a position
    magnitude: NDArray      # size of each coordinate, for the rounding floor
    # items: what has a history or does work
    table_at: NDArray       # (items + 1,) where each table starts
    table_times: NDArray
    table_cubics: NDArray   # (rows, 4), see sebody.model.histories
    corners: NDArray        # times at which a table has a corner, ascending
    functions: NDArray      # (items, 3) addresses of compiled histories, 0 for a table
    prescribed: NDArray     # (k, 3) coordinate, item, 1 for rotations
    prescribed_factor: NDArray
    links: Links
    relaxed: NDArray        # (1,) 1 where constraints are redundant
    damped: NDArray         # (1,) 1 where a superelement has structural damping
