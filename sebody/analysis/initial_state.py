"""A consistent start: velocities that fit the joints, accelerations and multipliers at t = 0."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import qr
from scipy.sparse import csc_matrix

from sebody.analysis.sparse import Scaled
from sebody.assembly.numbering import Numbering
from sebody.engine.evaluate import (
    assemble,
    move_prescribed,
    set_loads,
    set_powers,
    to_body_axes,
    turn_rotations,
)
from sebody.engine.links import place_hanging
from sebody.engine.matrix import sum_matrices
from sebody.engine.state import (
    HALF_TURN,
    INACCURATE,
    NO_FRAME,
    NOT_FINITE,
    RATES,
    RENEWED,
    SLOW,
    START,
    State,
)
from sebody.engine.system import System
from sebody.errors import InputError
from sebody.model.model import Model
from sebody.model.parts import Triplet

REASONS = {
    HALF_TURN: "a node is turned by nearly half a turn against its body's frame",
    NO_FRAME: "the search for a body's frame did not end",
    NOT_FINITE: "the iteration matrix is singular or the iterate is not finite",
    SLOW: "Newton's iteration did not converge",
    INACCURATE: "the error of a step is above the tolerance",
}
SMALL = 1e-8            # residuals of constraints, relative to lengths and velocities
HEAVY = 1e10            # mass that keeps velocities the user gave
LARGEST = 3000          # unknowns up to which redundant constraints are sorted out


class Start(NamedTuple):
    """What a simulation did before its first step."""

    changed: dict[str, float]       # triplets whose velocity was solved for, and by how much
    redundant: tuple[str, ...]      # joints with constraints that others contain


def start(model: Model, system: System, numbering: Numbering, state: State) -> Start:
    """Fit the velocities to the constraints, then solve for accelerations and multipliers.

    Raises
    ------
    InputError
        Positions off their joints, given velocities that do not fit, constraints that contradict
        each other, an unknown without mass.
    """
    set_loads(system, state.loads, 0.0)
    state.loads_old[:] = state.loads
    move_prescribed(system, state)
    place_hanging(system.links, state.q, state.v, state.a, state.R)
    multipliers = np.flatnonzero(system.is_multiplier)
    state.coefficients[:5] = (1.0, 0.0, 0.0, 1.0, 1.0)
    matrix = _matrix(system, state)
    gaps = state.residual[multipliers]
    _check(gaps, np.abs(state.q).max(), "position", multipliers, numbering,
           "start from a state the joints allow")
    solver = _Solver(matrix, numbering, multipliers)
    changed = _fit_velocities(model, system, numbering, state, matrix, multipliers)
    _accelerate(system, numbering, state, solver)
    state.aux[:numbering.free] = state.a[:numbering.free]
    state.frames_old[:] = state.frames
    system.relaxed[0] = int(bool(solver.redundant))
    set_powers(system, state)
    return Start(changed, solver.redundant)


def _accelerate(system: System, numbering: Numbering, state: State, solver: "_Solver") -> None:
    """Accelerations and multipliers of a state."""
    moving = system.is_multiplier[:numbering.total] == 0
    solved = np.arange(numbering.total) < numbering.free
    state.a[solved & moving], state.q[~moving] = 0.0, 0.0
    place_hanging(system.links, state.q, state.v, state.a, state.R)
    _evaluate(system, state, START)
    to_body_axes(system, state.frames, state.residual, False)
    answer = np.zeros(numbering.total)
    answer[:numbering.free] = -solver(state.residual[:numbering.free].copy())
    to_body_axes(system, state.frames, answer, True)
    state.a[solved & moving], state.q[~moving] = answer[solved & moving], answer[~moving]
    place_hanging(system.links, state.q, state.v, state.a, state.R)


def acceleration_rates(system: System, numbering: Numbering, state: State, dt: float) -> NDArray:
    """Rates of the accelerations at the start, by a difference over a short time."""
    kept, loads = state.now.copy(), state.loads.copy()
    state.R_old[:] = state.R
    state.dq[:] = dt * state.v + 0.5 * dt * dt * state.a
    state.q[:] += state.dq
    state.v[:] += dt * state.a
    set_loads(system, state.loads, dt)
    move_prescribed(system, state)
    turn_rotations(system, state)
    state.coefficients[:5] = (1.0, 0.0, 0.0, 1.0, 1.0)
    multipliers = np.flatnonzero(system.is_multiplier)
    _accelerate(system, numbering, state, _Solver(_matrix(system, state), numbering, multipliers))
    later = state.a.copy()
    state.now[:], state.loads[:] = kept, loads
    rates = (later - state.a) / dt
    rates[numbering.free:] = 0.0
    return rates


def assembled(system: System, state: State) -> csc_matrix:
    """The assembled matrix, without padding."""
    n, entries = system.diagonal.size, state.matrix[:-1]
    kept = np.flatnonzero((entries != 0.0) & (system.rows < n))
    return csc_matrix((entries[kept], (system.rows[kept], system.columns[kept])), shape=(n, n))


def _matrix(system: System, state: State) -> csc_matrix:
    """The matrix of the present coefficients; leaves the forces in `residual`."""
    _evaluate(system, state, RENEWED)
    sum_matrices(system, state, state.residual)
    return assembled(system, state)


def _evaluate(system: System, state: State, level: int) -> None:
    status = assemble(level, system, state, state.residual)
    if status:
        raise InputError(f"the initial state cannot be evaluated: {REASONS[status]}")


def _check(values: NDArray, size: float, what: str, multipliers: NDArray, numbering: Numbering,
           remedy: str) -> None:
    if values.size:
        worst = int(np.argmax(np.abs(values)))
        if not abs(values[worst]) <= SMALL * max(size, 1e-300):
            raise InputError(f"the initial {what} violates "
                             f"{numbering.names[multipliers[worst]]} by {abs(values[worst]):.3g}: "
                             f"{remedy}")


def _fit_velocities(model: Model, system: System, numbering: Numbering, state: State,
                    matrix: csc_matrix, multipliers: NDArray) -> dict[str, float]:
    """Change velocities as little as the kinetic energy allows; those given stay."""
    if not multipliers.size:
        return {}
    size = max(np.abs(state.v).max(), 1e-300)
    rates = _rates(system, state, multipliers)
    if np.abs(rates).max() <= SMALL * size:
        return {}
    triplets = [t for t in model.triplets() if t.solved and id(t) in numbering.triplets]
    weighted = matrix.tolil(copy=True)
    scale = abs(matrix.diagonal()).max()
    for triplet in triplets:
        for i in _places(numbering, triplet) if triplet.given else ():
            weighted[i, i] += HEAVY * scale
    demand = np.zeros(numbering.free)
    demand[multipliers] = -rates
    answer = np.zeros(numbering.total)
    answer[:numbering.free] = _least(csc_matrix(weighted), demand, numbering)
    answer[multipliers] = 0.0
    to_body_axes(system, state.frames, answer, True)
    state.v[:] += answer
    place_hanging(system.links, state.q, state.v, state.a, state.R)
    given = [t for t in triplets if t.given]
    for triplet in given:
        change = np.abs(answer[_places(numbering, triplet)]).max()
        if change > 1e-6 * size:
            raise InputError(f"the given initial velocity of {triplet.name} does not fit the "
                             "joints and the other given ones, it would have to change by "
                             f"{change:.3g}: leave some of them out, they are solved for")
    _check(_rates(system, state, multipliers), size, "velocity", multipliers, numbering,
           "no velocities fit this joint and the given ones; give others")
    changes = {t.name: float(np.abs(answer[_places(numbering, t)]).max()) for t in triplets}
    return {name: change for name, change in changes.items() if change > SMALL * size}


def _rates(system: System, state: State, multipliers: NDArray) -> NDArray:
    _evaluate(system, state, RATES)
    return state.residual[multipliers]


def _places(numbering: Numbering, triplet: Triplet) -> NDArray:
    first = numbering.triplets[id(triplet)]
    return np.arange(first, first + triplet.start.size)


def _least(matrix: csc_matrix, demand: NDArray, numbering: Numbering) -> NDArray:
    """Solution of least norm, where the matrix is singular."""
    system = Scaled(matrix)
    if system.regular:
        return system.solve(demand)
    if numbering.free > LARGEST:
        raise InputError("the constraints are redundant and too many to be sorted out: remove "
                         "redundant joints")
    return system.least(demand)[0]


class _Solver:
    """Solves for accelerations and multipliers; finds redundant constraints and missing mass."""

    def __init__(self, matrix: csc_matrix, numbering: Numbering, multipliers: NDArray):
        self.system, self.names = Scaled(matrix), numbering.names
        self.redundant: tuple[str, ...] = ()
        if not self.system.regular:
            self._sort_out(multipliers)

    def __call__(self, residual: NDArray) -> NDArray:
        """Accelerations and multipliers, of least norm where these are not unique."""
        if self.system.regular:
            return self.system.solve(residual)
        answer, left = self.system.least(residual)
        if left.max() > 1e-7 * max(np.abs(self.system.scale * residual).max(), 1e-300):
            raise InputError(f"the constraints contradict each other at "
                             f"{self.names[int(np.argmax(left))]}: they demand different "
                             "accelerations of the same thing; remove a joint or a drive")
        return answer

    def _sort_out(self, multipliers: NDArray) -> None:
        """Redundant constraints have many answers, mass that is missing has none."""
        names, weakest = self.names, self.system.weakest
        if len(self.system.scale) > LARGEST:
            raise InputError(f"the constraints or the mass are singular at "
                             f"{'an unknown' if weakest is None else names[weakest]}: remove "
                             "redundant joints, give every body mass")
        whole = self.system.matrix.toarray()
        kept = np.ones(len(whole), dtype=bool)
        kept[multipliers] = False
        constraints = whole[multipliers][:, kept]
        rank, self.redundant = self._redundant(constraints, multipliers)
        free = np.linalg.svd(constraints)[2][rank:] if rank else np.eye(kept.sum())
        self._check_mass(free, whole[kept][:, kept], np.flatnonzero(kept))

    def _redundant(self, constraints: NDArray, multipliers: NDArray
                   ) -> tuple[int, tuple[str, ...]]:
        """Rank of the constraints and the joints that add nothing to it."""
        if not multipliers.size:
            return 0, ()
        names, lengths = self.names, np.linalg.norm(constraints, axis=1)
        for k in np.flatnonzero(lengths == 0.0):
            raise InputError(f"{names[multipliers[k]]} acts on nothing that can move: remove "
                             "the joint or free a node")
        R, order = qr(constraints.T / lengths, mode="r", pivoting=True)
        diagonal = np.abs(np.diag(R))
        rank = int((diagonal > 1e-9 * diagonal[0]).sum())
        return rank, tuple(dict.fromkeys(names[multipliers[k]].partition(" of ")[2]
                                         for k in order[rank:]))

    def _check_mass(self, free: NDArray, mass: NDArray, unknowns: NDArray) -> None:
        """Whatever the constraints leave free must have mass."""
        if not len(free):
            return
        mass = free @ mass @ free.T
        values, modes = np.linalg.eigh((mass + mass.T) / 2)
        if values[0] < 1e-12 * values[-1]:
            name = self.names[unknowns[np.argmax(np.abs(modes[:, 0] @ free))]]
            raise InputError(f"the mass is singular at {name}: nothing with mass moves with it; "
                             "give it a mass, fix it, or leave it out")
