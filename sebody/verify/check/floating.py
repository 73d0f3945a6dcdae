"""Generic bodies of option C, and their energies from the definition."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial.transform import Rotation

from sebody.assembly.floating import Free, frame_conditions, free_coordinates, packed
from sebody.contract.counts import axes_of
from sebody.generated.options import INERTIA_OPTIONS
from sebody.kernels.packed import unpack
from sebody.reduction.invariants import InertiaInvariants
from sebody.verify.check.definitions import frame_rotation, local_coordinates
from sebody.verify.check.states import Case, along_path, constants_of, derivative

FOLLOWING = (3, 2), (0, 0)      # slaved coordinates and resultants, by state: gamma and plain C


def is_floating(case: Case) -> bool:
    """Tell whether the kernel has the kinetic energy of the displacement field."""
    return INERTIA_OPTIONS[case.module.INERTIA].field


def generic_invariants(random: np.random.Generator, n: int, slaved: int, resultants: int,
                       planar: bool, mass: float) -> InertiaInvariants:
    """Any constants: no identity of the forces needs those of a real body."""
    axes = axes_of(planar)
    D, r, N = axes["D"], axes["turns"], n + slaved

    def any_of(*shape):
        return random.normal(size=shape)

    def symmetric(*shape):
        A = any_of(*shape)
        return A + A.swapaxes(-1, -2)
    J2 = symmetric(r, r, N, N)
    return InertiaInvariants(
        mass, any_of(D), any_of(D, N), symmetric(r, r), any_of(r, N), any_of(r, r, N),
        any_of(r, N, N), J2 + J2.swapaxes(0, 1), symmetric(N, N), symmetric(slaved, n, n),
        1.0 + random.uniform(size=resultants), any_of(n, resultants), symmetric(resultants, n, n))


def generic_constants(random: np.random.Generator, case: Case,
                      values: Mapping[str, ArrayLike], damping: float) -> dict[str, ArrayLike]:
    """Values of the constants of option C by name, with the conditions of the frame."""
    free, D = case.counts["free"], case.dimension
    A, B = random.normal(size=(2, free, free))
    conditions = frame_conditions(case.module.FRAME, case.counts, values)
    axes = random.normal(size=3) * ([0, 0, 1] if case.planar else 1)
    coordinates = free_coordinates(conditions, case.counts,
                                   Rotation.from_rotvec(axes).as_matrix()[:D, :D])[0]
    return packed(generic_invariants(random, free, case.slaved, case.resultants, case.planar,
                                     values["masses"][0]), A @ A.T,
                  coordinates._replace(order=random.permutation(free)),
                  damping * B @ B.T if case.damped else None)


def without_stiffness(case: Case) -> dict[str, NDArray]:
    """Constants of a body without strain energy."""
    constants = constants_of(case)
    return {name: np.zeros_like(constants[name]) for name in ("stretched", "E")}


def strain(case: Case, y: NDArray) -> float:
    """``V`` of the local coordinates."""
    constants, y = constants_of(case), _coordinates(case).matrix(case.n) @ y
    lam, E, stretched = constants["lam"], constants["E"], matrices(case, "stretched")
    Ghat, S = stretched[:-1], stretched[-1]
    linear = lam * (E.T @ y)
    s = linear + np.einsum("i,eij,j->e", y, Ghat, y) / 2
    return float(y @ S @ y / 2 + np.sum((s**2 - linear**2) / (2 * lam)))


def stiffness(case: Case, y: NDArray) -> NDArray:
    """Second derivatives of the strain energy by the local coordinates, (n, n)."""
    constants, of_y = constants_of(case), _coordinates(case).matrix(case.n)
    y = of_y @ y
    lam, E, stretched = constants["lam"], constants["E"], matrices(case, "stretched")
    Ghat, S = stretched[:-1], stretched[-1]
    gradients = lam * E + np.einsum("eij,j->ie", Ghat, y)
    s = lam * (E.T @ y) + np.einsum("i,eij,j->e", y, Ghat, y) / 2
    return of_y.T @ (S - E @ np.diag(lam) @ E.T
                     + gradients / lam @ gradients.T
                     + np.einsum("e,eij->ij", s / lam, Ghat)) @ of_y


def first_moment(case: Case, y: NDArray) -> NDArray:
    """First moment of the deformed body, about the origin of the frame, in its axes."""
    constants = constants_of(case)
    moment = constants["c0"] + constants["moment_columns"][:, :case.dimension].T @ _whole(case, y)
    return _coordinates(case).turn @ moment


def kinetic_terms(case: Case) -> NDArray:
    """Terms of ``T``: of the frame's velocity, and of the rates of z by differences."""
    h, d = 0.003, case.dimension
    constants, R0 = constants_of(case), frame_rotation(case).as_matrix()
    z = _whole(case, local_coordinates(case))
    zd = derivative(lambda t: _whole(case, local_coordinates(along_path(case, t))), h)
    rotated = R0.T @ derivative(lambda t: frame_rotation(along_path(case, t)).as_matrix(), h)
    axes = np.eye(3)
    axes[:d, :d] = _coordinates(case).turn
    w = axes.T @ [rotated[2, 1], rotated[0, 2], rotated[1, 0]]
    velocities = case.v[:case.first_rotation].reshape(-1, d)
    v = axes.T @ np.r_[constants["alphas"] @ velocities @ R0[:d, :d], np.zeros(3 - d)]
    moments = constants["moment_columns"]
    c = np.r_[constants["c0"] + moments[:, :d].T @ z, np.zeros(3 - d)]
    pushed = np.r_[moments[:, :d].T @ zd, np.zeros(3 - d)]
    J, B = _inertia(case, z), _coupling(case, z)
    w_kept = w[2:] if case.planar else w
    return np.array([constants["masses"][0] * v @ v / 2, v @ np.cross(w, c), v @ pushed,
                     w_kept @ J @ w_kept / 2, w_kept @ B @ zd,
                     zd @ matrices(case, "Mz")[0] @ zd / 2])


def matrices(case: Case, name: str) -> NDArray:
    """Packed constants as matrices, one after the other."""
    return unpack(constants_of(case)[name], _shape(case, name))


def _shape(case: Case, name: str) -> tuple[int, int, int]:
    part = next(part for part in case.row.parts if part.name == name)
    return tuple(case.counts[size] if isinstance(size, str) else size for size in part.shape)


def _coordinates(case: Case) -> Free:
    constants = constants_of(case)
    turn = constants["turn"]
    if case.planar:
        turn = np.array([[turn[0], -turn[1]], [turn[1], turn[0]]])
    return Free(turn.reshape(case.dimension, -1), constants["axes"],
                constants["order"].astype(int))


def _whole(case: Case, y: NDArray) -> NDArray:
    """``z = (y, eta)``, of the coordinates that determine the others."""
    y = _coordinates(case).matrix(case.n) @ y
    return np.r_[y, np.einsum("i,bij,j->b", y, matrices(case, "followers"), y) / 2]


def _inertia(case: Case, z: NDArray) -> NDArray:
    constants, pairs = constants_of(case), axes_of(case.planar)["pairs"]
    packed = (constants["J0"] + constants["moment_columns"][:, -pairs:].T @ z
              + np.einsum("i,bij,j->b", z, matrices(case, "couplings")[:pairs], z))
    if case.planar:
        return packed.reshape(1, 1)
    xx, yy, zz, xy, xz, yz = packed
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def _coupling(case: Case, z: NDArray) -> NDArray:
    constants, axes = constants_of(case), axes_of(case.planar)
    D, turns = axes["D"], axes["turns"]
    first = axes["pairs"]
    couplings = matrices(case, "couplings")[first:first + turns]
    return constants["moment_columns"][:, D:D + turns].T + couplings @ z
