"""Bearings by tables of the speed: read at the speed of what turns in them."""

from __future__ import annotations

from typing import cast

import numpy as np

from sebody.basics.errors import InputError
from sebody.model.bushings import by_tables, table_constants
from sebody.model.model import Model
from sebody.model.parts import Element
from sebody.model.variants.copying import copied
from sebody.runs.rotating_frame import Spin

OTHER = 1e-6        # of a speed: another one at which a table was read


def copied_for_reading(model: Model) -> Model:
    """A copy of a model if it has tables, so that those can be read; else the model itself."""
    return cast(Model, copied(model)) if by_tables(model) else model


def read_tables(model: Model, spin: Spin) -> None:
    """Give bearings the coefficients at a spin: at the relative speed of their two nodes.

    Raises
    ------
    InputError
        A speed outside a table.
    """
    for bearing in by_tables(model):
        assert bearing.table is not None
        speed = speed_in(bearing, spin)
        bearing.constants = {**bearing.constants,
                             **table_constants(bearing.table, speed, bearing)}
        bearing.read_at = speed


def speed_in(bearing: Element, spin: Spin) -> float:
    """Relative speed of the nodes of a bearing."""
    ends = [spin.turning(place.dof_block) for place in bearing.attachments[2:]]
    first, second = (0.0 if one is None else one.factor for one in ends)
    return abs(second - first) * float(np.sqrt(spin.squared))


def limits(model: Model, unit: Spin) -> tuple[float, float]:
    """Lowest and highest speed that all tables have, in multiples of a spin."""
    lowest, highest = 0.0, np.inf
    for bearing in by_tables(model):
        assert bearing.table is not None
        if (ratio := speed_in(bearing, unit)) > 0.0:
            lowest = max(lowest, bearing.table.speeds[0] / ratio)
            highest = min(highest, bearing.table.speeds[-1] / ratio)
    return lowest, highest


def check_read(model: Model, spin: Spin) -> None:
    """Refuse a spin at which tables of a state were not read.

    Raises
    ------
    InputError
        The message names the bearing.
    """
    for bearing in by_tables(model):
        speed = speed_in(bearing, spin)
        if bearing.read_at is None or abs(bearing.read_at - speed) > OTHER * max(speed, 1e-300):
            raise InputError(
                f"{bearing.name!r} has a table of the speed, which was read at "
                f"{0.0 if bearing.read_at is None else bearing.read_at:.6g} and not at "
                f"{speed:.6g} rad/time: give the equilibrium at this spin, equilibrium(model, "
                "spin=...)")
