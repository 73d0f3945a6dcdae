"""Generic bodies of option C, and their energies from the definition."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sebody.assembly.floating import determining, frame_conditions, packed
from sebody.generated.options import INERTIA_OPTIONS
from sebody.kernels.layout import axes_of
from sebody.reduction.invariants import InertiaInvariants
from sebody.studies.check.definitions import frame_rotation, frame_traits, local_coordinates
from sebody.studies.check.states import Case, along_path, constants_of, derivative

FOLLOWING = (3, 2), (0, 0)      # slaved coordinates and resultants, by state: gamma and plain C


def is_floating(case: Case) -> bool:
    """Whether the kernel has the kinetic energy of the displacement field."""
    return INERTIA_OPTIONS[case.module.INERTIA].field


def generic_invariants(random: np.random.Generator, n: int, slaved: int, resultants: int,
                       planar: bool, mass: float) -> InertiaInvariants:
    """Any constants: no identity of the forces needs those of a real body."""
    axes = axes_of(planar)
    D, r, N = axes["D"], axes["lines"] - axes["D"] - axes["pairs"], n + slaved

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
    free = case.counts["free"]
    A, B = random.normal(size=(2, free, free))
    conditions = frame_conditions(frame_traits(case.module), case.counts, values)
    return packed(generic_invariants(random, free, case.slaved, case.resultants, case.planar,
                                     values["masses"][0]), A @ A.T, determining(conditions)[0],
                  damping * B @ B.T if case.damped else None)


def without_stiffness(case: Case) -> dict[str, NDArray]:
    """Constants of a body without strain energy."""
    constants = constants_of(case)
    return {name: np.zeros_like(constants[name]) for name in ("Sz", "E", "Ghat")}


def strain(case: Case, y: NDArray) -> float:
    """``V`` of the local coordinates."""
    constants = constants_of(case)
    y = _free(case, y)
    lam, E, Ghat = constants["lam"], constants["E"], _stack(constants["Ghat"], case.resultants)
    linear = lam * (E.T @ y)
    s = linear + np.einsum("i,eij,j->e", y, Ghat, y) / 2
    return float(y @ constants["Sz"] @ y / 2 + np.sum((s**2 - linear**2) / (2 * lam)))


def stiffness(case: Case, y: NDArray) -> NDArray:
    """Second derivatives of the strain energy by the local coordinates, (n, n)."""
    constants, whole = constants_of(case), np.zeros((case.n, case.n))
    kept, y = constants["kept"].astype(int), _free(case, y)
    lam, E, Ghat = constants["lam"], constants["E"], _stack(constants["Ghat"], case.resultants)
    gradients = lam * E + np.einsum("eij,j->ie", Ghat, y)
    s = lam * (E.T @ y) + np.einsum("i,eij,j->e", y, Ghat, y) / 2
    whole[np.ix_(kept, kept)] = (constants["Sz"] - E @ np.diag(lam) @ E.T
                                 + gradients / lam @ gradients.T
                                 + np.einsum("e,eij->ij", s / lam, Ghat))
    return whole


def first_moment(case: Case, y: NDArray) -> NDArray:
    """Of the deformed body, about the origin of the frame, in its axes."""
    constants = constants_of(case)
    return constants["c0"] + constants["moment_columns"][:, :case.dimension].T @ _whole(case, y)


def kinetic_terms(case: Case) -> NDArray:
    """Terms of ``T``: of the frame's velocity, and of the rates of z by differences."""
    h, d = 0.003, case.dimension
    constants, R0 = constants_of(case), frame_rotation(case).as_matrix()
    z = _whole(case, local_coordinates(case))
    zd = derivative(lambda t: _whole(case, local_coordinates(along_path(case, t))), h)
    turned = R0.T @ derivative(lambda t: frame_rotation(along_path(case, t)).as_matrix(), h)
    w = np.array([turned[2, 1], turned[0, 2], turned[1, 0]])
    velocities = case.v[:case.first_rotation].reshape(-1, d)
    v = np.r_[constants["alphas"] @ velocities @ R0[:d, :d], np.zeros(3 - d)]
    c = np.r_[first_moment(case, local_coordinates(case)), np.zeros(3 - d)]
    moments = constants["moment_columns"]
    pushed = np.r_[moments[:, :d].T @ zd, np.zeros(3 - d)]
    J, B = _inertia(case, z), _coupling(case, z)
    w_kept = w[2:] if case.planar else w
    return np.array([constants["masses"][0] * v @ v / 2, v @ np.cross(w, c), v @ pushed,
                     w_kept @ J @ w_kept / 2, w_kept @ B @ zd, zd @ constants["Mz"] @ zd / 2])


def _free(case: Case, y: NDArray) -> NDArray:
    return y[constants_of(case)["kept"].astype(int)]


def _whole(case: Case, y: NDArray) -> NDArray:
    """``z = (y, eta)``, of the coordinates that determine the others."""
    y = _free(case, y)
    Q = _stack(constants_of(case)["followers"], case.slaved)
    return np.r_[y, np.einsum("i,bij,j->b", y, Q, y) / 2]


def _inertia(case: Case, z: NDArray) -> NDArray:
    constants, pairs = constants_of(case), axes_of(case.planar)["pairs"]
    blocks = _stack(constants["quadratics"], axes_of(case.planar)["blocks"])
    packed = (constants["J0"] + constants["moment_columns"][:, -pairs:].T @ z
              + np.einsum("i,bij,j->b", z, blocks[:pairs], z))
    if case.planar:
        return packed.reshape(1, 1)
    xx, yy, zz, xy, xz, yz = packed
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def _coupling(case: Case, z: NDArray) -> NDArray:
    constants, axes = constants_of(case), axes_of(case.planar)
    pairs, D = axes["pairs"], axes["D"]
    blocks = _stack(constants["quadratics"], axes["blocks"])
    turns = (len(blocks) - pairs) // 2
    return constants["moment_columns"][:, D:D + turns].T + blocks[pairs:pairs + turns] @ z


def _stack(columns: NDArray, count: int) -> NDArray:
    """Matrices from columns that take turns."""
    n = len(columns)
    return columns.reshape(n, n, count).transpose(2, 0, 1)
