"""Kernels as plain Python: their text is executed with NumPy views, without Numba.

The functions of the runtime that kernels call are written here once more, by other means: frames by
SciPy, coefficients by mpmath's series, products by NumPy.
"""

import builtins
import sys
from types import SimpleNamespace

import mpmath
import numpy as np
from scipy.spatial.transform import Rotation

from sebody.contract.counts import packed_size, whole_vectors
from sebody.contract.layout import OK
from sebody.derive.symbolic.rotations import stumpff_value, tangent_inverse_value
from sebody.kernels.abi import Arguments
from sebody.kernels.packed import diagonals_of, multiples, strips
from sebody.verify.check.states import arguments


def executed(text: str) -> SimpleNamespace:
    """The module of a kernel's text."""
    def importer(name, scope=None, local=None, fromlist=(), level=0):
        module = builtins.__import__(name, scope, local, fromlist, level)
        return SimpleNamespace(**{key: RUNTIME.get(key, getattr(module, key, None))
                                  for key in fromlist})
    scope = {"__builtins__": {**vars(builtins), "__import__": importer}, "__name__": "plain"}
    exec(compile(text, "plain kernel", "exec"), scope)
    return SimpleNamespace(**scope)


def evaluated(case, task: int, coefficients=(0, 0, 0, 1, 1), matrices=None, **changed) -> Arguments:
    """The arguments of the plain kernel of a case after a call."""
    given = arguments(case, coefficients)._replace(**changed)
    if matrices is not None:
        given = given._replace(matrices=matrices)
    status = case.module.kernel(task, 1, len(case.index), case.n, *given)
    assert status == OK
    return given


def columns(A, rows, count, height):
    """A matrix of columns that are `height` numbers apart."""
    return A[:count * height].reshape(count, height)[:, :rows].T


def columns_times(A, x, out, rows, count):
    out[:rows] = columns(A, rows, count, whole_vectors(rows)) @ x[:count]


def columns_times_all(A, x, y, z, of_x, of_y, of_z, rows, count):
    for given, out in ((x, of_x), (y, of_y), (z, of_z)):
        columns_times(A, given, out, rows, count)


def arrow_times(A, x, out, n, filled):
    columns_times(A, x, out, n, n)


def add_block_times(A, x, out, rows, count, height):
    out[:rows] += columns(A, rows, count, height) @ x[:count]


def block_times(A, x, out, rows, count, height):
    out[:rows] = columns(A, rows, count, height) @ x[:count]


def add_blocks_times(A, x, B, y, out, rows, count, of_B, height):
    add_block_times(A, x, out, rows, count, height)
    add_block_times(B, y, out, rows, of_B, height)


def rows_times(A, x, out, rows, count, height):
    out[:count] = columns(A, rows, count, height).T @ x[:rows]


def add_rows_times(A, x, out, rows, count, height):
    out[:count] += columns(A, rows, count, height).T @ x[:rows]


def clear(row, count):
    row[:count] = 0.0


def _products(matrices):
    """Of packed matrices: vector, place of the sums, matrix, first row and column, entries."""
    for strip in strips(matrices):
        for use in strip.uses:
            at, entries = (strip.row, strip.first), strip.entries
            if use.transposed:
                at, entries = at[::-1], entries.T
            yield use.vector, use.place, use.matrix, *at, entries
    for place, matrix, _, numbers in diagonals_of(matrices):
        yield 0, place, matrix, 0, 0, np.diag(numbers)


def packed_times(matrices, x, out, count):
    couplings_times(matrices, x, x, out, count)


def packed_times_both(matrices, x, y, of_x, of_y, count):
    packed_times(matrices, x, of_x, count)
    packed_times(matrices, y, of_y, count)


def couplings_times(matrices, x, y, out, count):
    out[:count] = 0.0
    _add_products(matrices, x, y, out)
    for place, other, _, factors in multiples(matrices):
        out[place:place + len(factors)] = factors * out[other:other + len(factors)]


def add_packed_times(matrices, x, out):
    _add_products(matrices, x, x, out)


def _add_products(matrices, x, y, out):
    for vector, place, _, _, first, entries in _products(matrices):
        rows, columns = entries.shape
        out[place:place + rows] += entries @ (x, y)[vector][first:first + columns]


def add_packed(matrices, factors, out, height):
    for _, _, k, row, first, entries in _products(matrices):
        for c, column in enumerate(entries.T):
            place = (first + c) * height + row
            out[place:place + len(column)] += factors[k] * column


def add_couplings(matrices, factors, scales, of_x, of_y, count, size, height):
    scales[:count * size] = np.repeat(factors[:count], size)
    for place, other, _, own in multiples(matrices):
        scales[other:other + len(own)] += own * scales[place:place + len(own)]
    for vector, at, _, row, first, entries in _products(matrices):
        for c, column in enumerate(entries.T):
            place = (first + c) * height + row
            (of_x, of_y)[vector][place:place + len(column)] += scales[at:at + len(column)] * column


def to_free(y, axes, order, moved, z, bound, bound_free, free, end):
    columns_times(axes, y, moved, bound_free, bound)
    moved[bound_free:free] = y[bound:bound + free - bound_free]
    z[:end] = 0.0
    z[:free] = moved[order[:free].astype(int)]


def from_free(z, back, order, moved, y, bound, bound_free, free):
    moved[order[:free].astype(int)] = z[:free]
    columns_times(back, moved, y, bound, bound_free)
    y[bound:bound + free - bound_free] = moved[bound_free:free]


def all_to_free(y, yd, ydd, axes, order, moved, z, zd, zdd, *sizes):
    for given, to in ((y, z), (yd, zd), (ydd, zdd)):
        to_free(given, axes, order, moved, to, *sizes)


def follow(Zq, Zd, z, zd, zdd, free, slaved, height):
    Q, Qd = (columns(Z, free, slaved, height).T for Z in (Zq, Zd))
    z[free:free + slaved] = Q @ z[:free] / 2
    zdd[free:free + slaved] = Q @ zdd[:free] + Qd @ zd[:free]
    zd[free:free + slaved] = Q @ zd[:free]


def follow_changes(Zq, Zd, Za, dz, dzd, dzdd, free, slaved, height):
    Q, Qd, Qdd = (columns(Z, free, slaved, height).T for Z in (Zq, Zd, Za))
    dzdd[free:free + slaved] = Q @ dzdd[:free] + 2 * Qd @ dzd[:free] + Qdd @ dz[:free]
    dzd[free:free + slaved] = Q @ dzd[:free] + Qd @ dz[:free]


def inverse_3(*entries):
    return np.linalg.inv(np.reshape(entries, (3, 3))).ravel()


def relative_rotations(count, nodes, R, frame, psi):
    of_nodes = R.reshape(-1, 3, 3)[nodes[:count]]
    turns = np.swapaxes(frame[:9].reshape(3, 3), 0, 1) @ of_nodes
    psi[:3 * count] = Rotation.from_matrix(turns).as_rotvec().ravel() if count else 0.0
    return OK


def converged_mean(count, nodes, alpha, R, frame, psi):
    for _ in range(80):
        relative_rotations(count, nodes, R, frame, psi)
        step = alpha[:count] @ psi[:3 * count].reshape(-1, 3)
        rotate(frame, step, frame)
    return relative_rotations(count, nodes, R, frame, psi)


def rotate(frame, step, out):
    out[:9] = (frame[:9].reshape(3, 3) @ Rotation.from_rotvec(step).as_matrix()).ravel()


def weighted_mean(count, nodes, alpha, R, reference, frame, beta, psi):
    relative_rotations(count, nodes, R, reference, beta)
    rotate(reference, alpha[:count] @ beta[:3 * count].reshape(-1, 3), frame)
    return relative_rotations(count, nodes, R, frame, psi)


def in_plane(frame, angle):
    frame[:9] = Rotation.from_rotvec([0, 0, angle]).as_matrix().ravel()


def planar_mean(count, alpha, angles, frame, psi):
    mean = alpha[:count] @ angles[:count]
    psi[:count] = angles[:count] - mean
    in_plane(frame, mean)
    return OK


def best_fit(count, fit, X, alpha, x, frame):
    points = x[:3 * count].reshape(-1, 3)
    arms = points - alpha[:count] @ points
    frame[:9] = Rotation.align_vectors(arms, X[:3 * count].reshape(-1, 3), fit[:count])[
        0].as_matrix().ravel()
    return OK


def planar_fit(count, fit, X, alpha, x, frame):
    points = x[:2 * count].reshape(-1, 2)
    arms = points - alpha[:count] @ points
    turns = (arms @ [1, 1j]) * (X[:2 * count].reshape(-1, 2) @ [1, -1j])
    in_plane(frame, np.angle(fit[:count] @ turns))
    return OK


def planar_relative_angles(count, angles, frame, psi):
    turned = angles[:count] - np.arctan2(frame[3], frame[0])
    psi[:count] = (turned + np.pi) % (2 * np.pi) - np.pi
    return OK


def inverse_tangent_coefficients(s):
    return float(tangent_inverse_value(0, mpmath.mpf(s))), float(tangent_inverse_value(
        1, mpmath.mpf(s)))


def inverse_tangent_second(s):
    return float(tangent_inverse_value(2, mpmath.mpf(s)))


def stumpff_2345(s):
    return [float(stumpff_value(k, mpmath.mpf(s))) for k in range(2, 6)]


def stumpff_1_to_7(s):
    return [float(stumpff_value(k, mpmath.mpf(s))) for k in range(1, 8)]


def at(array, first):
    return array[first:]


def opaque(number):
    return number


def kernel_function(function=None, sizes_known=False):
    return kernel_function if function is None else function


RUNTIME = {name: value for name, value in vars(sys.modules[__name__]).items()
           if callable(value) and getattr(value, "__module__", "") == __name__}
RUNTIME |= {"padded": whole_vectors, "packed_room": packed_size}
