"""Elimination by blocks against SciPy, and the loop with it against one with row exchanges."""

import numpy as np
import pytest
from helpers import multipliers_first
from numba import njit
from scipy.sparse import csc_matrix
from scipy.sparse.linalg import spsolve

from sebody import Simulation, generalized_alpha
from sebody.assembly import build as assembly, elimination_pattern
from sebody.assembly.equal_bodies import evaluate_alone
from sebody.contract.counts import LANES
from sebody.contract.layout import RESIDUAL
from sebody.engine import elimination
from sebody.engine.evaluate import UNMOVED, assemble, run_moved, sum_forces
from sebody.engine.newton import OLDEST_ROTATED
from sebody.kernels.abi import at, pointer_to
from sebody.scenes import chain


@njit
def factorized(pattern, regularized, matrix, column, scale):
    unknowns = np.arange(LANES * pattern.diagonal.size)
    return elimination.eliminate(
        0, pattern.diagonal.size, regularized, pointer_to(pattern.starts),
        pointer_to(pattern.rows), pointer_to(pattern.diagonal), at(pointer_to(pattern.starts), 1),
        pointer_to(unknowns), pointer_to(matrix), pointer_to(column), pointer_to(scale))


@njit
def substituted(pattern, regularized, factors, x):
    across, starts = pattern.diagonal.size, pointer_to(pattern.starts)
    elimination.substitute(0, across, at(starts, 1), pointer_to(pattern.rows),
                           pointer_to(pattern.diagonal), pointer_to(factors), pointer_to(x))
    elimination.substitute_back(0, across, regularized, starts, pointer_to(pattern.rows),
                                pointer_to(pattern.diagonal), pointer_to(factors), pointer_to(x))


def system(n, seed, links):
    """A random matrix with a dominant diagonal and a structurally symmetric pattern."""
    random = np.random.default_rng(seed)
    row, column = random.integers(0, n, (2, links))
    row, column = np.r_[row, column, np.arange(n)], np.r_[column, row, np.arange(n)]
    value = random.normal(size=len(row))
    value[-n:] += 20.0 * np.sign(value[-n:])
    return row, column, value


def solved(pattern, slot, row, column, value, b, regularized=False):
    """Solution by slots, all of them."""
    slots = LANES * len(pattern.diagonal)
    matrix = np.zeros(len(pattern.rows) * LANES**2)
    np.add.at(matrix, elimination_pattern.entries(pattern, slot[row], slot[column]), value)
    free = np.setdiff1d(np.arange(slots), slot)
    matrix[elimination_pattern.entries(pattern, free, free)] = 1.0
    assert factorized(pattern, regularized, matrix, np.zeros(LANES * slots), np.ones(slots))
    x = np.zeros(slots)
    x[slot] = b
    substituted(pattern, regularized, matrix, x)
    assert not x[free].any()
    return x


@pytest.mark.parametrize("regularized", [False, True])
@pytest.mark.parametrize("n, links", [(4, 3), (17, 30), (63, 100), (200, 500)])
def test_solves_what_scipy_solves(n, links, regularized):
    row, column, value = system(n, n, links)
    b = np.random.default_rng(0).normal(size=n)
    pattern = elimination_pattern.block_pattern(row, column, n)
    x = solved(pattern, np.arange(n), row, column, value, b, regularized)
    exact = spsolve(csc_matrix((value, (row, column)), shape=(n, n)), b)
    # diagonally dominant, a condition below two: EPS times the terms of a row and its fill
    assert np.abs(x[:n] - exact).max() < 1e-12 * np.abs(exact).max()


@pytest.mark.parametrize("groups", [[0, 3, 9, 14], [0, 0, 8, 30, 30], [0]])
def test_slots_leave_the_solution_as_it_is(groups):
    n = 30
    row, column, value = system(n, 5, 60)
    slot, pattern = elimination_pattern.best_slots(row, column, np.array(groups), n)
    assert len(set(slot)) == n and np.all(np.diff(slot) > 0)
    b = np.random.default_rng(1).normal(size=n)
    x = solved(pattern, slot, row, column, value, b)
    exact = spsolve(csc_matrix((value, (row, column)), shape=(n, n)), b)
    assert np.abs(x[slot] - exact).max() < 1e-12 * np.abs(exact).max()      # as above


def test_bodies_on_whole_blocks_are_less_work(monkeypatch):
    asked, best = [], elimination_pattern.best_slots

    def spy(*arguments):
        asked.append(arguments)
        return best(*arguments)
    monkeypatch.setattr(elimination_pattern, "best_slots", spy)
    Simulation(chain.build(links=12).model, 0.01)
    (row, column, groups, n, _), = asked
    _, pattern = best(row, column, groups, n)
    plain = elimination_pattern.block_pattern(row, column, n)
    assert pattern.products < 0.6 * plain.products


def test_elements_that_do_not_move_keep_their_forces():
    run = Simulation(chain.build(links=12).model, 0.01)
    evaluate_alone(run.model, run.system)       # eight at a time are rounded otherwise than two
    system, now, n = run.run_to(0.3).system, run.state, run.numbering.free
    assert assemble(RESIDUAL, RESIDUAL, system, now, now.residual) == 0
    moved = run.numbering.names.index("joint 5.position[0]")
    now.last_change[:] = 0.0
    now.last_change[moved] = 1e-3
    now.q[moved] -= 1e-3
    limit = 1e-6 * now.weight[:n].min()
    now.clock.target = limit / UNMOVED
    assert run_moved(system, now) == 0
    sum_forces(system, now, now.residual)
    assert now.moved.sum() == 2             # the links on both sides; the joint is on rotations
    residual = now.residual.copy()
    assert assemble(RESIDUAL, RESIDUAL, system, now, now.residual) == 0
    assert np.array_equal(residual, now.residual)
    now.last_change[moved] = 1e-3 * limit / now.weight[moved]
    now.q[moved] += 1e-3
    assert run_moved(system, now) == 0
    sum_forces(system, now, now.residual)
    assert not now.moved.any() and np.array_equal(residual, now.residual)


def test_a_small_pivot_is_noticed():
    row = column = np.arange(5)
    pattern = elimination_pattern.block_pattern(row, column, 5)
    matrix = np.zeros(len(pattern.rows) * LANES**2)
    matrix[elimination_pattern.entries(pattern, row, column)] = [1.0, 1.0, 1e-12, 1.0, 1.0]
    assert not factorized(pattern, False, matrix, np.zeros(2 * LANES**2), np.ones(8))


def test_every_entry_has_its_place():
    row, column, _ = system(30, 1, 50)
    pattern = elimination_pattern.block_pattern(row, column, 30)
    rows, columns = elimination_pattern.places(pattern)
    place = elimination_pattern.entries(pattern, row, column)
    assert np.array_equal(rows[place], row) and np.array_equal(columns[place], column)


@pytest.mark.parametrize("index", [3, 2])
def test_row_exchanges_take_over_at_small_pivots(monkeypatch, index):
    """With index 2 the loop stops twice an iteration: for the constraints and for their rates."""
    scheme = generalized_alpha(index=index)
    own = Simulation(chain.build(links=8).model, 0.01, scheme).run_to(0.3)
    monkeypatch.setattr(assembly, "number", multipliers_first(assembly.number))
    exchanged = Simulation(chain.build(links=8).model, 0.01, scheme).run_to(0.3)
    assert own.state.control.pivoted == 0 and exchanged.state.control.pivoted == 1
    for name in ("tip.position", "energy.strain", "energy.kinetic"):
        a, b = own.result()[name], exchanged.result()[name]
        assert np.abs(a - b).max() < 1e-9 * np.abs(a).max(), name


def test_refreshed_matrices_are_of_element_matrices_that_are_not_old():
    """Steps of a chain that refresh their matrix take new element matrices now and then."""
    run = Simulation(chain.build(links=100, inertia="material").model, 0.01)
    refreshed = 0
    for k in range(1, 76):
        begins_with_one = run.state.control.back_off_left > 0
        run.run_to(0.01 * k)
        if begins_with_one:
            assert run.state.control.age <= OLDEST_ROTATED
            refreshed += 1
    assert refreshed > 50
