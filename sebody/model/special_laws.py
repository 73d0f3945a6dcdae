"""Laws of springs and dampers that are more than coefficients: tables, gaps, preloads."""

from __future__ import annotations

from os import PathLike
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.model.spring_laws import Given, Law

_NO_CUBIC = "force, gap, tension_only, preload or a table"


class Special(NamedTuple):
    """A spring's options that make it one of tables."""

    force: Given | None
    damping: float | Given
    gap: float
    tension_only: bool
    preload: float
    between: ArrayLike | None

    @property
    def given(self) -> bool:
        """Tell whether any of it is given: else a spring has coefficients alone."""
        left_out = all(np.isscalar(one) and one == 0
                       for one in (self.gap, self.tension_only, self.preload))
        return (not left_out or self.force is not None or _is_table(self.damping)
                or self.between is not None)

    def tables(self, what: str, stiffness: float, cubic: float) -> dict[str, NDArray]:
        """The numbers of both tables, by the names of the kernel's constants."""
        if self.force is None:
            check(what, stiffness=stiffness)
            law = Law.straight(stiffness)
            if self.between is not None:
                raise InputError(f"{what}: between= is of a function: give force=, or leave it out")
        else:
            if stiffness:
                raise InputError(f"{what} has a stiffness and a force: give one of them")
            law = Law.of(self.force, self.between, f"{what}: force")
        if cubic:
            raise InputError(f"{what} has cubic= and {_NO_CUBIC}: put the cubic in force=")
        if gap := inputs.number(self.gap, f"{what}: gap", least=0):
            law = law.with_gap(gap, what)
        if preload := inputs.number(self.preload, f"{what}: preload"):
            law = law._replace(forces=law.forces + preload)
        if inputs.flag(self.tension_only, f"{what}: tension_only"):
            law = law.pulling(what)
        if not _is_table(self.damping):
            damper = Law.straight(inputs.number(self.damping, f"{what}: damping", least=0))
        elif callable(self.damping):
            raise InputError(f"{what}: damping is a function: give a table of rows (rate, force)")
        else:
            damper = Law.of(self.damping, None, f"{what}: damping")
            if (damper.forces * damper.places < 0.0).any():
                raise InputError(f"{what}: damping has rows whose force drives the rate: give "
                                 "forces of the sign of the rate")
        return {"force": law.packed(), "damper": damper.packed()}


def _is_table(damping: float | Given) -> bool:
    """Tell a table, a file or a function from what is to be a number."""
    if isinstance(damping, str):
        return bool(Path(damping).suffix)
    rows = isinstance(damping, list | tuple | np.ndarray) and len(damping) > 0
    return callable(damping) or isinstance(damping, PathLike) or (
        rows and np.iterable(damping[0]))   # type: ignore[index]


def check(what: str, **values: float) -> None:
    """Refuse numbers that are negative or not finite."""
    for name, value in values.items():
        inputs.number(value, f"{what}: {name}", least=0)
