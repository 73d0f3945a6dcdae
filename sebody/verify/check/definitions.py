"""Coordinates of a superelement computed independently of the kernels: by SciPy and an SVD."""

from types import ModuleType

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import root
from scipy.spatial.transform import Rotation

from sebody.contract.traits import FrameTraits
from sebody.generated.options import FRAMES, INERTIA_OPTIONS
from sebody.verify.check.states import Case, constants_of


def local_coordinates(case: Case) -> NDArray:
    """Local coordinates ``y``, (11), by SciPy's rotations."""
    return _local(case, frame_rotation(case))


def _local(case: Case, frame: Rotation) -> NDArray:
    """The same in any frame."""
    constants = constants_of(case)
    x = case.q[:case.first_rotation].reshape(case.n_positions, -1)
    R0 = frame.as_matrix()[:x.shape[1], :x.shape[1]]
    u = (x - constants["alphas"] @ x) @ R0 - constants["X"]
    if case.planar:
        psi = case.q[case.first_rotation:case.first_mode] - np.arctan2(R0[1, 0], R0[0, 0])
        psi = (psi + np.pi) % (2 * np.pi) - np.pi
    elif case.n_rotations:
        psi = Rotation.from_matrix(R0.T @ case.R.reshape(-1, 3, 3)).as_rotvec()
    else:
        psi = np.zeros(0)
    return np.concatenate([u.ravel(), psi.ravel(), case.q[case.first_mode:]])


def local_velocities(case: Case) -> NDArray:
    """``ydot`` of the inertia option, (33) and (36) or (52)."""
    module, v = case.module, case.v.copy()
    d = case.dimension
    R0 = frame_rotation(case).as_matrix()
    positions = v[:case.first_rotation].reshape(-1, d) @ R0[:d, :d]
    v[:case.first_rotation] = positions.ravel()
    if not INERTIA_OPTIONS[module.INERTIA].material:
        for j, at in enumerate(case.rotations):
            v[at:at + 3] = R0.T @ case.R[9 * j:9 * j + 9].reshape(3, 3) @ v[at:at + 3]
    return v


def frame_traits(module: ModuleType) -> FrameTraits:
    """The traits that the frame of a kernel declares."""
    return FRAMES[module.FRAME]


def frame_rotation(case: Case) -> Rotation:
    """``R0`` from its definition, (14)-(16) or the best fit, without the search of the kernels."""
    constants, traits = constants_of(case), frame_traits(case.module)
    if traits.modes:
        return mean_axes(case)
    if not traits.needs_rotations:
        x = case.q[:case.first_rotation].reshape(case.n_positions, -1)
        arms, X, fits = x - constants["alphas"] @ x, constants["X"], constants["fits"]
        if not case.planar:
            return Rotation.align_vectors(arms, X, fits)[0]
        turns = (arms @ [1, 1j]) * (X @ [1, -1j])
        return Rotation.from_rotvec([0, 0, np.angle(fits @ turns)])
    if case.planar:
        angles = case.q[case.first_rotation:case.first_mode]
        return Rotation.from_rotvec([0, 0, constants["alpha_rs"] @ angles])
    if not traits.incremental:
        return Rotation.from_matrix(mean_rotation(case).reshape(3, 3))
    last = Rotation.from_matrix(case.reference.reshape(3, 3))
    increments = (last.inv() * Rotation.from_matrix(case.R.reshape(-1, 3, 3))).as_rotvec()
    return last * Rotation.from_rotvec(constants["alpha_rs"] @ increments)


def mean_axes(case: Case) -> Rotation:
    """Rotation in which the local coordinates, weighted, vanish: by a root search of SciPy."""
    d, Gam = case.dimension, constants_of(case)["Gam"]
    start = Rotation.from_matrix(case.frames.reshape(3, 3))

    def frame(step: NDArray) -> Rotation:
        return start * Rotation.from_rotvec([0, 0, *step] if d == 2 else step)
    answer = root(lambda step: Gam.T @ _local(case, frame(step)), np.zeros(Gam.shape[1]), tol=1e-15)
    return frame(answer.x)


def mean_rotation(case: Case) -> NDArray:
    """Frame in which the weighted rotation vectors of the nodes vanish, by fixed-point search."""
    weights = constants_of(case)["alpha_rs"]
    nodes = Rotation.from_matrix(case.R.reshape(-1, 3, 3))
    frame = nodes[0]
    for _ in range(60):
        step = weights @ (frame.inv() * nodes).as_rotvec()
        frame = frame * Rotation.from_rotvec(step)
        if np.abs(step).max() < 1e-16:
            break
    return frame.as_matrix().ravel()
