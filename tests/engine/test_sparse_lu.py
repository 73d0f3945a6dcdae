"""Sparse factors with row exchanges against SuperLU and, where nothing else is exact, rationals."""

from fractions import Fraction

import numpy as np
import pytest
from everyday import Place, bricard
from helpers import multipliers_first
from scipy.sparse import csc_matrix, diags, random as random_matrix
from scipy.sparse.linalg import splu

from sebody import Simulation
from sebody.assembly import build as assembly
from sebody.assembly.evaluation import assembled, matrix
from sebody.engine.matrix import equilibrate
from sebody.engine.regularization import REGULARIZATION, regularize
from sebody.engine.sparse_lu import (
    REGULAR,
    ROOM,
    SINGULAR,
    THRESHOLD,
    Columns,
    Factors,
    factorize,
    substitute,
)
from sebody.scenes import chain

EPS = 2.2e-16


def factors(A, entries=None):
    """What a factorization ends with, and its factors; room is made where it is asked for."""
    A, entries = csc_matrix(A), 4 * csc_matrix(A).nnz if entries is None else entries
    n = A.shape[0]
    matrix = Columns(A.data.astype(float), A.indices.astype(np.int64), A.indptr.astype(np.int64))
    found = Factors.of(n, entries)
    while (code := factorize(matrix, n, found)) == ROOM:
        entries = 2 * entries + 1
        found = Factors.of(n, entries)
    return code, found


def solved(found, b):
    x = np.zeros(b.size)
    substitute(found, b.size, b.copy(), x)
    return x


def superlu(A):
    return splu(csc_matrix(A), permc_spec="NATURAL", diag_pivot_thresh=THRESHOLD)


def backward_error(A, x, b):
    """Residual over what rounding of the entries makes of it (Oettli and Prager)."""
    A = csc_matrix(A)
    return np.max(np.abs(A @ x - b) / (abs(A) @ np.abs(x) + np.abs(b)))


def saddle(n, constraints, seed):
    """Masses and constraints in an arbitrary order, units of unknowns up to 1e6 apart."""
    random = np.random.default_rng(seed)
    K = random_matrix(n, n, 0.1, random_state=seed)
    # two entries of each constraint on coordinates of its own: constraints are independent
    G = random_matrix(constraints, n, 0.1, random_state=seed + 1).tolil()
    for k in range(constraints):
        G[k, 2 * k] = 3.0
        G[k, 2 * k + 1] = -2.0
    A = np.zeros((n + constraints,) * 2)
    A[:n, :n] = (K + K.T + 4.0 * diags(random.uniform(0.5, 2.0, n))).toarray()
    A[n:, :n] = G.toarray()
    A[:n, n:] = A[n:, :n].T
    order = random.permutation(len(A))
    units = 10.0 ** random.uniform(-3.0, 3.0, len(A))
    return csc_matrix(diags(units) @ A[np.ix_(order, order)] @ diags(units))


@pytest.mark.parametrize("n, constraints, entries", [
    (1, 0, 0), (4, 2, 1), (30, 12, None), (150, 60, 5)])
def test_solves_saddle_points_as_superlu(n, constraints, entries):
    A = saddle(n, constraints, seed=n)
    b = np.random.default_rng(n).normal(size=A.shape[0])
    code, found = factors(A, entries)
    assert code == REGULAR or n == 150      # pivots of unscaled matrices are far apart
    own, other = solved(found, b), superlu(A)
    # growth of entries by exchanges below the largest pivot: at most 1 / THRESHOLD a column, and
    # in fact what SuperLU has with the same threshold, within a factor of ten
    assert backward_error(A, own, b) < 10.0 * max(backward_error(A, other.solve(b), b), EPS)
    # SuperLU pads its columns to rectangles
    assert found.starts[A.shape[0]] <= other.L.nnz + other.U.nnz


def test_ill_scaled_systems_against_rationals():
    """Hilbert's matrix of 7, condition 5e8, with rows and columns in an odd order."""
    n, order = 7, [3, 0, 6, 2, 5, 1, 4]
    exact = [[Fraction(1, i + k + 1) for k in order] for i in range(n)]
    A = np.array([[float(x) for x in row] for row in exact])
    x = np.array([1.0, -2.0, 3.0, 0.5, -1.0, 2.0, 0.25])
    b = np.array([float(sum(a * Fraction(y) for a, y in zip(row, x, strict=True)))
                  for row in exact])
    code, found = factors(A)
    assert code == REGULAR
    assert np.abs(solved(found, b) - x).max() < 10.0 * EPS * np.linalg.cond(A)


def test_exchanges_rows_only_where_the_diagonal_is_small():
    A = np.array([[1.0, 5.0, 0.0], [50.0, 1e-9, 2.0], [0.0, 3.0, 4.0]])
    _, found = factors(A)
    assert list(found.pivots) == [0, 1, 2]          # 1 is a fiftieth of 50: kept
    A[0, 0] = 0.4
    assert list(factors(A)[1].pivots[:1]) == [1]    # below THRESHOLD


@pytest.mark.parametrize("A", [
    [[1.0, 2.0], [2.0, 4.0]], [[1.0, 0.0], [2.0, 0.0]], [[0.0, 0.0], [0.0, 1.0]],
    [[np.nan, 1.0], [1.0, 1.0]], [[np.inf, 1.0], [1.0, 1.0]]])
def test_singular_and_damaged_matrices_are_noticed(A):
    assert factors(np.array(A))[0] == SINGULAR


MODELS = {"chain": lambda: chain.build(links=8).model,
          "redundant loop": lambda: bricard(Place.at_random(4, length=1e3, mass=0.01,
                                                            backwards=True))}


@pytest.mark.parametrize("name", MODELS)
def test_iteration_matrices_with_multipliers_first(name, monkeypatch):
    """Of a chain, and of a redundant loop of six links in general position, regularized."""
    monkeypatch.setattr(assembly, "number", multipliers_first(assembly.number))
    run = Simulation(MODELS[name](), 2e-3).run_to(0.1)
    system, state, n = run.system, run.state, run.system.diagonal.size
    # exchanges are needed but where multipliers have R on the diagonal
    assert state.control.pivoted == 1 - system.regularized[0]
    matrix(system, state, "the state", mass=1.0, damping=1e-3, stiffness=1e-6, constraint=1.0)
    equilibrate(system, state)
    if system.regularized[0]:
        regularize(system, state, REGULARIZATION)
    scale = diags(state.scale[:n])
    A = csc_matrix(scale @ assembled(system, state) @ scale)
    b = np.random.default_rng(2).normal(size=n)
    (_, own), other = factors(A), superlu(A)
    x = solved(own, b)
    assert backward_error(A, x, b) < 10.0 * max(backward_error(A, other.solve(b), b), EPS)
    assert own.starts[n] <= other.L.nnz + other.U.nnz
