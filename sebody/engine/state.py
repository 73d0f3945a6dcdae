"""Data of the compiled loop: state, records and scheme."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.contract.layout import COEFFICIENTS, HALF_TURN, NO_FRAME, OFF_PATH, OK, RECORD
from sebody.engine.arrays import Arrays

DONE, CHUNK, FAILED = range(3)      # what the loop returns
# what it asks its aid for: factors with row exchanges, a solution by them, readings of sensors
FACTORS, SOLUTION, READINGS = range(3)
# what an iteration needs: the factors as they are; factors of a matrix in which the bodies' old
# element matrices are rotated with them and all others are new; of new element matrices only; or
# ROTATED ones that were new in the state before the step, see `step.renew_bodies`
KEPT, ROTATED, EVALUATED, RENEWED = range(4)
# tasks of threads, see `engine.sharing`: forces and matrices of KEPT to EVALUATED, or of RENEWED
# those of bodies alone; forces of elements that moved
SHARE_MOVED, SHARE_SUM, SHARE_FACTORS, SHARE_SOLUTION, SHARE_BACK, HELP = range(
    RENEWED + 1, RENEWED + 7)
CONVERGED, GO_ON, NEW_MATRIX, GIVE_UP, LEAVES_GAP = range(5)    # verdicts after a correction
# why a step failed: answers of kernels keep their numbers, further reasons follow
NO_REASON = OK
NOT_FINITE, SLOW, INACCURATE, GAP = range(OFF_PATH + 1, OFF_PATH + 5)
NO_START, BAD_CONTROL, CONTACT, GROWS, NO_AID = range(GAP + 1, GAP + 6)
ANEW = NO_AID + 1       # no failure: the step is to be made once more, with new matrices
REASONS = {
    HALF_TURN: "a node is rotated by nearly half a revolution relative to its body frame",
    NO_FRAME: "the iteration for a body frame did not converge",
    OFF_PATH: "a point is beyond the end of its path",
    NOT_FINITE: "the iteration matrix is singular or the solution diverged",
    SLOW: "Newton's iteration did not converge",
    INACCURATE: "the error of a step is above the tolerance",
    GAP: "the constraints cannot be satisfied",
    BAD_CONTROL: "a controller gave what is not finite, or raised",
    CONTACT: "a contact or stop changes its rate by more than a tenth of the impact speed",
    GROWS: "energy grows",
    NO_AID: "what a step lacks, such as room for factors, was not given",
    NO_START: "no accelerations were found that satisfy dynamics and constraints",
}
# what a step ends at; at a sample and at a jump of accelerations is a restart
NOTHING, BEND, SAMPLED, JUMP = range(4)
# of a restart: to be done; looking ahead, see `engine.restart`; to be done with the factors of
# masses and constraints that are there, as long as corrections converge
ASKED, AHEAD, FACTORS_KEPT = 1, 2, 3
FINEST = 4096           # largest number of equal parts that a grid step is cut into


@dataclass(frozen=True, eq=False)
class State(Arrays):
    """The numbers that the loop reads and writes: all that a restart needs, and scratch memory.

    Of a model with N coordinates, the first n of them unknowns, with r rotation matrices, b
    superelements and p power ports. Rates are derivatives with respect to time; of rotations,
    angular velocities and accelerations in material axes. The suffix ``_old`` is for values at the
    last accepted step.

    ====================  ==========================================================================
    recorded, see `layout.RECORD`
    ------------------------------------------------------------------------------------------------
    now                   the whole row of the present state; the members down to `frames_old` are
                          views of its parts
    kept                  a copy of it, while something is evaluated in another state
    works                 (p,) work of every power port since the start
    q                     (N,) positions, modes, multipliers; of rotations increments of the step
    R                     (9 r,) rotation matrices, row by row
    v, a                  (N,) velocities and accelerations; zeros at multipliers
    frames                (9 b + m,) frames of the superelements, row by row, in the current
                          iterate, then what elements keep from step to step, m numbers
    frames_old            (9 b + m,) the same at the last accepted step
    --------------------  --------------------------------------------------------------------------
    integrator
    ------------------------------------------------------------------------------------------------
    aux                   (N,) auxiliary accelerations of generalized-alpha
    changes               (9 N,) how aux and multipliers changed in the last steps
    fitted                (N,) how they will by a fit, and `fit`, its numbers: see `prediction`
    q_start               (N,) coordinates at t = 0
    q_old, v_old, a_old   (N,) coordinates, velocities, accelerations
    aux_old               (N,) auxiliary accelerations
    R_old                 (9 r,) rotation matrices
    dq                    (N,) increments of the coordinates in the step
    T                     (9 r,) tangent operators of the rotation increments
    turns                 (3 N,) of coordinates in the plane that rotate arms of rigid links: an
                          angle, its cosine and sine, see `links.remember`
    error_weights         (N,) one over the error that is allowed of an unknown in a step
    schedule              (k, 2) end and length of planned steps; none where errors choose them
    step_log              (m, 3) end, length and error over h^3 of the last m steps, lengths without
                          halvings where energy would grow; m is 0 in most runs
    --------------------  --------------------------------------------------------------------------
    power ports
    ------------------------------------------------------------------------------------------------
    loads                 (3 p,) amplitude of every port and its first two rates
    loads_old             (3 p,) the same
    acting                forces of the ports, as residuals: of elements in the order of `g`, then
                          on prescribed coordinates; then what amplitudes of gravity multiply
    acting_old            the same
    works_old             (p,) work of every port
    powers, powers_old    (p,) power of every port at both ends of the last step, for output within
    --------------------  --------------------------------------------------------------------------
    elements
    ------------------------------------------------------------------------------------------------
    coefficients          the row `layout.COEFFICIENTS`
    g                     forces of the elements, one after the other
    J                     matrices of the elements; of superelements in the axes of their frame
    condensed             those of superelements with their internal unknowns eliminated, see
                          `sebody.engine.condensation`; empty where there are none
    rotated_matrix        one element matrix, positions in the axes they are solved for in
    energy                the row `layout.ENERGIES`
    work                  scratch memory of kernels
    moved                 (elements,) one where the last correction moved the element, else zero
    expansion             scratch memory for element matrices with rigid links
    --------------------  --------------------------------------------------------------------------
    Newton's iteration
    ------------------------------------------------------------------------------------------------
    residual              (N,) sum of the element forces, free positions in body axes
    constraint_residuals  (N,) residuals of the constraints, while `residual` holds those of the
                          constraints' rates (index 2)
    forces                (N,) the residual at the last factorization, in global axes: for links
    correction            (N, padded) solution of the linear system
    solution              (slots,) the same in the order of the elimination
    last_correction       (N,) solution of the last iteration, before mixing
    last_change           (N,) correction of the last iteration, after mixing
    shift                 (N,) correction of positions alone, which velocities do not follow
    --------------------  --------------------------------------------------------------------------
    iteration matrix
    ------------------------------------------------------------------------------------------------
    matrix                entries by columns, or by blocks that are replaced by their factors; one
                          entry more collects what belongs to fixed coordinates
    scale                 (N, padded) of the unknowns: the scaled matrix has a unit diagonal
    weight                (N,) one over `scale`: norms of corrections are weighted by these
    inverse               (n, padded n) inverse of a small matrix, scales included, by columns
    spare                 factors of accelerations beside those of the steps, where inputs are
                          set at samples: see `kept_factors`
    regularization            (N,) R + L of a regularized matrix, see `sebody.engine.regularization`
    constraint_columns    entries `System.constraint_columns` of the matrix, before elimination
    projected, pulled     (N,) scratch memory of projections
    column                scratch memory of the elimination for a column of blocks
    --------------------  --------------------------------------------------------------------------
    control
    ------------------------------------------------------------------------------------------------
    memory                samples so far, delayed values: see `engine.control`
    --------------------  --------------------------------------------------------------------------
    counters
    ------------------------------------------------------------------------------------------------
    guard                 energies and counters, see the fields `growth.GUARD`
    clock                 times, lengths of steps and norms, see the fields `clock.CLOCK`
    control               counters and flags, see the fields `clock.CONTROL`
    ====================  ==========================================================================
    """

    now: NDArray
    kept: NDArray
    works: NDArray
    q: NDArray
    R: NDArray
    v: NDArray
    a: NDArray
    frames: NDArray
    frames_old: NDArray
    aux: NDArray
    changes: NDArray
    fitted: NDArray
    fit: NDArray
    q_start: NDArray
    q_old: NDArray
    R_old: NDArray
    v_old: NDArray
    a_old: NDArray
    aux_old: NDArray
    dq: NDArray
    T: NDArray
    turns: NDArray
    loads: NDArray
    loads_old: NDArray
    acting: NDArray
    acting_old: NDArray
    works_old: NDArray
    powers: NDArray
    powers_old: NDArray
    coefficients: NDArray
    g: NDArray
    J: NDArray
    condensed: NDArray
    rotated_matrix: NDArray
    residual: NDArray
    forces: NDArray
    correction: NDArray
    solution: NDArray
    last_correction: NDArray
    last_change: NDArray
    moved: NDArray
    constraint_residuals: NDArray
    shift: NDArray
    expansion: NDArray
    matrix: NDArray
    scale: NDArray
    weight: NDArray
    inverse: NDArray
    spare: NDArray
    regularization: NDArray
    constraint_columns: NDArray
    projected: NDArray
    pulled: NDArray
    column: NDArray
    work: NDArray
    energy: NDArray
    error_weights: NDArray
    schedule: NDArray
    step_log: NDArray
    memory: NDArray
    guard: np.record
    clock: np.record
    control: np.record

    @classmethod
    def of(cls, counts: Mapping[str, int], **others: NDArray) -> "State":
        """A state whose recorded parts are views of one row of zeros.

        Parameters
        ----------
        counts : mapping
            Numbers of power ports, coordinates, rotations and bodies, as `RECORD` names them.
        **others : ndarray
            Members that are not recorded.
        """
        now = np.zeros(RECORD.size(counts))
        parts = {name: now[part] for name, part in RECORD.slices(counts).items()
                 if name in cls.__annotations__}
        return cls(now=now, kept=now.copy(), **parts, **others)

    @property
    def recorded_parts(self) -> dict[str, slice]:
        """The places of the parts of `RECORD` in `now` and in the rows of a record."""
        return RECORD.slices({"ports": self.works.size, "coordinates": self.q.size,
                              "rotations": self.R.size // 9, "stored": self.frames.size})

    def set_coefficients(self, **values: float) -> None:
        """Set some of the coefficients of the matrix, by their names in `COEFFICIENTS`."""
        places = COEFFICIENTS.slices({})
        for name, value in values.items():
            self.coefficients[places[name]] = value


@dataclass(frozen=True, eq=False)
class Record(Arrays):
    """Recorded states of a run."""

    rows: NDArray           # (records, size of RECORD) copies of State.now
    every: NDArray          # (1,) grid steps between records
    at: NDArray             # (parts of RECORD,) first column of each; Q_PART and others count them

    @classmethod
    def of(cls, state: State, steps: int, every: int = 1) -> "Record":
        """An empty record with room for some number of states."""
        return cls(np.zeros((steps, state.now.size)), np.array([every]),
                   np.array([part.start for part in state.recorded_parts.values()]))


class Scheme(NamedTuple):
    """Parameters of generalized-alpha; HHT is ``alpha_m = 0``."""

    alpha_m: float
    alpha_f: float
    beta: float
    gamma: float
    tolerance: float
    geometric: float        # 1 for consistent tangents, 0 for those of the paper
    stabilized: bool        # index 2: constraints hold for velocities, too
