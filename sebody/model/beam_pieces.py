"""Parts of a beam that become superelements: where they end, and their FE models."""

from __future__ import annotations

from typing import Literal, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse.linalg import spsolve

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.fem import Axis, beam_along, planar_beam, straight_beam
from sebody.fem.beam import section_axes
from sebody.fem.general_section import GeneralSection
from sebody.fem.model import FEModel
from sebody.fem.section_along import AnySection, part_of, section_at
from sebody.model.mechanism import Mechanism
from sebody.model.parts import Node

MEASURED = 128      # elements of the whole beam whose turning is divided equally
NEAR = 1e-6         # of the length: distance of the last node from the end of an axis

Division: TypeAlias = Literal["length", "rotation"] | ArrayLike


class StraightPiece(NamedTuple):
    """A straight part along x, its section's y axis along y."""

    planar: bool
    length: float
    section: AnySection
    elements: int

    def fe_model(self) -> FEModel:
        """FE model of equal elements."""
        first, last = np.zeros((2, 2 if self.planar else 3))
        last[0] = self.length
        return (planar_beam(first, last, self.section, self.elements) if self.planar else
                straight_beam(first, last, self.section, self.elements, (0.0, 1.0, 0.0)))


class AxisPiece(NamedTuple):
    """A part of an axis, in the axes in which it is given."""

    axis: Axis
    section: AnySection
    first: float
    last: float
    elements: int

    def fe_model(self) -> FEModel:
        """FE model of elements that are equally long."""
        return beam_along(self.axis, self.section,
                          np.linspace(self.first, self.last, self.elements + 1))


class Course(NamedTuple):
    """The whole way of a beam, straight between two nodes or along an axis.

    Parameters
    ----------
    model : Mechanism
    ends : two of Node
    section : AnySection
        A function of the place, or one for all.
    up : (3,), optional
    axis : Axis, optional
    rotation : (3, 3), optional
        From the axes of the axis to those of the model.
    """

    model: Mechanism
    ends: tuple[Node, Node]
    section: AnySection
    up: ArrayLike | None = None
    axis: Axis | None = None
    rotation: ArrayLike | None = None

    @property
    def length(self) -> float:
        """Length of the whole beam."""
        return (float(np.linalg.norm(self.ends[1].point - self.ends[0].point))
                if self.axis is None else self.axis.length)

    @property
    def coupled(self) -> bool:
        """Tell whether tension, torsion and bending need not be independent."""
        return self.axis is not None or isinstance(section_at(self.section, 0.5), GeneralSection)

    @property
    def turn(self) -> tuple[tuple[float, ...], ...]:
        """Rows of the rotation from the axes of the parts to those of the model."""
        if self.axis is not None:
            turn = np.eye(3) if self.rotation is None else inputs.rotation(self.rotation,
                                                                           "rotation")
        else:
            line, d = np.zeros(3), self.model.dimension
            line[:d] = self.ends[1].point - self.ends[0].point
            up = None if self.up is None else inputs.vector(self.up, "up", 3)
            turn = section_axes(line, up)[:d, :d].T
        return tuple(map(tuple, turn.tolist()))

    def points(self, places: NDArray) -> NDArray:
        """Points (n, D) of the model at places."""
        first, last = (node.point for node in self.ends)
        if self.axis is None:
            return first + places[:, None] * (last - first)
        way = self.axis.position(places) - self.axis.position(0.0)
        return first + way @ np.array(self.turn).T

    def piece(self, first: float, last: float, elements: int) -> StraightPiece | AxisPiece:
        """The part between two places."""
        if self.axis is not None:
            return AxisPiece(self.axis, self.section, first, last, elements)
        part = self.section if (first, last) == (0.0, 1.0) else part_of(self.section, first, last)
        return StraightPiece(self.model.planar, (last - first) * self.length, part, elements)

    def check(self, name: str) -> None:
        """Refuse what does not fit together.

        Raises
        ------
        InputError
            An axis in a plane or beside `up`, one that does not end at the last node.
        """
        if self.axis is None:
            if self.up is not None and self.model.planar:
                raise InputError(f"beam {name!r}: up is for beams in space, leave it out")
            return
        inputs.instance(self.axis, f"axis of beam {name!r}", Axis, "give a sebody.fem.Axis")
        if self.model.planar:
            raise InputError(f"beam {name!r}: an axis is for beams in space: build a spatial model")
        if self.up is not None:
            raise InputError(f"beam {name!r}: its axis has its own up: leave up out here")
        end = self.points(np.array([1.0]))[0]
        off = np.linalg.norm(end - self.ends[1].point)
        if off > NEAR * self.axis.length:
            raise InputError(
                f"beam {name!r}: from node {self.ends[0].name!r} its axis leads to "
                f"({', '.join(f'{x:.6g}' for x in end)}), and node {self.ends[1].name!r} is "
                f"{off:.3g} away: place it there (axis.position(1.0)), or give rotation=, the "
                "matrix that turns the axis into the model")


def divided(course: Course, name: str, divide: Division, elements: int, bodies: int) -> NDArray:
    """Places of the ends of a beam's superelements, (bodies + 1,).

    Raises
    ------
    InputError
        Another division, or places that do not ascend from 0 to 1.
    """
    if isinstance(divide, str):
        if inputs.choice(divide, f"beam {name!r}: divide", ("length", "rotation"),
                         "give 'length', 'rotation' or places from 0 to 1") == "length":
            return np.linspace(0, 1, bodies + 1)
        return _equal_turning(course, bodies, elements)
    places = inputs.vector(divide, f"beam {name!r}: divide", bodies + 1, remedy=(
        f"give 'length', 'rotation' or {bodies + 1} places from 0 to 1, the ends of "
        f"{bodies} bodies"))
    if places[0] != 0 or places[-1] != 1 or (np.diff(places) <= 0).any():
        raise inputs.refusal(f"beam {name!r}: divide", places.tolist(),
                             "give places that ascend from 0 to 1")
    return places


def _equal_turning(course: Course, bodies: int, elements: int) -> NDArray:
    """Places between which the beam turns equally under the tip load that moves it most."""
    count = max(MEASURED, elements)
    fe = course.piece(0.0, 1.0, count).fe_model()
    held = len(fe.node_dofs)
    K, tip = fe.stiffness[held:, held:].tocsc(), fe.dofs(count, "translation")
    loads = np.zeros((fe.stiffness.shape[0], len(tip)))
    loads[tip, range(len(tip))] = 1.0
    moved = np.zeros_like(loads)
    moved[held:] = spsolve(K, loads[held:])
    worst = np.linalg.eigh(moved[tip])[1][:, -1]
    turns = (moved @ worst).reshape(count + 1, held)[:, -(held // 2):]
    steps = np.cumsum([0.0, *np.linalg.norm(np.diff(turns, axis=0), axis=1)])
    found = np.interp(np.linspace(0, steps[-1], bodies + 1), steps, np.linspace(0, 1, count + 1))
    found[[0, -1]] = 0.0, 1.0
    return found
