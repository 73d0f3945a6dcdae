"""Large stiffness matrices, whose pivots are not looked at unless they are suspect."""

import gc
import re
import sys
from types import SimpleNamespace

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


def test_pardiso_factors_large_matrices_where_it_is_installed(monkeypatch):
    """A stand-in with the calls of pypardiso: the upper triangle of a definite matrix, by rows."""
    freed = []

    class PyPardisoSolver:
        def __init__(self, mtype):
            assert mtype == 2

        def factorize(self, upper):
            assert upper.format == "csr" and (upper.tocoo().row <= upper.tocoo().col).all()
            whole = upper + upper.T
            whole.setdiag(upper.diagonal())
            self.matrix = upper
            self.factor = cho_factor(whole.toarray())

        def solve(self, upper, forces):
            assert upper is self.matrix and forces.flags.f_contiguous
            return cho_solve(self.factor, forces)

        def free_memory(self, everything):
            freed.append(everything)
    mean = MeanFace(nodes_on_plane(BLOCK, [1, 0, 0], [1, 0, 0]))
    expected = reduce(BLOCK, [(mean, "full")], 3)
    assert "DOFs, factored by SuperLU" in expected.summary()
    monkeypatch.setitem(sys.modules, "pypardiso", SimpleNamespace(PyPardisoSolver=PyPardisoSolver))
    assert "factored by SuperLU" in reduce(BLOCK, [(mean, "full")], 3).summary()    # it is small
    monkeypatch.setattr(factor, "_LARGE", 50)
    body = reduce(BLOCK, [(mean, "full")], 3)
    assert "DOFs, factored by PARDISO" in body.summary()
    np.testing.assert_allclose(body.mass, expected.mass, atol=1e-8 * np.abs(expected.mass).max())
    gc.collect()
    assert freed == [True]
    monkeypatch.setitem(sys.modules, "pypardiso", None)         # its import fails
    assert "factored by SuperLU" in reduce(BLOCK, [(mean, "full")], 3).summary()
    # without the libraries of MKL, or of a matrix that it does not factor
    monkeypatch.setitem(sys.modules, "pypardiso",
                        SimpleNamespace(PyPardisoSolver=lambda mtype: 1 / 0))
    assert "factored by SuperLU" in reduce(BLOCK, [(mean, "full")], 3).summary()


def test_the_real_pardiso_agrees(monkeypatch):
    pytest.importorskip("pypardiso")
    mean = MeanFace(nodes_on_plane(BLOCK, [1, 0, 0], [1, 0, 0]))
    expected = reduce(BLOCK, [(mean, "full")], 3)
    monkeypatch.setattr(factor, "_LARGE", 50)
    body = reduce(BLOCK, [(mean, "full")], 3)
    assert "factored by PARDISO" in body.summary()
    np.testing.assert_allclose(body.mass, expected.mass, atol=1e-8 * np.abs(expected.mass).max())


def test_factors_that_do_not_fit_into_memory_are_named(monkeypatch):
    def fails(matrix):
        raise MemoryError
    monkeypatch.setattr(factor, "_lu", fails)
    left = MeanFace(nodes_on_plane(BLOCK, [1, 0, 0], [1, 0, 0]))
    with pytest.raises(InputError, match=r"factors of the stiffness of \d+ unknowns do not fit "
                                         "into memory: allow more, take a coarser mesh, or a sol"):
        craig_bampton(BLOCK, [(left, "full")], 2)
