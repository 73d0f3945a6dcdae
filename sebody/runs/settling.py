"""Search for the rest of a loaded structure: by Newton's iteration, or by a motion to there.

A cable that is slack, a chain or any other mechanism has no stiffness until it has moved to where
its loads stretch it. It gets there in steps, each of which is the equilibrium of the loads and of
springs to where the step began,

    r(x) + rate W (x - x_0) = 0

with the masses and the largest moments of inertia W: the proximal-point iteration for the least
potential (R. T. Rockafellar, SIAM J. Control and Optimization 14, 1976, p. 877). The rate falls
until the springs are soft beside the loads; then the steps are repeated until nothing is left of
them, by a factor of about `LAST` in each. Where they shrink slowly, as of a rod between ball joints
that only its own sag keeps from rolling, the springs are still too stiff and their rate falls on.
They also end where springs pull with no more than the rounding of forces.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_matrix, diags

from sebody.basics.errors import InputError
from sebody.engine.evaluate import to_body_axes, update_rotations
from sebody.results import rotations
from sebody.runs.kkt_solver import Scaled
from sebody.runs.rotating_frame import Spin
from sebody.runs.simulation import Standstill
from sebody.runs.stability import Stiffness
from sebody.runs.state_derivatives import rotating

FULL = 25                   # iterations with full corrections, whatever their size
ITERATIONS = 50             # iterations with shortened ones
LEAST = 1.0 / 64.0          # part of a correction: those that do not shrink are halved, since what
                            # friction holds may slide to and fro between two of them
NUDGE = 1e-3                # of an unstable state along its softest motion, in extents or radians
PUSH = 1e-6                 # share of the forces that may act on a motion without stiffness
ROUNDED = 1e-13             # part of the forces of all elements that is rounding of their sums
PLACED = 4.0 * np.finfo(float).eps  # of positions and rotations: what rounding may leave
SEARCH = 2500               # iterations of a motion to rest: falling arches of forty rods take 1500
SEARCHES = 4000             # of all motions of a structure that lead to no rest; then
FEW = 200                   # of each further one: a smaller load step may rest soon
FIRST, LAST = 10.0, 1e-4    # rate, by the square of that at which loads begin to move the structure
STIFFEST = 1e-8     # the rate is at most the square of the pace over this: near an unstable state,
                    # which is left, loads are almost in balance
SLOW, SOFTEST = 0.1, 1e-9   # steps that shrink by less need softer springs, down to this rate
SLOWEST, FASTEST = 1.5, 5.0  # factor by which the rate falls after a step that was found
AGAIN = 4.0                 # factor by which it rises after one that was not
ROUGH = 0.2                # tolerance of a step, by its length: the next one corrects it
DRIFT = 1e3                 # of a step that gets no shorter, by the tolerance: what rounding moves
FAR = 0.5                   # longest step and correction, in extents or radians
FURTHEST = 100.0            # extents of the model that it may move until it is no structure


class Springs(NamedTuple):
    """Springs of all unknowns to where a step began."""

    stiffness: NDArray      # (unknowns,) zeros at multipliers
    q: NDArray
    R: NDArray


class Work:
    """Iterations that are left for searches of states of rest; those that find one are free."""

    def __init__(self) -> None:
        self.left = SEARCHES

    @property
    def vain(self) -> int:
        """Iterations that led to nothing."""
        return SEARCHES - self.left


class Found(NamedTuple):
    """An equilibrium by Newton's iteration."""

    tangent: csc_matrix     # before the last correction
    first: float            # size of the first correction


def balance(run: Standstill, tolerance: float, spin: Spin, springs: Springs | None = None,
            stiff: bool = False, work: Work | None = None) -> Found | None:
    """Newton's iteration with full corrections, then, from the same start, with shortened ones.

    Slender structures need full ones: a correction across stretches such a structure to second
    order, which the next one takes back, so that corrections grow before they shrink. What friction
    holds needs shortened ones.

    Parameters
    ----------
    springs : Springs, optional
        With these it may end where a correction is `ROUGH` times what they are stretched by.
    stiff : bool
        Nothing is found where motions have no stiffness.
    work : Work, optional
        Its iterations are counted.

    Returns
    -------
    Found or None
        None where no equilibrium is found.
    """
    start = run.state.now.copy()
    work = work or Work()
    found, ended = _balance(run, tolerance, spin, springs, stiff, work, FULL, 1.0)
    if not ended:
        run.state.now[:] = start
        found, _ = _balance(run, tolerance, spin, springs, stiff, work, ITERATIONS, LEAST)
    return found


def _balance(run: Standstill, tolerance: float, spin: Spin, springs: Springs | None, stiff: bool,
             work: Work, iterations: int, least: float) -> tuple[Found | None, bool]:
    """The equilibrium, if one is found, and whether this ended before all iterations.

    Corrections that do not shrink are halved, to no less than `least` of them.
    """
    state, n = run.state, run.numbering.free
    state.frames_old[:] = state.frames
    far = FAR if np.any(run.system.magnitude[:n] > 0.0) else 1.0    # else of what it leads to
    first, last, part = np.nan, np.inf, 1.0
    for _ in range(iterations):
        work.left -= 1
        try:
            tangent, residual = linear(run, spin, springs)
        except InputError:              # too far: a state that no element can evaluate
            return None, True
        if not (np.isfinite(tangent.data).all() and np.isfinite(residual).all()):
            return None, True           # likewise, of sheaves that would overlap
        solver = Scaled(tangent)
        if stiff and not solver.regular:
            return None, True
        correction = solution(run, solver, residual)
        change = size(run, correction)
        if not np.isfinite(change) or change > far:     # perhaps to an unstable place
            return None, True
        part = max(part / 2.0, least) if change > part * last else min(2.0 * part, 1.0)
        rounded = change < DRIFT * tolerance and change > last / 2.0    # gets no shorter
        first, last = change if last == np.inf else first, change
        move(run, -part * correction)
        if change < tolerance or rounded or springs and change < ROUGH * size(run, _displacement(
                run, springs.q, springs.R)):
            spin.move(run)
            return Found(tangent, first), True
    return None, False


def settle(run: Standstill, tolerance: float, spin: Spin, near: bool, work: Work) -> bool:
    """Let the structure move to where it rests; False where it does not come to rest.

    Each step must end where the potential of loads and springs is least: at a largest one, or at a
    saddle, the springs are too soft.

    Parameters
    ----------
    near : bool
        Whether it rests nearly where it is.
    work : Work
        What is left of it bounds the search; iterations that lead to nothing are taken off.
    """
    unit, start = pace(run, spin), run.state.now.copy()
    if not 0.0 < unit < np.inf:
        return False
    rate, faster, lowest = (LAST if near else FIRST) * unit, FASTEST, LAST * unit
    last, before = np.inf, work.left
    least = before - FEW if before <= 0 else max(before - SEARCH, 0)
    while work.left > least:
        kept, ending = run.state.now.copy(), rate <= lowest
        springs = _springs(run, rate)
        found = balance(run, tolerance, spin, springs, work=work)
        moved = size(run, moved_by(run, kept))
        if found is None or moved > FAR or not (
                spin.rotates or _is_least(run, spin, springs, unit, ending or moved < NUDGE)):
            run.state.now[:] = kept
            rate, faster = AGAIN * rate, max(np.sqrt(faster), SLOWEST)
            if rate > unit / STIFFEST or found is not None and max(moved, last) < tolerance:
                return False        # the latter on a saddle, which no spring moves it off
            continue
        if ending and (moved < tolerance or last / 2.0 < moved < DRIFT * tolerance
                       or _is_rounding(run, found.tangent, springs)):
            work.left = before
            return True
        if ending and moved > SLOW * last:
            lowest = max(lowest / FASTEST, SOFTEST * unit)
        last = moved
        if size(run, moved_by(run, start)) > FURTHEST:
            return False
        rate, faster = max(rate / faster, lowest), min(SLOWEST * faster, FASTEST)
    return False


def _is_rounding(run: Standstill, tangent: csc_matrix, springs: Springs) -> bool:
    """Tell if springs pull with no more than what the rounding of unknowns makes of forces.

    So they do on rods that spin freely, by as much as softer springs let these turn.
    """
    n = run.numbering.free
    places = np.where(run.system.magnitude[:n] > 0.0, run.system.magnitude[:n],
                      np.abs(run.state.q[:n]))
    pull = springs.stiffness * _displacement(run, springs.q, springs.R)
    return bool(np.all(np.abs(pull) <= PLACED * (abs(tangent) @ places)))


def _is_least(run: Standstill, spin: Spin, springs: Springs, unit: float, rests: bool) -> bool:
    """Tell if a potential is least; stiffer springs cost less than certainty until it rests."""
    try:
        stiffness = Stiffness(run, linear(run, spin, springs)[0], unit)
    except InputError:          # no element can evaluate the last correction
        return False
    return stiffness.stable() if rests else stiffness.surely_stable()


def nudge(run: Standstill, motion: NDArray, side: float) -> None:
    """Move a state a little along a motion, (unknowns,), to one of its sides."""
    move(run, side * NUDGE / max(size(run, motion), 1e-300) * motion)


def move(run: Standstill, change: NDArray) -> None:
    """Add a change of the unknowns, in their axes."""
    state, full = run.state, np.zeros(run.numbering.total)
    full[:len(change)] = change
    to_body_axes(run.system, state.frames, full, True)
    state.R_old[:], state.dq[:] = state.R, full
    state.q[:] += full[:state.q.size]
    update_rotations(run.system, state)


def size(run: Standstill, change: NDArray) -> float:
    """Size of a change of the unknowns, relative to magnitudes of positions and rotations.

    Modes and multipliers have no magnitude. Where nothing has one, as in a body that is held at all
    its nodes, the change is compared with what it leads to.
    """
    n = run.numbering.free
    magnitude = run.system.magnitude[:n]
    if np.any(magnitude > 0.0):
        return float(np.abs(change[magnitude > 0.0] / magnitude[magnitude > 0.0]).max())
    largest = np.abs(run.state.q[:n] - change).max()
    return 0.0 if largest == 0.0 else float(np.abs(change).max() / largest)


def linear(run: Standstill, spin: Spin, springs: Springs | None) -> tuple[csc_matrix, NDArray]:
    """Tangent and residual, with those of the springs; what is held does not move."""
    spin.move(run)
    tangent, residual = rotating(run, spin)
    if len(run.held_unknowns):
        moving = np.ones(len(residual))
        moving[run.held_unknowns] = 0.0
        tangent = csc_matrix(diags(moving) @ tangent @ diags(moving) + diags(1.0 - moving))
        residual *= moving
    if springs is None:
        return tangent, residual
    pull = springs.stiffness * _displacement(run, springs.q, springs.R)
    return csc_matrix(tangent + diags(springs.stiffness)), residual + pull


def solution(run: Standstill, solver: Scaled, residual: NDArray) -> NDArray:
    """Correction; motions without stiffness and load, such as the angle of a spin, are kept.

    No numbers where a load acts on such a motion.
    """
    if solver.regular:
        return solver.solve(residual)
    answer, left = solver.least(residual)
    n, sums = len(residual), np.zeros(run.numbering.total)
    np.add.at(sums, run.system.g_unknown, np.abs(run.state.g))
    forces = max(PUSH * np.abs(solver.scale * residual).max(),
                 ROUNDED * np.abs(solver.scale * sums[:n]).max())
    places = ROUNDED * run.system.magnitude[:n] / solver.scale      # by rounding of unknowns
    return np.full(n, np.nan) if np.any(left > np.maximum(forces, places)) else answer


def _springs(run: Standstill, rate: float) -> Springs:
    n = run.numbering.free
    moving = run.system.is_multiplier[:n] == 0.0
    return Springs(np.where(moving, rate * run.system.inertias[:n], 0.0), run.state.q.copy(),
                   run.state.R.copy())


def moved_by(run: Standstill, before: NDArray) -> NDArray:
    """Displacement of the unknowns since a state, (unknowns,)."""
    parts = run.state.recorded_parts
    return _displacement(run, before[parts["q"]], before[parts["R"]])


def _displacement(run: Standstill, q: NDArray, R: NDArray) -> NDArray:
    """From a configuration to the present one, (unknowns,): rotation vectors, else differences.

    In the axes of the unknowns.
    """
    state, n = run.state, run.numbering.free
    change = state.q - q
    if len(R):
        relative = np.swapaxes(R.reshape(-1, 3, 3), 1, 2) @ state.R.reshape(-1, 3, 3)
        at = run.system.rotation_at[:, None] + np.arange(3)
        change[at] = rotations.vectors(relative)
    change *= run.system.is_multiplier[:change.size] == 0.0
    to_body_axes(run.system, state.frames, change, False)
    return change[:n]


def pace(run: Standstill, spin: Spin) -> float:
    """Square of the rate at which the loads begin to move the structure [1/time^2]."""
    unit = _springs(run, 1.0).stiffness
    tangent, residual = linear(run, spin, None)
    alone = diags((unit > 0.0).astype(float))
    inert = tangent - alone @ tangent @ alone + diags(unit)
    return size(run, solution(run, Scaled(csc_matrix(inert)), residual))
