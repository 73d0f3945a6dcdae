"""Frequencies and real parts of eigenvalues of small motion over the speed of a steady rotation."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sebody.basics import inputs, tabular
from sebody.basics.errors import InputError
from sebody.basics.units import Units, of_frequencies, of_rates, parsed_units
from sebody.model.model import Model
from sebody.model.parts import Node
from sebody.pictures.frequency_pictures import ORDERS, Diagram, save_campbell
from sebody.small_motion.crossings import (
    Crossings,
    by_interpolation,
    orders_of,
    refuse_turning,
)
from sebody.small_motion.linearization import Modes, modes_in
from sebody.small_motion.mode_tables import damping_ratios
from sebody.small_motion.rotation.speeds import Rotations
from sebody.small_motion.rotation.whirls import whirls

SEEN = 1e-3         # of the highest frequency: that of a crossing that is marked
HEADS = ("mode", "whirl", "[{hertz}] at {first} {rate}", "[{hertz}] at {last} {rate}",
         "largest real part [{growth}]")


@dataclass(frozen=True, eq=False)
class Campbell:
    """Modes over speed, each column one that is followed by its shape; see `campbell`.

    Attributes
    ----------
    speeds : (m,)
        Angular velocities [1/time].
    omega : (m, count)
        Angular frequencies in the axes of `frame` [1/time].
    growth : (m, count)
        Real parts of the eigenvalues, negative where the motion decays [1/time].
    rounding : (m, count)
        How far rounding may move the values: a growth below it is none [1/time].
    frame, reason : str
        The axes in which the motion is told, and why these: see `modes`.
    whirl : (m, count) of str
        ``forward``, ``backward``, ``mixed`` where some nodes run forward and others backward, or
        ``none`` of motion along a line or about the axis.
    """

    speeds: NDArray
    omega: NDArray
    growth: NDArray
    rounding: NDArray
    frame: str
    reason: str
    whirl: NDArray
    units: Units | None = None

    def __repr__(self) -> str:
        return tabular.text(*self._table())

    def _repr_html_(self) -> str:
        """HTML that notebooks show."""
        return tabular.titled(*self._table())

    def _table(self) -> tuple[str, tuple[str, ...], list[tuple[str, ...]]]:
        first, last = (f"{speed:.6g}" for speed in (self.speeds[0], self.speeds[-1]))
        title = (f"{self.omega.shape[1]} modes at {len(self.speeds)} speeds from {first} to {last} "
                 f"{of_rates(self.units)}, in {self.frame} axes"
                 + f" ({self.reason})" * bool(self.reason))
        heads = tuple(head.format(
            hertz=of_frequencies(self.units), first=first, last=last,
            rate=of_rates(self.units), growth=of_rates(self.units, "1/time")) for head in HEADS)
        hertz = self.omega / (2 * np.pi)
        growths = np.where(np.abs(self.growth) > self.rounding, self.growth, 0.0)
        return title, heads, [
            (str(k + 1), self._sense(k), f"{hertz[0, k]:.6g}", f"{hertz[-1, k]:.6g}",
             f"{growth.max():.4g}")
            for k, growth in enumerate(growths.T)]

    def _sense(self, k: int) -> str:
        """The whirl of a mode over the speeds."""
        return " to ".join(dict.fromkeys(self.whirl[1:, k]))

    @property
    def damping(self) -> NDArray:
        """Parts of critical damping, (m, count); NaN of rigid motions."""
        return np.array([damping_ratios(one) for one in self.growth + 1j * self.omega])

    def crossings(self, orders: ArrayLike = (1.0,)) -> Crossings:
        """Speeds at which a frequency is a multiple of the speed, as the diagram shows them.

        Between its speeds frequencies are cubics; `critical_speeds` finds exact values.

        Parameters
        ----------
        orders : sequence of float
            The multiples.

        Raises
        ------
        InputError
            Orders that are not positive, or frequencies that are told in turning axes.
        """
        refuse_turning(self.frame, self.reason)
        return by_interpolation(self.speeds, self.growth + 1j * self.omega, self.whirl,
                                orders_of(orders))

    def save_picture(self, path: str | Path, orders: ArrayLike = ORDERS) -> Path:
        """Draw frequencies and real parts of eigenvalues over the speed: png, pdf or svg.

        Lines tell the whirls, colours the damping; dashed are the multiples `orders` of the speed,
        with a dot where one crosses a frequency that is told in standing axes.

        Raises
        ------
        InputError
            A picture that cannot be made, or orders that are not positive.
        """
        multiples = orders_of(orders)
        return save_campbell(path, *self.drawn(multiples))

    def drawn(self, orders: NDArray) -> tuple[Diagram, NDArray, NDArray]:
        """Contents of pictures: the diagram, orders, and the crossings that are marked."""
        marked = np.zeros((0, 2))
        if self.frame != "turning":
            found = self.crossings(orders)
            vibrates = found.omega > SEEN * self.omega.max()
            marked = np.column_stack([found.speeds, found.omega])[vibrates]
        return (Diagram(self.speeds, self.omega, self.growth, self.damping, self.whirl, self.frame,
                        self.units), orders, marked)


def campbell(model: Model, speeds: ArrayLike, axis: ArrayLike | None = None, count: int = 8,
             steps: int = 4, frame: str = "auto", hub: Node | str | None = None) -> Campbell:
    """Campbell diagram of a model of which parts, or which as a whole, rotate steadily.

    At every speed the equilibrium of the rotation is found, and the modes about it. Unbalances are
    left out: to the first order they change neither.

    Parameters
    ----------
    model : Model
    speeds : (m,)
        Angular velocities, at least two, ascending [1/time].
    axis : (3,), optional
        Axis of rotation in space, by default that of the model's hinges and bearings; none in a
        plane.
    count : int
        Lowest modes at the first speed to follow.
    steps : int
        Load steps of each equilibrium.
    frame, hub
        The axes in which the motion is told, and what turns: see `modes`. In turning axes whirls
        are at ``|omega -+ speed|`` of what they are from the ground.

    Raises
    ------
    InputError
        Speeds that do not ascend, no axis or several, fewer modes than `count`, or axes in which
        the matrices are not constant.
    SimulationError
        A speed without an equilibrium.
    """
    speeds = inputs.vector(speeds, "speeds")
    if len(speeds) < 2 or not np.all(np.diff(speeds) > 0):
        raise InputError("speeds must ascend, at least two of them: give them in order")
    count = inputs.integer(count, "count", least=1)
    fastest = speeds[np.argmax(np.abs(speeds))]
    rotations = Rotations(model, axis, fastest, frame, hub, steps, "Campbell diagram")
    rows, names = [], []
    for speed in speeds:
        run, view = rotations.at(speed)
        rows.append(modes_in(run, view))
        names.append(whirls(rotations.model, rows[-1], rotations.unit.times(np.sign(speed) or 1.0)))
    if len(rows[0].values) < count:
        raise InputError(f"count is {count}, but there are {len(rows[0].values)} modes: ask for "
                         "fewer")
    chosen = [np.arange(count)]
    for last, now in zip(rows, rows[1:], strict=False):
        chosen.append(followed(last, chosen[-1], now))
    values, rounding, senses = (
        np.array([of[own] for of, own in zip(each, chosen, strict=True)])
        for each in ([one.values for one in rows], [one.rounding for one in rows], names))
    return Campbell(speeds, values.imag, values.real, rounding, rotations.view.frame,
                    rotations.view.reason, senses, parsed_units(model.units))


def followed(last: Modes, own: NDArray, now: Modes) -> NDArray:
    """The modes most like those of the last speed, by shape and by value."""
    from scipy.optimize import linear_sum_assignment  # takes 0.1 s to import

    likeness = np.abs(last.shapes[:, own].conj().T @ now.shapes)**2
    scale = np.abs(last.values[own]).max()
    change = np.abs(last.values[own][:, None] - now.values[None]) / max(scale, 1e-300)
    return linear_sum_assignment(1.0 - likeness + change)[1]
