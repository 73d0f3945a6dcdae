"""Frequency response of any quantity to a harmonic load, about rest or a steady rotation.

The load has the amplitude ``exp(i omega t)``; the unknowns, multipliers included, answer with
``(-omega^2 M + i omega C + K) X = F``, with the exact derivatives of `linearization` and F that of
the forces by the load's amplitude. A quantity follows from its values in states moved a little
along X, in positions, velocities, accelerations and load: whatever has a history has an answer.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sebody import inputs, tabular
from sebody.assembly.evaluation import evaluate
from sebody.assembly.numbering import coordinates
from sebody.contract.layout import RECORD_T, RESIDUAL
from sebody.engine.evaluate import set_loads, to_body_axes
from sebody.errors import InputError
from sebody.model.parts import Element
from sebody.pictures.frequency_pictures import save_response
from sebody.results import rotations
from sebody.results.naming import component_names
from sebody.results.postprocessing import Forces
from sebody.results.result import Result
from sebody.runs.rotating_frame import Spin, motion
from sebody.runs.simulation import Simulation
from sebody.small_motion.linearization import small_motion

HEADS = "quantity", "largest amplitude", "phase [deg]", "at [Hz]"
UNMOVED, ADDED_UP = ("t", "energy.external_work"), ".work"     # quantities that do not answer
SMALL = 1e-5        # motion of the states that are compared, of the extent or in radians


@dataclass(frozen=True, eq=False)
class FrequencyResponse:
    """Complex frequency response of quantities to a load of unit amplitude.

    ``response["tip.position"]`` is the change of the quantity, (m, ...), over the angular
    frequencies `omega`, (m,) [1/time]; its argument is the phase ahead of the load.
    """

    load: str
    omega: NDArray
    answers: dict[str, NDArray]

    def __repr__(self) -> str:
        return tabular.text(self._title(), HEADS, self._rows())

    def _repr_html_(self) -> str:
        """What notebooks show."""
        return tabular.titled(self._title(), HEADS, self._rows())

    def _title(self) -> str:
        return (f"response to a unit of {self.load!r}, {len(self.omega)} frequencies from "
                f"{self.omega.min(initial=np.inf):.6g} to {self.omega.max(initial=0.0):.6g} rad/s")

    def _rows(self) -> Iterator[tuple[str, ...]]:
        """The largest response of every component of every quantity."""
        for name, answer in self.answers.items():
            columns = answer.reshape(len(self.omega), -1).T
            for label, column in zip(component_names(answer, name), columns, strict=True):
                k = int(np.argmax(np.abs(column)))
                yield (f"{name}.{label}".rstrip("."), f"{abs(column[k]):.6g}",
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
        return save_response(path, self.load, self.omega, self.answers)


def frequency_response(run: Simulation | Result, load: str, quantities: str | Iterable[str],
                       omega: ArrayLike, spin: ArrayLike | None = None) -> FrequencyResponse:
    """Response of quantities to a load of harmonic amplitude, about the state of a run.

    Parameters
    ----------
    run : Simulation or Result
        At rest or in steady rotation, as `equilibrium` leaves it.
    load : str
        Name of a force, torque or mode force of the model; its amplitude may be 0 there.
    quantities : str or iterable of str
        Names of quantities, as of a `Result`: ``"tip.position"``, ``"hinge.force"``,
        ``"beam.node12.section_forces"``. Von Mises's stress and that of the most stressed fibre of
        a beam are no linear quantities about a body without stress.
    omega : (m,)
        Angular frequencies [1/time].
    spin : (3,) array_like or float, optional
        Angular velocity of the axes in which the motion is described, as for `linearize`; vectors
        are those in these axes as they lie at the instant.

    Returns
    -------
    FrequencyResponse

    Raises
    ------
    InputError
        No such load or quantity, a state that cannot be evaluated, or a frequency at which the
        response is infinite.
    """
    inputs.instance(run, "run", Simulation | Result, "give a Simulation, or the Result of a run or "
                    "of an equilibrium")
    names = [quantities] if isinstance(quantities, str) else inputs.items(
        quantities, "quantities", "give names of quantities")
    omega = inputs.vector(omega, "omega")
    if not len(omega):
        raise inputs.refusal("omega", omega, "give at least one frequency")
    if not names:
        raise inputs.refusal("quantities", quantities, "name at least one")
    for name in names:
        if inputs.name(name, "name of a quantity") in UNMOVED or name.endswith(ADDED_UP):
            raise InputError(f"quantity {name!r} has no harmonic response: time and work are not "
                             "periodic; name a position, a force or a power")
    steady = Spin.of(run, spin)
    matrices = small_motion(run, steady)
    element = _load(run, load)
    forces = _by_amplitude(run, element)
    push = -forces.sums.copy()
    to_body_axes(run.system, run.state.frames, push, False)
    X = _answers(matrices, push[:run.numbering.free], omega)
    recording, scale = _moved_states(run, steady, X, omega)
    share = np.zeros(len(recording.rows))
    share[0::4], share[1::4] = scale, -scale        # the load is real
    base = recording.forces
    recording.forces = Forces(base.elements + share[:, None] * forces.elements,
                              base.sums + share[:, None] * forces.sums)
    return FrequencyResponse(load, omega, {
        name: _difference(np.asarray(recording[name]), scale) for name in names})


def _load(run: Simulation | Result, name: str) -> Element:
    loads = {load.name: load for load in run.model.loads if load.time_function is not None}
    if not loads:
        raise InputError("the model has no force or torque whose amplitude could vary: add one, "
                         "of amplitude 0 if it shall not act at rest")
    return loads[inputs.choice(name, "load", loads)]


def _by_amplitude(run: Simulation | Result, load: Element) -> Forces:
    """Derivatives of the forces of all elements, and of their sums, by the load's amplitude.

    Loads are linear in their amplitude, so the difference is exact.
    """
    state, at = run.state, 3 * run.numbering.ports[load]
    kept, found = state.loads.copy(), []
    set_loads(run.system, state.loads, state.now[RECORD_T])
    for step in (0.5, -1.0):
        state.loads[at] += step
        evaluate(run.system, state, RESIDUAL, RESIDUAL, "the state")
        found.append((state.g.copy(), state.residual.copy()))
    state.loads[:] = kept
    return Forces(*(high - low for high, low in zip(*found, strict=True)))


def _answers(matrices: tuple[NDArray, ...], push: NDArray, omega: NDArray) -> NDArray:
    """Responses of the unknowns, (m, unknowns)."""
    mass, damping, stiffness = matrices
    # unknowns of different units: rows and columns of one size, for the judgment of solvability
    size = np.sqrt(np.abs(stiffness).max(axis=1) + np.abs(mass).max(axis=1))
    size[size == 0.0] = 1.0
    found = []
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
        found.append(answer / size)
    return np.array(found).reshape(len(omega), -1)


def _moved_states(run: Simulation | Result, spin: Spin, X: NDArray, omega: NDArray
                  ) -> tuple[Result, NDArray]:
    """States moved both ways along the real and the imaginary part of every response.

    Returns their recording and the share of the response by which they are moved, (m,).
    """
    numbering, state = run.numbering, run.state
    moved = X @ motion(run).toarray().T         # (m, coordinates), in global axes
    w = 1j * omega[:, None]
    rate, second = w * moved, w**2 * moved
    if spin.rotates:
        velocity, place, turning = spin.operators(run)
        second = second + rate @ turning.T + moved @ place.T
        rate = rate + moved @ velocity.T
    extent = np.full(numbering.total, np.inf)   # of what has no size of its own: any
    rotated = {}
    for node in (*run.model.nodes.values(), *run.model.grounds):
        for dof_block in (node.position, node.rotation):
            if dof_block is not None and dof_block in numbering.dof_blocks:
                own = coordinates(numbering, dof_block)
                extent[own] = 1.0 if dof_block.rotational else run.model.size()
                if dof_block.rotational and not run.model.planar:
                    rotated[numbering.rotations[dof_block]] = own
    largest = (np.abs(moved) / extent).max(axis=1)
    scale = SMALL / np.where(largest > 0, largest, 1.0)
    parts, rows = state.recorded_parts, []
    for k, factor in enumerate(scale):
        for change in (1.0, -1.0, -1j, 1j):     # real parts of these times the answer
            row = state.now.copy()
            step = (factor * change * np.array([moved[k], rate[k], second[k]])).real
            for name, values in zip("qva", step, strict=True):
                row[parts[name]] += values
            for number, own in rotated.items():
                first = parts["R"].start + 9 * number
                R = row[first:first + 9].reshape(3, 3)
                row[first:first + 9] = (R @ rotations.matrices(step[0][own])).ravel()
            rows.append(row)
    return Result(run.model, numbering, run.system, state, np.array(rows), 0.0), scale


def _difference(values: NDArray, scale: NDArray) -> NDArray:
    """Complex change from the values in states that are moved, four for each frequency."""
    half = 2 * scale.reshape(-1, *[1] * (values.ndim - 1))
    return (values[0::4] - values[1::4]) / half + 1j * (values[2::4] - values[3::4]) / half
