"""Turning of a deformation: its generator S, so that by an angle phi it turns by ``exp(S phi)``.

Displacements and small rotations turn as vectors about the line. How the amplitudes of internal
modes y do follows from the body's own matrices X, if turning does not change them,

    S^T X + X S = 0,    S = diag(S_b, S_y),    so X_by S_y = S_b X_by

with the known S_b of the boundary. S_y couples modes of equal frequencies alone.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag, eigh

from sebody.basics.vectors import skew
from sebody.model.parts import Superelement

EQUAL = 1e-6        # difference of squares of frequencies of a pair, of the larger one
ALIKE = 1e-5        # residual of the equation above, of its right side, of an axisymmetric body


def about(direction: NDArray) -> NDArray:
    """Generator of vectors: ``d x``; in a plane of positions."""
    if len(direction) == 1:
        return float(direction[0]) * np.array([[0.0, -1.0], [1.0, 0.0]])
    return skew(direction)


def of_modes(body: Superelement, direction: NDArray) -> NDArray:
    """Generator of the amplitudes of internal modes, (m, m); zeros if the body has no such."""
    reduced = body.reduced
    m = reduced.modes
    b = len(reduced.mass) - m
    found = np.zeros((m, m))
    if not m or not b:
        return found
    turns = np.zeros((1, 1)) if reduced.planar else about(direction)
    boundary = block_diag(*[about(direction)] * len(reduced.position_nodes),
                          *[turns] * len(reduced.rotation_nodes))
    masses = reduced.mass[b:, b:]
    squares, shapes = eigh(reduced.stiffness[b:, b:], masses)
    coupling = reduced.mass[:b, b:] @ shapes
    size = np.sqrt(np.maximum(np.diag(reduced.mass)[:b], 1e-300))[:, None]
    wanted = boundary @ coupling / size
    own = np.zeros((m, m))
    first = 0
    while first < m:
        last = first + 1
        while last < m and squares[last] - squares[first] <= EQUAL * squares[last]:
            last += 1
        group = slice(first, last)
        turn = np.linalg.lstsq(coupling[:, group] / size, wanted[:, group], rcond=1e-8)[0]
        own[group, group] = (turn - turn.T) / 2
        first = last
    left = np.abs(coupling / size @ own - wanted).max()
    if left > ALIKE * np.abs(wanted).max():
        return found
    return shapes @ own @ np.linalg.inv(shapes)
