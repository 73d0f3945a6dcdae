"""Exact derivatives of the forces of a state by motion, rates and second rates, all unknowns.

Element matrices are evaluated three times, for K, C and M, turned to global axes and summed for
all coordinates; then dependent positions are replaced by what they follow from, see `links`.
"""

from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from sebody.assembly.axes import in_frames
from sebody.basics.errors import InputError
from sebody.compiler.decorators import compiled
from sebody.contract.layout import (
    AT_FRAME,
    AT_POSITIONS,
    C_CONSTRAINT,
    C_DAMPING,
    C_GEO,
    C_MASS,
    C_STIFFNESS,
    OK,
    TANGENT,
)
from sebody.engine.evaluate import run_kernels, sum_forces
from sebody.engine.state import REASONS
from sebody.gradients.links import Followers
from sebody.gradients.recorded_states import put_state
from sebody.runs.simulation import Simulation

DENSE = 160         # most unknowns of full matrices: beyond, sparse ones are quicker
Matrix: TypeAlias = NDArray | sparse.csc_array


class Parts(NamedTuple):
    """Derivatives of the residual of all unknowns, multipliers included, in global axes."""

    mass: Matrix
    damping: Matrix
    stiffness: Matrix   # with the rows and columns of constraints


@compiled
def _evaluate(system, state, row, end, beside, turned, places, sums):
    """Sums of the element matrices M, C and K in the state of a row; the kernels' status."""
    put_state(system, state, row, end, beside)
    for i in range(state.T.size):
        state.T[i] = 1.0 if i % 9 % 4 == 0 else 0.0
    c = state.coefficients
    c[C_GEO] = 1.0
    for part in range(3):
        c[C_MASS], c[C_DAMPING] = 1.0 * (part == 0), 1.0 * (part == 1)
        c[C_STIFFNESS] = c[C_CONSTRAINT] = 1.0 * (part == 2)
        status = run_kernels(TANGENT, 0, system.address.size, system, state)
        if status != OK:
            return status
        _turn(system, state, turned)
        for k in range(sums.shape[1]):
            sums[part, k] = 0.0
        for k in range(places.size):
            sums[part, places[k]] += state.J[k]
    sum_forces(system, state, state.residual)
    return OK


@compiled
def _turn(system, state, turned):
    """Turn the matrices of some batches from the axes of frames to global axes."""
    d = system.dimension[0]
    for b in turned:
        width, stride = system.width[b], system.stride[b]
        for element in range(system.count[b]):
            at_index = system.at_index[b] + element * stride
            frame, first = 9 * system.index[at_index + AT_FRAME], system.at_J[b] + (
                element * width * width)
            for position in range(system.index[at_index + AT_POSITIONS]):
                _turn_rows(state.J, first, width, d * position, d, state.frames, frame)


@compiled
def _turn_rows(J, first, width, at, d, frames, frame):
    """Rows and columns of one position: ``R J`` and ``J R^T``."""
    R = np.empty((3, 3))
    for i in range(d):
        for j in range(d):
            R[i, j] = frames[frame + 3 * i + j]
    if d == 2:          # of a plane the frame holds cosine and sine
        R[0, 1], R[1, 1] = -R[1, 0], R[0, 0]
    old = np.empty(3)
    for k in range(width):
        for i in range(d):
            old[i] = J[first + (at + i) * width + k]
        for i in range(d):
            J[first + (at + i) * width + k] = 0.0
            for j in range(d):
                J[first + (at + i) * width + k] += R[i, j] * old[j]
    for k in range(width):
        for i in range(d):
            old[i] = J[first + k * width + at + i]
        for i in range(d):
            J[first + k * width + at + i] = 0.0
            for j in range(d):
                J[first + k * width + at + i] += R[i, j] * old[j]


class Linear:
    """Evaluates derivatives of the forces of a model in its states.

    Parameters
    ----------
    run : Simulation
        Its state is overwritten.
    """

    def __init__(self, run: Simulation):
        self.system, self.state = run.arrays_of_loop
        system, free = self.system, run.numbering.free
        self.free, self.total = free, run.numbering.total
        self.turned = np.flatnonzero(in_frames(run.model, run.numbering, system))
        self.followers = Followers(system.links, free, self.total)
        self.dense = free <= DENSE
        rows, columns = self._entries()
        keys = columns.astype(np.int64) * self.total + rows
        if self.dense:
            self.places, size = rows.astype(np.int64) * self.total + columns, self.total**2
        else:
            unique, self.places = np.unique(keys, return_inverse=True)
            self.indices, size = (unique % self.total).astype(np.int32), len(unique)
            self.starts = np.searchsorted(unique // self.total, np.arange(self.total + 1)).astype(
                np.int32)
        self.sums = np.zeros((3, size))

    def _entries(self) -> tuple[NDArray, NDArray]:
        """Row and column of every entry of `State.J`, among all coordinates."""
        system = self.system
        rows, columns = [], []
        for b, (count, width) in enumerate(zip(system.count, system.width, strict=True)):
            own = system.g_unknown[system.at_g[b]:system.at_g[b + 1]].reshape(count, width)
            row, column = np.broadcast_arrays(own[:, :, None], own[:, None, :])
            rows.append(row.ravel())
            columns.append(column.ravel())
        return np.concatenate(rows), np.concatenate(columns)

    def at(self, row: NDArray, end: float, beside: float) -> Parts:
        """M, C and K in the state of a row, under the loads of a time.

        Raises
        ------
        InputError
            The state cannot be evaluated.
        """
        status = _evaluate(self.system, self.state, row, end, beside, self.turned,
                           self.places, self.sums)
        if status != OK:
            raise InputError(f"the state at t = {row[0]:.6g} has no derivatives: {REASONS[status]}")
        M, C, K = map(self.matrix, self.sums)
        if not self.followers:
            return Parts(*(self._free(A) for A in (M, C, K)))
        return Parts(*self.followers.reduced(self.state, M, C, K, self.dense))

    def put(self, row: NDArray, end: float, beside: float) -> None:
        """Make the state of a row, under the loads of a time, that of the arrays."""
        put_state(self.system, self.state, row, end, beside)

    def matrix(self, values: NDArray) -> Matrix:
        """All coordinates, of sums of entries as of `places`."""
        if self.dense:
            return values.reshape(self.total, self.total)
        return sparse.csc_array((values.copy(), self.indices, self.starts),
                                shape=(self.total, self.total))

    def _free(self, A: Matrix) -> Matrix:
        n = self.free
        return A[:n, :n].copy() if n < self.total or self.dense else A
