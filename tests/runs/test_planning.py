"""Steps planned for whole runs: energy of conservative motion, plans, restarts of planned runs."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from sebody import (
    Interrupted,
    Model,
    Simulation,
    SimulationError,
    Tolerance,
    generalized_alpha,
    simulate,
    simulate_within,
)
from sebody.analysis import resume, save_state
from sebody.runs.accuracy import difference
from sebody.runs.planning import LOGGED, Plan, planned
from sebody.runs.whole_runs import planned_simulation
from sebody.scenes import hinged_beam, spherical_beam_strong

GRAVITY, INERTIA = 9.81, 4.0 / 3.0


def pendulum(angle: float, units: float = 1.0) -> Model:
    """A uniform rod of 2 m on a pin, let go at an angle from below."""
    model = Model(planar=True)
    model.gravity((0.0, -GRAVITY * units))
    pin = model.node("pin", (0.3 * units, -0.2 * units))
    model.rigid_body("rod", pin, 1.0, units**2 / 3.0,
                     centre=np.add(pin.point, (units * np.sin(angle), -units * np.cos(angle))))
    model.fix(pin, "position")
    return model


def exact(angle: float, t):
    """Its angle over time, by a method of order 8."""
    return solve_ivp(lambda t, y: [y[1], -GRAVITY / INERTIA * np.sin(y[0])], (0.0, t[-1]),
                     [angle, 0.0], method="DOP853", rtol=1e-12, atol=1e-13, t_eval=t).y[0]


def off(run, angle: float) -> float:
    return float(np.abs(np.unwrap(run["pin.rotation"]) + angle - exact(angle, run.t)).max())


@pytest.mark.parametrize("angle", [2.0, 3.0])
def test_planned_steps_keep_energy_as_fixed_ones_do(angle):
    """Errors and energy of fixed steps of the same number; near the separatrix, too.

    Steps that follow the phase of the swing have up to hundreds of times these errors.
    """
    scheme, errors = generalized_alpha(index=2), []
    for tolerance in (1e-3, 1e-4, 1e-5, 1e-6):
        run = simulate(pendulum(angle), 0.01, 20.0, scheme, tolerance=Tolerance(tolerance))
        fixed = simulate(pendulum(angle), 20.0 / run.steps, 20.0, scheme)
        errors.append(off(run, angle))
        assert errors[-1] <= 1.1 * off(fixed, angle)
        assert run.energy_balance() <= 1.1 * fixed.energy_balance()
    assert (np.diff(errors) < 0.0).all()


def tumbling() -> Model:
    """A flexible bar with unequal masses at its ends, which spins about all axes."""
    turn = Rotation.from_rotvec((0.3, -1.1, 0.6)).as_matrix()
    model = Model()
    nodes = [model.node(name, turn @ (x, 0.0, 0.0) + (1.0, 2.0, -0.5))
             for name, x in (("a", 0.0), ("b", 1.2))]
    model.beam("bar", nodes, hinged_beam.SECTION, 8, 1, 2)
    for node, mass in zip(nodes, (40.0, 70.0), strict=True):
        model.rigid_body(f"{node.name} ball", node, mass, np.diag((3.0, 4.0, 5.0)))
    model.rigid_velocity(turn @ (0.1, 0.0, 0.2), turn @ (0.9, 2.0, -0.4), about=nodes[0].point)
    return model


def test_a_plan_is_one_length_for_motion_that_repeats():
    run = planned_simulation(pendulum(2.0), 0.01, 20.0, tolerance=Tolerance(1e-5))
    assert len(run.plan.schedule) == 1
    run.run_to(20.0)
    assert run.state.control.rejected == run.state.control.cuts == 0
    assert "planned steps        by a run with a larger tolerance" in run.result().summary()
    assert run.result().all_seconds > run.seconds


def test_planned_steps_of_a_flexible_body():
    """Its vibrations die out, so steps grow; errors stay below those of fixed steps."""
    scheme = generalized_alpha(index=2)
    exact = simulate(tumbling(), 0.01 / 32, 12.0, scheme, output_every=32)
    planned, fixed = (simulate(tumbling(), 0.01, 12.0, scheme, tolerance=tolerance)
                      for tolerance in (Tolerance(1e-5), None))
    assert planned.steps == pytest.approx(fixed.steps, rel=0.1)
    share = (fixed.steps / planned.steps)**2
    assert difference(planned, exact, Tolerance()) <= 1.1 * share * difference(
        fixed, exact, Tolerance())
    assert planned.energy_balance() <= 1.1 * share * fixed.energy_balance()


def test_plans_of_what_shrinks_and_grows():
    """Long steps, then an event at t = 3, then short ones up to a corner at 7, long again."""
    def lengths(t):
        return np.where(abs(t - 3.0) < 0.02, 1e-4, np.where((t > 4.0) & (t < 7.0), 0.02, 0.2))
    rows, t = [], 0.0
    while t < 10.0:
        h = float(lengths(t))
        t = min(t + h, 7.0) if t < 7.0 else t + h
        rows.append((t, h, 0.5 / h**3))
    plan = planned(np.array(rows), np.array([0.0, 7.0]))
    ends, planned_lengths = plan.T
    assert 7.0 in ends and (np.diff(ends) > 0.0).all()
    at = np.linspace(0.0, 9.9, 500)
    found = planned_lengths[np.searchsorted(ends, at, side="right").clip(max=len(ends) - 1)]
    # nowhere longer than errors allow, and few lengths
    assert (found <= 1.001 * lengths(at)).all() and len(plan) < 20
    assert found[at > 7.2] == pytest.approx(0.2) and found[at < 1.0].min() > 0.1
    assert found[(at > 4.5) & (at < 6.5)] == pytest.approx(0.02, rel=0.5)
    finer = planned(np.array(rows), np.array([0.0, 7.0]), 8.0)
    assert finer[-1, 1] == pytest.approx(0.1)


def test_first_steps_that_know_nothing_do_not_rule():
    """They grow by four from a thousandth; errors of all are those of steps of 0.1."""
    lengths = np.array([1e-4, 4e-4, 1.6e-3, 6.4e-3, 0.0256, *(96 * [0.1])])
    rows = np.stack([np.cumsum(lengths), lengths, np.full(len(lengths), 500.0)], axis=1)
    assert planned(rows, np.array([0.0]))[:, 1] == pytest.approx([0.1])


@pytest.mark.parametrize("angle", [2.0, 3.0])
def test_a_pendulum_is_within_its_tolerance_and_not_chaotic(angle):
    for tolerance in (1.5e-4, 1e-4):
        run = simulate_within(pendulum(angle), 0.01, 20.0, Tolerance(tolerance))
        error = np.unwrap(run["pin.rotation"]) + angle - exact(angle, run.t)
        true = np.sqrt(np.mean(error**2)) / tolerance
        assert true <= 1.0 and run.error == pytest.approx(true, rel=0.05)


def test_steps_have_no_unit_of_length():
    steps = [simulate_within(pendulum(2.0, units), 0.01, 10.0, Tolerance(1e-3)).steps
             for units in (1.0, 1e6, 1e-4)]
    assert len(set(steps)) == 1


def test_a_planned_run_goes_on_from_a_file(tmp_path):
    def begun():
        return planned_simulation(spherical_beam_strong.build(modes=0).model, 0.05, 16.0,
                                  tolerance=Tolerance(1e-3))
    whole = begun().run_to(16.0)
    assert len(whole.plan.schedule) > 3
    path = save_state(begun().run_to(15.05), tmp_path / "half.npz")
    rest = resume(spherical_beam_strong.build(modes=0).model, path).run_to(16.0)
    assert np.array_equal(rest.result().rows, whole.result().rows)


def test_the_run_that_plans_can_be_interrupted():
    def progress(part):
        raise KeyboardInterrupt
    with pytest.raises(Interrupted, match="results up to this time are kept"):
        simulate(pendulum(2.0), 0.01, 20.0, tolerance=Tolerance(1e-5), progress=progress)


def test_where_no_plan_can_be_made_errors_choose_the_steps(monkeypatch):
    """A plan's run that fails is no failure of the run."""
    plain = Simulation.run_to

    def failing(self, t_end, progress=None):
        if self.plan.logged:
            raise SimulationError("stopped", None)
        return plain(self, t_end, progress)
    monkeypatch.setattr(Simulation, "run_to", failing)
    run = simulate(pendulum(2.0), 0.01, 2.0, tolerance=Tolerance(1e-4))
    monkeypatch.undo()
    alone = Simulation(pendulum(2.0), 0.01, tolerance=Tolerance(1e-4)).run_to(2.0).result()
    assert np.array_equal(run.rows, alone.rows)


def test_the_log_has_every_accepted_step():
    run = Simulation(pendulum(2.0), 0.01, tolerance=Tolerance(1e-6), plan=Plan(logged=LOGGED))
    run.run_to(10.0)
    ends, lengths, rates = run.log.rows().T
    assert len(ends) == run.state.control.steps > 2 * LOGGED
    assert np.cumsum(lengths) == pytest.approx(ends, rel=1e-9)
    assert (rates * lengths**3 <= 1.0).all()


def test_a_run_of_no_time_has_no_plan():
    assert len(simulate(pendulum(2.0), 0.01, 0.0, tolerance=Tolerance(1e-4)).t) == 1
