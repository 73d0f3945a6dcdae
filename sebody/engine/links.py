"""Rigid links: positions at the ends of arms that rotate with a node are dependent coordinates.

A dependent position is ``x = x_root + sum_k R_k r_k``. Its motion follows from that of the
unknowns, forces on it are pulled back to root and rotations, and in element matrices its rows and
columns are replaced by ``dx = dx_root - sum_k R_k skew(r_k) T_k dq_k``.

The derivative of the pull-back itself is part of the matrix. Gyroscopic terms, by which velocity
and acceleration of a dependent position depend on the unknowns, are left out: of order h in an
iteration matrix, without influence on a converged step.
"""

import math
from dataclasses import dataclass

from numpy.typing import NDArray

from sebody.compiler.decorators import compiled
from sebody.engine.arrays import Arrays
from sebody.kernels.abi import at, pointer_to


@dataclass(frozen=True, eq=False)
class Links(Arrays):
    """Rigid links as arrays: constant during a run.

    Of k dependent positions with m arms in all, coordinates of a position d, and e elements that
    act on dependent positions. Such an element has w unknowns, and W with links replaced: all that
    are not dependent, then roots and rotations that are not among them.

    ==================  ============================================================================
    dependent           (k, 4) first coordinate, that of the root, first and last + 1 row of `arms`
    arms                (m, 2) number of the rotation matrix, first coordinate of the rotation
    arm_vectors         (m, d) the arms in the axes of their rotation
    elements            (e, 7) start of the matrix in `State.J`, w, W, start in `maps`, start in
                        `entries`, first and last + 1 row of `blocks`
    maps                places among the W: of the w unknowns, -1 for dependent ones; then of the
                        root and the rotations of each block
    blocks              (b, 4) dependent positions of elements: first of the w unknowns, row of
                        `dependent`, start in `maps`, axes the root is solved for in or -1
    entries             matrix entries of these elements, W x W each
    arm_entries         matrix entries of the derivative of the pull-back, of each arm
    ==================  ============================================================================
    """

    dependent: NDArray
    arms: NDArray
    arm_vectors: NDArray
    elements: NDArray
    maps: NDArray
    blocks: NDArray
    entries: NDArray
    arm_entries: NDArray


@compiled
def place_dependent(links, q, v, a, R, turns):
    """Set positions, velocities and accelerations of the dependent positions."""
    spatial = links.arm_vectors.shape[1] == 3
    for k in range(links.dependent.shape[0]):
        x, root = links.dependent[k, 0], links.dependent[k, 1]
        for i in range(links.arm_vectors.shape[1]):
            q[x + i], v[x + i], a[x + i] = q[root + i], v[root + i], a[root + i]
        for m in range(links.dependent[k, 2], links.dependent[k, 3]):
            c, r = links.arms[m, 1], links.arm_vectors[m]
            if spatial:
                _place_in_space(at(pointer_to(R), 9 * links.arms[m, 0]), r, c, x, q, v, a)
            else:
                s, t = _rotated(turns, c, q[c], r)
                q[x] += s
                q[x + 1] += t
                v[x] -= v[c] * t
                v[x + 1] += v[c] * s
                a[x] -= a[c] * t + v[c] * v[c] * s
                a[x + 1] += a[c] * s - v[c] * v[c] * t


@compiled(forceinline=True)
def _place_in_space(R, r, c, x, q, v, a):
    u, w = _cross(v[c], v[c + 1], v[c + 2], r[0], r[1], r[2]), _cross(
        a[c], a[c + 1], a[c + 2], r[0], r[1], r[2])
    z = _cross(v[c], v[c + 1], v[c + 2], u[0], u[1], u[2])
    for i in range(3):
        f, g, h = R[3 * i], R[3 * i + 1], R[3 * i + 2]
        q[x + i] += f * r[0] + g * r[1] + h * r[2]
        v[x + i] += f * u[0] + g * u[1] + h * u[2]
        a[x + i] += f * (w[0] + z[0]) + g * (w[1] + z[1]) + h * (w[2] + z[2])


@compiled(forceinline=True)
def _cross(a, b, c, x, y, z):
    return b * z - c * y, c * x - a * z, a * y - b * x


@compiled(forceinline=True)
def _rotated(turns, k, angle, r):
    """An arm rotated by an angle in the plane, coordinate k."""
    remember(turns, 3 * k, angle)
    c, s = turns[3 * k + 1], turns[3 * k + 2]
    return c * r[0] - s * r[1], s * r[0] + c * r[1]


@compiled(forceinline=True)
def remember(turns, first, angle):
    """Set cosine and sine of an angle unless those of this angle are there.

    Each iterate needs them for every arm that rotates with a node, and again for the forces on it.
    """
    if turns[first] != angle:
        turns[first], turns[first + 1], turns[first + 2] = angle, math.cos(angle), math.sin(angle)


@compiled
def pull_back(links, q, R, turns, residual):
    """Add the forces on dependent positions to those on their roots and rotations."""
    spatial = links.arm_vectors.shape[1] == 3
    for k in range(links.dependent.shape[0]):
        x, root = links.dependent[k, 0], links.dependent[k, 1]
        for i in range(links.arm_vectors.shape[1]):
            residual[root + i] += residual[x + i]
        for m in range(links.dependent[k, 2], links.dependent[k, 3]):
            c, r = links.arms[m, 1], links.arm_vectors[m]
            if spatial:
                f = _in_body(at(pointer_to(R), 9 * links.arms[m, 0]), residual, x)
                moment = _cross(r[0], r[1], r[2], f[0], f[1], f[2])
                for i in range(3):
                    residual[c + i] += moment[i]
            else:
                s, t = _rotated(turns, c, q[c], r)
                residual[c] += s * residual[x + 1] - t * residual[x]


@compiled(forceinline=True)
def _in_body(R, f, x):
    return (R[0] * f[x] + R[3] * f[x + 1] + R[6] * f[x + 2],
            R[1] * f[x] + R[4] * f[x + 1] + R[7] * f[x + 2],
            R[2] * f[x] + R[5] * f[x + 1] + R[8] * f[x + 2])


@compiled
def add_expanded(links, k, J, frames, q, R, T, turns, matrix, expansion):
    """Add the matrix J of an element, rows and columns of dependent positions replaced."""
    w, wide = links.elements[k, 1], links.elements[k, 2]
    maps, entry = links.elements[k, 3], links.elements[k, 4]
    G = pointer_to(expansion)
    half, whole = at(G, 9), at(G, 9 + w * wide)
    for i in range(w * wide + wide * wide):
        half[i] = 0.0
    for i in range(w):
        to = links.maps[maps + i]
        for row in range(w if to >= 0 else 0):
            half[row * wide + to] += J[row * w + i]
    for b in range(links.elements[k, 5], links.elements[k, 6]):
        _add_part(links, b, J, w, half, wide, True, frames, q, R, T, turns, G)
    for i in range(w):
        to = links.maps[maps + i]
        for j in range(wide if to >= 0 else 0):
            whole[to * wide + j] += half[i * wide + j]
    for b in range(links.elements[k, 5], links.elements[k, 6]):
        _add_part(links, b, half, w, whole, wide, False, frames, q, R, T, turns, G)
    for i in range(wide * wide):
        matrix[links.entries[entry + i]] += whole[i]


@compiled
def _add_part(links, b, source, w, target, wide, column, frames, q, R, T, turns, G):
    """Add the columns, or the rows, of a dependent position to those of root and rotations."""
    d = links.arm_vectors.shape[1]
    first, dependent, maps = (links.blocks[b, 0], links.blocks[b, 1],
                         links.blocks[b, 2])
    arms = links.dependent[dependent, 3] - links.dependent[dependent, 2]
    for part in range(arms + 1):
        count = _replacement(links, b, part, column, frames, q, R, T, turns, G)
        to = links.maps[maps + part]
        for i in range(d):
            for j in range(count):
                g = G[3 * i + j]
                if column:
                    for row in range(w):
                        target[row * wide + to + j] += source[row * w + first + i] * g
                else:
                    for c in range(wide):
                        target[(to + j) * wide + c] += g * source[(first + i) * wide + c]


@compiled
def _replacement(links, b, part, column, frames, q, rotations, operators, turns, G):
    """Derivative of a dependent position by its root (part 0) or the rotation of an arm.

    The derivative goes to G, three numbers a row; returns its number of columns.
    """
    d, dependent, frame = links.arm_vectors.shape[1], links.blocks[b, 1], links.blocks[b, 3]
    if part == 0:
        for i in range(d):
            for j in range(d):
                G[3 * i + j] = 1.0 * (i == j) if frame < 0 else frames[9 * frame + 3 * i + j]
        return d
    m = links.dependent[dependent, 2] + part - 1
    r = links.arm_vectors[m]
    if d == 2:
        c = links.arms[m, 1]
        s, t = _rotated(turns, c, q[c], r)
        G[0], G[3] = -t, s
        return 1
    R, T = (at(pointer_to(rotations), 9 * links.arms[m, 0]),
            at(pointer_to(operators), 9 * links.arms[m, 0]))
    for i in range(3):
        x, y, z = R[3 * i], R[3 * i + 1], R[3 * i + 2]
        x, y, z = z * r[1] - y * r[2], x * r[2] - z * r[0], y * r[0] - x * r[1]
        if column:
            x, y, z = (x * T[0] + y * T[3] + z * T[6], x * T[1] + y * T[4] + z * T[7],
                       x * T[2] + y * T[5] + z * T[8])
        G[3 * i], G[3 * i + 1], G[3 * i + 2] = x, y, z
    return 3


@compiled
def add_second_order(links, place, q, rotations, operators, turns, forces, matrix):
    """Add the derivative of the pull-back: moments of constant forces as the arms rotate."""
    d = links.arm_vectors.shape[1]
    for k in range(links.dependent.shape[0]):
        x = links.dependent[k, 0]
        for m in range(links.dependent[k, 2], links.dependent[k, 3]):
            r = links.arm_vectors[m]
            if d == 2:
                c = links.arms[m, 1]
                s, t = _rotated(turns, c, q[c], r)
                matrix[links.arm_entries[m]] -= place * (s * forces[x] + t * forces[x + 1])
                continue
            R, T = (at(pointer_to(rotations), 9 * links.arms[m, 0]),
                    at(pointer_to(operators), 9 * links.arms[m, 0]))
            f = _in_body(R, forces, x)
            along = r[0] * f[0] + r[1] * f[1] + r[2] * f[2]
            for i in range(3):
                for j in range(3):
                    change = -along * T[3 * i + j]
                    for c in range(3):
                        change += f[i] * r[c] * T[3 * c + j]
                    matrix[links.arm_entries[9 * m + 3 * i + j]] += place * change
