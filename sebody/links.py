"""Rigid links: positions at the ends of arms that turn with rotations take no part in the solution.

Such a position is ``x = x_root + sum_k R_k r_k``. Its motion follows from that of the unknowns, its
forces are pulled back to them, and in element matrices its rows and columns are replaced:
``dx = dx_root - sum_k R_k skew(r_k) T_k dq_k``.

The second-order term of the force is in the matrix, gyroscopic terms of the position's velocity and
acceleration are not: of order h in an iteration matrix, nothing in a converged step.
"""

import numpy as np
from numba import njit
from numpy.typing import NDArray

from .abi import at, pointer_to
from .model import Model
from .numbering import Numbering


def link_arrays(model: Model, numbering: Numbering, batches: list,
                turned: NDArray) -> tuple[dict[str, NDArray], NDArray, NDArray]:
    """Arrays of `assembly.System`, and rows and columns of the additional matrix entries.

    ==================  ============================================================================
    hanging             (k, 4) first coordinate, that of the root, first and last + 1 of the arms
    arms                (m, 2) number of the rotation matrix, first coordinate of the rotation
    arm_vectors         (m, d)
    linked_elements     (e, 7) start of the matrix among the element matrices, width w, width W with
                        links replaced, start in maps, in entries, first and last + 1 of the blocks
    linked_maps         of w local unknowns, which of the W it is; -1 for hanging ones; then of each
                        block that of its root and of its arms
    linked_blocks       (b, 4) first local unknown, which of `hanging`, start in maps, frame in
                        whose axes the root is solved for, or -1
    ==================  ============================================================================
    """
    d = model.dimension
    hanging, arms, vectors = [], [], []
    for triplet in numbering.hanging:
        first = len(arms)
        for rotation, arm in triplet.arms:
            arms.append((numbering.rotations.get(id(rotation), 0),
                         numbering.triplets[id(rotation)]))
            vectors.append(arm)
        hanging.append((numbering.triplets[id(triplet)], numbering.triplets[id(triplet.root)],
                        first, len(arms)))
    which = {row[0]: k for k, row in enumerate(hanging)}
    frame_of = dict(turned.tolist())
    elements, maps, blocks, rows, columns = [], [], [], [], []
    start = 0
    for batch in batches:
        for unknowns in batch.unknowns:
            if any(u in which for u in unknowns):
                element = _expanded(unknowns, which, hanging, arms, frame_of, d,
                                    model.rotation_size, len(maps))
                wide, own_map, own_blocks = element
                elements.append((start, batch.width, len(wide), len(maps), len(rows),
                                 len(blocks), len(blocks) + len(own_blocks)))
                maps += own_map
                blocks += own_blocks
                rows += np.repeat(wide, len(wide)).tolist()
                columns += wide * len(wide)
            start += batch.width ** 2
    size = model.rotation_size
    for _, first in arms:
        own = list(range(first, first + size))
        rows += np.repeat(own, size).tolist()
        columns += own * size

    def table(values, width):
        return np.array(values, dtype=np.int64).reshape(-1, width)
    arrays = {"hanging": table(hanging, 4), "arms": table(arms, 2),
              "arm_vectors": np.array(vectors, dtype=float).reshape(-1, d),
              "linked_elements": table(elements, 7), "linked_maps": table(maps, 1).ravel(),
              "linked_blocks": table(blocks, 4), "arm_entry_count": len(arms) * size**2}
    return arrays, table(rows, 1).ravel(), table(columns, 1).ravel()


def _expanded(unknowns, which, hanging, arms, frame_of, d, turning, at_map):
    """Unknowns of an element with links replaced; see `link_arrays` for map and blocks."""
    inner = {u + k for u in unknowns if u in which for k in range(d)}
    wide = [u for u in dict.fromkeys(unknowns) if u not in inner]

    def first_of(unknown, count):
        for k in range(count):
            if unknown + k not in wide:
                wide.append(unknown + k)
        return wide.index(unknown)
    local = [-1 if u in inner else wide.index(u) for u in unknowns]
    blocks = []
    for i, u in enumerate(unknowns):
        if u in which:
            _, root, first, last = hanging[which[u]]
            blocks.append((i, which[u], at_map + len(local), frame_of.get(root, -1)))
            local.append(first_of(root, d))
            local += [first_of(arms[k][1], turning) for k in range(first, last)]
    return wide, local, blocks


@njit(cache=True, error_model="numpy")
def place_hanging(system, q, v, a, R):
    """Positions, velocities and accelerations at the ends of the links."""
    spatial = system.dimension[0] == 3
    for k in range(system.hanging.shape[0]):
        x, root = system.hanging[k, 0], system.hanging[k, 1]
        for i in range(system.dimension[0]):
            q[x + i], v[x + i], a[x + i] = q[root + i], v[root + i], a[root + i]
        for m in range(system.hanging[k, 2], system.hanging[k, 3]):
            c, r = system.arms[m, 1], system.arm_vectors[m]
            if spatial:
                _place_in_space(at(pointer_to(R), 9 * system.arms[m, 0]), r, c, x, q, v, a)
            else:
                s, t = _turned(q[c], r)
                q[x] += s
                q[x + 1] += t
                v[x] -= v[c] * t
                v[x + 1] += v[c] * s
                a[x] -= a[c] * t + v[c] * v[c] * s
                a[x + 1] += a[c] * s - v[c] * v[c] * t


@njit(cache=True, error_model="numpy", forceinline=True)
def _place_in_space(R, r, c, x, q, v, a):
    u, w = _cross(v[c], v[c + 1], v[c + 2], r[0], r[1], r[2]), _cross(
        a[c], a[c + 1], a[c + 2], r[0], r[1], r[2])
    z = _cross(v[c], v[c + 1], v[c + 2], u[0], u[1], u[2])
    for i in range(3):
        f, g, h = R[3 * i], R[3 * i + 1], R[3 * i + 2]
        q[x + i] += f * r[0] + g * r[1] + h * r[2]
        v[x + i] += f * u[0] + g * u[1] + h * u[2]
        a[x + i] += f * (w[0] + z[0]) + g * (w[1] + z[1]) + h * (w[2] + z[2])


@njit(cache=True, error_model="numpy", forceinline=True)
def _cross(a, b, c, x, y, z):
    return b * z - c * y, c * x - a * z, a * y - b * x


@njit(cache=True, error_model="numpy", forceinline=True)
def _turned(angle, r):
    c, s = np.cos(angle), np.sin(angle)
    return c * r[0] - s * r[1], s * r[0] + c * r[1]


@njit(cache=True, error_model="numpy")
def pull_back(system, q, R, residual):
    """Add the forces at the ends of the links to those on root and rotations."""
    spatial = system.dimension[0] == 3
    for k in range(system.hanging.shape[0]):
        x, root = system.hanging[k, 0], system.hanging[k, 1]
        for i in range(system.dimension[0]):
            residual[root + i] += residual[x + i]
        for m in range(system.hanging[k, 2], system.hanging[k, 3]):
            c, r = system.arms[m, 1], system.arm_vectors[m]
            if spatial:
                f = _in_body(at(pointer_to(R), 9 * system.arms[m, 0]), residual, x)
                moment = _cross(r[0], r[1], r[2], f[0], f[1], f[2])
                for i in range(3):
                    residual[c + i] += moment[i]
            else:
                s, t = _turned(q[c], r)
                residual[c] += s * residual[x + 1] - t * residual[x]


@njit(cache=True, error_model="numpy", forceinline=True)
def _in_body(R, f, x):
    return (R[0] * f[x] + R[3] * f[x + 1] + R[6] * f[x + 2],
            R[1] * f[x] + R[4] * f[x + 1] + R[7] * f[x + 2],
            R[2] * f[x] + R[5] * f[x + 1] + R[8] * f[x + 2])


@njit(cache=True, error_model="numpy")
def add_expanded(system, state, k, J):
    """Add the matrix J of an element with links, its rows and columns replaced."""
    w, wide = system.linked_elements[k, 1], system.linked_elements[k, 2]
    maps, entry = system.linked_elements[k, 3], system.linked_elements[k, 4]
    half, whole = np.zeros((w, wide)), np.zeros((wide, wide))
    for i in range(w):
        to = system.linked_maps[maps + i]
        if to >= 0:
            for row in range(w):
                half[row, to] += J[row * w + i]
    for b in range(system.linked_elements[k, 5], system.linked_elements[k, 6]):
        first = system.linked_blocks[b, 0]
        G, to = _replacement(system, state, b, True)
        for row in range(w):
            for i in range(G.shape[0]):
                for j in range(G.shape[1]):
                    half[row, to[j]] += J[row * w + first + i] * G[i, j]
    for i in range(w):
        to_row = system.linked_maps[maps + i]
        if to_row >= 0:
            for j in range(wide):
                whole[to_row, j] += half[i, j]
    for b in range(system.linked_elements[k, 5], system.linked_elements[k, 6]):
        first = system.linked_blocks[b, 0]
        G, to = _replacement(system, state, b, False)
        for i in range(G.shape[0]):
            for r in range(G.shape[1]):
                for j in range(wide):
                    whole[to[r], j] += G[i, r] * half[first + i, j]
    for i in range(wide):
        for j in range(wide):
            state.matrix[system.linked_entries[entry + i * wide + j]] += whole[i, j]


@njit(cache=True, error_model="numpy")
def _replacement(system, state, b, column):
    """Derivative of a hanging position by root and rotations, and where these are."""
    d, k = system.dimension[0], system.linked_blocks[b, 1]
    maps, frame = system.linked_blocks[b, 2], system.linked_blocks[b, 3]
    first, last = system.hanging[k, 2], system.hanging[k, 3]
    turning = 3 if d == 3 else 1
    G = np.zeros((d, d + turning * (last - first)))
    to = np.zeros(G.shape[1], dtype=np.int64)
    for i in range(d):
        to[i] = system.linked_maps[maps] + i
        for j in range(d):
            G[i, j] = 1.0 * (i == j) if frame < 0 else state.frames[9 * frame + 3 * i + j]
    for m in range(first, last):
        c, r = d + turning * (m - first), system.arm_vectors[m]
        for j in range(turning):
            to[c + j] = system.linked_maps[maps + 1 + m - first] + j
        if d == 2:
            s, t = _turned(state.q[system.arms[m, 1]], r)
            G[0, c], G[1, c] = -t, s
            continue
        number = system.arms[m, 0]
        R = state.R[9 * number:9 * number + 9].copy().reshape(3, 3)
        S = np.array([[0.0, r[2], -r[1]], [-r[2], 0.0, r[0]], [r[1], -r[0], 0.0]])
        A = R @ S
        if column:
            A = A @ state.T[9 * number:9 * number + 9].copy().reshape(3, 3)
        for i in range(3):
            for j in range(3):
                G[i, c + j] = A[i, j]
    return G, to


@njit(cache=True, error_model="numpy")
def add_second_order(system, state, forces):
    """Change of the pulled-back moments as the arms turn and the forces stay."""
    place, d = state.coefficients[2], system.dimension[0]
    for k in range(system.hanging.shape[0]):
        x = system.hanging[k, 0]
        for m in range(system.hanging[k, 2], system.hanging[k, 3]):
            r = system.arm_vectors[m]
            if d == 2:
                s, t = _turned(state.q[system.arms[m, 1]], r)
                state.matrix[system.arm_entries[m]] -= place * (s * forces[x] + t * forces[x + 1])
                continue
            number = system.arms[m, 0]
            f = _in_body(at(pointer_to(state.R), 9 * number), forces, x)
            along = r[0] * f[0] + r[1] * f[1] + r[2] * f[2]
            T = state.T[9 * number:9 * number + 9].copy().reshape(3, 3)
            A = np.zeros((3, 3))
            for i in range(3):
                for j in range(3):
                    A[i, j] = f[i] * r[j] - (along if i == j else 0.0)
            A = A @ T
            for i in range(3):
                for j in range(3):
                    state.matrix[system.arm_entries[9 * m + 3 * i + j]] += place * A[i, j]
