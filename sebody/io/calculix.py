"""CalculiX: ``*FREQUENCY, SOLVER=MATRIXSTORAGE`` writes ``.sti``, ``.mas`` and ``.dof``.

``ccx -i se`` writes one triangle of the matrices beside the deck ``se.inp``; line i of ``.dof`` is
``node.direction`` of row i, a text: node 12.1 and the number 12.1 are not the same. Nodes that
``*RIGID BODY`` ties have no rows; its REF NODE has those of their translation, its ROT NODE those
of their rotation vector.
"""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sebody.errors import InputError
from sebody.fem.model import FEModel
from sebody.io.deck import Deck, deck_cells, deck_sets, read_deck
from sebody.io.prestress import deck_prestress, deck_stress
from sebody.io.reading import Reading
from sebody.io.text import fault, first_repeated, read_text
from sebody.io.tied import tied_mass_field
from sebody.io.triplets import read_triplets

_NAMES = ("x", "y", "z", "rx", "ry", "rz")
_REMEDY = ("run ccx with *FREQUENCY, SOLVER=MATRIXSTORAGE, which writes .sti, .mas and .dof beside "
           "the deck")

def read(path: Path) -> Reading:
    """The FE model of a deck and the matrices beside it.

    Parameters
    ----------
    path : Path
        The deck, ``.inp``, or one of ``.sti``, ``.mas``, ``.dof``.

    Raises
    ------
    InputError
        A file that is missing, cut off or of another run; labels that repeat; nodes of which some
        directions have no rows.
    """
    deck = read_deck(path.with_suffix(".inp"))
    labels = _labels(path.with_suffix(".dof"), deck)
    stiffness, mass = (
        read_triplets(path.with_suffix(suffix), len(labels), what, _REMEDY,
                      str(path.with_suffix(".dof")))
        for suffix, what in ((".sti", "stiffness file"), (".mas", "mass file")))
    partners = {body.rotation: body.reference for body in deck.rigid_bodies
                if body.rotation != body.reference}
    order = [label for label in deck.nodes if label not in partners]
    index = {label: k for k, label in enumerate(order)}
    rows = np.full((len(order), 6), -1)
    dof_map = []
    for row, (label, direction) in enumerate(labels):
        at = index[partners.get(label, label)]
        kind = direction + 3 * (label in partners)
        rows[at, kind] = row
        dof_map.append((at, _NAMES[kind]))
    _check_directions(rows, order, path)
    points = np.array([deck.nodes[label] for label in order])
    present = rows[:, 0] >= 0
    field = tied_mass_field(mass, points[present], rows[present])
    notes = {} if field else {"exact inertia": "none: the mass matrix is not that of solids whose "
                              "nodes are free or tied by *RIGID BODY"}
    geometric, note = deck_prestress(deck, index, points, rows, stiffness)
    notes["geometric stiffness"] = note
    model = FEModel(stiffness, mass, points, dof_map=tuple(dof_map), labels=tuple(order),
                    node_sets=deck_sets(deck, index), cells=deck_cells(deck, index),
                    mass_field=field, geometric_stiffness=geometric,
                    stress=deck_stress(deck, index, points, rows),
                    source=f"CalculiX {path.with_suffix('.inp').name}")
    return Reading(model, rotation_nodes=partners, notes=notes)


def _labels(path: Path, deck: Deck) -> list[tuple[int, int]]:
    """Node and direction, from 0, of every row."""
    found = []
    for number, line in enumerate(read_text(path, "DOF file", _REMEDY).splitlines(), 1):
        node, point, direction = line.strip().partition(".")
        if not (point and node.isdecimal() and direction in ("1", "2", "3")):
            raise fault(path, number, f"{line.strip()!r} is no node.direction with a direction "
                        "from 1 to 3", "write the matrices of a mechanical model again")
        if int(node) not in deck.nodes:
            raise fault(path, number, f"node {node} is not in the deck {deck.path}",
                        "give files of one run of ccx")
        found.append((int(node), int(direction) - 1))
    if not found:
        raise InputError(f"DOF file {path} is empty: {_REMEDY}")
    twice = first_repeated(found)
    if twice:
        node, direction = found[twice[1]]
        raise fault(path, twice[1] + 1, f"label {node}.{direction + 1} is that of line "
                    f"{twice[0] + 1}, too", "CalculiX makes solids of beams and shells (B31, B32, "
                    "S4, S8 ...), whose rows it does not tell apart; use solids, C3D8 or C3D20")
    return found


def _check_directions(rows: NDArray, order: list[int], path: Path) -> None:
    """Refuse nodes of which some directions alone have rows."""
    for columns, what in ((slice(0, 3), "translations"), (slice(3, 6), "rotations")):
        there = (rows[:, columns] >= 0).sum(axis=1)
        if np.any((there > 0) & (there < 3)):
            k = int(np.argmax((there > 0) & (there < 3)))
            raise InputError(
                f"{path.with_suffix('.dof')} has {there[k]} of 3 {what} of node {order[k]}: take "
                "*BOUNDARY, *EQUATION and *MPC off the body, which must be free, and tie nodes "
                "with *RIGID BODY")
