"""CalculiX: ``*FREQUENCY, SOLVER=MATRIXSTORAGE`` writes ``.sti``, ``.mas`` and ``.dof``.

``ccx -i se`` writes one triangle of the matrices beside the deck ``se.inp``; line i of ``.dof`` is
``node.direction`` of row i, a text: node 12.1 and the number 12.1 are not the same. Nodes that
``*RIGID BODY`` ties have no rows; its REF NODE has those of their translation, its ROT NODE those
of their rotation vector.
"""

from collections import Counter
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from sebody.basics.errors import InputError
from sebody.io.deck.model import deck_model
from sebody.io.deck.reading import Deck, read_deck
from sebody.io.reading import Reading
from sebody.io.text import fault, first_repeated, read_text
from sebody.io.triplets import read_triplets

_REMEDY = ("run ccx with *FREQUENCY, SOLVER=MATRIXSTORAGE, which writes .sti, .mas and .dof beside "
           "the deck")
_OWN_WAYS = ("C3D8R",)      # hourglass control
# beginnings of the types of elements that CalculiX makes solids of, with nodes of its own
_EXPANDED = ("S3", "S4", "S6", "S8", "B2", "B3", "CP", "CA", "M3D", "T2D", "T3D")


def read(path: Path) -> Reading:
    """The FE model of a deck and the matrices beside it.

    Parameters
    ----------
    path : Path
        The deck, ``.inp``, or one of ``.sti``, ``.mas``, ``.dof``.

    Raises
    ------
    InputError
        A file that is missing, cut off or of another run; elements that have no rows of their
        own; supports; labels that repeat; nodes of which some directions have no rows.
    """
    deck = read_deck(path.with_suffix(".inp"))
    _check_free(deck)
    labels = _labels(path.with_suffix(".dof"))
    stiffness, mass = (
        read_triplets(path.with_suffix(suffix), len(labels), what, _REMEDY,
                      str(path.with_suffix(".dof")))
        for suffix, what in ((".sti", "stiffness file"), (".mas", "mass file")))
    partners = _rotation_nodes(deck, labels, stiffness, path.with_suffix(".dof"))
    dofs = [(partners.get(label, label), direction + 3 * (label in partners))
            for label, direction in labels]
    _check_directions(dofs, deck, path)
    nodes = [label for label in deck.nodes if label not in partners]
    source = f"CalculiX {path.with_suffix('.inp').name}"
    reading = deck_model(deck, nodes, dofs, stiffness, mass, source, _OWN_WAYS)
    return reading._replace(rotation_nodes={
        rotation: node for rotation, node in partners.items() if rotation in deck.nodes})


def _check_free(deck: Deck) -> None:
    """Refuse elements that CalculiX replaces, and supports."""
    for group in deck.elements:
        if group.kind.startswith(_EXPANDED):
            raise group.row.fault(
                f"CalculiX makes solids of beams, shells and plane elements ({group.kind}), whose "
                "rows have labels that are not in the deck", "use solids, such as C3D20 or C3D10, "
                "and delete elements of surfaces and lines that the mesher has written")
        if group.kind == "C3D8I":
            raise group.row.fault(
                "CalculiX gives the incompatible modes of C3D8I rows and masses of their own, "
                "which belong to no node of the deck", "use C3D20R, C3D20 or C3D10")
    if "MPC" in deck.places:
        raise deck.places["MPC"].fault(
            "CalculiX takes DOFs of nodes that *MPC constrains out of the matrices, and writes "
            "numbers that are none for some kinds", "take it out and run ccx again: tie faces "
            "with *RIGID BODY, or at import by rbe2:SET or rbe3:SET")
    for group in deck.elements:
        if group.kind == "DCOUP3D":
            raise group.row.fault(
                "CalculiX puts the reference node of *DISTRIBUTING COUPLING (DCOUP3D) in the place "
                "of a node of its face, whose rows are not in the matrices", "take the element and "
                "the card out and run ccx again: name the face at import, rbe3:SET")
    if deck.supports:
        raise deck.supports[0].fault(
            "*BOUNDARY holds nodes, whose rows are not in the matrices", "take it out and run ccx "
            "again: the body must be free, joints of the model hold it")


def _labels(path: Path) -> list[tuple[int, int]]:
    """Node and direction, from 0, of every row."""
    labels = []
    for number, line in enumerate(read_text(path, "DOF file", _REMEDY).splitlines(), 1):
        node, point, direction = line.strip().partition(".")
        if not (point and node.isdecimal() and direction in ("1", "2", "3")):
            raise fault(path, number, f"{line.strip()!r} is not node.direction with a direction "
                        "from 1 to 3", "write the matrices of a mechanical model again")
        labels.append((int(node), int(direction) - 1))
    if not labels:
        raise InputError(f"DOF file {path} is empty: {_REMEDY}")
    twice = first_repeated(labels)
    if twice:
        node, direction = labels[twice[1]]
        raise fault(path, twice[1] + 1, f"label {node}.{direction + 1} is that of line "
                    f"{twice[0] + 1}, too", "CalculiX makes solids of beams and shells (B31, B32, "
                    "S4, S8 ...), whose rows it does not distinguish; use solids, C3D8 or C3D20")
    return labels


def _rotation_nodes(deck: Deck, labels: list[tuple[int, int]], stiffness: sparse.csc_array,
                    path: Path) -> dict[int, int]:
    """Nodes whose rows are rotations, and the nodes these belong to.

    Where *RIGID BODY names no ROT NODE, and for *KINEMATIC, CalculiX makes one itself. It has the
    entries in the same columns as its reference node, zeros among them: those of the elements at
    the nodes that both move.

    Raises
    ------
    InputError
        Rows of nodes that the deck does not have, and that are not of these kinds.
    """
    references = {body.rotation: body.reference for body in deck.rigid_bodies
                  if body.rotation not in (None, body.reference)}
    unknown = {label: row for row, (label, _) in enumerate(labels) if label not in deck.nodes}
    without = {body.reference for body in deck.rigid_bodies if body.rotation is None}
    rows = {label: row for row, (label, _) in enumerate(labels) if label in without}
    for label, row in unknown.items():
        alike = [node for node, own in rows.items() if np.array_equal(
            _columns(stiffness, own), _columns(stiffness, row))]
        if len(alike) != 1 or alike[0] in references.values():
            number = next(k for k, (other, _) in enumerate(labels, 1) if other == label)
            raise fault(path, number, f"node {label} is not in the deck {deck.path}", (
                "give every *RIGID BODY a ROT NODE, and tie with *RIGID BODY in place of "
                "*KINEMATIC" if without else "give files of one run of ccx"))
        references[label] = alike[0]
    return references


def _columns(matrix: sparse.csc_array, row: int) -> NDArray:
    return np.sort(matrix.indices[matrix.indptr[row]:matrix.indptr[row + 1]])


def _check_directions(dofs: list[tuple[int, int]], deck: Deck, path: Path) -> None:
    """Refuse nodes of which some directions alone have rows."""
    counts = Counter((label, direction // 3) for label, direction in dofs)
    for (label, turns), count in counts.items():
        if count < 3:
            cards = [deck.card(keyword) for keyword in ("EQUATION", "MPC")
                     if keyword in deck.places]
            raise InputError(
                f"{path.with_suffix('.dof')} has {count} of 3 "
                f"{'rotations' if turns else 'translations'} of node {label}: take "
                f"{' and '.join(cards) or '*BOUNDARY, *EQUATION and *MPC'} off the body, which "
                "must be free, and tie nodes with *RIGID BODY")
