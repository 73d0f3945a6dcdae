"""Cantilevers along any axis under a force at the tip, of the cases with coupled sections.

A case is its axis, section, force at the tip, and the displacement of the tip that is published.
"""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sebody import Model
from sebody.analysis import equilibrium
from sebody.fem import Axis, GeneralSection, Stations
from sebody.model.parts import Node
from sebody.verify.outside.case import Quantity

Beam = tuple[Axis, GeneralSection | Stations, ArrayLike, ArrayLike]
LINE = [[0.0, 0.0, 0.0], [10.0, 0.0, 0.0]]
ELEMENTS = 32           # of one body each


def cantilever(case: tuple, elements: int, bodies: int | None = None, modes: int = 0,
               turn: ArrayLike | None = None, **options: Any) -> tuple[Model, Node]:
    """Model of a case, perhaps turned and shifted, and its last node."""
    axis, section, force = case[:3]
    R = np.eye(3) if turn is None else np.asarray(turn)
    model = Model()
    root = model.node("root", R @ axis.position(0.0) + (0.0 if turn is None else [1.0, 2.0, 3.0]))
    tip = model.node("tip", root.point + R @ (axis.position(1.0) - axis.position(0.0)))
    if turn is not None:
        options["rotation"] = R
    model.beam("beam", (root, tip), section, elements, bodies, modes, axis=axis, **options)
    model.fix(root)
    model.force(tip, R @ force)
    return model, tip


def moved(case: tuple, *arguments: Any, **options: Any) -> NDArray:
    """Displacement of the tip at rest."""
    model, tip = cantilever(case, *arguments, **options)
    return equilibrium(model, steps=5)["tip.position"][-1] - tip.point


def error(u: NDArray, case: Beam) -> float:
    """Difference from the published displacement, relative to its length."""
    return float(np.linalg.norm(u - np.asarray(case[3])) / np.linalg.norm(case[3]))


def by_axes(u: NDArray, label: str = "") -> dict[str, float]:
    """A displacement of the tip as values of quantities."""
    return {f"u{axis} of the tip{label}": value for axis, value in zip("xyz", u, strict=True)}


def quantities(reference: ArrayLike, label: str = "", **others: Any) -> tuple[Quantity, ...]:
    """A published displacement of the tip, by its length."""
    size = float(np.linalg.norm(reference))
    return tuple(Quantity(name, value, size, group=f"tip{label}", **others)
                 for name, value in by_axes(np.asarray(reference), label).items())
