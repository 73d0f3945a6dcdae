"""Nested dissection: an order of all rows, with less fill than minimum degree in solids."""

import re

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from scipy import sparse
from scipy.sparse.linalg import splu

from sebody.errors import InputError
from sebody.fem import FEModel, hexahedral_block
from sebody.fem.selection import nodes_on_plane
from sebody.reduction import MeanFace, craig_bampton, factor
from sebody.reduction.dissection import dissection

STEEL = (2.1e6, 0.3, 7.8e-3)
BLOCK = hexahedral_block([1, 2, 3], [6, 4, 4], (9, 7, 7), *STEEL)
PLACES = np.repeat(BLOCK.coordinates, 3, axis=0)
TURN = np.linalg.qr(np.random.default_rng(2).normal(size=(3, 3)))[0]


def fill(matrix, order, ordering="NATURAL"):
    held = matrix + sparse.diags_array(0.1 * matrix.diagonal(), format="csc")
    return splu(held[order][:, order], ordering, diag_pivot_thresh=0.0,
                options={"SymmetricMode": True}).nnz


@pytest.mark.parametrize("turn", [np.eye(3), TURN])
def test_every_row_is_taken_once_and_fill_is_small(turn):
    shuffle = np.random.default_rng(0).permutation(len(PLACES))
    K = BLOCK.stiffness[shuffle][:, shuffle]
    order = dissection(K, PLACES[shuffle] @ turn.T)
    assert_array_equal(np.sort(order), np.arange(len(order)))
    # as good as minimum degree at this size; a third less at 60 000 DOFs
    assert fill(K, order) < 1.1 * fill(K, np.arange(len(order)), "MMD_AT_PLUS_A")


def test_the_order_changes_nothing_but_rounding(monkeypatch):
    ends = [(MeanFace(nodes_on_plane(BLOCK, [x, 0, 0], [1, 0, 0])), "full") for x in (1, 7)]
    expected = craig_bampton(BLOCK, ends, 3)
    monkeypatch.setattr(factor, "_SMALL", 100)
    found = craig_bampton(BLOCK, ends, 3)
    for name in ("stiffness", "mass"):
        matrix = getattr(expected, name)
        unit = np.sqrt(np.outer(np.diag(matrix), np.diag(matrix)))
        # EPS times the condition of the pinned block, 1e4, and of its means, 1e2
        assert_allclose(getattr(found, name) / unit, matrix / unit, rtol=0, atol=1e-9)


def test_loose_parts_of_large_models_are_named(monkeypatch):
    monkeypatch.setattr(factor, "_SMALL", 100)
    other = hexahedral_block([20, 2, 3], [1, 1, 1], (1, 1, 1), *STEEL)
    n, size = len(BLOCK.coordinates), len(PLACES)
    K, M = (np.zeros((size + 24, size + 24)) for _ in range(2))
    for whole, name in ((K, "stiffness"), (M, "mass")):
        whole[:size, :size] = getattr(BLOCK, name).toarray()
        whole[size:, size:] = getattr(other, name).toarray()
    model = FEModel(K, M, np.vstack([BLOCK.coordinates, other.coordinates]), BLOCK.node_dofs,
                    labels=np.arange(n + 8) + 1, cells=BLOCK.cells)
    left = MeanFace(nodes_on_plane(BLOCK, [1, 0, 0], [1, 0, 0]))
    # some of its DOFs may be among those that are pinned
    with pytest.raises(InputError, match=r"a part of (1[89]|2\d) DOFs is loose, that ") as told:
        craig_bampton(model, [(left, "full")], 2)
    named = {int(word) for word in re.findall(r"node (\d+)", str(told.value))}
    assert named and named <= set(range(n + 1, n + 9))
