"""Equations of steps and restarts whose constraints hold for velocities, too (index 2), linearized.

A step moves positions by y and by a shift s that velocities do not follow:

    q' = q + y + s,   r(q', v'(y), a'(y), lam') = 0,   phidot(q', v') = 0,   phi(q') = 0
    s = B mu,   B = the moving rows of J^-1 [0; 1]

so that its unknowns are two vectors. With rows r of forces, rows c of constraints, D the derivative
of phidot by motion, and B that follows parameters, but is held as the motion changes:

    (28)  [ cm M + cd C + K T;  Phi + D T/cd ] y + [ K T; D T/cd ] s = -b      rows r; c over cd
          [ 0; Phi T ] y + J s = -[ r_p(shifted) - r_p; b_phi ]              multipliers in s: mu

The residuals r(shifted) are those in the state moved by s with rates cd s and cm s, whose
derivatives are those of J s. (J of the run is an older matrix, which follows parameters likewise.)

After a restart auxiliary accelerations are those of a later time: with F the equations of a
restart, its look ahead by dt from x, v, with accelerations a, gives a correction c,

    (29)  F(x, v, a + c, lam + c_lam) = F(x + dt v + dt^2 a/2, v + dt a, a, lam; t + dt)
          aux = a - (am - af) h c/dt
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from sebody.basics.errors import InputError
from sebody.contract.layout import ACCELERATION, OK, RESIDUAL
from sebody.engine.evaluate import assemble
from sebody.engine.restart import SHORT, move_ahead
from sebody.engine.state import REASONS
from sebody.gradients.linear import Linear, Matrix, Parts
from sebody.gradients.rates import columns_of, rows_of
from sebody.gradients.turns import Turns, turns_of


class Doubled(NamedTuple):
    """The linearized equations of an event, of two unknown vectors."""

    matrix: Matrix      # (2 n, 2 n)
    by: Parts           # (2 n, n) derivatives by second rates, rates and motion


def step(parts: Parts, rates: Matrix, cm: float, cd: float, turns: Turns, fixed: NDArray
         ) -> Doubled:
    """(28) of a step; `rates` is D."""
    (M, C, K), moving = parts, ~fixed
    KT, DT, phi = turns.of_columns(K), turns.of_columns(rates) / cd, rows_of(K, fixed)
    J = cm * M + cd * C + KT
    return Doubled(
        _blocks([[rows_of(J, moving) + phi + DT, columns_of(rows_of(KT, moving) + DT, moving)],
                 [rows_of(KT, fixed), J]]),
        Parts(_blocks([[M], [0.0 * M]]), _blocks([[C + phi / cd], [0.0 * C]]),
              _blocks([[rows_of(K, moving) + rates / cd], [phi]])))


class Restart(NamedTuple):
    """The equations F of a restart, linearized in a state."""

    matrix: Matrix      # by accelerations and multipliers
    damping: Matrix     # by rates
    stiffness: Matrix   # by motion


def restart(now: Restart, corrected: Restart, ahead: Restart, turns: Turns, dt: float,
            fixed: NDArray) -> Doubled:
    """(29) linearized in the three states that it is of; `turns` are those of the look ahead."""
    K = columns_of(ahead.stiffness, ~fixed)
    moved, turned = turns._replace(T=turns.H).of_columns(K), turns.of_columns(K)
    follows = columns_of(dt * ahead.damping + 0.5 * dt * dt * turned, ~fixed)
    none = 0.0 * now.matrix
    return Doubled(
        _blocks([[now.matrix, none],
                 [corrected.matrix - ahead.matrix - follows, corrected.matrix]]),
        Parts(_blocks([[none], [none]]),
              _blocks([[now.damping], [corrected.damping - ahead.damping - dt * turned]]),
              _blocks([[now.stiffness], [corrected.stiffness - moved]])))


def _blocks(parts: list[list[Matrix]]) -> Matrix:
    if isinstance(parts[0][0], np.ndarray):
        return np.concatenate([np.concatenate(row, axis=1) for row in parts])  # quicker than block
    return sparse.csc_array(sparse.block_array(parts))


class Second(NamedTuple):
    """Numbers that the second residuals of the events of a history are made with."""

    by_rates: NDArray       # (events,) cd of the steps
    by_seconds: NDArray     # (events,) cm
    shifts: NDArray         # (events, n) s
    aheads: NDArray         # (events,) dt of restarts
    corrections: NDArray    # (restarts, n) c
    first: int              # of these, that is not of the first event


class Ahead(NamedTuple):
    """State that a restart sees a short time later."""

    dt: float
    turns: Turns
    row: NDArray            # the state there
    forces: NDArray         # (n,) F there, with the accelerations and multipliers of now


def look_ahead(linear: Linear, places: NDArray, h: float, end: float, beside: float) -> Ahead:
    """From the state that was evaluated last, before a step h.

    Raises
    ------
    InputError
        The state there cannot be evaluated.
    """
    system, state, n = linear.system, linear.state, linear.free
    dt = SHORT * h
    move_ahead(system, state, dt, end, beside)
    status = assemble(RESIDUAL, ACCELERATION, system, state, state.residual)
    if status != OK:
        raise InputError(f"the state after t = {end:.6g} has no derivatives: {REASONS[status]}")
    return Ahead(dt, turns_of(places, state.dq[places][None])[0], state.now.copy(),
                 state.residual[:n].copy())
