"""Triplets, the blocks of unknowns, and the nodes made of them."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from sebody.model.histories import History


@dataclass(eq=False)
class Triplet:
    """A block of unknowns: a position or a rotation (in a plane two coordinates or an angle).

    It is free, fixed, moved in a prescribed way, or, for a position, dependent: at the end of rigid
    arms that turn with rotations, the first one at a root.
    """

    name: str
    start: NDArray                  # initial position; zeros for a rotation
    rate: NDArray                   # initial velocity, or angular velocity (material = global)
    fixed: bool = False             # not solved for: at rest or prescribed
    motions: list[tuple[NDArray, History]] = field(default_factory=list)  # directions, histories
    root: "Triplet | None" = None   # of a dependent position, with its arms
    arms: tuple[tuple["Triplet", NDArray], ...] = ()
    given: bool = False             # its initial velocity was given by the user
    turns: bool = False             # a rotation

    @property
    def solved(self) -> bool:
        """Whether it is an unknown."""
        return not self.fixed and self.root is None

    def parents(self) -> list["Triplet"]:
        """The triplets its place depends on: itself, or root and rotations of the arms."""
        return [self] if self.root is None else [self.root, *(r for r, _ in self.arms)]


@dataclass(eq=False)
class Node:
    """A named point of the model; either triplet may be absent or shared with another node."""

    name: str
    point: NDArray
    position: Triplet | None
    rotation: Triplet | None


@dataclass(eq=False)
class Element:
    """A joint, rigid body, load, spring or drive: a generated kernel on some triplets."""

    name: str
    kind: str                       # of its kernel
    triplets: tuple[Triplet, ...]   # positions first, then rotations
    constants: NDArray
    multipliers: int = 0
    history: History | None = None
    mode: tuple[str, int] | None = None     # superelement and internal mode it acts on
    function: object = None                 # a user's compiled one, kept alive

    @property
    def direction(self) -> NDArray:
        """Of a load."""
        return self.constants


def unit_vectors(axis: NDArray) -> tuple[NDArray, NDArray, NDArray]:
    """A unit vector along the axis and two normal to it, right-handed."""
    e = axis / np.linalg.norm(axis)
    first = np.cross(e, np.eye(3)[np.argmin(np.abs(e))])
    first /= np.linalg.norm(first)
    return e, first, np.cross(e, first)
