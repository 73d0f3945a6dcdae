"""Parts of ropes: sheaves, places, stretches of one tension."""

from typing import NamedTuple

from numpy.typing import NDArray

from sebody.model.parts import DofBlock, Element, Node

ROPE = "rope"       # kind of the joints that hold the equations of ropes


class Sheave(NamedTuple):
    """A sheave or drum on a node, which ropes pass or end on."""

    name: str
    node: Node
    radius: float           # [length]
    axis: NDArray           # unit vector, global axes at the start, (3,)
    wheel: Element | None   # of one with inertia, which turns about its node
    friction: float = 0.0   # coefficient against ropes that pass

    @property
    def holds(self) -> bool:
        """Tell whether tensions on the sides of a rope that passes it differ."""
        return self.wheel is not None or self.friction > 0.0

    @property
    def angle(self) -> DofBlock | None:
        """The angle of the sheave relative to its node, of one with inertia."""
        return None if self.wheel is None else self.wheel.hidden


class RopePlace(NamedTuple):
    """A point or sheave of a rope."""

    node: Node
    sheave: Sheave | None
    radius: float           # with the sign of the side: negative where it passes clockwise
    normal: NDArray         # that sides are seen from, global axes at the start, (3,)
    wrap: float             # angle of contact at the start [rad]


class Stretch(NamedTuple):
    """A part of a rope with one tension: its law, and the spans that are in it."""

    law: Element
    spans: tuple[Element, ...]

    @property
    def length(self) -> DofBlock:
        """The unknown of its length."""
        assert self.law.hidden is not None
        return self.law.hidden


class Rope(NamedTuple):
    """A rope over points and sheaves."""

    name: str
    places: tuple[RopePlace, ...]
    stretches: tuple[Stretch, ...]
    winch: DofBlock | None      # what a winch has given
    frictions: tuple[Element, ...] = ()     # on the sheaves that have some, in its order

    def __repr__(self) -> str:
        over = ", ".join(place.node.name if place.sheave is None else place.sheave.name
                         for place in self.places)
        return f"<Rope {self.name!r} over {over}>"
