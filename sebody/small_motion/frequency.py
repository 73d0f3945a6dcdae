"""Frequency response of any quantity to a harmonic load, about rest or a steady rotation.

The load has the amplitude ``exp(i omega t)``; the unknowns, multipliers included, answer with
``(-omega^2 M + i omega C + K) X = F``, with the exact derivatives of `linearization` and F that of
the forces by the load's amplitude. Whatever has a time function has an answer, see `moved_states`.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sebody.assembly.evaluation import evaluate
from sebody.basics import inputs, tabular
from sebody.basics.errors import InputError
from sebody.basics.units import Units, of_frequencies, of_rates, parsed_units
from sebody.contract.layout import RECORD_T, RESIDUAL
from sebody.engine.evaluate import set_loads, to_body_axes
from sebody.model.model import Model
from sebody.model.parts import Element, Node
from sebody.pictures.frequency_pictures import save_response
from sebody.results.naming import component_names
from sebody.results.result import Result
from sebody.results.units import with_unit
from sebody.runs.simulation import Simulation
from sebody.small_motion.given_state import state_of
from sebody.small_motion.linearization import small_motion, warn_of_spin
from sebody.small_motion.moved_states import differences, moves, refuse_unmoved
from sebody.small_motion.rotation.azimuths import steady
from sebody.small_motion.rotation.views import View, view

HEADS = "quantity", "largest amplitude", "phase [deg]", "at [{}]"


@dataclass(frozen=True, eq=False)
class FrequencyResponse:
    """Complex frequency response of quantities to a load of unit amplitude.

    ``response["tip.position"]`` is the change of the quantity, (m, ...), over the angular
    frequencies `omega`, (m,) [1/time]; its argument is the phase ahead of the load.
    """

    load: str
    omega: NDArray
    answers: dict[str, NDArray]
    units: Units | None = None

    def __repr__(self) -> str:
        return tabular.text(self._title(), self._heads(), self._rows())

    def _repr_html_(self) -> str:
        """HTML that notebooks show."""
        return tabular.titled(self._title(), self._heads(), self._rows())

    def _heads(self) -> tuple[str, ...]:
        return tuple(head.format(of_frequencies(self.units)) for head in HEADS)

    def _title(self) -> str:
        return (f"response to a unit of {self.load!r}, {len(self.omega)} frequencies from "
                f"{self.omega.min(initial=np.inf):.6g} to {self.omega.max(initial=0.0):.6g} "
                f"{of_rates(self.units)}")

    def _rows(self) -> Iterator[tuple[str, ...]]:
        """The largest response of every component of every quantity."""
        for name, answer in self.answers.items():
            columns = answer.reshape(len(self.omega), -1).T
            for label, column in zip(component_names(answer, name), columns, strict=True):
                k = int(np.argmax(np.abs(column)))
                full = f"{name}.{label}".rstrip(".")
                yield (with_unit(full, full, self.units), f"{abs(column[k]):.6g}",
                       f"{np.degrees(np.angle(column[k])):.4g}",
                       f"{self.omega[k] / (2 * np.pi):.6g}")

    def __getitem__(self, name: str) -> NDArray:
        """Response of one of the requested quantities."""
        return self.answers[inputs.choice(name, "quantity of the response", self.answers)]

    def save_picture(self, path: str | Path) -> Path:
        """Draw amplitudes and phases: png, pdf or svg (extra ``plot``).

        Raises
        ------
        InputError
            A picture that cannot be made.
        """
        return save_response(path, self.load, self.omega, self.answers, self.units)


def frequency_response(run: Simulation | Result | Model, load: str, quantities: str | Iterable[str],
                       omega: ArrayLike, spin: ArrayLike | None = None, frame: str = "auto",
                       hub: Node | str | None = None) -> FrequencyResponse:
    """Response of quantities to a load of harmonic amplitude, about the state of a run.

    Parameters
    ----------
    run : Simulation, Result or Model
        At rest or in steady rotation, as `equilibrium` leaves it; of a model, the state is that.
    load : str
        Name of a force, torque or mode force of the model; its amplitude may be 0 there.
    quantities : str or iterable of str
        Names of quantities, as of a `Result`: ``"tip.position"``, ``"hinge.force"``,
        ``"beam.node12.section_forces"``. Von Mises's stress and that of the most stressed fibre of
        a beam are no linear quantities about a body without stress.
    omega : (m,)
        Angular frequencies [1/time].
    spin : (3,) array_like or float, optional
        Angular velocity of a steady rotation of what turns, see `modes`.
    frame, hub
        The axes in which the motion is told, see `modes`. Loads and vectors are those in these
        axes as they lie at the instant: in standing ones a load on a rotor keeps its direction in
        space, in turning ones one on a support turns with the rotor.

    Returns
    -------
    FrequencyResponse

    Raises
    ------
    InputError
        No such load or quantity, a state that cannot be evaluated, or a frequency at which the
        response is infinite.
    """
    run = state_of(run, spin, hub)
    names = [quantities] if isinstance(quantities, str) else inputs.items(
        quantities, "quantities", "give names of quantities")
    omega = inputs.vector(omega, "omega")
    if not len(omega):
        raise inputs.refusal("omega", omega, "give at least one frequency")
    if not names:
        raise inputs.refusal("quantities", quantities, "name at least one")
    for name in names:
        inputs.name(name, "name of a quantity")
    refuse_unmoved(names, "harmonic response")
    axes = view(run, spin, frame, hub)
    with steady(run, axes.spin):
        matrices = small_motion(run, axes)
        if spin is None:
            warn_of_spin(run, np.abs(omega), "a harmonic response")
        forces, push = by_amplitude(run, _load(run, load))
        X = harmonic_motions(matrices, axes.pushed(run, push), omega)
        return FrequencyResponse(load, omega, harmonic_quantities(
            run, axes, names, X, omega, np.tile(forces, (len(omega), 1))),
            parsed_units(run.model.units))


def _load(run: Simulation | Result, name: str) -> Element:
    loads = {load.name: load for load in run.model.loads
             if load.time_function is not None and load.law is None}
    if not loads:
        raise InputError("the model has no force or torque whose amplitude could vary: add one, "
                         "of amplitude 0 if it shall not act at rest")
    return loads[inputs.choice(name, "load", loads)]


def by_amplitude(run: Simulation | Result, load: Element) -> tuple[NDArray, NDArray]:
    """Derivatives by the amplitude of a load: forces of all elements, and minus the residual.

    The latter is that of the unknowns, in their own axes. Loads are linear in their amplitude, so
    the difference is exact.
    """
    if load.series is not None:
        raise InputError(f"{load.name!r} is a series of loads, whose columns have no amplitude in "
                         "common: name a force, a torque or a body_load")
    state, at = run.state, 3 * run.numbering.ports[load]
    kept, derivatives = state.loads.copy(), []
    set_loads(run.system, state.frames, state.loads, state.now[RECORD_T])
    for step in (0.5, -1.0):
        state.loads[at] += step
        evaluate(run.system, state, RESIDUAL, RESIDUAL, "the state")
        derivatives.append((state.g.copy(), state.residual.copy()))
    state.loads[:] = kept
    forces, residual = (high - low for high, low in zip(*derivatives, strict=True))
    to_body_axes(run.system, state.frames, residual, False)
    return forces, -residual[:run.numbering.free]


def harmonic_quantities(run: Simulation | Result, axes: View, names: Iterable[str], X: NDArray,
                        omega: NDArray, forces: NDArray) -> dict[str, NDArray]:
    """Complex amplitudes of quantities, (m, ...) each.

    Parameters
    ----------
    X : (m, unknowns) complex
        Motions of the unknowns.
    omega : (m,)
        Their angular frequencies.
    forces : (m, forces of all elements)
        Change of the forces of elements beside what the motions make.
    """
    w = 1j * omega[:, None]
    along = moves(run, axes, *(np.concatenate([z.real, z.imag]) for z in (X, w * X, w**2 * X)))
    pushed = np.concatenate([forces.real, forces.imag])
    return {name: values[:len(omega)] + 1j * values[len(omega):]
            for name, values in differences(run, list(names), along, pushed).items()}


def harmonic_motions(matrices: tuple[NDArray, ...], push: NDArray, omega: NDArray) -> NDArray:
    """Responses of the unknowns to harmonic forces, (m, unknowns).

    Raises
    ------
    InputError
        A response is infinite.
    """
    mass, damping, stiffness = matrices
    # unknowns of different units: rows and columns of one size, for the judgment of solvability
    size = np.sqrt(np.abs(stiffness).max(axis=1) + np.abs(mass).max(axis=1))
    size[size == 0.0] = 1.0
    responses = []
    for w in omega:
        A = (stiffness - w * w * mass + 1j * w * damping) / np.outer(size, size)
        try:
            answer = np.linalg.solve(A, push / size)
        except np.linalg.LinAlgError:
            answer = np.full(len(A), np.nan)
        with np.errstate(invalid="ignore"):
            left = np.abs(A @ answer - push / size).max()
        if not left <= 1e-6 * np.abs(push / size).max():
            raise InputError(f"the response at omega = {w:.6g} is infinite: the undamped model has "
                             "a natural frequency there, or a motion without stiffness; add "
                             "damping, or leave out this frequency")
        responses.append(answer / size)
    return np.array(responses).reshape(len(omega), -1)
