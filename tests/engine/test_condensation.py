"""Matrices of element matrices with eliminated internal unknowns, against sparse solutions."""

import numpy as np
import pytest
from scipy.sparse import csc_matrix
from scipy.sparse.linalg import spsolve
from scipy.spatial.transform import Rotation

from sebody import Model, Simulation
from sebody.engine.matrix import refactorize, solve, sum_matrices
from sebody.engine.state import ROTATED
from sebody.scenes import chain


def arm(order: int = 1) -> Model:
    """Links with 4, 2 and 7 modes along a bent line, a branch, and a link on a rigid arm."""
    bodies = [chain.link_body(modes) for modes in (4, 2, 7)]
    model = Model()
    model.gravity((1.0, -9.0, 2.0))
    starts = [model.node("base", (0.2, 0.1, -0.3))]
    model.revolute(starts[0], axis=(0.3, 1.0, 0.2))
    ends, links = [], []
    for k in range(9):
        turn = Rotation.from_rotvec((0.3 * k, 0.2, -0.4 * k)).as_matrix()
        end = model.node(f"end {k}", starts[k].point + turn[:, 0])
        links.append((f"link {k}", bodies[k % 3], [starts[k], end], turn))
        ends.append(end)
        if k < 8:
            before = ends[3] if k == 5 else end     # the branch begins at the fourth link
            starts.append(model.node(f"start {k + 1}", before.point, at=before))
            model.revolute(before, (0.2, -0.1 * k, 1.0), to=starts[-1])
    tool = model.attach("tool", ends[5].point + (0.1, 0.2, 0.0), ends[5])
    hand = model.node("hand", tool.point + (1.0, 0.0, 0.0))
    links.append(("held", bodies[0], [tool, hand], np.eye(3)))
    for name, body, nodes, turn in links[::order]:
        model.superelement(name, body, nodes, rotation=turn)
    return model


def solution(run: Simulation, refreshed: int) -> tuple[np.ndarray, np.ndarray]:
    """The correction of a refreshed matrix, and what SciPy finds with the sum of all matrices."""
    system, state, n = run.system, run.state, run.numbering.free
    sum_matrices(system, state, state.forces, False)
    kept = (system.rows < n) & (system.columns < n)
    matrix = csc_matrix((state.matrix[:-1][kept], (system.rows[kept], system.columns[kept])),
                        shape=(n, n))
    state.residual[:n] = matrix @ np.sin(np.arange(n))
    state.control.refreshed = refreshed
    right = state.residual[:n].copy()
    assert refactorize(system, state, ROTATED, False) and state.control.pivoted == 0
    solve(system, state, False)
    return state.correction[:n] * state.weight[:n], spsolve(matrix, right) * state.weight[:n]


@pytest.mark.parametrize("order", [1, -1])
def test_refreshed_matrices_solve_what_scipy_solves(order):
    run = Simulation(arm(order), 0.005).run_to(0.05)
    system, state = run.system, run.state
    assert len(system.internal) > 5
    rng, frames = np.random.default_rng(3), state.frames[:90].reshape(-1, 3, 3)
    state.condensed[:] = np.nan         # the second refresh makes them, later ones do not
    for refreshed in (1, 2, 3, 4):
        frames[:] = Rotation.random(10, rng).as_matrix()
        found, exact = solution(run, refreshed)
        # without row exchanges: pivots of the scaled matrix down to 1e-11 may cost as many digits
        assert np.abs(found - exact).max() < 1e-7 * np.abs(exact).max()
        assert np.isnan(state.condensed).all() == (refreshed == 1)


def test_matrices_are_condensed_after_row_exchanges():
    """The second refresh comes while factors have row exchanges, so the third one condenses."""
    run = Simulation(arm(), 0.005).run_to(0.05)
    run.state.condensed[:] = np.nan
    run.state.control.pivoted = 1
    solution(run, 2)
    assert np.isnan(run.state.condensed).all()
    found, exact = solution(run, run.state.control.refreshed + 1)
    assert np.abs(found - exact).max() < 1e-7 * np.abs(exact).max()
    assert not np.isnan(run.state.condensed).all()


def test_columns_with_unknowns_of_others_are_not_internal():
    """Internal modes of a link, and what its free end has, but nothing that joints act on."""
    run = Simulation(arm(), 0.005)
    system, n = run.system, run.numbering.free
    names = np.array(run.numbering.names)
    columns = system.internal[:, 0]
    unknowns = system.slot_unknowns.reshape(-1, 4)[columns]
    internal = set(names[unknowns[unknowns < n]])
    assert {"mode 3 of link 0", "mode 6 of link 8", "end 8.rotation[0]"} <= internal
    assert all(name.startswith(("mode", "end 8.")) for name in internal)
    assert not any(name.endswith("of held") for name in internal)
    for k, row in enumerate(system.internal):       # rows above are of the same element's columns
        above = system.block_rows[system.block_starts[row[0]]:system.block_diagonal[row[0]]]
        assert set(above) <= set(columns[:k])


def test_new_matrices_of_elements_are_condensed_anew():
    """A run whose every step refreshes its matrix, beside one that never condenses any."""
    run, other = (Simulation(chain.build(links=16).model, 0.01) for _ in range(2))
    run.run_to(0.5)
    for k in range(50):
        other.state.control.refreshed = 0
        other.run_to(0.01 * (k + 1))
    assert run.state.control.refreshed > 2 and run.state.condensed.any()
    assert other.state.control.matrices == run.state.control.matrices > 50
    assert not other.state.condensed.any()
    assert np.abs(run.state.q - other.state.q).max() < 1e-11     # rounding, in 50 steps
