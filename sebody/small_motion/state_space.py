"""The state space of small motion: ``x' = A x + B u``, ``y = C x + D u``.

The unknowns of a model with constraints are ``z = N xi + P u``: xi are coordinates that may move
freely, the others follow from the constraints ``G z = b u`` and from drives u. With mass, damping
and stiffness of `linearize` and the pushes f of the inputs,

    N'M N xi'' + N'C N xi' + N'K N xi = N'[(f0 - K P) u + (f1 - C P) u' + (f2 - M P) u'']

Loads have f0 alone. Of what a drive or a prescribed motion does the input is the acceleration u'',
and u and u' are states.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sebody.basics import inputs as given
from sebody.basics.errors import InputError
from sebody.basics.tabular import brief
from sebody.model.model import Model
from sebody.model.parts import Node
from sebody.results.naming import component_names
from sebody.results.result import Result
from sebody.runs.rotating_frame import motion
from sebody.runs.simulation import Simulation
from sebody.small_motion import inputs_of_motion, realization
from sebody.small_motion.constrained_motion import ConstrainedMotion
from sebody.small_motion.given_state import state_of
from sebody.small_motion.linearization import small_motion
from sebody.small_motion.moved_states import differences, moves, refuse_unmoved
from sebody.small_motion.rotation.azimuths import steady
from sebody.small_motion.rotation.views import View, view

if TYPE_CHECKING:
    from control import StateSpace as ControlSystem

ACCELERATED = "{}.acceleration"
RATES = {"position": "velocity", "rotation": "angular_velocity", "modes": "mode_rates"}


class StateSpace(NamedTuple):
    """A linear model ``x' = A x + B u``, ``y = C x + D u`` about a state of a run.

    x, u and y are changes from that state.
    """

    A: NDArray      # (n, n)
    B: NDArray      # (n, m)
    C: NDArray      # (p, n)
    D: NDArray      # (p, m)
    states: tuple[str, ...]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    values: NDArray         # (p,) the outputs in the state itself

    __repr__ = brief

    @property
    def measurements(self) -> tuple[str, ...]:
        """Names of the quantities that are the states, and their rates, for `state_feedback`.

        Positions, modes and, in a plane, rotations. A regulator subtracts their values in the state
        of the matrices.

        Raises
        ------
        InputError
            States that no quantity is: rotations in space, drives, and those of `minimal` and
            `reduce`.
        """
        quantities = []
        for name in self.states:
            whole, rate = name.removesuffix(".rate"), name.endswith(".rate")
            owner, kind, component = [*whole.split("."), "", ""][:3]
            if kind == "states":        # of a continuous controller
                quantities.append(name)
                continue
            if kind not in RATES or (kind == "rotation" and component):
                raise InputError(f"no quantity is the state {name!r}: use outputs, of which "
                                 "measurements determine the states")
            parts = owner, RATES[kind] if rate else kind, component
            quantities.append(".".join(part for part in parts if part))
        return tuple(quantities)

    @property
    def poles(self) -> NDArray:
        """Eigenvalues of A, (n,) complex [1/time]."""
        return np.linalg.eigvals(self.A)

    def response(self, omega: ArrayLike) -> NDArray:
        """Complex response ``C (i omega - A)^-1 B + D``, (k, p, m), at angular frequencies (k,).

        Raises
        ------
        InputError
            A frequency that is a pole.
        """
        responses = []
        for w in given.vector(np.atleast_1d(omega), "omega"):
            try:
                X = np.linalg.solve(1j * w * np.eye(len(self.A)) - self.A, self.B)
            except np.linalg.LinAlgError as error:
                raise InputError(f"the response at omega = {w:.6g} is infinite: a pole is there; "
                                 "leave out this frequency") from error
            responses.append(self.C @ X + self.D)
        return np.array(responses).reshape(-1, *self.D.shape)

    def minimal(self, tolerance: float = 1e-9) -> StateSpace:
        """The part that inputs move and outputs show, in modal coordinates.

        Parameters
        ----------
        tolerance : float
            Modes are left out whose share of the response is below this part of the largest.
        """
        tolerance = given.number(tolerance, "tolerance", least=0)
        return self._replace(**realization.minimal(self.A, self.B, self.C, self.D, tolerance))

    def reduce(self, order: int) -> StateSpace:
        """The modes with the largest shares of the response, and the static share of the others.

        Parameters
        ----------
        order : int
            Largest number of states. Poles at zero and unstable ones are kept first; one of a
            pair of poles is not kept alone.

        Raises
        ------
        InputError
            An order that does not hold what must be kept.
        """
        order = given.integer(order, "order", least=1)
        return self._replace(**realization.reduced(self.A, self.B, self.C, self.D, order))

    def to_control(self) -> ControlSystem:
        """The same as `control.StateSpace` of python-control (extra ``control``), with names.

        Dots in names are underscores there.

        Raises
        ------
        InputError
            The package is not installed.
        """
        try:
            import control
        except ImportError as error:
            raise InputError('python-control is not installed: pip install "sebody[control]"'
                             ) from error
        names = {kind: [name.replace(".", "_") for name in getattr(self, kind)]
                 for kind in ("states", "inputs", "outputs")}
        return control.ss(self.A, self.B, self.C, self.D, **names)


def state_space(run: Simulation | Result | Model, inputs: str | Iterable[str],
                outputs: str | Iterable[str], spin: ArrayLike | None = None, frame: str = "auto",
                hub: Node | str | None = None) -> StateSpace:
    """Linear model between inputs and outputs about the state a run, or an equilibrium, reached.

    Parameters
    ----------
    run : Simulation, Result or Model
        At rest or in steady rotation; of a model, the state is its `equilibrium`. Of a run
        that moves otherwise, the matrices are those of the instant.
    inputs : str or iterable of str
        Names of forces, torques, actuators, loads on bodies and modes, drives and prescribed
        motions, default names included. Of the last two the input is the acceleration, named
        ``<name>.acceleration``; displacement and rate are states.
    outputs : str or iterable of str
        Names of quantities, as of a `Result`. Those with components are several outputs.
    spin : (3,) array_like or float, optional
        Angular velocity of a steady rotation of what turns, see `modes`.
    frame, hub
        The axes in which the motion is told, see `modes`.

    Returns
    -------
    StateSpace
        Its first four members are A, B, C and D. States are named by coordinates and their rates:
        positions in global axes (with a spin as they lie at the instant), rotations about the axes
        of their nodes, ``<body>.modes``. Coordinates that follow from others are none.

    Raises
    ------
    InputError
        No such input or output, a state that cannot be evaluated, or a motion without mass.
    """
    run = state_of(run, spin, hub)
    names = _listed(inputs, "inputs", "name of an input")
    wanted = _listed(outputs, "outputs", "name of a quantity")
    refuse_unmoved(wanted, "linear model")
    _refuse_powers_of_loads(run, names, wanted)
    axes = view(run, spin, frame, hub)
    if axes.frame == "multiblade":
        raise InputError("multi-blade coordinates have no names that states could have: ask for "
                         "modes or a frequency response")
    with steady(run, axes.spin):
        return _in_axes(run, names, wanted, axes)


def _in_axes(run: Simulation | Result, names: list[str], wanted: list[str], axes: View
             ) -> StateSpace:
    """The model about a state whose rates are those of the rotation."""
    drives = [inputs_of_motion.found(run, axes.spin, name) for name in names]
    own = motion(run)[:run.numbering.free].toarray()    # axes of the unknowns, to global ones
    system = ConstrainedMotion(run, [own @ X @ own.T for X in small_motion(run, axes)],
                               [one._replace(pushes=one.pushes @ own.T) for one in drives])
    A, B = system.matrices()
    unknowns = [z @ own for z in system.motions(A, B)]
    amplitudes, moved = system.amplitudes(), np.array([one.motion for one in drives])
    along = moves(run, axes, *unknowns).plus(*(u @ moved for u in amplitudes))
    pushed = amplitudes[0] @ np.array([one.elements for one in drives])
    answers = differences(run, wanted, along, pushed)
    Y = np.hstack([answers[name].reshape(len(pushed), -1) for name in wanted])
    base = Result(run.model, run.numbering, run.system, run.state, run.state.now[None].copy(), 0.0)
    values = np.concatenate([np.asarray(base[name]).ravel() for name in wanted])
    labels = [f"{name}.{label}".rstrip(".") for name in wanted
              for label in component_names(answers[name], name)]
    size, states = len(A), system.states
    return StateSpace(A[np.ix_(states, states)], B[states], Y[states].T, Y[size:].T, system.names(),
                      tuple(ACCELERATED.format(one.name) if one.moves else one.name
                            for one in drives), tuple(labels), values)


def _refuse_powers_of_loads(run: Simulation | Result, names: list[str], wanted: list[str]) -> None:
    """Refuse the power of a load that is an input: it is a product with the input itself."""
    loads = {load.name for load in run.model.loads}
    for name in names:
        if name in loads and f"{name}.power" in wanted:
            raise InputError(f"output {name + '.power'!r} is a product of the input {name!r} and a "
                             "velocity: name the velocity where the load acts")


def _listed(names: str | Iterable[str], what: str, one: str) -> list[str]:
    listed = [names] if isinstance(names, str) else given.items(names, what, "give a list of names")
    if not listed:
        raise given.refusal(what, names, "name at least one")
    for name in listed:
        given.name(name, one)
    if len(set(listed)) < len(listed):
        raise given.refusal(what, names, "name each once")
    return list(listed)
