"""What the compiled loop works on: state, records, scheme, and the names of its numbers."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.engine.arrays import Arrays
from sebody.kernels.layout import COEFFICIENTS, HALF_TURN, NO_FRAME, OK, RECORD

DONE, CHUNK, FACTOR, SOLVE, FAILED = range(5)           # what the loop returns
BEGIN, ITERATE, FACTORED, PROJECT, PROJECTED, READY, SOLVED = range(7)      # where it goes on
# which element matrices are made anew: none, those of joints and loads while the bodies' old ones
# are turned to their new places, or all
KEPT, TURNED, RENEWED = range(3)
CONVERGED, GO_ON, NEW_MATRIX, GIVE_UP = range(4)        # what a correction says of its step
# why a step failed: the answers of kernels come first, so that such an answer is a reason
NO_REASON = OK
NOT_FINITE, SLOW, INACCURATE = range(max(HALF_TURN, NO_FRAME) + 1, max(HALF_TURN, NO_FRAME) + 4)
REASONS = {
    HALF_TURN: "a node is turned by nearly half a turn against its body's frame",
    NO_FRAME: "the search for a body's frame did not end",
    NOT_FINITE: "the iteration matrix is singular or the iterate is not finite",
    SLOW: "Newton's iteration did not converge",
    INACCURATE: "the error of a step is above the tolerance",
}
FINEST = 4096           # a grid step is cut into at most this many parts


@dataclass(frozen=True, eq=False)
class State(Arrays):
    """Everything a restart needs, and scratch memory."""

    now: NDArray            # the row RECORD of the present state; these are parts of it:
    works: NDArray
    q: NDArray
    R: NDArray
    v: NDArray
    a: NDArray
    frames: NDArray
    frames_old: NDArray
    # the rest is not recorded
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
    coefficients: NDArray   # the row COEFFICIENTS
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
    energy: NDArray         # the row ENERGIES
    strictness: NDArray     # inverse of the error that is allowed of an unknown in a step
    clock: NDArray          # see the CLOCK indices
    control: NDArray        # see the CONTROL indices

    @classmethod
    def of(cls, counts: Mapping[str, int], **others: NDArray) -> "State":
        """A state whose recorded parts are views of one row of zeros.

        Parameters
        ----------
        counts : mapping
            Numbers of items, coordinates, rotations and bodies, as `RECORD` names them.
        **others : ndarray
            Members that are not recorded.
        """
        now = np.zeros(RECORD.size(counts))
        parts = {name: now[part] for name, part in RECORD.slices(counts).items()
                 if name in cls.__annotations__}
        return cls(now=now, **parts, **others)

    @property
    def recorded_parts(self) -> dict[str, slice]:
        """Where the parts of `RECORD` are in `now` and in the rows of a record."""
        return RECORD.slices({"items": self.works.size, "coordinates": self.q.size,
                              "rotations": self.R.size // 9, "bodies": self.frames.size // 9})

    def set_coefficients(self, **values: float) -> None:
        """Set some of the coefficients of the matrix, by their names in `COEFFICIENTS`."""
        places = COEFFICIENTS.slices({})
        for name, value in values.items():
            self.coefficients[places[name]] = value


# State.clock; CURRENT_STEP is the one under way, AUX_STEP the one the auxiliary accelerations
# belong to, CHOSEN the one the error asks for
(TIME, STEP, CURRENT_STEP, LAST_NORM, CONTRACTION, FACTOR_STEP, FLOOR, SPAN, YOUNG_RATE,
 EXCESS, BEND, AUX_STEP, CHOSEN, LARGEST_ERROR, TARGET) = range(15)
CLOCKS = TARGET + 1
# State.control; SECANT where the last correction belongs to this step and its matrix
(PHASE, GRID, UNIT, LEVEL, ITERATION, FRESH, WANTED, REASON, ITERATIONS, MATRICES, STEPS, CUTS,
 RECORDED, AGE, PIVOTED, EAGER, EAGER_LEFT, ADAPTIVE, CORNER, HELD, REJECTED,
 SECANT) = range(22)
CONTROLS = SECANT + 1


@dataclass(frozen=True, eq=False)
class Record(Arrays):
    """What is kept of the output steps."""

    rows: NDArray           # a copy of State.now each
    every: NDArray          # (1,) grid steps between records
    at: NDArray             # where each part of RECORD begins, see its PART names

    @classmethod
    def of(cls, state: State, steps: int, every: int = 1) -> "Record":
        """Room for so many output steps."""
        return cls(np.zeros((steps, state.now.size)), np.array([every]),
                   np.array([part.start for part in state.recorded_parts.values()]))


class Scheme(NamedTuple):
    """Parameters of generalized-alpha; HHT is ``alpha_m = 0``."""

    alpha_m: float
    alpha_f: float
    beta: float
    gamma: float
    tolerance: float
    geometric: float        # 1 for consistent tangents, 0 for the paper's
    stabilized: bool        # constraints hold for velocities, too: index 2
