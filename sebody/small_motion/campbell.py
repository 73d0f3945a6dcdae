"""Frequencies and real parts of eigenvalues of small motion over the speed of a steady rotation."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sebody.basics import inputs, tabular
from sebody.basics.errors import InputError
from sebody.model.arguments import known
from sebody.model.model import Model
from sebody.model.parts import Node
from sebody.pictures.frequency_pictures import save_campbell
from sebody.runs.rotating_frame import Spin
from sebody.runs.statics import steady_rotation
from sebody.runs.turning_parts import parts_of
from sebody.small_motion.linearization import Modes, modes_in
from sebody.small_motion.rotation.views import FRAMES, decided


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
    """

    speeds: NDArray
    omega: NDArray
    growth: NDArray
    rounding: NDArray
    frame: str = "turning"
    reason: str = ""

    def __repr__(self) -> str:
        return tabular.text(*self._table())

    def _repr_html_(self) -> str:
        """What notebooks show."""
        return tabular.titled(*self._table())

    def _table(self) -> tuple[str, tuple[str, ...], list[tuple[str, ...]]]:
        first, last = (f"{speed:.6g}" for speed in (self.speeds[0], self.speeds[-1]))
        title = (f"{self.omega.shape[1]} modes at {len(self.speeds)} speeds from {first} to {last} "
                 f"rad/s, in {self.frame} axes" + f" ({self.reason})" * bool(self.reason))
        heads = "mode", f"[Hz] at {first} rad/s", f"[Hz] at {last} rad/s", "largest real part [1/s]"
        hertz = self.omega / (2 * np.pi)
        growths = np.where(np.abs(self.growth) > self.rounding, self.growth, 0.0)
        return title, heads, [
            (str(k + 1), f"{hertz[0, k]:.6g}", f"{hertz[-1, k]:.6g}", f"{growth.max():.4g}")
            for k, growth in enumerate(growths.T)]

    def save_picture(self, path: str | Path) -> Path:
        """Draw frequencies and real parts of eigenvalues over the speed: png, pdf or svg.

        Raises
        ------
        InputError
            A picture that cannot be made.
        """
        return save_campbell(path, self.speeds, self.omega, self.growth)


def campbell(model: Model, speeds: ArrayLike, axis: ArrayLike | None = None, count: int = 8,
             steps: int = 4, frame: str = "auto", hub: Node | str | None = None) -> Campbell:
    """Campbell diagram of a model of which parts, or which as a whole, rotate steadily.

    At every speed the equilibrium of the rotation is found, and the modes about it.

    Parameters
    ----------
    model : Model
    speeds : (m,)
        Angular velocities, at least two, ascending [1/time].
    axis : (3,), optional
        Axis of rotation in space; none in a plane.
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
        Speeds that do not ascend, no axis, fewer modes than `count`, or axes in which the matrices
        are not constant.
    SimulationError
        A speed without an equilibrium.
    """
    inputs.instance(model, "model", Model, "give a Model")
    speeds = inputs.vector(speeds, "speeds")
    if len(speeds) < 2 or not np.all(np.diff(speeds) > 0):
        raise InputError("speeds must ascend, at least two of them: give them in order")
    count = inputs.integer(count, "count", least=1)
    frame = inputs.choice(frame, "frame", FRAMES)
    own = None if hub is None else known(model, hub)
    unit = parts_of(model, Spin(_direction(model, axis), model.planar), own)
    fastest = speeds[np.argmax(np.abs(speeds))]
    decision = decided(model, unit.times(fastest), frame, own)
    rows: list[Modes] = []
    for speed in speeds:
        spin = unit.times(speed)
        rows.append(modes_in(steady_rotation(model, steps, spin), replace(decision, spin=spin)))
    if len(rows[0].values) < count:
        raise InputError(f"count is {count}, but there are {len(rows[0].values)} modes: ask for "
                         "fewer")
    chosen = [np.arange(count)]
    for last, now in zip(rows, rows[1:], strict=False):
        chosen.append(_followed(last, chosen[-1], now))
    values, rounding = (np.array([of[own] for of, own in zip(each, chosen, strict=True)])
                        for each in ([one.values for one in rows], [one.rounding for one in rows]))
    return Campbell(speeds, values.imag, values.real, rounding, decision.frame, decision.reason)


def _direction(model: Model, axis: ArrayLike | None) -> NDArray:
    """The axis of rotation, of unit length."""
    if model.planar:
        return np.array(1.0)
    if axis is None:
        raise InputError("in space a Campbell diagram needs axis=, three numbers")
    direction = inputs.vector(axis, "axis", 3)
    length = np.linalg.norm(direction)
    if not length > 0.0:
        raise InputError("axis has no length: give its direction")
    return direction / length


def _followed(last: Modes, own: NDArray, now: Modes) -> NDArray:
    """The modes most like those of the last speed, by shape and by value."""
    from scipy.optimize import linear_sum_assignment  # takes 0.1 s to import

    likeness = np.abs(last.shapes[:, own].conj().T @ now.shapes)**2
    scale = np.abs(last.values[own]).max()
    change = np.abs(last.values[own][:, None] - now.values[None]) / max(scale, 1e-300)
    return linear_sum_assignment(1.0 - likeness + change)[1]
