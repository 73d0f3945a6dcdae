"""The FE model of a deck and of matrices whose rows belong to its nodes."""

from collections.abc import Collection, Sequence

import numpy as np
from scipy import sparse

from sebody.basics.errors import InputError
from sebody.fem.materials import Material
from sebody.fem.model import FEModel
from sebody.io.deck.motion import deck_motion
from sebody.io.deck.reading import CELLS, Deck
from sebody.io.deck.solids import deck_prestress, deck_solids, deck_stress
from sebody.io.reading import Reading
from sebody.io.tied import tied_mass_field

_REMEDY = "correct the deck and import again"
_GROUNDED = ("SPRING1", "DASHPOT1")     # springs and dampers of one node
_LOADING = ("STATIC", "TRANSFORM")      # steps before, which prestress; systems of nodes
_NAMES = ("x", "y", "z", "rx", "ry", "rz")


def deck_model(deck: Deck, labels: Sequence[int], dofs: Sequence[tuple[int, int]],
               stiffness: sparse.csc_array, mass: sparse.csc_array, source: str,
               own_ways: Collection[str]) -> Reading:
    """The FE model.

    Parameters
    ----------
    labels : sequence of int
        Nodes of the model.
    dofs : sequence of (int, int)
        Label and direction, 0 to 5, of every row.
    stiffness, mass : (n_dofs, n_dofs)
    source : str
        In words.
    own_ways : collection of str
        Types of elements that the program integrates in a way of its own.
    """
    index = {label: k for k, label in enumerate(labels)}
    rows = np.full((len(labels), 6), -1)
    for row, (label, direction) in enumerate(dofs):
        rows[index[label], direction] = row
    motion = deck_motion(deck, index, np.array([deck.nodes[label] for label in labels]), rows,
                         len(dofs))
    solids = deck_solids(deck, index, motion)
    geometric, note, related = deck_prestress(deck, solids, motion, stiffness, own_ways)
    present = rows[:, 0] >= 0
    field = tied_mass_field(mass, motion.points[present], rows[present])
    missing = {} if geometric else {"stiffening": f"{note}; {_REMEDY}"}
    if solids.lacks:
        missing["stresses"] = f"{', '.join(solids.lacks)}; {_REMEDY}"
    if not related:
        missing["stresses"] = missing["stiffening"]
    if field is None:
        missing["exact inertia"] = ("the mass matrix is not that of solids whose nodes are free, "
                                    "tied or follow a rigid body; use solids alone")
    follows = np.repeat(motion.known & ~present, 3)
    followers = (sparse.csr_array(sparse.diags_array(follows.astype(float)) @ motion.matrix)
                 if follows.any() else None)
    light = _without_density(deck, mass)
    model = FEModel(
        stiffness, mass, motion.points,
        dof_map=[(index[label], _NAMES[direction]) for label, direction in dofs],
        labels=np.array(labels), node_sets=_node_sets(deck, index), cells=_cells(deck, index),
        mass_field=field, geometric_stiffness=geometric,
        stress=deck_stress(solids, motion.points) if related else (), source=source,
        followers=followers, missing=missing,
        materials=_materials(deck))
    notes = {"geometric stiffness": note} if geometric else {}
    if light:
        notes["materials without density"] = ", ".join(light)
    return Reading(model, notes=notes,
                   holding=_holding(deck), loading=tuple(
                       deck.card(keyword) for keyword in _LOADING if keyword in deck.places))


def _without_density(deck: Deck, mass: sparse.csc_array) -> list[str]:
    """Materials that sections use and that have no density.

    Raises
    ------
    InputError
        Nothing else has mass.
    """
    names = dict.fromkeys(section.material for section in deck.sections)
    without = [name for name in names
               if name in deck.materials and not deck.materials[name].density]
    if without and not mass.diagonal().any():
        raise InputError(f"deck {deck.path}: material {without[0]} has no *DENSITY, so the body "
                         "has no mass: give it and run the program again")
    return without


def _holding(deck: Deck) -> dict[int, str]:
    """Cards by the nodes that they connect to the ground."""
    return {label: f"*ELEMENT, TYPE={group.kind} (line {group.row.number})"
            for group in deck.elements if group.kind in _GROUNDED
            for nodes in group.nodes.values() for label in nodes}


def _materials(deck: Deck) -> list[Material]:
    """Materials that sections use and of which the deck says enough."""
    used = {section.material: deck.materials.get(section.material) for section in deck.sections}
    substances = [one.substance(name) for name, one in used.items() if one is not None]
    return [one for one in substances if one is not None]


def _node_sets(deck: Deck, index: dict[int, int]) -> dict[str, list[int]]:
    """Node sets and surfaces as node indices."""
    return {name: list(dict.fromkeys(index[label] for label in labels if label in index))
            for name, labels in deck.named_nodes()}


def _cells(deck: Deck, index: dict[int, int]) -> list[tuple[str, np.ndarray]]:
    """Connectivity of the solids by meshio's names."""
    by_kind: dict[str, list] = {}
    for group in deck.elements:
        if group.kind in CELLS:
            by_kind.setdefault(CELLS[group.kind], []).extend(
                [index[label] for label in nodes] for nodes in group.nodes.values())
    return [(kind, np.array(cells)) for kind, cells in by_kind.items()]
