"""What the compiled loop works on: state, records, scheme, and the names of its numbers."""

from dataclasses import dataclass
from typing import NamedTuple

from numpy.typing import NDArray

from sebody.engine.arrays import Arrays

DONE, CHUNK, FACTOR, SOLVE, FAILED = range(5)           # what the loop returns
BEGIN, ITERATE, FACTORED, PROJECT, PROJECTED, READY, SOLVED = range(7)      # where it goes on
FORCES, TURNED, RENEWED, START, RATES = range(5)        # what is assembled, see assemble
# why a step failed
NO_REASON, HALF_TURN, NO_FRAME, NOT_FINITE, SLOW, INACCURATE = range(6)
FINEST = 4096           # a grid step is cut into at most this many parts


@dataclass(frozen=True, eq=False)
class State(Arrays):
    """Everything a restart needs, and scratch memory."""

    now: NDArray            # one block of what is recorded: the next seven are parts of it
    works: NDArray          # done by every item since the start
    q: NDArray              # positions, modes, angles, multipliers; rotations: step increments
    R: NDArray              # rotation matrices, nine numbers each
    v: NDArray
    a: NDArray              # true accelerations
    frames: NDArray         # of superelements, nine numbers each
    frames_old: NDArray     # of the last accepted step
    aux: NDArray            # auxiliary accelerations of the integrator
    q_start: NDArray        # at t = 0
    q_old: NDArray          # the last accepted step
    R_old: NDArray
    v_old: NDArray
    a_old: NDArray
    aux_old: NDArray
    dq: NDArray             # increment of the step
    T: NDArray              # tangent operators of the rotation increments
    loads: NDArray          # of every item its amplitude and two rates
    loads_old: NDArray      # at the last accepted step
    powers: NDArray         # of the items, there
    powers_old: NDArray     # a step before
    coefficients: NDArray   # (8,) of the matrix, then gravity: see sebody.kernels.abi
    g: NDArray              # element forces
    J: NDArray              # element matrices, of superelements in the axes of their frame
    turned: NDArray         # one of them, positions in the axes they are solved for in
    residual: NDArray       # in body axes
    forces: NDArray         # the same, of the last matrix and in global axes, for links
    correction: NDArray
    solution: NDArray       # the same by slots of the elimination
    last_correction: NDArray    # what the matrix gave in the last iteration,
    last_change: NDArray    # and what was made of it and subtracted
    moved: NDArray          # of every element, whether that moved it
    gaps: NDArray           # of the constraints, where `residual` has those of their rates
    shift: NDArray          # correction of positions that velocities do not follow
    expansion: NDArray      # scratch of links
    matrix: NDArray         # entries by columns or in blocks, there its factors; in body axes
    scale: NDArray          # of the unknowns: the scaled matrix has a unit diagonal
    weight: NDArray         # its inverse: corrections are measured in it, multipliers included
    inverse: NDArray        # of small systems, by padded columns, scales included
    column: NDArray         # scratch of the elimination
    work: NDArray
    energy: NDArray
    strictness: NDArray     # inverse of the error that is allowed of an unknown in a step
    clock: NDArray          # see the CLOCK indices
    control: NDArray        # see the CONTROL indices


# State.clock; CURRENT_STEP is the one under way, AUX_STEP the one the auxiliary accelerations
# belong to, CHOSEN the one the error asks for
(TIME, STEP, CURRENT_STEP, LAST_NORM, CONTRACTION, FACTOR_STEP, FLOOR, SPAN, YOUNG_RATE,
 EXCESS, BEND, AUX_STEP, CHOSEN, LARGEST_ERROR, TARGET) = range(15)
CLOCKS = 15
# State.control; SECANT where the last correction belongs to this step and its matrix
(PHASE, GRID, UNIT, LEVEL, ITERATION, FRESH, WANTED, REASON, ITERATIONS, MATRICES, STEPS, CUTS,
 RECORDED, AGE, PIVOTED, EAGER, EAGER_LEFT, ADAPTIVE, CORNER, HELD, REJECTED,
 SECANT) = range(22)
CONTROLS = 22


@dataclass(frozen=True, eq=False)
class Record(Arrays):
    """What is kept of the output steps."""

    rows: NDArray           # a copy of State.now each
    every: NDArray          # (1,) grid steps between records


def recorded_parts(coordinates: int, rotations: int, bodies: int, items: int
                   ) -> dict[str, slice]:
    """Where things are in State.now and so in the rows of a record."""
    sizes = {"t": 1, "iterations": 1, "works": items, "q": coordinates, "R": 9 * rotations,
             "v": coordinates, "a": coordinates, "frames": 9 * bodies, "frames_old": 9 * bodies}
    parts, first = {}, 0
    for name, size in sizes.items():
        parts[name] = slice(first, first + size)
        first += size
    return parts


class Scheme(NamedTuple):
    """Parameters of generalized-alpha; HHT is ``alpha_m = 0``."""

    alpha_m: float
    alpha_f: float
    beta: float
    gamma: float
    tolerance: float
    geometric: float        # 1 for consistent tangents, 0 for the paper's
    stabilized: bool        # constraints hold for velocities, too: index 2
