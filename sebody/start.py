"""A consistent start: velocities that fit the joints, accelerations and multipliers at t = 0."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import qr
from scipy.sparse import csc_matrix
from scipy.sparse.linalg import splu

from . import loop
from .assembly import System
from .errors import InputError
from .links import place_hanging
from .loop import State
from .model import Model
from .numbering import Numbering
from .triplets import Triplet

REASONS = {
    loop.HALF_TURN: "a node is turned by nearly half a turn against its body's frame",
    loop.NO_FRAME: "the search for a body's frame did not end",
    loop.NOT_FINITE: "the iteration matrix is singular or the iterate is not finite",
    loop.SLOW: "Newton's iteration did not converge",
}
SMALL = 1e-8            # residuals of constraints, relative to lengths and velocities
HEAVY = 1e10            # mass that keeps velocities the user gave
LARGEST = 3000          # unknowns up to which redundant constraints are sorted out
SINGULAR = 1e-13


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
    loop.set_loads(system, state.loads, 0.0)
    state.loads_old[:] = state.loads
    loop.move_prescribed(system, state)
    place_hanging(system.links, state.q, state.v, state.a, state.R)
    multipliers = np.flatnonzero(system.is_multiplier)
    state.coefficients[:5] = (1.0, 0.0, 0.0, 1.0, 1.0)
    _evaluate(system, state, loop.RENEWED)
    gaps = state.residual[multipliers]
    matrix = assembled(system, state)
    _check(gaps, np.abs(state.q).max(), "position", multipliers, numbering,
           "start from a state the joints allow")
    solver = _Solver(matrix, numbering, multipliers)
    changed = _fit_velocities(model, system, numbering, state, matrix, multipliers)
    _evaluate(system, state, loop.START)
    loop.to_body_axes(system, state.frames, state.residual, False)
    answer = np.zeros(numbering.total)
    answer[:numbering.free] = -solver(state.residual[:numbering.free].copy())
    loop.to_body_axes(system, state.frames, answer, True)
    moving = system.is_multiplier[:numbering.total] == 0
    solved = np.arange(numbering.total) < numbering.free
    state.a[solved & moving] = answer[solved & moving]
    state.q[~moving] = answer[~moving]
    state.aux[solved & moving] = answer[solved & moving]
    place_hanging(system.links, state.q, state.v, state.a, state.R)
    state.frames_old[:] = state.frames
    system.relaxed[0] = int(bool(solver.redundant))
    loop.set_powers(system, state)
    return Start(changed, solver.redundant)


def assembled(system: System, state: State) -> csc_matrix:
    """The assembled matrix, without padding."""
    n, entries = system.diagonal.size, state.matrix[:-1]
    kept = np.flatnonzero((entries != 0.0) & (system.rows < n))
    return csc_matrix((entries[kept], (system.rows[kept], system.columns[kept])), shape=(n, n))


def _evaluate(system: System, state: State, level: int) -> None:
    status = loop.assemble(level, system, state, state.residual)
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
    loop.to_body_axes(system, state.frames, answer, True)
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
    _evaluate(system, state, loop.RATES)
    return state.residual[multipliers]


def _places(numbering: Numbering, triplet: Triplet) -> NDArray:
    first = numbering.triplets[id(triplet)]
    return np.arange(first, first + triplet.start.size)


def _scaled(matrix: csc_matrix) -> tuple[csc_matrix, NDArray]:
    scale = 1.0 / np.sqrt(np.maximum(abs(matrix).max(axis=0).toarray().ravel(), 1e-300))
    return csc_matrix(matrix.multiply(scale[:, None]).multiply(scale[None, :])), scale


def _least(matrix: csc_matrix, demand: NDArray, numbering: Numbering) -> NDArray:
    """Solution of least norm, where the matrix is singular."""
    scaled, scale = _scaled(matrix)
    try:
        factors = splu(scaled)
        pivots = np.abs(factors.U.diagonal())
        if pivots.min() >= SINGULAR * pivots.max():
            return scale * factors.solve(scale * demand)
    except RuntimeError:
        pass
    if numbering.free > LARGEST:
        raise InputError("the constraints are redundant and too many to be sorted out: remove "
                         "redundant joints")
    return scale * np.linalg.lstsq(scaled.toarray(), scale * demand, rcond=1e-11)[0]


class _Solver:
    """Solves for accelerations and multipliers; finds redundant constraints and missing mass."""

    def __init__(self, matrix: csc_matrix, numbering: Numbering, multipliers: NDArray):
        self.matrix, self.numbering = matrix, numbering
        self.scaled, self.scale = _scaled(matrix)
        self.redundant: tuple[str, ...] = ()
        self.factors = None
        weakest = self._factorize()
        if self.factors is None:
            self._sort_out(multipliers, weakest)

    def __call__(self, residual: NDArray) -> NDArray:
        """Accelerations and multipliers, of least norm where these are not unique."""
        if self.factors is not None:
            return self.scale * self.factors.solve(self.scale * residual)
        demand = self.scale * residual
        answer = np.linalg.lstsq(self.scaled.toarray(), demand, rcond=1e-11)[0]
        left = np.abs(self.scaled @ answer - demand)
        if left.max() > 1e-7 * max(np.abs(demand).max(), 1e-300):
            raise InputError(f"the constraints contradict each other at "
                             f"{self.numbering.names[int(np.argmax(left))]}: they demand different "
                             "accelerations of the same thing; remove a joint or a drive")
        return self.scale * answer

    def _factorize(self) -> str:
        """Name of the unknown that makes the matrix singular, where it is."""
        names = self.numbering.names
        try:
            factors = splu(self.scaled)
        except RuntimeError:
            return "an unknown"
        pivots = np.abs(factors.U.diagonal())
        weakest = int(np.argmin(pivots))
        if pivots[weakest] < SINGULAR * pivots.max():
            return names[int(np.argsort(factors.perm_c)[weakest])]
        self.factors = factors
        return ""

    def _sort_out(self, multipliers: NDArray, weakest: str) -> None:
        """Redundant constraints have many answers, mass that is missing has none."""
        names = self.numbering.names
        if self.numbering.free > LARGEST:
            raise InputError(f"the constraints or the mass are singular at {weakest}: remove "
                             "redundant joints, give every body mass")
        whole = self.scaled.toarray()
        kept = np.ones(len(whole), dtype=bool)
        kept[multipliers] = False
        constraints = whole[multipliers][:, kept]
        rank, redundant = 0, []
        if multipliers.size:
            lengths = np.linalg.norm(constraints, axis=1)
            R, order = qr(constraints.T / np.maximum(lengths, 1e-300), mode="r", pivoting=True)
            diagonal = np.abs(np.diag(R))
            rank = int((diagonal > 1e-9 * diagonal[0]).sum())
            redundant = [names[multipliers[k]].partition(" of ")[2] for k in order[rank:]]
            for k in np.flatnonzero(lengths == 0.0):
                raise InputError(f"{names[multipliers[k]]} acts on nothing that can move: remove "
                                 "the joint or free a node")
        _, values, vectors = np.linalg.svd(constraints) if rank else (0, 0, np.eye(kept.sum()))
        free = vectors[rank:]
        mass = free @ whole[kept][:, kept] @ free.T
        if len(mass):
            values, modes = np.linalg.eigh((mass + mass.T) / 2)
            if values[0] < 1e-12 * values[-1]:
                name = names[np.flatnonzero(kept)[np.argmax(np.abs(modes[:, 0] @ free))]]
                raise InputError(f"the mass is singular at {name}: nothing with mass moves with "
                                 "it; give it a mass, fix it, or leave it out")
        self.redundant = tuple(dict.fromkeys(redundant))
