"""A model as flat arrays: what the compiled loop runs on."""

from dataclasses import dataclass

from numpy.typing import NDArray

from sebody.engine.arrays import Arrays
from sebody.engine.control_data import Control
from sebody.engine.links import Links
from sebody.engine.mailbox import Shared


@dataclass(frozen=True, eq=False)
class System(Arrays):
    """A model as arrays: constant during a run.

    Of a model with N coordinates, the first n of them unknowns, with B batches of equal elements,
    r rotation matrices and p power ports. Axes are given as the number of the superelement whose
    frame they are, -1 for global axes.

    ==================  ============================================================================
    batches, superelements first, then elements without a power port, then those with one
    ------------------------------------------------------------------------------------------------
    address             (B,) of the kernel
    count               (B,) number of elements
    stride              (B,) length of an index row
    width               (B,) unknowns of an element
    at_index            (B + 1,) where the batch begins in `index`
    at_g, at_J          (B + 1,) where the batch begins in `State.g` and in `State.J`
    first_joint         (1,) first batch that is not of superelements
    first_power         (1,) first batch of elements with a power port
    index               index rows of all elements, see `layout.INDEX`
    constants           constants of all elements
    g_unknown           coordinate of every entry of `State.g`
    J_place             entries of element matrices that are summed, from the start of each matrix:
                        not those of fixed coordinates, nor zeros between internal modes;
                        elements with the same pattern share them
    J_entry             entry of the matrix for each of them, from the first of the element on
    ------------------  ----------------------------------------------------------------------------
    iteration matrix: by columns, or in the blocks of a sparse elimination
    ------------------------------------------------------------------------------------------------
    rows, columns       of every stored entry
    diagonal            (n,) entry on the diagonal of each unknown
    part_blocks         (parts + 1,) first column of blocks of every part of the elimination that
                        does not wait for others, then of the rest, see `engine.sharing`
    block_ends          of every column of blocks, the first block that is in a row of the rest
    condensed_ends      of every column of blocks, where it ends; of those in `internal`, begins
    part_summands       (parts + 1,) first row of `summands` of every part, then of the rest
    constraint_columns  entries in columns of multipliers, without their diagonal
    padding             entries with ones: the diagonal of free slots
    block_starts        pattern of the blocks, see `sebody.engine.elimination`; empty for a small
    block_rows          matrix, as the next ones
    block_diagonal
    slot_unknowns       (slots,) unknown of every slot; n for free slots
    ------------------  ----------------------------------------------------------------------------
    coordinates
    ------------------------------------------------------------------------------------------------
    is_multiplier       (N, padded) 1.0 for multipliers
    rotation_at         (r,) first coordinate of each rotation
    dimension           (1,) coordinates of a position
    part                (N,) first coordinate of the position or rotation, or first multiplier of
                        the equation, that each belongs to
    inertias            (N,) largest mass or moment of inertia of that position or rotation at the
                        start, which sets it
    massless_axes       (N,) the same where about some axis there is nearly none, zero elsewhere
    magnitude           (N,) size of each coordinate, for tolerances and rounding: of positions the
                        characteristic length, 1 of rotations, 0 of modes and multipliers
    rotated             (k, 2) positions, and forces that hold them, not solved for in global axes:
                        first unknown, axes
    rotated_blocks      (k, 5) positions in element matrices that are in other axes than they are
                        solved for in: start and width of the matrix, row, axes of the unknown, of
                        the matrix
    summands            (elements, 10) start and width of the element matrix, first and last + 1 row
                        of `rotated_blocks`, row of `Links.elements` or -1, first and last + 1 of
                        `J_place`, first entry of the matrix, first and last + 1 row of `internal`;
                        by parts of the elimination
    internal            (k, 5) internal unknowns of superelements that fill a column of blocks: the
                        column, places of the unknowns in the element, -1 for free slots
    linked              (1,) 1 where bodies that rotate against each other are coupled
    ------------------  ----------------------------------------------------------------------------
    power ports
    ------------------------------------------------------------------------------------------------
    table_at            (p + 1,) where the table of each port begins
    table_times         times of the tables, ascending in each
    table_pieces        (times, PIECE) see `sebody.engine.load_amplitudes`
    functions           (p, 3) addresses of a compiled time function and its rates, 0 for a table;
                        CLOCK where it is the time itself
    corners             times at which a time function has a corner, ascending
    jumps               1 for those of them at which accelerations jump
    series              (k, SERIES) series of loads, see `sebody.engine.load_amplitudes`
    series_times        times of their pieces, ascending in each
    series_values       coefficients of their pieces
    prescribed          (k, 3) coordinate, port, 1 for rotations
    prescribed_factor   (k,) motion of the coordinate by that of the port
    gravity_ports       (k,) ports of gravity that changes with time
    gravity_fields      (k, 3) fields that their amplitudes multiply
    ------------------  ----------------------------------------------------------------------------
    others
    ------------------------------------------------------------------------------------------------
    links               rigid links
    control             sensors, controllers and inputs
    shared              mail and scratch memory of threads; empty for one thread
    regularized         (1,) 1 where constraints are redundant or something without mass can move
    body_stiffness      diagonals of the stiffness of all superelements, which parameters change
                        linearly, as those of the mass
    body_mass           diagonals of their mass
    massless            (1,) 1 where a motion has stiffness and no mass: Python solves for
                        accelerations
    damped              (1,) 1 where a superelement has structural damping
    aid                 (2,) address and context of what gives the loop what it lacks, see
                        `engine.aid`; zeros where nobody does
    routines            (4,) addresses of `refactorize`, `restart`, `sample` and `share`: see
                        `engine.routines`
    guarded             places in `State.frames` of the rates of contacts, followed by the speeds of
                        their impacts, see `sebody.engine.guard`
    ==================  ============================================================================
    """

    address: NDArray
    count: NDArray
    stride: NDArray
    width: NDArray
    at_index: NDArray
    at_g: NDArray
    at_J: NDArray
    first_joint: NDArray
    first_power: NDArray
    index: NDArray
    constants: NDArray
    g_unknown: NDArray
    J_place: NDArray
    J_entry: NDArray
    rows: NDArray
    columns: NDArray
    diagonal: NDArray
    constraint_columns: NDArray
    padding: NDArray
    block_starts: NDArray
    block_rows: NDArray
    block_diagonal: NDArray
    slot_unknowns: NDArray
    part_blocks: NDArray
    block_ends: NDArray
    condensed_ends: NDArray
    part_summands: NDArray
    is_multiplier: NDArray
    rotation_at: NDArray
    rotated: NDArray
    rotated_blocks: NDArray
    summands: NDArray
    internal: NDArray
    linked: NDArray
    dimension: NDArray
    part: NDArray
    inertias: NDArray
    massless_axes: NDArray
    magnitude: NDArray
    table_at: NDArray
    table_times: NDArray
    table_pieces: NDArray
    corners: NDArray
    jumps: NDArray
    functions: NDArray
    series: NDArray
    series_times: NDArray
    series_values: NDArray
    prescribed: NDArray
    prescribed_factor: NDArray
    gravity_ports: NDArray
    gravity_fields: NDArray
    links: Links
    control: Control
    shared: Shared
    regularized: NDArray
    massless: NDArray
    body_stiffness: NDArray
    body_mass: NDArray
    damped: NDArray
    guarded: NDArray
    aid: NDArray
    routines: NDArray
