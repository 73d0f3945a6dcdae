"""Equal bodies that are oriented differently at the start, in the axes of one of them.

Rotated by Q, a body moves as the original, whose constants are known, does on nodes that were
rotated by Q before: their rotations are R Q, and what is in the axes of a node, such as angular
velocities and moments, has the components Q^T w there. Positions, forces on them and internal modes
are the same; in the matrix, where positions are in the axes of the frame, they are rotated, too. In
a plane the angles of the nodes are larger by that of Q.
"""

from sebody.compiler.decorators import compiled
from sebody.kernels.abi import at


@compiled
def turn_coordinates(turn, count, x):
    """``Q^T x`` of some vectors in the axes of nodes."""
    for j in range(0, 3 * count, 3):
        a, b, c = x[j], x[j + 1], x[j + 2]
        for i in range(3):
            x[j + i] = turn[i] * a + turn[3 + i] * b + turn[6 + i] * c


@compiled
def turn_rotations(turn, count, R):
    """``R Q`` of some rotations."""
    for j in range(0, 9 * count, 3):
        a, b, c = R[j], R[j + 1], R[j + 2]
        for i in range(3):
            R[j + i] = a * turn[i] + b * turn[3 + i] + c * turn[6 + i]


@compiled
def turn_operators(turn, count, T):
    """``Q^T T Q`` of some operators on vectors in the axes of nodes."""
    turn_rotations(turn, count, T)
    for j in range(0, 9 * count, 9):
        for k in range(3):
            a, b, c = T[j + k], T[j + 3 + k], T[j + 6 + k]
            for i in range(3):
                T[j + 3 * i + k] = turn[i] * a + turn[3 + i] * b + turn[6 + i] * c


@compiled
def turn_back(turn, count, g):
    """``Q g`` of some vectors in the axes of nodes or of the frame."""
    for j in range(0, 3 * count, 3):
        a, b, c = g[j], g[j + 1], g[j + 2]
        for i in range(3):
            g[j + i] = turn[3 * i] * a + turn[3 * i + 1] * b + turn[3 * i + 2] * c


@compiled
def turn_matrix_back(turn, dimension, width, count, J):
    """Rows and columns of a matrix that belong to vectors: ``Q J Q^T``.

    Its positions are in the axes of the frame, as rotations are in those of nodes. In a plane
    vectors are positions alone.
    """
    d = dimension
    for row in range(0, width * width, width):
        for j in range(row, row + d * count, d):
            a, b, c = J[j], J[j + 1], J[j + d - 1]      # the last times zero in a plane
            for i in range(d):
                J[j + i] = turn[3 * i] * a + turn[3 * i + 1] * b + turn[3 * i + 2] * c
    for j in range(0, d * count * width, d * width):
        for k in range(j, j + width):
            a, b, c = J[k], J[k + width], J[k + (d - 1) * width]
            for i in range(d):
                J[k + i * width] = turn[3 * i] * a + turn[3 * i + 1] * b + turn[3 * i + 2] * c


@compiled
def turn_frame_back(turn, E):
    """``E Q^T`` of a frame, which stays orthonormal however often it is turned there and back."""
    for j in range(0, 9, 3):
        turn_back(turn, 1, at(E, j))
    xx = E[0] * E[0] + E[3] * E[3] + E[6] * E[6]
    yy = E[1] * E[1] + E[4] * E[4] + E[7] * E[7]
    zz = E[2] * E[2] + E[5] * E[5] + E[8] * E[8]
    xy = E[0] * E[1] + E[3] * E[4] + E[6] * E[7]
    xz = E[0] * E[2] + E[3] * E[5] + E[6] * E[8]
    yz = E[1] * E[2] + E[4] * E[5] + E[7] * E[8]
    for j in range(0, 9, 3):        # E (3 - E^T E) / 2
        a, b, c = 0.5 * E[j], 0.5 * E[j + 1], 0.5 * E[j + 2]
        E[j] = (3.0 - xx) * a - xy * b - xz * c
        E[j + 1] = (3.0 - yy) * b - xy * a - yz * c
        E[j + 2] = (3.0 - zz) * c - xz * a - yz * b
