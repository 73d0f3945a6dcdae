"""The plane in space that a planar model was taken from, and quantities of its runs in space."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError

POINTS = ("position",)
VECTORS = ("velocity", "acceleration", "displacement", "force", "reaction", "momentum")
AXIAL = ("angular_velocity", "angular_acceleration", "moment", "reaction_moment")
SAME = ("t", "torque", "thrust", "power", "work", "kinetic", "strain", "potential",
        "external_work", "section_forces", "section_strains", "stress", "von_mises",
        "value", "states")      # numbers, or in own axes


@dataclass(frozen=True, eq=False)
class Plane:
    """A plane in space.

    Parameters
    ----------
    origin : (3,)
        Where the planar coordinates are zero [length].
    axes : (3, 3)
        A rotation: its columns are the planar x and y axes, then the normal, about which the
        angles count.
    """

    origin: NDArray
    axes: NDArray

    @classmethod
    def through(cls, point: ArrayLike, normal: ArrayLike) -> "Plane":
        """The plane through a point; normal to a global axis it has the other two as axes.

        Parameters
        ----------
        point, normal : (3,)
        """
        n = inputs.vector(normal, "normal of a plane", 3)
        n = n / np.linalg.norm(n)
        n = np.where(np.abs(n) < 1e-14, 0.0, n)     # rounding would choose between equal axes
        n = n / np.linalg.norm(n)
        first = np.eye(3)[int(np.argmin(np.abs(n)))]
        first = first - n * (n @ first)
        first /= np.linalg.norm(first)
        axes = np.column_stack([first, np.cross(n, first), n])
        return cls(n * (n @ inputs.vector(point, "point of a plane", 3)), axes)

    @property
    def normal(self) -> NDArray:
        """Unit normal, (3,)."""
        return self.axes[:, 2]

    def points(self, values: ArrayLike) -> NDArray:
        """Points in space, (..., 3), of planar ones (..., 2)."""
        return self.origin + self.vectors(values)

    def vectors(self, values: ArrayLike) -> NDArray:
        """Vectors in space, (..., 3), of planar ones (..., 2), or (..., 3) along the axes."""
        values = np.asarray(values, dtype=float)
        return values @ self.axes[:, :values.shape[-1]].T

    def axial(self, values: ArrayLike) -> NDArray:
        """Angular velocities or moments in space, (..., 3), of planar ones (...)."""
        return np.asarray(values, dtype=float)[..., None] * self.normal

    def rotations(self, angles: ArrayLike) -> NDArray:
        """Rotation matrices in space, (..., 3, 3), of planar angles (...)."""
        c, s = np.cos(angles)[..., None, None], np.sin(angles)[..., None, None]
        n, one = self.normal, np.eye(3)
        return c * one + s * np.cross(one, n) + (1 - c) * np.outer(n, n)

    def to_space(self, name: str, values: ArrayLike) -> NDArray:
        """A quantity of a planar run as the spatial model has it: to compare the two.

        Parameters
        ----------
        name : str
            Of the quantity, such as ``"tip.position"``, see `sebody.Result`.
        values : (n, ...)
            Its time function in the planar run.

        Raises
        ------
        InputError
            A quantity that differs by more than axes: modes, multipliers, axes of joints.
        """
        quantity = inputs.name(name, "name of a quantity").rpartition(".")[2]
        values = np.asarray(values, dtype=float)
        if quantity == "angular_momentum" or name.startswith("constraints."):
            raise InputError(f"{name!r} is another quantity in a plane, about another point or of "
                             "other equations: compare a quantity of a node, joint or load")
        if quantity not in _MAPS:
            raise InputError(f"{name!r} of a planar run has no counterpart in space: there are "
                             f"{', '.join(_MAPS)}")
        return _MAPS[quantity](self, values)


_MAPS: dict[str, Callable[[Plane, NDArray], NDArray]] = (
    dict.fromkeys(POINTS, Plane.points) | dict.fromkeys(VECTORS, Plane.vectors)
    | dict.fromkeys(AXIAL, Plane.axial) | {"rotation": Plane.rotations}
    | dict.fromkeys(SAME, lambda plane, values: values))
