"""Input decks of CalculiX and Abaqus: nodes, elements, sets, rigid bodies, materials."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.errors import InputError
from sebody.io.element_checks import check_elements
from sebody.io.text import fault, read_text

# meshio's names of the cells of solids, whose orders of nodes are those of CalculiX and Abaqus
CELLS = {"C3D8": "hexahedron", "C3D8R": "hexahedron", "C3D8I": "hexahedron",
         "C3D20": "hexahedron20", "C3D20R": "hexahedron20", "C3D4": "tetra", "C3D10": "tetra10",
         "C3D10M": "tetra10", "C3D6": "wedge", "C3D15": "wedge15"}
_DEPTH = 10     # of files that include others; more is a circle


class RigidBody(NamedTuple):
    """Nodes tied to a reference node, whose rotation may be that of a node of its own."""

    nodes: tuple[int, ...]
    reference: int
    rotation: int


class Elements(NamedTuple):
    """Elements of one type, ``{label: node labels}``."""

    kind: str
    name: str       # of their set
    nodes: dict[int, tuple[int, ...]]


class Material(NamedTuple):
    """Isotropic material; a number that the deck does not give is NaN."""

    youngs_modulus: float
    poisson_ratio: float
    density: float


@dataclass(eq=False)
class Deck:
    """What a deck says, by the labels of nodes and the names of sets in capitals."""

    path: Path
    nodes: dict[int, tuple[float, float, float]] = field(default_factory=dict)
    node_sets: dict[str, list[int]] = field(default_factory=dict)
    elements: list[Elements] = field(default_factory=list)
    rigid_bodies: list[RigidBody] = field(default_factory=list)
    materials: dict[str, Material] = field(default_factory=dict)
    sections: dict[str, str] = field(default_factory=dict)      # material by set of elements
    keywords: set[str] = field(default_factory=set)


class Card(NamedTuple):
    """A keyword with its parameters and data lines, each with the line it stands in."""

    path: Path
    line: int
    keyword: str
    parameters: dict[str, str]
    data: list[tuple[int, list[str]]]


def read_deck(path: Path) -> Deck:
    """A deck with the files it includes.

    Raises
    ------
    InputError
        A file that cannot be read, or a line that cannot be understood, which is named.
    """
    deck = Deck(Path(path))
    for card in _cards(deck.path, 0):
        deck.keywords.add(card.keyword)
        if card.keyword in _READERS:
            _READERS[card.keyword](deck, card)
    if not deck.nodes:
        raise InputError(f"deck {path} has no *NODE: give the deck that the matrices were "
                         "computed from")
    check_elements(deck.path, deck.elements, deck.nodes, CELLS)
    return deck


def deck_sets(deck: Deck, index: dict[int, int]) -> dict[str, list[int]]:
    """Node sets as node indices."""
    return {name: list(dict.fromkeys(index[label] for label in labels if label in index))
            for name, labels in deck.node_sets.items()}


def deck_cells(deck: Deck, index: dict[int, int]) -> list[tuple[str, NDArray]]:
    """Connectivity of the solids by meshio's names."""
    found: dict[str, list] = {}
    for elements in deck.elements:
        if elements.kind in CELLS:
            found.setdefault(CELLS[elements.kind], []).extend(
                [index[label] for label in nodes] for nodes in elements.nodes.values())
    return [(kind, np.array(cells)) for kind, cells in found.items()]


def material_of(deck: Deck, elements: Elements) -> Material | None:
    """The material of a group of elements, if a section gives it one."""
    return deck.materials.get(deck.sections.get(elements.name, ""))


def _cards(path: Path, depth: int) -> Iterator[Card]:
    remedy = "give the deck that the matrices were computed from"
    if depth > _DEPTH:
        raise InputError(f"deck {path} is included by itself: take the circle of *INCLUDE out")
    card = None
    for number, line in enumerate(read_text(path, "deck", remedy).splitlines(), 1):
        if line.startswith("**") or not line.strip():
            continue
        if not line.startswith("*"):
            if card:
                card.data.append((number, [word.strip() for word in line.split(",")]))
            continue
        if card:
            yield card
        card = _card(path, number, line)
        if card.keyword == "INCLUDE":
            yield from _cards(path.parent / _parameter(card, "INPUT").strip('"\''), depth + 1)
            card = None
    if card:
        yield card


def _card(path: Path, number: int, line: str) -> Card:
    keyword, *rest = line[1:].split(",")
    pairs = (word.partition("=") for word in rest)
    parameters = {name.strip().upper().replace(" ", ""): value.strip() for name, _, value in pairs}
    return Card(path, number, " ".join(keyword.upper().split()), parameters, [])


def _parameter(card: Card, name: str) -> str:
    found = card.parameters.get(name)
    if not found:
        raise fault(card.path, card.line, f"*{card.keyword} has no {name}", f"give {name}=")
    return found


def _label(card: Card, line: int, word: str) -> int:
    try:
        return int(word)
    except ValueError as error:
        raise fault(card.path, line, f"{word!r} is no label of a node or element",
                    "write the deck again") from error


def _number(card: Card, line: int, word: str) -> float:
    try:
        return float(word.upper().replace("D", "E")) if word else 0.0
    except ValueError as error:
        raise fault(card.path, line, f"{word!r} is no number", "write the deck again") from error


def _node(deck: Deck, card: Card) -> None:
    found = []
    for line, words in card.data:
        label = _label(card, line, words[0])
        x, y, z = ([_number(card, line, word) for word in words[1:4]] + [0.0] * 3)[:3]
        if label in deck.nodes and deck.nodes[label] != (x, y, z):
            raise fault(card.path, line, f"node {label} has two places",
                        "give every node a label of its own")
        deck.nodes[label] = (x, y, z)
        found.append(label)
    if "NSET" in card.parameters:
        deck.node_sets.setdefault(card.parameters["NSET"].upper(), []).extend(found)


def _element(deck: Deck, card: Card) -> None:
    kind = _parameter(card, "TYPE").upper()
    nodes: dict[int, tuple[int, ...]] = {}
    words: list[str] = []
    for line, more in card.data:
        words += [word for word in more if word]
        if more[-1] == "" or len(words) - 1 < NODES_OF.get(kind, 0):
            continue                    # goes on in the next line
        labels = [_label(card, line, word) for word in words]
        nodes[labels[0]] = tuple(labels[1:])
        words = []
    if words:
        raise fault(card.path, card.data[-1][0], f"the last element of *ELEMENT, TYPE={kind} has "
                    f"{len(words) - 1} nodes", "the deck is cut off, write it again")
    deck.elements.append(Elements(kind, card.parameters.get("ELSET", "").upper(), nodes))


# numbers of nodes of elements that may fill several lines
NODES_OF = {"C3D20": 20, "C3D20R": 20, "C3D15": 15, "C3D10": 10, "C3D10M": 10}


def _node_set(deck: Deck, card: Card) -> None:
    name = _parameter(card, "NSET").upper()
    found = deck.node_sets.setdefault(name, [])
    for line, words in card.data:
        if "GENERATE" in card.parameters:
            first, last, *step = [_label(card, line, word) for word in words if word]
            found.extend(range(first, last + 1, *step))
            continue
        for word in filter(None, words):
            other = deck.node_sets.get(word.upper())
            found.extend([_label(card, line, word)] if other is None else other)


def _rigid_body(deck: Deck, card: Card) -> None:
    name = _parameter(card, "NSET").upper()
    if name not in deck.node_sets:
        raise fault(card.path, card.line, f"*RIGID BODY of node set {name}, which there is not",
                    "define the set before it")
    reference = _label(card, card.line, _parameter(card, "REFNODE"))
    rotation = card.parameters.get("ROTNODE")
    deck.rigid_bodies.append(RigidBody(
        tuple(deck.node_sets[name]), reference,
        reference if rotation is None else _label(card, card.line, rotation)))


def _material(deck: Deck, card: Card) -> None:
    deck.materials[_parameter(card, "NAME").upper()] = Material(*[float("nan")] * 3)


def _elastic(deck: Deck, card: Card) -> None:
    if card.parameters.get("TYPE", "ISO").upper() not in ("ISO", "ISOTROPIC") or not card.data:
        return
    line, words = card.data[0]
    values = [_number(card, line, word) for word in words[:2]]
    _of_last_material(deck, youngs_modulus=values[0], poisson_ratio=values[1])


def _density(deck: Deck, card: Card) -> None:
    if card.data:
        line, words = card.data[0]
        _of_last_material(deck, density=_number(card, line, words[0]))


def _of_last_material(deck: Deck, **numbers: float) -> None:
    if deck.materials:
        name = next(reversed(deck.materials))
        deck.materials[name] = deck.materials[name]._replace(**numbers)


def _section(deck: Deck, card: Card) -> None:
    deck.sections[_parameter(card, "ELSET").upper()] = _parameter(card, "MATERIAL").upper()


_READERS = {"NODE": _node, "ELEMENT": _element, "NSET": _node_set, "RIGID BODY": _rigid_body,
            "MATERIAL": _material, "ELASTIC": _elastic, "DENSITY": _density,
            "SOLID SECTION": _section}
