"""Steady response to unbalances: motion at the speed of rotation, and its orbits.

An unbalance m r on a node pushes it by ``m r W^2``, in standing axes with the amplitude
``W^2 (m - i n x m) exp(i W t)``, m the first moment at the start and n the axis. In turning axes it
is a force that rests, and what rests there turns in space. Its weight, which twists a shaft that is
not upright, is left out.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sebody.basics import inputs, tabular
from sebody.basics.errors import InputError
from sebody.basics.units import Units, of_rates, parsed_units
from sebody.model.model import Model
from sebody.model.numbering import coordinates
from sebody.model.parts import Node
from sebody.pictures.orbit_pictures import save_orbits, save_synchronous
from sebody.results.units import with_unit
from sebody.runs.rotating_frame import motion
from sebody.small_motion.frequency import harmonic_motions, harmonic_quantities
from sebody.small_motion.linearization import small_motion
from sebody.small_motion.moved_states import refuse_unmoved
from sebody.small_motion.rotation.azimuths import steady
from sebody.small_motion.rotation.speeds import Rotations
from sebody.small_motion.rotation.whirls import Ellipses, directions_across, on_axis

HEADS = "quantity", "largest half axis", "other half axis", "at [{}]", "whirl"
EQUAL = 1e-9        # of a rate: others that are the same


@dataclass(frozen=True, eq=False)
class SynchronousResponse:
    """Response to unbalances over the speed; see `synchronous_response`.

    ``response["disc.position"]`` is the complex amplitude U of a vector, (m, 3) in standing axes:
    it changes by ``Re(U exp(i w t))``, where the unbalances are as they were built at ``t = 0``.

    Attributes
    ----------
    speeds : (m,)
        Angular velocities [1/time].
    rates : (m,)
        Angular frequencies w: the speeds, times the ratio of gears if the unbalances are on a part
        that gears turn.
    across : (3, 2)
        Directions in which orbits are told.
    frame, reason : str
        The axes of the analysis: see `modes`.
    """

    speeds: NDArray
    rates: NDArray
    across: NDArray
    answers: dict[str, NDArray]
    frame: str
    reason: str
    units: Units | None = None

    def __repr__(self) -> str:
        return tabular.text(self._title(), self._heads(), self._rows())

    def _repr_html_(self) -> str:
        """Table that notebooks show."""
        return tabular.titled(self._title(), self._heads(), self._rows())

    def _heads(self) -> tuple[str, ...]:
        return tuple(head.format(of_rates(self.units)) for head in HEADS)

    def _title(self) -> str:
        first, last = self.speeds.min(), self.speeds.max()
        return (f"synchronous response at {len(self.speeds)} speeds from {first:.6g} to "
                f"{last:.6g} {of_rates(self.units)}, in {self.frame} axes ({self.reason})")

    def _rows(self) -> list[tuple[str, ...]]:
        rows: list[tuple[str, ...]] = []
        for name in self.answers:
            one = self.orbit(name)
            k = int(np.argmax(one.major))
            rows.append((with_unit(name, name, self.units), f"{one.major[k]:.6g}",
                         f"{abs(one.minor[k]):.6g}", f"{self.speeds[k]:.6g}", str(one.whirl[k])))
        return rows

    def __getitem__(self, name: str) -> NDArray:
        """Complex amplitudes of one of the quantities."""
        return self.answers[inputs.choice(name, "quantity of the response", self.answers)]

    def orbit(self, name: str) -> Ellipses:
        """Ellipses that a quantity, such as ``"disc.position"``, runs through across the axis."""
        return Ellipses.of(self[name], self.across)

    def save_picture(self, path: str | Path) -> Path:
        """Draw half axes and phases over the speed: png, pdf or svg (extra ``plot``).

        Raises
        ------
        InputError
            A picture that cannot be made.
        """
        orbits = {name: self.orbit(name) for name in self.answers}
        return save_synchronous(path, self.speeds, {
            with_unit(name, name, self.units): (one.major, one.minor, one.phase)
            for name, one in orbits.items()}, of_rates(self.units))

    def save_orbits(self, path: str | Path, speed: float) -> Path:
        """Draw the orbits at the speed that is nearest: png, pdf or svg (extra ``plot``).

        A dot is where a quantity is at ``t = 0``, and the gap of the line behind it.

        Raises
        ------
        InputError
            A picture that cannot be made.
        """
        k = int(np.argmin(np.abs(self.speeds - inputs.number(speed, "speed"))))
        return save_orbits(path, f"orbits at {self.speeds[k]:.6g} {of_rates(self.units)}", {
            with_unit(f"{name}, {self.orbit(name).whirl[k]}", name, self.units):
            values[k] @ self.across for name, values in self.answers.items()})


def synchronous_response(model: Model, speeds: ArrayLike,
                         quantities: str | Iterable[str] | None = None,
                         axis: ArrayLike | None = None, steps: int = 1, frame: str = "auto",
                         hub: Node | str | None = None) -> SynchronousResponse:
    """Steady response to all unbalances of a model at speeds of its rotation, to the first order.

    Parameters
    ----------
    model : Model
        With unbalances on one part, or on parts of one speed.
    speeds : (m,)
        Angular velocities, all positive [1/time].
    quantities : str or iterable of str, optional
        Vectors: ``"disc.position"``, ``"bearing.force"``; by default the positions of all nodes on
        the axis of what turns.
    axis : (3,), optional
        Axis of rotation in space, by default that of the model's hinges and bearings.
    steps : int
        Load steps of each equilibrium.
    frame, hub
        See `modes`: standing or turning axes.

    Returns
    -------
    SynchronousResponse

    Raises
    ------
    InputError
        No unbalance, a quantity that is no vector, an undamped rotor at a critical speed, or motion
        whose matrices are constant in neither of these axes.
    SimulationError
        A speed without an equilibrium.
    """
    speeds = inputs.vector(speeds, "speeds")
    if not len(speeds) or speeds.min() <= 0.0:
        raise inputs.refusal("speeds", speeds, "give at least one, all positive")
    rotations = Rotations(model, axis, speeds.max(), frame, hub, steps, "synchronous response")
    view = rotations.view
    if view.frame not in ("standing", "turning"):
        raise InputError("a synchronous response needs standing or turning axes in which the "
                         f"matrices are constant, and here are {view.frame} ones: {view.reason}")
    factor = _factor(rotations)
    names = _names(rotations, quantities)
    rows = [_at(rotations, speed, factor, names) for speed in speeds]
    answers = {name: np.array([row[name] for row in rows]) for name in names}
    return SynchronousResponse(speeds, abs(factor) * speeds,
                               directions_across(rotations.unit.times(np.sign(factor))), answers,
                               view.frame, view.reason, parsed_units(model.units))


def _names(rotations: Rotations, quantities: str | Iterable[str] | None) -> list[str]:
    """Quantities asked for."""
    if quantities is None:
        return [f"{name}.position" for name in on_axis(rotations.model, rotations.unit)]
    names = [quantities] if isinstance(quantities, str) else list(inputs.items(
        quantities, "quantities", "give names of quantities"))
    for name in names:
        inputs.name(name, "name of a quantity")
    refuse_unmoved(names, "harmonic response")
    return names


def _factor(rotations: Rotations) -> float:
    """Multiple of the spin at which all unbalances turn."""
    parts = rotations.unit.parts
    if not rotations.unbalances:
        raise InputError("the model has no unbalance: add one by model.unbalance(node, "
                         "mass_times_radius)")
    found = {}
    for one in rotations.unbalances:
        block = one.attachments[-1].dof_block
        if parts is not None and block not in parts:
            raise InputError(f"{one.name!r} does not turn: name as hub= a node of what it is on")
        found[one.name] = 1.0 if parts is None else parts[block].factor
    first = next(iter(found.values()))
    for name, factor in found.items():
        if abs(factor - first) > EQUAL * abs(first):
            raise InputError(f"{name!r} turns at {factor:.6g} times the spin and others at "
                             f"{first:.6g}: leave out all but those of one speed")
    return first


def _at(rotations: Rotations, speed: float, factor: float, names: list[str]
        ) -> dict[str, NDArray]:
    """Complex amplitudes of quantities at a speed, in standing axes."""
    run, view = rotations.at(speed)
    standing = view.frame == "standing"
    turn = rotations.unit.across * np.sign(factor)
    rate = np.array([abs(factor) * speed if standing else 0.0])
    with steady(run, view.spin):
        push = np.zeros(run.numbering.total, dtype=complex)
        for one in rotations.unbalances:
            first = one.vector("mc")
            force = (factor * speed)**2 * (first - 1j * turn @ first * standing)
            push[coordinates(run.numbering, one.attachments[0].dof_block)] += force
        X = harmonic_motions(small_motion(run, view), motion(run).T @ push, rate)
        still = np.zeros((1, run.state.g.size))
        answers = harmonic_quantities(run, view, names, X, rate, still)
    found = {}
    for name in names:
        if answers[name].shape != (1, run.model.dimension):
            raise InputError(f"quantity {name!r} is no vector, which an orbit is of: name a "
                             "position, a velocity or a force")
        found[name] = answers[name][0] if standing else _in_space(answers[name][0], turn)
    return found


def _in_space(resting: NDArray, turn: NDArray) -> NDArray:
    """Amplitude in standing axes of a vector that rests in turning ones."""
    across = -turn @ turn @ resting if len(resting) == 3 else resting
    return across - 1j * turn @ across
