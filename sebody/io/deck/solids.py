"""Stresses and geometric stiffness of the solids of a deck: from its mesh and its materials."""

from collections import Counter
from collections.abc import Collection
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from sebody.basics.errors import InputError
from sebody.fem.isoparametric import SOLID_KINDS
from sebody.fem.solids import InvertedCell, SolidPrestress, knows
from sebody.fem.stress import SolidStress
from sebody.io.deck.materials import Section, turned_law
from sebody.io.deck.motion import Motion
from sebody.io.deck.reading import CELLS, Deck

# Largest difference of the strain energies of a bending field by our stresses and by the program's
# stiffness: reduced integration is within this, incompatible modes and shear locking are not.
_ALIKE = 0.05
# The same of elements that programs integrate in ways of their own, and of springs beside solids:
# beyond this the deck has other materials than the matrix.
_RELATED = 0.5
_SPRINGS = ("SPRINGA", "SPRING1", "SPRING2")
# elements that have no stress: masses, springs and dampers
_POINTS = ("MASS", "SPRINGA", "SPRING1", "SPRING2", "DASHPOTA", "DASHPOT1", "DASHPOT2", "DCOUP3D")
_UNLIKE = {"C3D8I": "have incompatible modes, whose stresses are not read: use C3D20R or C3D10"}


class Group(NamedTuple):
    """Solid elements of one kind and section."""

    kind: str
    nodes: NDArray      # (e, k), indices
    law: NDArray        # (6, 6) or (e, 6, 6)
    labels: NDArray     # (e,)


class Prestress(NamedTuple):
    """Geometric stiffness of a deck, if there is one, and what was done, or why there is none.

    Parameters
    ----------
    related : bool
        Whether the stresses may be those of the matrix, even if their energy is another.
    """

    stiffness: SolidPrestress | None
    note: str
    related: bool = True


class Solids(NamedTuple):
    """Elements of a deck, as far as they are known.

    Parameters
    ----------
    groups : list of Group
        Elements whose stresses are known.
    lacks : list of str
        Why others have none.
    """

    groups: list[Group]
    lacks: list[str]


def deck_solids(deck: Deck, index: dict[int, int], motion: Motion) -> Solids:
    """The solids of a deck with their materials, and why other elements have no stress."""
    section_of = {label: section for section in deck.sections
                  if section.element_set in deck.element_sets
                  for label in deck.element_sets.labels(section.element_set)}
    sorted_out: dict[tuple[str, Section | None], dict[int, tuple[int, ...]]] = {}
    for group in deck.elements:
        if group.kind not in _POINTS:
            for label, nodes in group.nodes.items():
                sorted_out.setdefault((group.kind, section_of.get(label)), {})[label] = nodes
    groups, lacks, count = [], Counter(), Counter()
    for (kind, section), elements in sorted_out.items():
        count[kind] += len(elements)
        lack = _lack(deck, kind, section)
        if lack:
            lacks[lack] += len(elements)
            continue
        nodes = np.array([[index[label] for label in own] for own in elements.values()])
        whole = motion.known[nodes].all(axis=1)
        if not whole.all():
            lacks["are at nodes that have no rows in the matrices and follow no others"] += int(
                np.sum(~whole))
        if whole.any():
            groups.append(Group(CELLS[kind], nodes[whole],
                                _law(deck, section, motion.points[nodes[whole]].mean(axis=1)),
                                np.array(list(elements))[whole]))
    total = sum(count.values())
    if not total:
        return Solids([], ["the deck has no elements"])
    return Solids(groups, [f"{number} of {total} elements {lack}"
                           for lack, number in lacks.items()])


def _lack(deck: Deck, kind: str, section: Section | None) -> str:
    """The reason why elements have no stress; empty if they have."""
    if kind not in CELLS or CELLS[kind] not in SOLID_KINDS:
        return f"are {kind}, which are not known solids"
    if kind in _UNLIKE:
        return f"are {kind}, which {_UNLIKE[kind]}"
    if section is None:
        return f"({kind}) are in no *SOLID SECTION"
    if section.material not in deck.materials:
        return f"have the material {section.material}, which the deck does not have"
    if section.orientation and section.orientation not in deck.orientations:
        return f"have the orientation {section.orientation}, which the deck does not have"
    material = deck.materials[section.material]
    return "" if material.law is not None else (
        f"have the material {section.material}, which {material.lack}")


def _law(deck: Deck, section: Section, middles: NDArray) -> NDArray:
    """The law of elements in axes of the model."""
    law = deck.materials[section.material].law
    if not section.orientation:
        return law
    return turned_law(law, deck.orientations[section.orientation].axes(middles))


def deck_stress(solids: Solids, points: NDArray) -> tuple[SolidStress, ...]:
    """Stress operators of the solids."""
    return tuple(SolidStress(group.kind, group.nodes, points, group.law)
                 for group in solids.groups)


def deck_prestress(deck: Deck, solids: Solids, motion: Motion, stiffness: sparse.csc_array,
                   own_ways: Collection[str]) -> Prestress:
    """Geometric stiffness of a model of solids alone.

    Parameters
    ----------
    own_ways : collection of str
        Types of elements that the program integrates in a way of its own.
    stiffness : (n_dofs, n_dofs)
        What the stresses are compared with.
    """
    if solids.lacks:
        return Prestress(None, ", ".join(solids.lacks))
    unknown = [group.kind for group in solids.groups if not knows(group.kind)]
    if unknown:
        return Prestress(None, f"cells of kind {unknown[0]} have no full integration here")
    try:
        prestress = SolidPrestress(motion.points, [group[:3] for group in solids.groups],
                                   motion.matrix, motion.rigid)
    except InvertedCell as error:
        label = solids.groups[error.group].labels[error.cell]
        raise InputError(f"element {label} of the deck is inverted or has no volume: "
                         "correct the order of its nodes, or their places") from error
    off = _difference(prestress, motion, stiffness)
    if off < _ALIKE:
        return Prestress(prestress, f"of the mesh; energy of its stresses off by {off:.1e}")
    own = sorted({group.kind for group in deck.elements} & {*own_ways, *_SPRINGS})
    note = ("the strain energy of the deck's mesh and materials differs from that of the "
            f"stiffness by {off:.1%}")
    if own and off < _RELATED:
        return Prestress(None, f"{note}, as {', '.join(own)} have a stiffness of their own")
    return Prestress(None, f"{note}: the deck is not that of the matrices", False)


def _difference(found: SolidPrestress, motion: Motion, stiffness: sparse.csc_array) -> float:
    """Energy of a bending field by the stresses of our elements, off that by the matrix."""
    points = motion.points[motion.known]
    middle, size = points.mean(axis=0), float(np.ptp(points, axis=0).max())
    x, y, z = ((motion.points - middle) / size).T
    bent = np.column_stack([-x * y + z * z, x * x / 2 - y * z, x * z])
    bent[~motion.known] = 0.0
    # the DOFs that follow the field best; those of tied nodes follow their rigid body
    u = sparse.linalg.lsqr(motion.matrix, bent.ravel(), atol=1e-12, btol=1e-12)[0]
    energy = u @ (stiffness @ u)
    return abs(u @ found.forces(u) / energy - 1) if energy > 0 else np.inf
