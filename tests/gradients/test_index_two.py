"""Gradients of runs whose constraints hold for velocities, too, and of variable steps with them."""

import differentiated as scenes
import numpy as np
import pytest
from readings import TABLE

from sebody import InputError, LimitWarning, Model, Simulation, Tolerance
from sebody.analysis import calibrate, contributions, final, gradient
from sebody.contract.layout import ACCELERATION, OK, RESIDUAL
from sebody.engine.evaluate import assemble
from sebody.engine.links import place_dependent
from sebody.engine.loop import advance
from sebody.engine.state import FAILED, Record
from sebody.gradients import segments
from sebody.gradients.gradient import Differentiated
from sebody.gradients.history import STEP, meet
from sebody.gradients.linear import Linear
from sebody.gradients.parameters import columns_of
from sebody.gradients.rates import Rates
from sebody.runs.schemes import generalized_alpha

INDEX_2 = generalized_alpha(tolerance=1e-13, index=2)
pytestmark = pytest.mark.filterwarnings("ignore::sebody.LimitWarning")
# of models of the table: the end of the run, and the largest difference from differences of runs
SCENES = {"redundant loop": (0.05, 1e-5), "jumps of loads": (0.2, 1e-4), "joints": (0.1, 1e-4),
          "driven rotor": (0.05, 1e-4)}
# where nothing is shifted, or shifts have one direction, the derivatives are exact
EXACT = "moved base", "moved in a plane", "a start that is a parameter"


def asked(name):
    """Builder, step, objectives and parameters of a model of the table."""
    row = TABLE[name]
    return row.build, row.h, row.objectives, row.parameters


def apart(one, other):
    """Largest difference, of the largest entry in a row."""
    return float((np.abs(one - other) / np.abs(other).max(axis=1, keepdims=True)).max())


def both(model, *run, **others):
    """Gradient by the adjoint recursion, and how far the forward one is from it."""
    one, other = (gradient(model, *run, mode, scheme=INDEX_2, **others)
                  for mode in ("adjoint", "forward"))
    return one, apart(one.matrix, other.matrix)


@pytest.mark.parametrize("name", SCENES)
def test_what_differences_of_runs_tell_beside_falls_as_the_square_of_the_step(name):
    (t_end, most), (build, h, *run) = SCENES[name], asked(name)
    found = []
    for step in (h, h / 4):     # shifts depend on how many corrections steps take
        one, unequal = both(build(), step, t_end, *run)
        assert unequal < 1e-12
        expected = scenes.differences(build(), step, t_end, *run, scheme=INDEX_2)
        found.append(apart(one.matrix, expected))
    assert found[0] < most
    assert found[0] / found[1] > 2.5**2


@pytest.mark.parametrize("build", [scenes.struck, scenes.joined, scenes.four_bar, scenes.flat])
def test_rates_of_constraints_change_along_a_motion_as_kernels_of_second_rates_say(build):
    """``d(phidot)/dq v`` is what second rates are without accelerations, links included."""
    run = Simulation(build(), 0.005)
    run.run_to(0.05)
    linear, state, n = Linear(run), run.state, run.numbering.free
    linear.at(state.now.copy(), 0.05, 0.0)
    D = Rates(linear, run.model.size()).by_motion()
    fixed, found = run.system.is_multiplier[:n] > 0, D @ state.v[:n]
    state.a[:n] = 0.0
    place_dependent(run.system.links, state.q, state.v, state.a, state.R, state.turns)
    assert assemble(RESIDUAL, ACCELERATION, run.system, state, state.residual) == OK
    expected = state.residual[:n][fixed]
    assert found[fixed] == pytest.approx(expected, abs=1e-10 * np.abs(expected).max())


@pytest.mark.parametrize("name", EXACT)
def test_what_has_no_shifts_that_turn_is_exact(name):
    build, h, *run = asked(name)
    run = h, TABLE[name].end, *run
    one, unequal = both(build(), *run)
    assert unequal < 1e-12
    assert apart(one.matrix, scenes.differences(build(), *run, scheme=INDEX_2)) < 1e-8


def end_of(model, h, t_end, tolerance, steps, quantity):
    """A quantity at the end of a run that is made to take given steps."""
    run = Simulation(model, h, INDEX_2, tolerance=tolerance)
    meet(run, [t_end])
    run.state.error_weights[:] = 0.0        # no step is rejected
    record = Record.of(run.state, len(steps) + 1)
    for step in steps:
        run.state.clock.chosen = step
        assert advance(run.system, run.state, record, run.scheme, round(t_end / h), 1,
                       run.dense) != FAILED
    assert run.state.clock.time == pytest.approx(t_end, rel=1e-12)
    run.rows.stretches.append(run.state.now.copy()[None])
    return np.ravel(run.result()[quantity][-1])


@pytest.mark.parametrize(("name", "quantity", "most"), [
    ("jumps of loads", "end.velocity", 2e-5), ("driven rotor", "slide.velocity", 2e-6)])
def test_variable_steps_against_runs_that_take_the_same(name, quantity, most):
    """Tables that jump off the grid, drives, links: starts and restarts that look ahead."""
    t_end, (build, h, _, names) = SCENES[name][0], asked(name)
    model, tolerance = build(), Tolerance(1e-5)
    history = Differentiated(model, h, t_end, INDEX_2, tolerance).history
    steps = history.steps[history.kinds == STEP]
    assert np.ptp(steps) > 0.5 * steps.max()
    one, unequal = both(model, h, t_end, {"q": final(quantity)}, names, tolerance=tolerance)
    assert unequal < 1e-12
    expected = []
    for column in columns_of(model, names):
        base, values = np.array(column.handle.base, dtype=float), []
        size = 1e-3 * max(np.abs(base).max(), 1.0)
        for change in scenes.STEPS:
            value = base.copy()
            value.reshape(-1)[column.component] += change * size
            column.handle.set(value)
            values.append(end_of(model, h, t_end, tolerance, steps, quantity))
            column.handle.reset()
        expected.append(scenes.WEIGHTS @ np.array(values) / size)
    assert apart(one.matrix, np.array(expected).T) < most


def test_segments_that_end_at_restarts(monkeypatch):
    t_end, (build, h, *run) = 0.2, asked("jumps of loads")
    whole = gradient(build(), h, t_end, *run, scheme=INDEX_2)
    row = Differentiated(build(), h, h, INDEX_2).history.rows[0]
    monkeypatch.setattr(segments, "STATES", 10 * row.nbytes)    # the first restart is number 10
    parts, unequal = both(build(), h, t_end, *run)
    assert np.array_equal(parts.value, whole.value)
    assert apart(parts.matrix, whole.matrix) < 1e-12
    assert unequal < 1e-12


def test_a_sparse_chain():
    """Of more unknowns than full matrices serve."""
    run = 0.01, 0.03, {"tip": final("tip.position")}, ["torque.amplitude", "link 7.mass"]
    one, unequal = both(scenes.chain(24), *run)
    assert unequal < 1e-12
    expected = scenes.differences(scenes.chain(24), *run, relative=1e-2, scheme=INDEX_2)
    assert apart(one.matrix, expected) < 3e-6


def test_measurements_are_fitted():
    t_end, (build, h, *_) = 0.1, asked("joints")
    model = build()
    spring = columns_of(model, ["spring.stiffness"])[0].handle
    spring.set(np.array(44.0))
    result = Simulation(model, h, INDEX_2).run_to(t_end).result()
    spring.reset()
    found = calibrate(model, h, {"d.position": np.column_stack(
        [result["t"], result["d.position"]])}, ["spring.stiffness"], {"d.position": 1e-6}, INDEX_2)
    assert found.value == pytest.approx([44.0], rel=1e-7)


@pytest.mark.filterwarnings("error")
def test_it_is_said_how_good_the_derivatives_are():
    build, h, *run = asked("joints")
    with pytest.warns(LimitWarning, match="index 2.*halve the step.*index=3.*exact"):
        gradient(build(), h, h, *run, scheme=INDEX_2)
    with pytest.warns(LimitWarning, match="divide the tolerance"):
        gradient(build(), h, h, *run, tolerance=Tolerance(1e-3))
    m = Model()
    a = m.node("a", (0.1, 0.2, 0.3))
    m.rigid_body("free", a, 1.0, np.diag([0.2, 0.3, 0.4]))
    m.initial_velocity(a, angular=(1.0, 2.0, 0.5))
    gradient(m, 0.01, 0.1, {"a": final("a.position")}, ["a.angular_velocity"], scheme=INDEX_2)


def test_uses_that_need_index_three_say_so():
    with pytest.raises(InputError, match="contributions with constraints of index 2.*index=3"):
        contributions(scenes.hinged(), 0.01, 0.05, ["tip.position"], scheme=INDEX_2)
