"""Small motion about a state, at rest or in steady rotation: exact matrices and eigenvalues."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.linalg import null_space

from sebody.assembly.numbering import hidden_states
from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.basics.tabular import brief, counted
from sebody.basics.warned import warn
from sebody.model.model import Model
from sebody.model.parts import Node
from sebody.reduction.massless import Condensed, condensed
from sebody.results.contact_states import states
from sebody.results.result import Result
from sebody.runs import user_faults
from sebody.runs.limits.watch import Watch
from sebody.runs.rotating_frame import fastest_spin
from sebody.runs.simulation import Simulation
from sebody.runs.state_derivatives import derivative
from sebody.runs.teeth import Gears, teeth_remarks
from sebody.small_motion import mode_tables
from sebody.small_motion.eigenvalues import NEGLIGIBLE, Eigenvalues, eigenvalues, undamped
from sebody.small_motion.given_state import state_of
from sebody.small_motion.pressed_friction import without_multipliers
from sebody.small_motion.rotation.periodic import exponents
from sebody.small_motion.rotation.views import View, view
from sebody.small_motion.shapes import Shapes

SPINS = 1e-3        # of the lowest eigenvalue: a slower rotation changes nothing that one sees


def small_motion(run: Simulation | Result, axes: View) -> tuple[NDArray, NDArray, NDArray]:
    """Mass, damping and stiffness of all unknowns, multipliers included, in their own axes.

    About a rotation the motion is told in the axes of an analysis.

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
    M, C, K = (axes.matrices(run) if axes.spin.rotates else
               tuple(derivative(run, *weights).toarray() for weights in np.eye(3)))
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


def linearize(run: Simulation | Result | Model, spin: ArrayLike | None = None, frame: str = "auto",
              hub: Node | str | None = None) -> Linearization:
    """Matrices of small motion about the state a run, or an equilibrium, has reached.

    Parameters
    ----------
    run : Simulation, Result or Model
        See `modes`.
    spin : (3,) array_like or float, optional
        Angular velocity [1/time] of a steady rotation of what turns.
        Without one, the matrices of a moving state are those of the instant.
    frame, hub
        The axes the motion is told in, see `modes`.

    Raises
    ------
    InputError
        A state that cannot be evaluated, a wrong spin, or axes in which the matrices are not
        constant.
    """
    run = state_of(run, spin, hub)
    return linearized(run, view(run, spin, frame, hub))


def linearized(run: Simulation | Result, axes: View) -> Linearization:
    """Matrices of small motion in the axes of an analysis."""
    M, C, K = small_motion(run, axes)
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
    """Words of a title on motions without mass."""
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
        """HTML that notebooks show."""
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


def vibrations(run: Simulation | Result | Model, count: int | None = None) -> Vibrations:
    """Undamped vibrations about the state of a simulation at rest, constraints included.

    Parameters
    ----------
    run : Simulation, Result or Model
        At rest. Of a model, the state is that of its `equilibrium`.
    count : int, optional
        Lowest vibrations to tell; all by default.

    Raises
    ------
    InputError
        The state moves, or is not stable: a square of a frequency is negative or complex.
    """
    if count is not None:
        count = inputs.integer(count, "count", least=1)
    run = state_of(run)
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
        warn(
            f"{what} of a state that rotates at up to {spinning:.6g} rad a unit of time, without "
            "spin=: the matrices are those of the instant, and nothing moves with their "
            f"eigenvalues for long. Give spin={axes}, the angular velocity of axes in which the "
            "rotation is steady, or a state at rest")


class Modes(NamedTuple):
    """Small damped or gyroscopic motion ``shape exp(value t)``, one of each conjugate pair."""

    values: NDArray     # (m,) complex, by ascending frequency [1/time]
    shapes: NDArray     # (unknowns, m) complex, of unit length
    of_names: Shapes
    rounding: NDArray   # (m,) how far rounding may move the values [1/time]
    following: int = 0  # motions without mass, which follow the others statically
    frame: str = ""     # axes they are told in, of a rotation: see `modes`
    reason: str = ""    # why these

    def __repr__(self) -> str:
        return mode_tables.text(self._title, self.values)

    def _repr_html_(self) -> str:
        """HTML that notebooks show."""
        return mode_tables.html(self._title, self.values)

    @property
    def _title(self) -> str:
        axes = f" in {self.frame} axes ({self.reason})" if self.frame else ""
        return f"{len(self.values)} modes of small motion{axes}" + _said(self.following)

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


def modes(run: Simulation | Result | Model, spin: ArrayLike | None = None, frame: str = "auto",
          hub: Node | str | None = None) -> Modes:
    """Eigenvalues and shapes about a state, from the exact tangents; see `linearize`.

    Where nothing takes or gives energy, as in undamped gyroscopic motion, and the stiffness is
    positive, growth is zero by construction. Otherwise a growth below `Modes.rounding` is none.

    Of what spins without `spin=` the matrices are those of the instant: a warning says so.

    Parameters
    ----------
    run : Simulation, Result or Model
        Of a model, the state is that of its `equilibrium`, in the steady rotation if there is one.
    spin : (3,) array_like or float, optional
        Angular velocity of a steady rotation [1/time]. What the model lets turn freely about its
        direction turns, with all that bodies, links, welds or gears tie to it; the rest stands.
        Where nothing turns by itself, supports turn with everything.
    frame : {"auto", "standing", "turning", "multiblade", "floquet"}
        Axes in which the motion is told. Its matrices are constant in ``standing`` ones, if what
        turns is axisymmetric, however it is held; in ``turning`` ones, if what stands is isotropic
        about the axis; but for a ripple that is averaged in ``multiblade`` ones of three or more
        equal blades. Otherwise motion is periodic, and values are exponents of the multipliers of a
        revolution, ``floquet``, with the frequency of the largest harmonic in standing axes. By
        default the first of these that holds, which is found by turning the model. `Modes.frame`
        and `Modes.reason` say which was taken, and why.
    hub : Node or str, optional
        A node on the axis of what turns: where blades join, or where there are several such parts.

    Raises
    ------
    InputError
        A state that cannot be evaluated, a wrong spin, or axes in which the matrices are not
        constant.
    """
    run = state_of(run, spin, hub)
    found = modes_in(run, view(run, spin, frame, hub))
    if spin is None:
        warn_of_spin(run, np.abs(found.values), "modes")
    return found


def _with_double_zeros(roots: Eigenvalues) -> Eigenvalues:
    """With the value 0 twice where rounding made a pair of it: of a turn without stiffness."""
    zero = np.abs(roots.values) <= 2.0 * roots.rounding
    again = np.concatenate([np.flatnonzero(zero & (roots.values.imag > 0.0)),
                            np.arange(len(zero))])
    values = np.where(zero, 0.0, roots.values)[again]
    order = np.argsort(values.imag, kind="stable")
    return Eigenvalues(values[order], roots.shapes[:, again[order]], roots.rounding[again[order]])


def modes_in(run: Simulation | Result, axes: View) -> Modes:
    """Eigenvalues and shapes in the axes of an analysis."""
    if axes.frame == "floquet" and axes.speed:
        found = exponents(axes.revolution(run), axes.speed)
        order = np.argsort(found.values.imag, kind="stable")
        shapes = axes.shapes(run, found.shapes[:, order])
        return Modes(found.values[order],
                     shapes / np.maximum(np.linalg.norm(shapes, axis=0), 1e-300), Shapes(run),
                     found.rounding[order], 0, axes.frame, axes.reason)
    M, C, K, free = linearized(run, axes)[:4]
    own = _with_mass(M, K, C)
    roots = eigenvalues(own.mass, own.damping, own.stiffness)
    if axes.frame == "standing":
        roots = _with_double_zeros(roots)
    # on integrals of controllers' states nothing depends: each has the value 0, which is no mode;
    # rounding may make a conjugate pair of two of these, of which one value is here
    nearest = np.argsort(np.abs(roots.values), kind="stable")
    counts = np.cumsum(np.where(roots.values[nearest].imag > 0.0, 2, 1))
    order = np.sort(nearest[counts > len(hidden_states(run.model, run.numbering))])
    shapes = axes.shapes(run, free @ (own.motions @ roots.shapes[:, order]))
    return Modes(roots.values[order], shapes / np.maximum(np.linalg.norm(shapes, axis=0), 1e-300),
                 Shapes(run), roots.rounding[order], own.following, axes.frame, axes.reason)
