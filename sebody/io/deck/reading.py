"""Input decks of CalculiX and Abaqus: nodes, elements, sets, what ties them, materials."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import NamedTuple

from sebody.basics.errors import InputError
from sebody.io.deck.cards import Card, Row, plain_name, read_cards
from sebody.io.deck.materials import (
    DeckMaterial,
    Orientation,
    Section,
    read_elastic,
    read_orientation,
)
from sebody.io.deck.sets import Sets
from sebody.io.deck.surfaces import Solid, Surface, surface_nodes
from sebody.io.element_checks import check_elements

# meshio's names of the cells of solids, whose orders of nodes are those of CalculiX and Abaqus
CELLS = {"C3D8": "hexahedron", "C3D8R": "hexahedron", "C3D8I": "hexahedron",
         "C3D20": "hexahedron20", "C3D20R": "hexahedron20", "C3D4": "tetra", "C3D10": "tetra10",
         "C3D10M": "tetra10", "C3D6": "wedge", "C3D15": "wedge15"}
# numbers of nodes of elements that may fill several lines
NODES_OF = {"C3D20": 20, "C3D20R": 20, "C3D15": 15, "C3D10": 10, "C3D10M": 10}


class RigidBody(NamedTuple):
    """Nodes tied to a reference node; its rotation may be that of a node of its own.

    A rotation node of None is one that the program makes, with a label of its choice.
    """

    kind: str           # NSET, ELSET or SURFACE, and its name
    name: str
    row: Row
    reference: int
    rotation: int | None


class Tie(NamedTuple):
    """A surface whose nodes follow the faces of another one."""

    name: str
    slave: str
    master: str
    adjusted: bool      # whether the nodes are moved to the faces
    row: Row


class Elements(NamedTuple):
    """Elements of one type, ``{label: node labels}``."""

    kind: str
    nodes: dict[int, tuple[int, ...]]
    row: Row        # where they begin


@dataclass(eq=False)
class Deck:
    """Contents of a deck, by the labels of nodes and elements and names in capitals."""

    path: Path
    nodes: dict[int, tuple[float, float, float]] = field(default_factory=dict)
    elements: list[Elements] = field(default_factory=list)
    node_sets: Sets = field(default_factory=lambda: Sets("node"))
    element_sets: Sets = field(default_factory=lambda: Sets("element"))
    surfaces: dict[str, Surface] = field(default_factory=dict)
    rigid_bodies: list[RigidBody] = field(default_factory=list)
    coupling: RigidBody | None = None       # the last one
    ties: list[Tie] = field(default_factory=list)
    materials: dict[str, DeckMaterial] = field(default_factory=dict)
    orientations: dict[str, Orientation] = field(default_factory=dict)
    sections: list[Section] = field(default_factory=list)
    supports: list[Row] = field(default_factory=list)       # rows of *BOUNDARY
    places: dict[str, Row] = field(default_factory=dict)    # where each keyword occurs first

    @cached_property
    def solids(self) -> dict[int, Solid]:
        """Solid elements by their labels."""
        return {label: Solid(CELLS[group.kind], nodes) for group in self.elements
                if group.kind in CELLS for label, nodes in group.nodes.items()}

    def card(self, keyword: str) -> str:
        """A keyword that occurs, with its line, for messages."""
        return f"*{keyword} (line {self.places[keyword].number})"

    def surface_nodes(self, name: str) -> list[int]:
        """Labels of the nodes of a surface."""
        return surface_nodes(self.surfaces[name], self.node_sets, self.element_sets, self.solids)

    def element_nodes(self, labels: Iterable[int]) -> list[int]:
        """Labels of the nodes of some elements."""
        own = set(labels)
        return [node for group in self.elements for label, nodes in group.nodes.items()
                if label in own for node in nodes]

    def tied_nodes(self, body: RigidBody) -> list[int]:
        """Labels of the nodes that follow a reference node."""
        if body.kind == "SURFACE":
            if body.name not in self.surfaces:
                raise body.row.fault(f"surface {body.name} is unknown", "define it in the deck")
            labels = self.surface_nodes(body.name)
        elif body.kind == "ELSET":
            labels = self.element_nodes(self.element_sets.member(body.row, body.name))
        else:
            labels = self.node_sets.member(body.row, body.name)
        return [label for label in dict.fromkeys(labels) if label != body.reference]

    def named_nodes(self) -> Iterator[tuple[str, tuple[int, ...] | list[int]]]:
        """Names of node sets and surfaces with their nodes; a set goes before a surface."""
        for name in self.surfaces:
            if name not in self.node_sets:
                yield name, self.surface_nodes(name)
        for name in self.node_sets:
            yield name, self.node_sets.labels(name)


def read_deck(path: Path) -> Deck:
    """A deck with the files it includes.

    Raises
    ------
    InputError
        A file that cannot be read, or a line that cannot be understood, which is named.
    """
    deck = Deck(Path(path))
    for card in read_cards(deck.path):
        deck.places.setdefault(card.keyword, card.row)
        read = _READERS.get(card.keyword.replace(" ", ""))      # blanks do not matter
        if read:
            read(deck, card)
    if not deck.nodes:
        raise InputError(f"deck {path} has no *NODE: give the deck that the matrices were "
                         "computed from")
    check_elements(deck.path, deck.elements, deck.nodes, CELLS)
    return deck


def _node(deck: Deck, card: Card) -> None:
    coordinates = []
    for row in card.data:
        label = row.label(row.words[0])
        x, y, z = ([row.real(word) for word in row.words[1:4]] + [0.0] * 3)[:3]
        if label in deck.nodes and deck.nodes[label] != (x, y, z):
            raise row.fault(f"node {label} has two places", "give every node a label of its own")
        deck.nodes[label] = (x, y, z)
        coordinates.append(label)
    if "NSET" in card.parameters:
        deck.node_sets.add(card.name("NSET"), coordinates)


def _element(deck: Deck, card: Card) -> None:
    kind = card.name("TYPE")
    nodes: dict[int, tuple[int, ...]] = {}
    labels: list[int] = []
    for row in card.data:
        labels += [row.label(word) for word in row.words if word]
        if row.words[-1] == "" or len(labels) - 1 < NODES_OF.get(kind, 0):
            continue                    # goes on in the next line
        nodes[labels[0]] = tuple(labels[1:])
        labels = []
    if labels:
        raise card.data[-1].fault(f"the last element of *ELEMENT, TYPE={kind} has "
                                  f"{len(labels) - 1} nodes", "the deck is cut off, write it again")
    name = card.name("ELSET") if "ELSET" in card.parameters else ""
    deck.elements.append(Elements(kind, nodes, card.row))
    if name:
        deck.element_sets.add(name, nodes)


def _node_set(deck: Deck, card: Card) -> None:
    name = card.name("NSET")
    if "ELSET" in card.parameters:      # the nodes of these elements
        own = deck.element_sets.member(card.row, card.name("ELSET"))
        deck.node_sets.add(name, deck.element_nodes(own))
    deck.node_sets.read(card, name)


def _element_set(deck: Deck, card: Card) -> None:
    deck.element_sets.read(card, card.name("ELSET"))


def _surface(deck: Deck, card: Card) -> None:
    kind = card.parameters.get("TYPE", "ELEMENT").upper()
    deck.surfaces[card.name("NAME")] = Surface(kind == "NODE", card.data)


def _rigid_body(deck: Deck, card: Card) -> None:
    kind = "ELSET" if "ELSET" in card.parameters else "NSET"
    rotation = card.label("ROT NODE") if "ROTNODE" in card.parameters else None
    deck.rigid_bodies.append(RigidBody(kind, card.name(kind), card.row, card.label("REF NODE"),
                                       rotation))


def _coupling(deck: Deck, card: Card) -> None:
    deck.coupling = RigidBody("SURFACE", card.name("SURFACE"), card.row, card.label("REF NODE"),
                              None)


def _kinematic(deck: Deck, card: Card) -> None:
    """Nodes of the surface of the *COUPLING before; all of their translations follow."""
    if deck.coupling is None:
        raise card.row.fault("*KINEMATIC without a *COUPLING before it", "write the deck again")
    deck.rigid_bodies.append(deck.coupling)


def _tie(deck: Deck, card: Card) -> None:
    adjusted = card.parameters.get("ADJUST", "YES").upper() != "NO"
    for row in card.data:
        slave, master = (plain_name(word) for word in [*row.words, ""][:2])
        for name in (slave, master):
            if name not in deck.surfaces:
                raise row.fault(f"*TIE of surface {name or '(none)'}, which does not exist",
                                "define the surface before it")
        deck.ties.append(Tie(card.parameters.get("NAME", "").upper(), slave, master, adjusted,
                             row))


def _material(deck: Deck, card: Card) -> None:
    name = card.name("NAME")
    deck.materials.pop(name, None)      # the last one read is the last in order
    deck.materials[name] = DeckMaterial()


def _elastic(deck: Deck, card: Card) -> None:
    if deck.materials and card.data:
        read_elastic(_last(deck), card)


def _density(deck: Deck, card: Card) -> None:
    if deck.materials and card.data:
        _last(deck).density = card.reals()[0]


def _last(deck: Deck) -> DeckMaterial:
    return next(reversed(deck.materials.values()))


def _orientation(deck: Deck, card: Card) -> None:
    deck.orientations[card.name("NAME")] = read_orientation(card)


def _section(deck: Deck, card: Card) -> None:
    orientation = card.name("ORIENTATION") if "ORIENTATION" in card.parameters else ""
    deck.sections.append(Section(card.name("ELSET"), card.name("MATERIAL"), orientation))


def _boundary(deck: Deck, card: Card) -> None:
    deck.supports += card.data


_READERS = {"NODE": _node, "ELEMENT": _element, "NSET": _node_set, "ELSET": _element_set,
            "SURFACE": _surface, "RIGIDBODY": _rigid_body, "COUPLING": _coupling,
            "KINEMATIC": _kinematic, "TIE": _tie, "BOUNDARY": _boundary, "MATERIAL": _material,
            "ELASTIC": _elastic, "DENSITY": _density, "ORIENTATION": _orientation,
            "SOLIDSECTION": _section}
