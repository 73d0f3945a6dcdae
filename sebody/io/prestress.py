"""Stresses and geometric stiffness of imported solids: from the mesh and material of their deck."""

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from sebody.fem.isoparametric import SOLID_KINDS
from sebody.fem.solids import SolidPrestress, knows
from sebody.fem.stress import SolidStress, solid_stress
from sebody.io.deck import CELLS, Deck, material_of
from sebody.io.tied import motion_of

# Largest difference of the strain energies of a bending field by our stresses and by the program's
# stiffness: reduced integration is within this, incompatible modes and shear locking are not.
_ALIKE = 0.05


def deck_prestress(deck: Deck, index: dict[int, int], points: NDArray, rows: NDArray,
                   stiffness: sparse.csc_array) -> tuple[SolidPrestress | None, str]:
    """Geometric stiffness of a model of solids alone, and what was done in words.

    Parameters
    ----------
    index : dict of int by label
        Nodes of the model.
    points : (n, 3)
        Their places [length].
    rows : (n, 6)
        Row of every DOF, -1 for none.
    stiffness : (n_dofs, n_dofs)
        What the stresses are compared with.
    """
    groups = []
    for elements in deck.elements:
        material = material_of(deck, elements)
        if elements.kind not in CELLS or not knows(CELLS[elements.kind]):
            return None, f"none: elements {elements.kind} are no solids known here"
        if material is None or not np.isfinite(material[:2]).all():
            return None, f"none: the deck gives {elements.name or elements.kind} no *ELASTIC"
        cells = [[index[label] for label in nodes] for nodes in elements.nodes.values()]
        groups.append((CELLS[elements.kind], np.array(cells), *material[:2]))
    if not groups:
        return None, "none: the deck has no elements"
    followed, arms, tied = rows.copy(), np.zeros_like(points), []
    for body in deck.rigid_bodies:
        leader = index[body.reference]
        nodes = np.array([index[label] for label in body.nodes if index[label] != leader])
        followed[nodes] = rows[leader]
        arms[nodes] = points[nodes] - points[leader]
        tied.append((rows[leader, 3:], nodes, arms[nodes]))
    used = np.unique(np.concatenate([cells.ravel() for _, cells, *_ in groups]))
    if (followed[used, :3] < 0).any():
        return None, "none: nodes of elements have no rows and are not tied by *RIGID BODY"
    motion = motion_of(followed, arms, stiffness.shape[0])
    found = SolidPrestress(points, groups, motion, tied)
    return _compared(found, motion, points, stiffness)


def deck_stress(deck: Deck, index: dict[int, int], points: NDArray, rows: NDArray
                ) -> tuple[SolidStress, ...]:
    """Stress operators of the solids whose material is known and whose nodes all have DOFs.

    Nodes that are tied to a rigid body have none of their own, so the elements at them are left
    out.
    """
    found = []
    for elements in deck.elements:
        material = material_of(deck, elements)
        kind = CELLS.get(elements.kind)
        if kind not in SOLID_KINDS or material is None or not np.isfinite(material[:2]).all():
            continue
        cells = np.array([[index[label] for label in nodes] for nodes in elements.nodes.values()])
        cells = cells[(rows[cells][:, :, :3] >= 0).all(axis=(1, 2))]
        if len(cells):
            found += solid_stress(points, [(kind, cells)], *material[:2])
    return tuple(found)


def _compared(found: SolidPrestress, motion: sparse.csr_array, points: NDArray,
              stiffness: sparse.csc_array) -> tuple[SolidPrestress | None, str]:
    """The geometric stiffness, unless its elements are other ones than those of the matrix."""
    middle, size = points.mean(axis=0), float(np.ptp(points, axis=0).max())
    x, y, z = ((points - middle) / size).T
    bent = np.column_stack([-x * y + z * z, x * x / 2 - y * z, x * z]).ravel()
    # the DOFs that follow the field best; those of tied nodes follow their rigid body
    u = sparse.linalg.lsqr(motion, bent, atol=1e-12, btol=1e-12)[0]
    energy = u @ (stiffness @ u)
    off = abs(u @ found.forces(u) / energy - 1) if energy > 0 else np.inf
    if not off < _ALIKE:
        return None, (f"none: stresses of plain elements have another energy than the matrix, by "
                      f"{off:.1%} (incompatible modes, other materials)")
    return found, f"of the mesh; energy of its stresses off by {off:.1e}"
