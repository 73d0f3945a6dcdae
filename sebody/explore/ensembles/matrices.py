"""Work memory of the matrices of eight members: one by one, or all at once."""

from dataclasses import replace

import numpy as np
from numba import typeof, types
from numpy.typing import NDArray

from sebody.compiler.choice import way
from sebody.contract.counts import MEMBERS
from sebody.engine.lanes.arrays import empty
from sebody.engine.lanes.matrix import Alone
from sebody.engine.lanes.together import Together, refactorize
from sebody.engine.state import State
from sebody.engine.system import System
from sebody.explore.ensembles.choice import matrices_at_once
from sebody.explore.ensembles.member import Copies
from sebody.explore.ensembles.start_values import Image


def alone(copies: Copies, lanes: NDArray) -> Alone:
    """The single run of a thread, and what it shares with a member for a matrix.

    Parameters
    ----------
    copies : Copies
        The single run.
    lanes : (size, members)
        The numbers of all members.
    """
    image, system, state = copies.image, copies.image.template.system, copies.image.template.state
    made = (state.scale, state.weight, state.T, state.regularization, state.constraint_columns,
            state.q, state.dq)
    taken = (*made, state.v, state.a, state.R, state.R_old, state.frames, state.frames_old,
             state.turns, state.loads, state.coefficients, state.forces)
    factors = state.inverse if copies.dense else state.matrix
    kept = 0 if matrices_at_once(image.template) else _of_bodies(system)
    return Alone(copies.system, copies.state, copies.floats, lanes, taken=places(image, *taken),
                 returned=places(image, *made, factors, of_parameters=False),
                 J=np.zeros((MEMBERS, kept)))


def together(image: Image, system: System, state: State, begun: NDArray) -> Together:
    """Work memory of the matrices of all members.

    Parameters
    ----------
    system, state
        In lanes.
    begun : (9 b,)
        As of `Together`.
    """
    found = new_together(state, begun)
    if matrices_at_once(image.template):
        found.routine[0] = address_together(system, state, found)
    return found


def new_together(state: State, begun: NDArray) -> Together:
    """The same, of matrices that are made one by one."""
    own = {name: empty(*getattr(state, name).shape) for name in ("g", "frames", "matrix")}
    return Together(np.zeros(1, dtype=np.int64), replace(state, **own), empty(*state.T.shape),
                    empty(*state.J.shape), begun, empty(3))


def address_together(system: System, state: State, found: Together) -> int:
    """Address of the function that makes the matrices of all members; it is compiled if needed."""
    return way().address(refactorize, types.int64, tuple(map(typeof, (system, state, found))))


def carried(image: Image) -> NDArray:
    """Places of element matrices of bodies, where members have them in lanes."""
    of_bodies = _of_bodies(image.template.system) if matrices_at_once(image.template) else 0
    first = image.offsets.of(image.template.state.J).start
    return first + np.arange(of_bodies, dtype=np.int64)


def _of_bodies(system: System) -> int:
    """Numbers of the element matrices of bodies."""
    return int(system.at_J[system.first_joint[0]])


def places(image: Image, *parts: NDArray, of_parameters: bool = True) -> NDArray:
    """Places of some arrays in the buffer of all numbers, and of all that parameters change."""
    slices = map(image.offsets.of, parts)
    return np.unique(np.concatenate([image.lines.slots.astype(np.int64) if of_parameters else [],
                                     *(np.arange(own.start, own.stop) for own in slices)])
                     ).astype(np.int64)
