"""Small motion about a state, at rest or in steady rotation: exact matrices and eigenvalues."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from types import MappingProxyType
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.linalg import null_space

from sebody.assembly.numbering import hidden_states
from sebody.basics import inputs
from sebody.basics.errors import InputError, LimitWarning
from sebody.basics.tabular import brief, counted
from sebody.reduction.massless import Condensed, condensed
from sebody.results.contact_states import states
from sebody.results.result import Result
from sebody.runs import user_faults
from sebody.runs.limits.watch import Watch
from sebody.runs.rotating_frame import Spin, fastest_spin
from sebody.runs.simulation import Simulation
from sebody.runs.state_derivatives import derivative, turning
from sebody.runs.teeth import Gears, teeth_remarks
from sebody.small_motion import mode_tables
from sebody.small_motion.eigenvalues import NEGLIGIBLE, eigenvalues, undamped
from sebody.small_motion.pressed_friction import without_multipliers
from sebody.small_motion.shapes import Shapes

SPINS = 1e-3        # of the lowest eigenvalue: a slower rotation changes nothing that one sees


def small_motion(run: Simulation | Result, spin: Spin) -> tuple[NDArray, NDArray, NDArray]:
    """Mass, damping and stiffness of all unknowns, multipliers included, in their own axes.

    Raises
    ------
    InputError
        A state that cannot be evaluated.
    """
    if run.system is None:
        raise InputError("the result was read from a file, which holds no compiled functions: give "
                         "that of a run or of an equilibrium")
    watch = run.watch if isinstance(run, Simulation) else Watch()
    watch.look(run.model, run.numbering, run.state.now[None].copy())
    user_faults.forget(run.model)
    matrices = (turning(run, spin) if spin.rotates else
                tuple(derivative(run, *weights) for weights in np.eye(3)))
    M, C, K = (A.toarray() for A in matrices)
    did = user_faults.fault(run.model, -np.inf)     # which may concern what is fixed alone
    if not (did or all(np.isfinite(A).all() for A in (K, C, M))):
        did = "its forces are not finite"
    if did:
        raise InputError(f"the state cannot be evaluated: {did}")
    gears = Gears(run.model, run.numbering, *run.arrays_of_loop)
    for key, message in teeth_remarks(gears, M, K).items():
        watch.say(key, message)
    return M, C, K


class Linearization(NamedTuple):
    """``mass xi'' + damping xi' + stiffness xi = 0`` for motion ``free @ xi`` of the unknowns.

    The columns of `free` are an orthonormal basis of what the constraints allow. Forces of
    constraints do no work on these motions, but where friction slides they change it: these changes
    are in the matrices, which are not symmetric then. `contacts` says of
    every contact, stop and friction of the model what the matrices took it for: ``sticks``,
    ``slides``, ``presses`` or ``open``.
    """

    mass: NDArray
    damping: NDArray
    stiffness: NDArray
    free: NDArray
    contacts: Mapping[str, str] = MappingProxyType({})

    __repr__ = brief


def linearize(run: Simulation | Result, spin: ArrayLike | None = None) -> Linearization:
    """Matrices of small motion about the state a run, or an equilibrium, has reached.

    Parameters
    ----------
    spin : (3,) array_like or float, optional
        Angular velocity [1/time] of the axes the motion is described in: that of a steady rotation.
        Without one, the matrices of a moving state are those of the instant.

    Raises
    ------
    InputError
        A state that cannot be evaluated, or a wrong spin.
    """
    inputs.instance(run, "run", Simulation | Result, "give a Simulation, or the Result of a run or "
                    "of an equilibrium")
    M, C, K = small_motion(run, Spin.of(run, spin))
    n = len(K)
    multipliers = np.flatnonzero(run.system.is_multiplier[:n])
    moving = np.setdiff1d(np.arange(n), multipliers)
    G, columns = K[np.ix_(multipliers, moving)], K[np.ix_(moving, multipliers)]
    basis = null_space(G) if multipliers.size else np.eye(len(moving))
    free, tests = np.zeros((n, basis.shape[1])), np.zeros((n, basis.shape[1]))
    free[moving], tests[moving] = basis, without_multipliers(basis, G, columns)
    contacts = states(run.model, run.numbering, run.state.frames)
    if np.array_equal(free, tests):
        return Linearization(*(free.T @ A @ free for A in (M, C, K)), free, contacts)
    mass, pushed = (side.T @ M @ free for side in (free, tests))
    try:
        own = np.linalg.solve(pushed.T, mass.T).T       # so that the mass stays symmetric
    except np.linalg.LinAlgError:                       # there are motions without mass
        return Linearization(pushed, *(tests.T @ A @ free for A in (C, K)), free, contacts)
    return Linearization(mass, *(own @ tests.T @ A @ free for A in (C, K)), free, contacts)


def _said(following: int) -> str:
    """What a title says of motions without mass."""
    return f"; {counted(following, 'motion')} without mass follow statically" if following else ""


class Vibrations(NamedTuple):
    """Small undamped vibrations."""

    omega: NDArray      # (m,) angular frequencies, ascending [1/time]
    shapes: NDArray     # (unknowns, m) mass-normalised, in the axes of the unknowns
    of_names: Shapes
    following: int = 0  # motions without mass, which follow the others statically

    def __repr__(self) -> str:
        return mode_tables.text(self._title, 1j * self.omega)

    def _repr_html_(self) -> str:
        """What notebooks show."""
        return mode_tables.html(self._title, 1j * self.omega)

    @property
    def _title(self) -> str:
        return f"{len(self.omega)} undamped vibrations" + _said(self.following)

    @property
    def frequency(self) -> NDArray:
        """Frequencies, (m,), in cycles per unit of time: Hz where it is the second."""
        return self.omega / (2 * np.pi)

    def shape(self, name: str) -> NDArray:
        """Part of all shapes, (size, m): ``shape("tip.position")`` in global axes.

        Of ``<node>.position`` the displacement, of ``<node>.rotation`` the small rotation about
        global axes, of ``<superelement>.modes`` the amplitudes.

        Raises
        ------
        InputError
            A name that nothing has.
        """
        return self.of_names.of(name, self.shapes)


def vibrations(run: Simulation | Result, count: int | None = None) -> Vibrations:
    """Undamped vibrations about the state of a simulation at rest, constraints included.

    Raises
    ------
    InputError
        The state moves, or is not stable: a square of a frequency is negative or complex.
    """
    if count is not None:
        count = inputs.integer(count, "count", least=1)
    inputs.instance(run, "run", Simulation | Result, "give a Simulation or a Result")
    if np.abs(run.state.v).max() > 0:
        raise InputError("the state is not at rest: vibrations() needs a state at rest, use modes()"
                         " for moving states")
    if laws := [one.name for one in run.model.controllers.values() if not one.period]:
        raise InputError(f"controllers {', '.join(laws)} are continuous, and a closed loop has no "
                         "undamped vibrations: use modes()")
    M, _, K, free = linearize(run)[:4]
    own = _with_mass(M, K)
    try:
        squares, shapes = undamped(own.mass, own.stiffness)
    except ArithmeticError as error:
        raise InputError("the state is not stable: loads that turn with the model make it flutter; "
                         "modes() has the growth of its motions") from error
    if squares[0] < -NEGLIGIBLE * squares[-1]:
        raise InputError("the state is not stable: the lowest squared frequency is negative, "
                         f"{squares[0]:.4g}; modes() has the shape and the growth of this motion. "
                         "Start from an equilibrium to which it leads, or hold it")
    return Vibrations(np.sqrt(np.maximum(squares, 0.0))[:count],
                      free @ (own.motions @ shapes[:, :count]), Shapes(run), own.following)


def _with_mass(M: NDArray, K: NDArray, C: NDArray | None = None) -> Condensed:
    """Matrices of what has mass or damping; the rest follows statically.

    Raises
    ------
    InputError
        A motion has neither mass nor stiffness.
    """
    own = condensed(M, K, C)
    if own.bare:
        raise InputError(f"the model has {counted(own.bare, 'motion')} with neither mass nor "
                         "stiffness: hold what moves so, or give it inertia")
    return own


def warn_of_spin(run: Simulation | Result, rates: NDArray, what: str) -> None:
    """Warn that matrices of the instant are not those of what spins, beside these rates."""
    fastest, spinning = fastest_spin(run)
    lowest = rates[rates > 0.0].min(initial=np.inf)
    if spinning > SPINS * (lowest if np.isfinite(lowest) else 0.0):
        axes = (f"{fastest[0]:.6g}" if len(fastest) == 1 else
                f"({', '.join(f'{part + 0.0:.6g}' for part in fastest)})")
        warnings.warn(
            f"{what} of a state that rotates at up to {spinning:.6g} rad a unit of time, without "
            "spin=: the matrices are those of the instant, and nothing moves with their "
            f"eigenvalues for long. Give spin={axes}, the angular velocity of axes in which the "
            "rotation is steady, or a state at rest", LimitWarning, stacklevel=3)


class Modes(NamedTuple):
    """Small damped or gyroscopic motion ``shape exp(value t)``, one of each conjugate pair."""

    values: NDArray     # (m,) complex, by ascending frequency [1/time]
    shapes: NDArray     # (unknowns, m) complex, of unit length
    of_names: Shapes
    rounding: NDArray   # (m,) how far rounding may move the values [1/time]
    following: int = 0  # motions without mass, which follow the others statically

    def __repr__(self) -> str:
        return mode_tables.text(self._title, self.values)

    def _repr_html_(self) -> str:
        """What notebooks show."""
        return mode_tables.html(self._title, self.values)

    @property
    def _title(self) -> str:
        return f"{len(self.values)} modes of small motion" + _said(self.following)

    @property
    def frequency(self) -> NDArray:
        """Frequencies, (m,), in cycles per unit of time: Hz where it is the second."""
        return mode_tables.frequencies(self.values)

    @property
    def damping(self) -> NDArray:
        """Damping over critical damping, (m,); NaN of rigid motions."""
        return mode_tables.damping_ratios(self.values)

    def shape(self, name: str) -> NDArray:
        """Part of all shapes, (size, m): see `Vibrations.shape`."""
        return self.of_names.of(name, self.shapes)

    @property
    def omega(self) -> NDArray:
        """Angular frequencies [1/time]."""
        return self.values.imag

    @property
    def growth(self) -> NDArray:
        """Real parts of the eigenvalues, negative where the motion decays [1/time]."""
        return self.values.real


def modes(run: Simulation | Result, spin: ArrayLike | None = None) -> Modes:
    """Eigenvalues and shapes about a state, from the exact tangents; see `linearize`.

    Where nothing takes or gives energy, as in undamped gyroscopic motion, and the stiffness is
    positive, growth is zero by construction. Otherwise a growth below `Modes.rounding` is none.

    Of what spins without `spin=` the matrices are those of the instant: a warning says so.
    """
    M, C, K, free = linearize(run, spin)[:4]
    own = _with_mass(M, K, C)
    roots = eigenvalues(own.mass, own.damping, own.stiffness)
    if spin is None:
        warn_of_spin(run, np.abs(roots.values), "modes")
    # on integrals of controllers' states nothing depends: each has the value 0, which is no mode;
    # rounding may make a conjugate pair of two of these, of which one value is here
    nearest = np.argsort(np.abs(roots.values), kind="stable")
    counts = np.cumsum(np.where(roots.values[nearest].imag > 0.0, 2, 1))
    order = np.sort(nearest[counts > len(hidden_states(run.model, run.numbering))])
    shapes = free @ (own.motions @ roots.shapes[:, order])
    return Modes(roots.values[order], shapes / np.maximum(np.linalg.norm(shapes, axis=0), 1e-300),
                 Shapes(run), roots.rounding[order], own.following)
