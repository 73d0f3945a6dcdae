"""Velocities with which bodies follow drives that have a speed at the start, without a shock.

A drive that moves one node of a body at once, while the others rest, would strain the body. So of
the velocities that fit the joints those are taken that change least in the norm of kinetic energy,
the kinetic energy of deformation counting `STIFF` times as much: bodies move as rigid ones as far
as joints, drives and given velocities let them. What deformation this leaves, which is more where
light nodes pull heavy bodies, is reduced by as much again in every further pass from there.
"""

from typing import NamedTuple
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_matrix

from sebody.analysis.redundancy import least
from sebody.assembly.numbering import Numbering, coordinates
from sebody.engine.links import place_dependent
from sebody.engine.state import State
from sebody.engine.system import System
from sebody.model.mechanism import Mechanism
from sebody.model.parts import Superelement, Triplet
from sebody.reduction import ReducedBody

STIFF = 1e8
PASSES = 3              # of a long slender beam the first leaves 1e-4, the third 1e-12
SMALL = 1e-8            # change of a velocity, relative, that is none
HEAVY = 1e12            # added mass, relative, that keeps velocities the user gave

# energies of deformation of bodies that are still in use: the next run needs them again
_energies: WeakKeyDictionary[ReducedBody, NDArray] = WeakKeyDictionary()


def follow_drives(model: Mechanism, system: System, numbering: Numbering, state: State,
                  masses: csc_matrix, rates: NDArray) -> dict[str, float]:
    """Change the free velocities so that flexible bodies follow drives that start from speed.

    Returns the triplets whose velocity changed, and by how much.

    Parameters
    ----------
    masses : (unknowns, unknowns)
        Masses and constraints.
    rates : (multipliers,)
        Of the constraints; their residuals with the velocities as they are.
    """
    if not model.bodies or not _starting_from_speed(model, system, numbering, state):
        return {}
    multipliers = np.flatnonzero(system.is_multiplier)
    demand = np.zeros(numbering.free)
    demand[multipliers] = -rates
    parts = [_Deformation.of(body, numbering) for body in model.bodies.values()]
    held = np.zeros(numbering.free)
    triplets = [t for t in model.triplets() if t.solved and id(t) in numbering.triplets]
    if given := [c for t in triplets if t.given for c in coordinates(numbering, t)]:
        held[given] = HEAVY * np.abs(masses.diagonal()).max()
    solve = least(_with_energies(masses, held, parts), system)
    before = state.v.copy()
    for _ in range(PASSES):
        wanted = demand.copy()
        for part in parts:
            wanted[part.unknowns] -= part.places.T @ (part.energy @ state.v[part.own])
        answer = solve(wanted)
        answer[multipliers] = demand[multipliers] = 0.0
        state.v[:numbering.free] += answer
        place_dependent(system.links, state.q, state.v, state.a, state.R)
    changes = {t.name: float(np.abs((state.v - before)[coordinates(numbering, t)]).max())
               for t in triplets}
    return {name: change for name, change in changes.items()
            if change > SMALL * np.abs(state.v).max()}


def _starting_from_speed(model: Mechanism, system: System, numbering: Numbering,
                         state: State) -> bool:
    ports = [*system.prescribed[:, 1], *(numbering.ports[id(c)] for c in model.constraints
                                         if c.history is not None)]
    return any(state.loads[3 * port + 1] != 0.0 for port in ports)


class _Deformation(NamedTuple):
    """The kinetic energy of deformation of a body, as a function of its velocities."""

    energy: NDArray     # ``STIFF D``, D = M - M r (r^T M r)^-1 r^T M with the rigid modes r
    own: NDArray        # coordinates of the body
    unknowns: NDArray   # those its velocities depend on
    places: NDArray     # its velocities by those of the unknowns

    @classmethod
    def of(cls, body: Superelement, numbering: Numbering) -> "_Deformation":
        """That of a superelement."""
        reduced = body.body
        first = numbering.modes[body.name]
        own = [c for t in (*body.positions, *body.rotations) for c in coordinates(numbering, t)]
        own += range(first, first + reduced.modes)
        return cls(STIFF * deformation(reduced), np.array(own), *_by_unknowns(body, numbering))


def deformation(reduced: ReducedBody) -> NDArray:
    """Matrix D of a body, ``v^T D v / 2`` being the kinetic energy of its deformation.

    That of the velocities v less that of the rigid motion with the same momenta.
    """
    if reduced not in _energies:
        _energies[reduced] = _deformation(reduced)
    return _energies[reduced]


def _deformation(reduced: ReducedBody) -> NDArray:
    r = reduced.rigid_modes_about(reduced.centre_of_mass)
    momentum = reduced.mass @ r
    return reduced.mass - momentum @ np.linalg.pinv(r.T @ momentum) @ momentum.T


def _with_energies(masses: csc_matrix, held: NDArray, parts: list[_Deformation]) -> csc_matrix:
    """Masses with those of held coordinates and the energies of deformation."""
    across = len(held)
    rows = [masses.indices, np.arange(across)]
    columns = [np.repeat(np.arange(across), np.diff(masses.indptr)), np.arange(across)]
    values = [masses.data, held]
    for part in parts:
        rows.append(np.repeat(part.unknowns, len(part.unknowns)))
        columns.append(np.tile(part.unknowns, len(part.unknowns)))
        values.append((part.places.T @ part.energy @ part.places).ravel())
    keys, places = np.unique(across * np.concatenate(columns) + np.concatenate(rows),
                             return_inverse=True)
    starts = np.searchsorted(keys, across * np.arange(across + 1))
    # summed in SciPy's own order and integers: SciPy takes twice as long from rows and columns
    return csc_matrix((np.bincount(places, np.concatenate(values)),
                       (keys % across).astype(np.int32), starts.astype(np.int32)),
                      shape=masses.shape)


def _by_unknowns(body: Superelement, numbering: Numbering) -> tuple[NDArray, NDArray]:
    """Unknowns, and the velocities of a body's coordinates by theirs; axes are global at the start.

    Fixed and prescribed coordinates have none; the end of a rigid link follows root and arms.
    """
    column: dict[int, int] = {}     # unknown -> its column
    blocks = []                     # first row, columns, velocities

    def add(row: int, triplet: Triplet, block: NDArray) -> None:
        if triplet.solved:
            own = [column.setdefault(c, len(column)) for c in coordinates(numbering, triplet)]
            blocks.append((row, own, block))

    row = 0
    for triplet in (*body.positions, *body.rotations):
        size = triplet.start.size
        if triplet.root is None:
            add(row, triplet, np.eye(size))
        else:
            add(row, triplet.root, np.eye(size))
            for rotation, (*arm,) in triplet.arms:
                add(row, rotation, np.array([[-arm[1]], [arm[0]]]) if size == 2 else
                    np.cross(np.eye(3), arm).T)
        row += size
    modes, first = body.body.modes, numbering.modes[body.name]
    own = [column.setdefault(first + k, len(column)) for k in range(modes)]
    blocks.append((row, own, np.eye(modes)))
    places = np.zeros((row + modes, len(column)))
    for row, own, block in blocks:
        places[row:row + len(block), own] += block
    return np.array(list(column), dtype=int), places
