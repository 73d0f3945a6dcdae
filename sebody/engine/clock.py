"""Names of the scalars in `State.clock` and `State.control`."""

import numpy as np

# fields of State.clock
CLOCK = np.dtype([(name, np.float64) for name in (
    "time",                  # reached
    "step",                  # of the output grid
    "current_step",          # length of the step under way
    "last_norm",             # of the last correction, after mixing
    "contraction",           # rate of the last two corrections, carried over to the next step
    "factor_step",           # step length of the last matrix with new element matrices
    "floor",                 # norm that rounding of positions leaves
    "span",                  # the first correction's norm over its target
    "baseline_contraction",  # best rate of the first steps with new element matrices
    "excess",                # iterations since then that the baseline rate would have saved
    "acceleration_norm",     # largest norm of beta h^2 a so far, slowly forgotten
    "aux_step",              # step length that the auxiliary accelerations belong to
    "chosen",                # step length that the error allows (variable steps)
    "allowed",               # error of a step over its tolerance, above which it is repeated
    "origin",                # time of the last event, before which errors tell nothing
    "begun",                 # time at which the window of errors under way began
    "rate",                  # largest error over h^3 in it
    "rate_before",           # largest error over h^3 in the window before
    "natural",               # length of steps that bristles and teeth are stiff for
    "target",                # norm below which a correction counts as converged
    "end",                   # time at the end of the step under way
    "beside",                # time from there at which its loads are read: before a jump, or 0
)])
# fields of State.control
CONTROL = np.dtype([(name, np.int64) for name in (
    "grid",                  # output steps completed
    "unit",                  # parts of the next output step completed, of FINEST
    "level",                 # how often the output step is halved
    "iteration",             # corrections in this step
    "fresh",                 # factorizations in this step
    "wanted",                # what the next iteration needs: KEPT to RENEWED
    "reason",                # why the last step failed
    "iterations",            # corrections since the start
    "matrices",              # factorizations since the start
    "steps",                 # accepted
    "cuts",                  # steps repeated with a shorter one since the start
    "recorded",              # rows written to the record
    "age",                   # steps since all element matrices were evaluated
    "pivoted",               # 1 where the matrix needs row exchanges
    "refreshed",             # refreshed matrices, from the last one that was not condensed
    "condensed",             # 1 while a matrix is made of `State.condensed`
    "back_off",              # steps that begin with a refreshed matrix after reuse failed
    "back_off_left",         # of these, still to come
    "adaptive",              # 1 for variable steps
    "corner",                # next entry of System.corners
    "held",                  # steps since the step length changed; of a schedule 0 after a cut
    "piece",                 # row of the schedule that the time reached is in
    "rejected",              # steps repeated because of their error
    "secant",                # 1 where the last correction belongs to this step and its matrix
    "regularized",               # 1 where the matrix is regularized
    "meets",                 # what the step under way ends at: NOTHING, BEND or JUMP
    "split",                 # 1 where it ends at a jump within a part of an output step
    "inside",                # 1 where it began at such a jump
    "restart",               # ASKED and the like where accelerations are to be solved for, else 0
    "due",                   # 1 where the state is recorded after that
)])
