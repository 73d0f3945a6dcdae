"""Surfaces of a deck: faces of elements, or nodes."""

from collections.abc import Mapping
from typing import NamedTuple

from sebody.fem.cells import face_nodes, first_order
from sebody.io.deck.cards import Row
from sebody.io.deck.sets import Sets

# corners of the faces S1, S2, ... of solids as Abaqus and CalculiX count them, by meshio's names
# of the cells without their numbers of nodes
FACES = {"tetra": ((0, 1, 2), (0, 3, 1), (1, 3, 2), (2, 3, 0)),
         "wedge": ((0, 1, 2), (3, 5, 4), (0, 3, 4, 1), (1, 4, 5, 2), (2, 5, 3, 0)),
         "hexahedron": ((0, 1, 2, 3), (4, 7, 6, 5), (0, 4, 5, 1), (1, 5, 6, 2), (2, 6, 7, 3),
                        (3, 7, 4, 0))}


class Surface(NamedTuple):
    """A surface: rows of elements and faces, or of nodes."""

    of_nodes: bool
    rows: list[Row]


class Solid(NamedTuple):
    """A solid element: meshio's name of its kind, and the labels of its nodes."""

    kind: str
    nodes: tuple[int, ...]


def surface_faces(surface: Surface, sets: Sets, solids: Mapping[int, Solid]
                  ) -> list[tuple[int, ...]]:
    """Nodes of every face of a surface of elements, corners first, by their labels.

    Parameters
    ----------
    sets : Sets
        Of elements.
    solids : mapping of Solid by int
        Elements by their labels.

    Raises
    ------
    InputError
        Elements that are no solids, or faces that they do not have.
    """
    named: list[tuple[int, ...]] = []
    free: list[tuple[int, ...]] = []        # of elements without a face: their free surface
    for row in surface.rows:
        word, face = [*row.words, ""][:2]
        for label in sets.member(row, word):
            if label not in solids:
                raise row.fault(f"element {label} of the surface is not a solid of the deck",
                                "name faces of solid elements")
            kind, nodes = solids[label]
            faces = [face_nodes(kind, len(nodes), one) for one in _corners(row, kind, face)]
            (named if face else free).extend(tuple(nodes[k] for k in one) for one in faces)
    return named + _once(free)


def surface_nodes(surface: Surface, node_sets: Sets, element_sets: Sets,
                  solids: Mapping[int, Solid]) -> list[int]:
    """Labels of the nodes of a surface, each once."""
    if surface.of_nodes:
        labels = [label for row in surface.rows for label in node_sets.member(row, row.words[0])]
    else:
        labels = [label for face in surface_faces(surface, element_sets, solids) for label in face]
    return list(dict.fromkeys(labels))


def _corners(row: Row, kind: str, face: str) -> tuple[tuple[int, ...], ...]:
    """Corners of the face of a name, or of all faces if it has none."""
    faces = FACES[first_order(kind)]
    if not face:
        return faces
    number = face.upper().removeprefix("S")
    if not number.isdecimal() or not 1 <= int(number) <= len(faces):
        raise row.fault(f"there is no face {face!r} of the element", f"give S1 to S{len(faces)}")
    return (faces[int(number) - 1],)


def _once(faces: list[tuple[int, ...]]) -> list[tuple[int, ...]]:
    """Faces that belong to one element alone."""
    times: dict[frozenset, int] = {}
    for face in faces:
        times[frozenset(face)] = times.get(frozenset(face), 0) + 1
    return [face for face in faces if times[frozenset(face)] == 1]
