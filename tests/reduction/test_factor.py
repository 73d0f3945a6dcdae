"""Large stiffness matrices, whose pivots are not looked at unless they are suspect."""

import re

import numpy as np
import pytest
from scipy.linalg import cho_factor, cho_solve

from sebody.basics.errors import InputError
from sebody.fem import FEModel, hexahedral_block
from sebody.fem.selection import nodes_on_plane
from sebody.reduction import MeanFace, craig_bampton, factor, reduce

STEEL = (2.1e6, 0.3, 7.8e-3)
BLOCK = hexahedral_block([1, 2, 3], [6, 4, 4], (5, 3, 3), *STEEL)


def test_pivots_that_nobody_looks_at_change_nothing(monkeypatch):
    ends = [(MeanFace(nodes_on_plane(BLOCK, [x, 0, 0], [1, 0, 0])), "full") for x in (1, 7)]
    expected = craig_bampton(BLOCK, ends, 3)
    monkeypatch.setattr(factor, "_SMALL", 100)
    found = craig_bampton(BLOCK, ends, 3)
    for name in ("stiffness", "mass"):
        np.testing.assert_array_equal(getattr(found, name), getattr(expected, name))


def test_loose_parts_of_large_models_are_named(monkeypatch):
    monkeypatch.setattr(factor, "_SMALL", 100)
    other = hexahedral_block([20, 2, 3], [1, 1, 1], (1, 1, 1), *STEEL)
    n, size = len(BLOCK.coordinates), 3 * len(BLOCK.coordinates)
    K, M = (np.zeros((size + 24, size + 24)) for _ in range(2))
    for whole, name in ((K, "stiffness"), (M, "mass")):
        whole[:size, :size] = getattr(BLOCK, name).toarray()
        whole[size:, size:] = getattr(other, name).toarray()
    model = FEModel(K, M, np.vstack([BLOCK.coordinates, other.coordinates]), BLOCK.node_dofs,
                    labels=np.arange(n + 8) + 1, cells=BLOCK.cells)
    left = MeanFace(nodes_on_plane(BLOCK, [1, 0, 0], [1, 0, 0]))
    with pytest.raises(InputError, match="2 parts that share no node") as told:
        craig_bampton(model, [(left, "full")], 2)
    smaller = str(told.value).partition("one of 8 nodes")[2]
    named = {int(word) for word in re.findall(r"node (\d+)", smaller)}
    assert named and named <= set(range(n + 1, n + 9))


def banded(matrix):
    """A factor of LAPACK's, as a user may give one."""
    return Banded(matrix)


class Banded:
    def __init__(self, matrix):
        self.factor = cho_factor(matrix.toarray())

    def solve(self, forces):
        assert forces.ndim == 2
        return cho_solve(self.factor, forces)


@pytest.mark.parametrize("method", ["craig-bampton", "rubin"])
def test_a_factor_of_the_user(method):
    """The same body, which says what factored it; a wrong one is refused."""
    mean = MeanFace(nodes_on_plane(BLOCK, [1, 0, 0], [1, 0, 0]))
    one = reduce(BLOCK, [(mean, "full")], 3, method)
    other = reduce(BLOCK, [(mean, "full")], 3, method, factor=banded)
    np.testing.assert_allclose(other.mass, one.mass, atol=1e-8 * np.abs(one.mass).max())
    np.testing.assert_allclose(np.diag(other.stiffness), np.diag(one.stiffness), rtol=1e-7,
                               atol=1e-8 * np.abs(one.stiffness).max())
    assert "DOFs, factored by banded" in other.summary()
    with pytest.raises(InputError, match="solutions of the factor do not solve the equations"):
        reduce(BLOCK, [(mean, "full")], 3, method, factor=lambda m: banded(m * 1.1))
    with pytest.raises(InputError, match="factor ended in AttributeError: .*; give a function"):
        reduce(BLOCK, [(mean, "full")], 3, method, factor=lambda m: m)
