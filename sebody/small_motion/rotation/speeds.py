"""Steady rotations of a model at one speed after another, in axes of one kind.

Bearings by tables are read at every speed. Unbalances are left out: to the first order they change
no frequency, and with them the matrices are constant in no axes.
"""

from __future__ import annotations

from dataclasses import replace
from typing import cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.model.arguments import known, named_axis
from sebody.model.model import Model
from sebody.model.parts import Element, Node
from sebody.model.shafts import shaft_direction, unbalances
from sebody.model.variants.copying import copied
from sebody.results.result import Result
from sebody.runs.bearing_speeds import limits, read_tables
from sebody.runs.rotating_frame import Spin
from sebody.runs.statics import steady_rotation
from sebody.runs.turning_parts import parts_of
from sebody.small_motion.rotation.views import FRAMES, View, decided


class Rotations:
    """A model without its unbalances, at any speed.

    Parameters
    ----------
    fastest : float
        Speed at which the axes are decided on [1/time].
    what : str
        The analysis, for messages.

    Attributes
    ----------
    slowest, fastest : float
        Between which tables of bearings lie; from zero without any.
    """

    def __init__(self, model: Model, axis: ArrayLike | None, fastest: float, frame: str,
                 hub: Node | str | None, steps: int, what: str):
        inputs.instance(model, "model", Model, "give a Model")
        frame = inputs.choice(frame, "frame", FRAMES)
        self._steps = inputs.integer(steps, "steps", least=1)
        name = None if hub is None else known(model, hub).name
        self.unbalances, self.model = _apart(model)
        own = None if name is None else self.model.nodes[name]
        self.unit = parts_of(self.model, Spin(_direction(model, axis, what), model.planar), own)
        self.slowest, self.fastest = limits(self.model, self.unit)
        size = min(max(abs(fastest), self.slowest), self.fastest)
        read_tables(self.model, self.unit.times(size))
        self.view = decided(self.model, self.unit.times(np.copysign(size, fastest)), frame, own)

    def at(self, speed: float) -> tuple[Result, View]:
        """The steady rotation at a speed, and the axes in which motion about it is told.

        Raises
        ------
        SimulationError
            There is no equilibrium.
        """
        spin = self.unit.times(speed)
        read_tables(self.model, spin)
        return steady_rotation(self.model, self._steps, spin), replace(self.view, spin=spin)


def _apart(model: Model) -> tuple[list[Element], Model]:
    """Unbalances, and a copy of the model without them."""
    made = cast(Model, copied(model))
    found = unbalances(made)
    for one in found:
        del made.rigid_bodies[one.name]
    return found, made


def _direction(model: Model, axis: ArrayLike | None, what: str) -> NDArray:
    """The axis of rotation, of unit length."""
    if model.planar:
        return np.array(1.0)
    if axis is None:
        return shaft_direction(model, what)
    direction = inputs.vector(named_axis(axis, 3, "axis"), "axis", 3)
    length = np.linalg.norm(direction)
    if not length > 0.0:
        raise InputError("axis has no length: give its direction")
    return direction / length
