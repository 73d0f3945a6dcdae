"""Kernels in generic states, and the numerical derivatives they are compared with.

Differences are of sixth order, since axial stiffness makes central ones lose the digits asked for.
"""

from collections.abc import Iterable, Mapping
from types import ModuleType
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial.transform import Rotation

from sebody.basics.errors import InputError
from sebody.compiler.decorators import compiled
from sebody.contract.counts import (
    bound_counts,
    first_mode,
    first_rotation,
    floating_counts,
    rigid_part_counts,
    scratch_size,
    superelement_counts,
)
from sebody.contract.layout import (
    AT_POSITIONS,
    AT_ROTATIONS,
    ENERGY,
    INDEX,
    KINETIC,
    POWERS,
    RESIDUAL,
    TANGENT,
    Row,
)
from sebody.generated.options import INERTIA_OPTIONS
from sebody.kernels.abi import Arguments, call_kernel

STENCIL = ((1, 0.75), (2, -0.15), (3, 1.0 / 60.0))      # sixth-order central differences
LIMIT = 1e-7
STATES = 2


class CheckRow(NamedTuple):
    """A criterion in one state of a kernel."""

    kernel: str
    criterion: str
    state: int
    error: float            # relative to the largest entry
    slope: float | None     # order of convergence of a difference that the formulation has
    limit: float            # of the error from above, or of the slope from below
    nodes: tuple[int, ...] = ()     # of a general kernel: its positions, rotations and modes

    @property
    def passed(self) -> bool:
        """Tell whether error or slope is within the limit."""
        return self.error <= self.limit if self.slope is None else self.slope > self.limit


class Case(NamedTuple):
    """A kernel with a generic state to evaluate it in."""

    module: ModuleType
    n: int
    index: NDArray
    constants: NDArray
    q: NDArray
    R: NDArray
    v: NDArray
    a: NDArray
    reference: NDArray
    frames: NDArray
    field: NDArray = np.zeros(3)
    loads: NDArray = np.zeros(3)    # amplitude and two rates
    slaved: int = 0             # of option C: coordinates that follow the others
    resultants: int = 0         # and stress resultants of second order
    damped: bool = False        # whether the constants of options C and D have its damping
    series: int = 0             # of a load on a body: columns of a series
    path: int = 0               # of a point on a path: numbers of the path

    @property
    def planar(self) -> bool:
        """Tell whether the motion is planar: angles among q in place of rotation matrices."""
        return self.module.PLANAR

    @property
    def dimension(self) -> int:
        """Coordinates of a position."""
        return 2 if self.planar else 3

    @property
    def n_positions(self) -> int:
        """Nodes that keep their position."""
        return int(self.index[AT_POSITIONS])

    @property
    def n_rotations(self) -> int:
        """Nodes that keep their rotation."""
        return int(self.index[AT_ROTATIONS])

    @property
    def first_rotation(self) -> int:
        """The first rotation among the unknowns; elements may have scalars before them."""
        own = getattr(self.module, "ROTATIONS", None)
        return first_rotation(self.n_positions, self.planar) if own is None else own

    @property
    def first_mode(self) -> int:
        """The first internal mode among the unknowns."""
        return first_mode(self.n_positions, self.n_rotations, self.planar)

    @property
    def own(self) -> int:
        """Unknowns of the body; behind them are those of a node that carries a surface, or a point
        on a path, or a node that turns with it, with its way and multipliers.
        """
        if hasattr(self.module, "WAY"):
            equations = self.module.MULTIPLIERS
            return self.n - (equations if self.planar else 3) - 1 - equations
        return self.n - (self.dimension + (1 if self.planar else 3)) * self.carriers

    @property
    def carriers(self) -> int:
        """Nodes behind those of the body."""
        return getattr(self.module, "CARRIERS", 0)

    @property
    def counts(self) -> dict[str, int]:
        """The counts that sizes of the constants are products of."""
        counts = superelement_counts(self.n_positions, self.n_rotations, self.planar, self.own)
        option = INERTIA_OPTIONS.get(getattr(self.module, "INERTIA", ""))
        if option is not None and option.field:
            return counts | bound_counts(
                self.n_positions, self.n_rotations, self.planar) | floating_counts(
                self.planar, self.n, self.slaved, self.resultants, self.damped)
        return counts | rigid_part_counts(self.planar, self.n, self.damped) | {
            "series": self.series, "path": self.path}

    @property
    def row(self) -> Row:
        """The row of constants that the kernel reads."""
        return Row(self.module.__name__, self.module.CONSTANTS)

    @property
    def rotations(self) -> list[int]:
        """First unknown of each rotation DOF block."""
        if not self.R.size:
            return []
        return [*(self.first_rotation + 3 * j for j in range(self.n_rotations)),
                *[self.own + self._before] * self.carriers]

    @property
    def _before(self) -> int:
        """Coordinates of a node behind the body before its rotation."""
        return 0 if hasattr(self.module, "WAY") else self.dimension

    @property
    def positions(self) -> list[int]:
        """First unknown of each position DOF block."""
        return [*range(0, self.first_rotation, self.dimension), *[self.own] * self.carriers]


def index_row(n: int, positions: int, rotations: int) -> NDArray:
    """The index row of a kernel's only element."""
    values = {"constants": 0, "frame": 0, "port": 0, "positions": positions,
              "rotations": rotations, "nodes": range(rotations), "unknowns": range(n)}
    return INDEX.pack({"N_ROTATIONS": rotations, "n": n}, values).astype(np.int64)


def constants_of(case: Case) -> dict[str, NDArray]:
    """The constants of a case by name."""
    return case.row.unpack(case.counts, case.constants)


def with_constants(case: Case, values: Mapping[str, ArrayLike]) -> Case:
    """The case with constants given by name."""
    return case._replace(constants=case.row.pack(case.counts, values))


def changed(case: Case, **values: ArrayLike) -> Case:
    """The case with some of its constants replaced."""
    return with_constants(case, constants_of(case) | values)


@compiled
def _call(address, task, stride, width, arguments):
    return call_kernel(address, task, 1, stride, width, arguments)


def arguments(case: Case, coefficients: Iterable[float] = (0, 0, 0, 1, 1)) -> Arguments:
    """Arguments of the kernel of a case for one element, results zero."""
    n = case.n
    return Arguments(
        index=case.index, constants=case.constants, q=case.q, R=case.R, v=case.v, a=case.a,
        references=case.reference, frames=case.frames.copy(),
        T=np.tile(np.eye(3).ravel(), max(len(case.rotations), 1)), loads=case.loads,
        coefficients=np.array([*coefficients, *case.field], dtype=float), forces=np.zeros(n),
        matrices=np.zeros(n * n),
        work=np.zeros(scratch(case)),
        energies=np.zeros(POWERS + 1))


def called(case: Case, task: int, given: Arguments) -> int:
    """Call the kernel of a case; returns its status."""
    return _call(case.module.kernel.address, task, len(case.index), case.n, given)


def scratch(case: Case) -> int:
    """Scratch memory of a kernel; elements have no squares."""
    squares = getattr(case.module, "WORK_SQUARES", 0)
    return scratch_size(case.module.WORK_ROWS, squares, case.n, max(case.n_rotations, 1))


def evaluate(case: Case, task: int, coefficients: Iterable[float] = (0, 0, 0, 1, 1)
             ) -> tuple[NDArray, NDArray, NDArray]:
    """Forces, matrix and energies of a kernel in the state of a case."""
    n, read = case.n, arguments(case, coefficients)
    status = called(case, task, read)
    if status:
        raise InputError(f"kernel {case.module.__name__} refuses the check's state (status "
                         f"{status})")
    return (read.forces, _in_global_axes(read.matrices.reshape(n, n), read.frames, case),
            read.energies)


def _in_global_axes(J: NDArray, frame: NDArray, case: Case) -> NDArray:
    """Matrix with positions rotated to global axes, from those of the frame of a superelement."""
    if case.own < case.n or hasattr(case.module, "MOVING") or not hasattr(case.module, "FRAME"):
        return J
    turn, d = np.eye(len(J)), case.dimension
    R0 = frame.reshape(3, 3)[:d, :d]
    for i in range(0, case.first_rotation, d):
        turn[i:i + d, i:i + d] = R0
    return turn @ J @ turn.T


def moved(case: Case, direction: NDArray, size: float) -> Case:
    """The case with its configuration moved: rotations multiplied, the rest added."""
    q, R = case.q + size * direction, case.R.copy()
    for j, at in enumerate(case.rotations):
        turn = Rotation.from_rotvec(size * direction[at:at + 3]).as_matrix()
        R[9 * j:9 * j + 9] = (R[9 * j:9 * j + 9].reshape(3, 3) @ turn).ravel()
    return case._replace(q=q, R=R)


def derivative(function, step: float):
    """Sixth-order central derivative of a function of one number at zero."""
    return sum(w * (function(k * step) - function(-k * step)) for k, w in STENCIL) / step


def gradient(case: Case, function, step: float) -> NDArray:
    """Derivatives of a function of the case along every coordinate, as columns."""
    return np.array([derivative(lambda s, d=d: function(moved(case, d, s)), step)
                     for d in np.eye(case.n)]).T


def difference(a: NDArray, b: NDArray) -> float:
    """Largest difference relative to the largest entry."""
    return float(np.abs(a - b).max() / max(np.abs(b).max(), 1e-300))


def tangent_rate(case: Case) -> float:
    """Velocity tangent (61)-(63) against differences; the force is quadratic in the velocity."""
    columns = [(evaluate(case._replace(v=case.v + d), RESIDUAL)[0]
                - evaluate(case._replace(v=case.v - d), RESIDUAL)[0]) / 2 for d in np.eye(case.n)]
    return difference(evaluate(case, TANGENT, (0, 1, 0, 1, 1))[1], np.array(columns).T)


def tangent_mass(case: Case) -> float:
    """Mass (48), (60) against differences; the force is linear in the acceleration."""
    columns = [evaluate(case._replace(a=case.a + d), RESIDUAL)[0]
               - evaluate(case, RESIDUAL)[0] for d in np.eye(case.n)]
    return difference(evaluate(case, TANGENT, (1, 0, 0, 1, 1))[1], np.array(columns).T)


def mode_coupling(case: Case) -> float:
    """Largest force on a mode by the motion of another one, relative to all it causes.

    From differences of the force, with S, M and C without entries between modes. Assembly leaves
    these entries of the matrix out where the inertia option declares `modes_apart`.
    """
    inner = np.arange(case.n) >= case.first_mode
    between = inner[:, None] & inner & ~np.eye(case.n, dtype=bool)
    constants = constants_of(case)
    case = changed(case, **{name: np.where(between, 0.0, constants[name])
                            for name in ("S", "M", "C") if name in constants})
    motions = (lambda d: moved(case, d, 1.0), lambda d: case._replace(v=case.v + d),
               lambda d: case._replace(a=case.a + d))
    sizes = [0.0]
    for motion in motions:
        for d, others in zip(np.eye(case.n)[inner], between[inner], strict=True):
            changes = derivative(lambda s, d=d, motion=motion: evaluate(motion(s * d),
                                                                        RESIDUAL)[0], 0.1)
            sizes.append(np.abs(changes[others]).max() / np.abs(changes).max())
    return float(max(sizes))


def momenta(case: Case) -> NDArray:
    """``dT/dv`` by central differences, exact since T is quadratic."""
    def kinetic(v):
        return evaluate(case._replace(v=v), ENERGY)[2][KINETIC]
    return np.array([(kinetic(case.v + d) - kinetic(case.v - d)) / 2 for d in np.eye(case.n)])


def along_path(case: Case, t: float) -> Case:
    """The case at time t on a path with the given velocity and acceleration at t = 0."""
    step = case.v * t + case.a * t * t / 2
    v = case.v + case.a * t
    for at in case.rotations:
        psi, rate = step[at:at + 3], v[at:at + 3].copy()
        angle = np.linalg.norm(psi)
        if angle > 0:       # Omega = T(psi) psidot
            once = np.cross(psi, rate)
            v[at:at + 3] = (rate - (1 - np.cos(angle)) / angle**2 * once
                            + (angle - np.sin(angle)) / angle**3 * np.cross(psi, once))
    return moved(case, step, 1.0)._replace(v=v) if t else case
