"""Faces and edges of cells, by meshio's names and order of nodes (that of VTK).

Second-order cells have the corners of first-order ones, then the middles of their edges; those of
27 nodes have the middles of their faces, too, and their own.
"""

# corners of the faces, whose normals point outwards
FACES = {
    "tetra": ((0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)),
    "hexahedron": ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6),
                   (3, 0, 4, 7)),
    "wedge": ((0, 2, 1), (3, 4, 5), (0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5)),
    "pyramid": ((0, 3, 2, 1), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)),
    "triangle": ((0, 1, 2),),
    "quad": ((0, 1, 2, 3),),
}
# place of the middle of each of these faces among those of all
MIDDLES = {"hexahedron": (4, 5, 2, 1, 3, 0)}
SOLIDS = "tetra", "hexahedron", "wedge", "pyramid"
# edges in the order of their middle nodes
EDGES = {
    "tetra": ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)),
    "hexahedron": ((0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5),
                   (2, 6), (3, 7)),
    "wedge": ((0, 1), (1, 2), (2, 0), (3, 4), (4, 5), (5, 3), (0, 3), (1, 4), (2, 5)),
    "pyramid": ((0, 1), (1, 2), (2, 3), (3, 0), (0, 4), (1, 4), (2, 4), (3, 4)),
    "triangle": ((0, 1), (1, 2), (2, 0)),
    "quad": ((0, 1), (1, 2), (2, 3), (3, 0)),
}
CORNERS = {kind: 1 + max(map(max, edges)) for kind, edges in EDGES.items()}


def first_order(kind: str) -> str:
    """Name of the cell with the same corners: tetra of tetra10."""
    return kind.rstrip("0123456789")


def faces_of(kind: str, nodes: int) -> list[tuple[int, ...]]:
    """Nodes of each face of a cell: its corners, then the middles of its edges if it has them.

    Parameters
    ----------
    kind : str
        One of `FACES`, or a cell of second order.
    nodes : int
        Of the cell.
    """
    return [face_nodes(kind, nodes, face) for face in FACES[first_order(kind)]]


def face_nodes(kind: str, nodes: int, corners: tuple[int, ...]) -> tuple[int, ...]:
    """Corners of a face of a cell, then the middles of its edges if the cell has them."""
    base = first_order(kind)
    if nodes < CORNERS[base] + len(EDGES[base]):
        return corners
    middle = {frozenset(edge): CORNERS[base] + k for k, edge in enumerate(EDGES[base])}
    return (*corners, *(middle[frozenset(edge)]
                        for edge in zip(corners, corners[1:] + corners[:1], strict=True)))
