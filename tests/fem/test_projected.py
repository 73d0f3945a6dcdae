"""Geometric stiffness of solids on a basis, against the assembled matrix of all DOFs."""

import numpy as np
import pytest
from scipy import sparse

from sebody.fem.isoparametric import reference_nodes
from sebody.fem.solids import SolidPrestress
from sebody.fem.stress import elasticity

LAW = elasticity(210e3, 0.3)


def prestress(kinds, each, tied, rng):
    """Seven crooked elements of each kind that share no node, moved by more DOFs than they have."""
    points, cells, first = [], [], 0
    for kind in kinds:
        reference, own = reference_nodes(kind), []
        for e in range(7):
            bent = np.eye(3) * 2 + 0.2 * rng.standard_normal((3, 3))
            points.append(reference @ bent + 0.02 * rng.standard_normal(reference.shape) + 3 * e)
            own.append(first + np.arange(len(reference)))
            first += len(reference)
        law = LAW * (1 + 0.1 * np.arange(7))[:, None, None] if each else LAW
        cells.append((kind, np.array(own), law))
    points = np.vstack(points)
    size = 3 * len(points) + 3
    motion = sparse.csr_array(
        np.where(rng.random((size - 3, size)) < 0.02, rng.random((size - 3, size)), 0.0)
        + np.eye(size - 3, size))
    ties = [(np.arange(size - 3, size), np.arange(9), rng.standard_normal((9, 3)))] if tied else []
    return SolidPrestress(points, cells, motion, ties), size


@pytest.mark.parametrize("kinds", [["tetra"], ["tetra10"], ["hexahedron"], ["hexahedron20"],
                                   ["hexahedron27"], ["wedge"], ["wedge15"],
                                   ["tetra10", "hexahedron20"]])
@pytest.mark.parametrize("each, tied", [(False, False), (True, False), (False, True)])
def test_projection_is_that_of_the_matrix(kinds, each, tied):
    """Few and many shapes, few and many prestresses, none at all."""
    rng = np.random.default_rng(1)
    made, size = prestress(kinds, each, tied, rng)
    for n, k in ((5, 1), (5, 9), (20, 6), (80, 3), (5, 0)):
        basis, moved = rng.standard_normal((size, n)), rng.standard_normal((size, k))
        expected = np.array([basis.T @ (made(one) @ basis) for one in moved.T]).reshape(k, n, n)
        np.testing.assert_allclose(made.projected(moved, basis), expected,
                                   atol=1e-13 * np.abs(expected).max(initial=1.0))
