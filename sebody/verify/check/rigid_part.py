"""Generic bodies of option D, and their energies from the definition."""

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial.transform import Rotation

from sebody.contract.counts import axes_of
from sebody.generated.options import INERTIA_OPTIONS
from sebody.verify.check.definitions import frame_rotation, local_coordinates
from sebody.verify.check.states import Case, along_path, constants_of, derivative


def has_rigid_part(case: Case) -> bool:
    """Tell whether the kernel has a rigid part that turns by itself."""
    option = INERTIA_OPTIONS[case.module.INERTIA]
    return option.rates and not option.field


def generic_constants(random: np.random.Generator, case: Case, mass: NDArray,
                      damping: float) -> dict[str, ArrayLike]:
    """Any constants by name; `mass` is the reduced one."""
    axes = axes_of(case.planar)
    turns = axes["motions"] - axes["D"]
    A = random.normal(size=(turns, turns))
    rows = random.normal(size=(axes["motions"], case.n))
    C = damping * mass @ mass if case.damped else np.zeros((case.n, 0))     # any positive matrix
    return {"columns": [C.shape[1]], "Jc": _packed(A @ A.T), "rigid_rows": rows,
            "rigid_columns": rows.T, "C": C}


def first_moment(case: Case, y: NDArray) -> NDArray:
    """First moment of the deformed body, about the origin of the frame, in its axes."""
    constants = constants_of(case)
    return constants["mc"] + constants["rigid_rows"][:case.dimension] @ y


def kinetic_terms(case: Case) -> NDArray:
    """Terms of ``T``: of the rigid part from its path, and of the rates of y, by differences."""
    h, constants = 0.003, constants_of(case)
    mass, rows = constants["masses"][0], constants["rigid_rows"]
    J = _inertia(constants["Jc"])
    yd = derivative(lambda t: local_coordinates(along_path(case, t)), h)
    v = derivative(lambda t: _centre(along_path(case, t)), h)
    rotated = _rotation(case).T @ derivative(lambda t: _rotation(along_path(case, t)), h)
    w = np.array([rotated[2, 1], rotated[0, 2], rotated[1, 0]])
    first, angle = rows[:case.dimension] @ yd, np.zeros(3)
    angle[3 - len(rows) + case.dimension:] = rows[case.dimension:] @ yd
    return np.array([mass * v @ v / 2, w @ J @ w / 2, yd @ constants["M"] @ yd / 2,
                     -first @ first / (2 * mass), -angle @ J @ angle / 2])


def _centre(case: Case) -> NDArray:
    """Centre of mass."""
    d, constants = case.dimension, constants_of(case)
    x = case.q[:case.first_rotation].reshape(-1, d)
    R0 = frame_rotation(case).as_matrix()[:d, :d]
    return (constants["alphas"] @ x
            + R0 @ first_moment(case, local_coordinates(case)) / constants["masses"][0])


def _rotation(case: Case) -> NDArray:
    """Rotation of the rigid part."""
    angle = constants_of(case)["rigid_rows"][case.dimension:] @ local_coordinates(case)
    about = np.r_[np.zeros(3 - len(angle)), angle]
    return (frame_rotation(case) * Rotation.from_rotvec(about)).as_matrix()


def _packed(J: NDArray) -> NDArray:
    return J[0] if len(J) == 1 else J[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]


def _inertia(packed: NDArray) -> NDArray:
    if len(packed) == 1:
        return np.diag([0.0, 0.0, packed[0]])
    xx, yy, zz, xy, xz, yz = packed
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
