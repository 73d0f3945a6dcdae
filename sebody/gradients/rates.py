"""Derivatives of the rates of constraints by motion, which index 2 needs: no kernel has them.

Rates are linear in velocities and smooth functions of motion, of angles sines and cosines:
differences of the fourth order are exact to 1e-12 of a rate over a length of the model, and
weigh as much as a step is short beside that.
"""

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from sebody.basics.errors import InputError
from sebody.compiler.decorators import compiled
from sebody.contract.layout import OK, VELOCITY
from sebody.gradients.linear import Linear, Matrix
from sebody.kernels.abi import Arguments, at, call_kernel, pointer_to
from sebody.kernels.rotations import rotate
from sebody.small_motion.moved_states import STEPS, WEIGHTS

STEP = 1e-3         # of differences, of the model's size or in radians


@compiled
def _by_motion(system, state, places, length, stencil, weights):
    """Derivatives of the rates, in place of the joints' matrices in `State.J`; a status.

    `places` are the components of rotations, numbered 3 r + c, of all coordinates, others -1.
    """
    R = np.empty(9)
    for b in range(system.first_joint[0], system.address.size):
        width = system.width[b]
        for element in range(system.count[b]):
            first = system.at_g[b] + element * width
            own = system.at_J[b] + element * width * width
            for j in range(width * width):
                state.J[own + j] = 0.0
            for j in range(width):
                i = system.g_unknown[first + j]
                if system.is_multiplier[i] > 0.0:
                    continue
                r = 9 * (places[i] // 3)
                q, step = state.q[i], STEP * (length if places[i] < 0 else 1.0)
                for k in range(stencil.size):
                    if places[i] < 0:
                        state.q[i] = q + stencil[k] * step
                    else:
                        turn, c = stencil[k] * step, places[i] % 3
                        if k == 0:
                            for m in range(9):
                                R[m] = state.R[r + m]
                        rotate(pointer_to(R), 0, turn * (c == 0), turn * (c == 1), turn * (c == 2),
                               pointer_to(state.R), r)
                    status = _rates(system, state, b, element)
                    if status != OK:
                        return status
                    for row in range(width):
                        if system.is_multiplier[system.g_unknown[first + row]] > 0.0:
                            state.J[own + row * width + j] += (
                                weights[k] / step * state.g[first + row])
                state.q[i] = q
                if places[i] >= 0:
                    for m in range(9):
                        state.R[r + m] = R[m]
    return OK


@compiled
def _rates(system, state, b, element):
    """Rates of the constraints of an element, in `State.g`."""
    width, stride = system.width[b], system.stride[b]
    return call_kernel(
        system.address[b], VELOCITY, 1, stride, width,
        Arguments(index=at(pointer_to(system.index), system.at_index[b] + element * stride),
                  constants=system.constants, q=state.q, R=state.R, v=state.v, a=state.a,
                  references=state.frames_old, frames=state.frames, T=state.T, loads=state.loads,
                  coefficients=state.coefficients,
                  forces=at(pointer_to(state.g), system.at_g[b] + element * width),
                  matrices=at(pointer_to(state.J), system.at_J[b]), work=state.work,
                  energies=state.energy))


class Rates:
    """Derivatives of the rates of the constraints of a model.

    Parameters
    ----------
    linear : Linear
    size : float
        A length of the model.
    """

    def __init__(self, linear: Linear, size: float):
        self.linear, self.length = linear, size
        system = linear.system
        self.places = np.full(linear.total, -1, dtype=np.int64)
        for r, first in enumerate(system.rotation_at):
            self.places[first:first + 3] = 3 * r + np.arange(3)
        self.joints = int(system.at_J[system.first_joint[0]]) if (
            system.first_joint[0] < system.address.size) else len(linear.places)
        self.fixed = system.is_multiplier[:linear.free] > 0

    def by_motion(self) -> Matrix:
        """(n, n), of rows of multipliers alone, in the state that was evaluated last.

        Raises
        ------
        InputError
            The joints cannot be evaluated nearby.
        """
        linear = self.linear
        status = _by_motion(linear.system, linear.state, self.places, self.length,
                            np.array(STEPS, dtype=float), np.array(WEIGHTS, dtype=float))
        if status != OK:
            raise InputError("rates of constraints cannot be differentiated at "
                             f"t = {linear.state.now[0]:.6g}")
        found = linear.matrix(np.bincount(linear.places[self.joints:],
                                          linear.state.J[self.joints:], linear.sums.shape[1]))
        if linear.followers:
            motion = linear.followers.motion(linear.state, linear.dense)
            found = found @ motion.G + linear.matrix(linear.sums[2]) @ motion.V
        return rows_of(found[:linear.free, :linear.free], self.fixed)


def rows_of(A: Matrix, which: NDArray) -> Matrix:
    """Some rows of a matrix, others zero."""
    if isinstance(A, np.ndarray):
        return A * which[:, None]
    return sparse.csc_array(sparse.diags_array(which.astype(float)) @ A)


def columns_of(A: Matrix, which: NDArray) -> Matrix:
    """Some columns of a matrix, others zero."""
    if isinstance(A, np.ndarray):
        return A * which
    return sparse.csc_array(A @ sparse.diags_array(which.astype(float)))
