"""Work memory of the matrices of eight members: one by one, or all at once."""

from dataclasses import replace

import numpy as np
from numba import typeof, types
from numpy.typing import NDArray

from sebody.compiler.choice import way
from sebody.engine.lanes.arrays import empty
from sebody.engine.lanes.together import Together, refactorize
from sebody.engine.state import State
from sebody.engine.system import System
from sebody.explore.ensembles.choice import matrices_at_once
from sebody.explore.ensembles.start_values import Image


def of_matrices(image: Image) -> dict[str, NDArray]:
    """Places of what a matrix depends on, of what is made with it, of element matrices in lanes."""
    state = image.template.state
    made = (state.scale, state.weight, state.T, state.regularization, state.constraint_columns,
            state.q, state.dq)
    taken = (*made, state.v, state.a, state.R, state.R_old, state.frames, state.frames_old,
             state.turns, state.loads, state.coefficients, state.forces)
    factors = state.inverse if image.template.dense else state.matrix
    return {"taken": places(image, *taken), "carried": carried(image),
            "returned": places(image, *made, factors, of_parameters=False)}


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
    system = image.template.system
    of_bodies = system.at_J[system.first_joint[0]] if matrices_at_once(image.template) else 0
    first = image.offsets.of(image.template.state.J).start
    return first + np.arange(of_bodies, dtype=np.int64)


def places(image: Image, *parts: NDArray, of_parameters: bool = True) -> NDArray:
    """Places of some arrays in the buffer of all numbers, and of all that parameters change."""
    slices = map(image.offsets.of, parts)
    return np.unique(np.concatenate([image.lines.slots.astype(np.int64) if of_parameters else [],
                                     *(np.arange(own.start, own.stop) for own in slices)])
                     ).astype(np.int64)
