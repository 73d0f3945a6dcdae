"""Small motion about a state, at rest or in steady rotation: exact matrices and eigenvalues.

In axes that rotate with the angular velocity W of the state, a position moves as x + xi, a rotation
as R exp(theta). Then dv = xi' + W x xi, da = xi'' + 2 W x xi' + W x (W x xi), and with the material
W of the node dOmega = theta' + W x theta, dA = theta'' + W x theta'.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.linalg import LinAlgError, eig, eigh, null_space
from scipy.sparse import csc_matrix

from sebody import inputs
from sebody.analysis import user_faults
from sebody.analysis.evaluation import matrix
from sebody.analysis.simulation import Simulation
from sebody.assembly.numbering import coordinates
from sebody.engine.evaluate import to_body_axes
from sebody.engine.state import EVALUATED, WANTED
from sebody.errors import InputError
from sebody.results.result import Result


class Spin:
    """A steady rotation of everything about the origin."""

    def __init__(self, velocity: NDArray, planar: bool):
        self.velocity, self.planar = velocity, planar

    @classmethod
    def of(cls, run: Simulation | Result, velocity: ArrayLike | None) -> "Spin":
        """The spin a user gives, none by default.

        Raises
        ------
        InputError
            The wrong shape or no numbers, or rigid links that rotate.
        """
        planar = run.model.planar
        if velocity is None:
            velocity = 0.0 if planar else np.zeros(3)
        spin = cls(np.array(inputs.number(velocity, "spin", remedy="give a number")) if planar else
                   inputs.vector(velocity, "spin", 3, remedy="give three numbers"), planar)
        if spin.rotates and run.numbering.dependent:
            raise InputError(f"{run.numbering.dependent[0].name} hangs on a rigid link, which the "
                             "tangents of turning states leave out: give it a body of its own")
        return spin

    def times(self, factor: float) -> "Spin":
        """The spin multiplied by a factor."""
        return Spin(factor * self.velocity, self.planar)

    @property
    def rotates(self) -> bool:
        """Whether the angular velocity is not zero."""
        return bool(np.any(self.velocity))

    def move(self, run: Simulation) -> None:
        """Set velocities and accelerations to those of the rotation, of fixed nodes, too."""
        state, numbering = run.state, run.numbering
        state.v[:], state.a[:] = 0.0, 0.0
        for node in run.model.nodes.values():
            if node.position is not None and id(node.position) in numbering.triplets:
                at = coordinates(numbering, node.position)
                state.v[at] = self.cross(state.q[at])
                state.a[at] = self.cross(state.v[at])
            if node.rotation is not None and id(node.rotation) in numbering.triplets:
                at = coordinates(numbering, node.rotation)
                state.v[at] = self.velocity if self.planar else self._material(run, node.rotation)

    def cross(self, x: NDArray) -> NDArray:
        """``W x x``."""
        if self.planar:
            return float(self.velocity) * np.array([-x[1], x[0]])
        return np.cross(self.velocity, x)

    def _material(self, run: Simulation | Result, rotation) -> NDArray:
        k = run.numbering.rotations[id(rotation)]
        return run.state.R[9 * k:9 * k + 9].reshape(3, 3).T @ self.velocity

    def operators(self, run: Simulation | Result) -> tuple[csc_matrix, csc_matrix, csc_matrix]:
        """Derivatives of velocity and acceleration by motion, and of acceleration by its rate."""
        n = run.numbering.free
        velocity, place, rate = (np.zeros((n, n)) for _ in range(3))
        frame_of = dict(run.system.rotated.tolist())
        for node in run.model.nodes.values():
            for triplet in (node.position, node.rotation):
                at = (None if triplet is None or id(triplet) not in run.numbering.triplets
                      else coordinates(run.numbering, triplet))
                if at is None or at[0] >= n:
                    continue
                block = np.ix_(at, at)
                if triplet is node.position:
                    own = self._in_axes(run, frame_of.get(at[0]))
                    velocity[block], place[block], rate[block] = own, own @ own, 2.0 * own
                elif not self.planar:
                    velocity[block] = rate[block] = _skew(self._material(run, triplet))
        return csc_matrix(velocity), csc_matrix(place), csc_matrix(rate)

    def _in_axes(self, run: Simulation | Result, frame: int | None) -> NDArray:
        """The operator ``W x`` in the axes a position is solved for in."""
        if self.planar:
            return float(self.velocity) * np.array([[0.0, -1.0], [1.0, 0.0]])
        if frame is None:
            return _skew(self.velocity)
        axes = run.state.frames[9 * frame:9 * frame + 9].reshape(3, 3)
        return _skew(axes.T @ self.velocity)


def _skew(a: NDArray) -> NDArray:
    return np.array([[0.0, -a[2], a[1]], [a[2], 0.0, -a[0]], [-a[1], a[0], 0.0]])


def derivative(run: Simulation | Result, mass: float, damping: float,
               stiffness: float) -> csc_matrix:
    """Weighted sum of the exact derivatives, in body axes.

    Weights are those of the derivatives with respect to accelerations, velocities, and positions
    and rotations. Constraints go with the last: in a rotating state the columns of the others are
    combined with `Spin.operators`.
    """
    state = run.state
    state.control[WANTED] = EVALUATED     # a run that goes on needs its own matrix again
    state.T[:] = np.tile(np.eye(3).ravel(), len(state.T) // 9)
    return matrix(run.system, state, "the state", mass=mass, damping=damping,
                  stiffness=stiffness, constraint=stiffness)


def rotating(run: Simulation | Result, spin: Spin) -> tuple[csc_matrix, NDArray]:
    """Tangent stiffness in axes that rotate with the spin, and the residual."""
    stiffness = derivative(run, 0.0, 0.0, 1.0)
    residual = run.state.residual.copy()
    to_body_axes(run.system, run.state.frames, residual, False)
    if spin.rotates:
        velocity, place, _ = spin.operators(run)
        stiffness = (stiffness + derivative(run, 0.0, 1.0, 0.0) @ velocity
                     + derivative(run, 1.0, 0.0, 0.0) @ place)
    return csc_matrix(stiffness), residual[:run.numbering.free]


class Linearization(NamedTuple):
    """``mass xi'' + damping xi' + stiffness xi = 0`` for motion ``free @ xi`` of the unknowns.

    The columns of `free` are an orthonormal basis of what the constraints allow.
    """

    mass: NDArray
    damping: NDArray
    stiffness: NDArray
    free: NDArray


def linearize(run: Simulation | Result, spin: ArrayLike | None = None) -> Linearization:
    """Matrices of small motion about the state a run, or an equilibrium, has reached.

    Parameters
    ----------
    spin : (3,) array_like or float, optional
        Angular velocity of the axes the motion is described in: that of a steady rotation.
        Without one, the matrices of a moving state are those of the instant.

    Raises
    ------
    InputError
        A state that cannot be evaluated, a wrong spin, or one with rigid links.
    """
    inputs.instance(run, "run", Simulation | Result, "give a Simulation, or the Result of a run or "
                    "of an equilibrium")
    steady = Spin.of(run, spin)
    user_faults.forget(run.model)
    stiffness, _ = rotating(run, steady)
    mass, damping = derivative(run, 1.0, 0.0, 0.0), derivative(run, 0.0, 1.0, 0.0)
    if steady.rotates:
        damping = damping + mass @ steady.operators(run)[2]
    K, C, M = (A.toarray() for A in (stiffness, damping, mass))
    if not all(np.isfinite(A).all() for A in (K, C, M)):
        did = user_faults.fault(run.model, -np.inf) or "its forces are not finite"
        raise InputError(f"the state cannot be evaluated: {did}")
    n = len(K)
    multipliers = np.flatnonzero(run.system.is_multiplier[:n])
    moving = np.setdiff1d(np.arange(n), multipliers)
    basis = null_space(K[np.ix_(multipliers, moving)]) if multipliers.size else np.eye(len(moving))
    free = np.zeros((n, basis.shape[1]))
    free[moving] = basis
    return Linearization(*(free.T @ A @ free for A in (M, C, K)), free)


class Vibrations(NamedTuple):
    """Small undamped vibrations."""

    omega: NDArray      # (m,) angular frequencies, ascending [1/time]
    shapes: NDArray     # (unknowns, m) mass-normalised, in the axes of the unknowns


def vibrations(run: Simulation | Result, count: int | None = None) -> Vibrations:
    """Undamped vibrations about the state of a simulation at rest, constraints included.

    Raises
    ------
    InputError
        The state moves, or is not stable: a square of a frequency is negative.
    """
    if count is not None:
        count = inputs.integer(count, "count", least=1)
    inputs.instance(run, "run", Simulation | Result, "give a Simulation or a Result")
    if np.abs(run.state.v).max() > 0:
        raise InputError("the state moves: vibrations are about states at rest, modes about "
                         "moving ones")
    M, _, K, free = linearize(run)
    try:
        squares, shapes = eigh((K + K.T) / 2, (M + M.T) / 2)
    except LinAlgError as error:
        raise InputError("the model has motions without mass, which have no frequency: give every "
                         "rotation inertia, or use modes") from error
    if squares[0] < -100 * np.finfo(float).eps * squares[-1]:
        raise InputError(f"the state is not stable: the lowest square of a frequency is "
                         f"{squares[0]:.4g}")
    return Vibrations(np.sqrt(np.maximum(squares, 0.0))[:count], free @ shapes[:, :count])


class Modes(NamedTuple):
    """Small damped or gyroscopic motion ``shape exp(value t)``, one of each conjugate pair."""

    values: NDArray     # (m,) complex, by ascending frequency [1/time]
    shapes: NDArray     # (unknowns, m) complex, of unit length

    @property
    def omega(self) -> NDArray:
        """Angular frequencies [1/time]."""
        return self.values.imag

    @property
    def growth(self) -> NDArray:
        """Rates of growth, negative where the motion decays [1/time]."""
        return self.values.real


def modes(run: Simulation | Result, spin: ArrayLike | None = None) -> Modes:
    """Eigenvalues and shapes about a state, from the exact tangents; see `linearize`."""
    M, C, K, free = linearize(run, spin)
    m = len(M)
    identity, zero = np.eye(m), np.zeros((m, m))
    values, vectors = eig(np.block([[zero, identity], [-K, -C]]),
                          np.block([[identity, zero], [zero, M]]))
    kept = np.flatnonzero(values.imag >= 0.0)
    order = kept[np.lexsort((values[kept].real, values[kept].imag))]
    shapes = free @ vectors[:m, order]
    return Modes(values[order], shapes / np.maximum(np.linalg.norm(shapes, axis=0), 1e-300))
