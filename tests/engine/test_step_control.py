"""Steps chosen by their error: order with changing steps, corners, dense output, tolerances."""

import numpy as np
import pytest
from helpers import order

from sebody import (
    InputError,
    Model,
    Simulation,
    SimulationError,
    generalized_alpha,
    simulate,
)
from sebody.engine import loop
from sebody.engine.state import (
    Record,
)
from sebody.runs import simulation
from sebody.runs.accuracy import difference, simulate_within
from sebody.runs.planning import LOGGED, Plan
from sebody.runs.tolerance import Tolerance
from sebody.scenes import (
    heavy_top,
    hinged_beam,
    planar_hinged_beam,
    spherical_beam_strong,
    squeezer,
)

STRICT = generalized_alpha(0.5, tolerance=1e-12, index=2)


def driven(model, sequence, carried=True):
    """A run with given steps; `carried` takes auxiliary accelerations over to the next length."""
    run = Simulation(model, 1.0, STRICT, tolerance=Tolerance(1.0))
    run.state.error_weights[:] = 0.0
    run.state.control.corner = run.system.corners.size
    record = Record.of(run.state, 0, 10**9)
    for h in sequence:
        run.state.clock.chosen = h
        if not carried:
            run.state.clock.aux_step = h
        loop.advance(run.system, run.state, record, run.scheme, 10**9, 1, run.dense)
    return run


def errors(build, t_end, counts, read, **options):
    """Errors at the end with steps of h and 2 h in turn, against a run with small equal steps."""
    fine = Simulation(build().model, t_end / 12000, STRICT).run_to(t_end)
    found = []
    for n in counts:
        run = driven(build().model, np.tile([1.0, 2.0], n) * t_end / (3 * n), **options)
        assert run.time == pytest.approx(t_end, rel=1e-9)
        assert run.state.control.steps == 2 * n
        found.append(np.abs(read(run.state) - read(fine.state)).max())
    return found


def explicit():
    return heavy_top.build(explicit=True)


def attitude(state):
    return state.R


@pytest.mark.parametrize("build, t_end, counts, read", [
    (squeezer.build, 0.01, (50, 100, 200), lambda state: state.q[0]),
    (heavy_top.build, 0.3, (200, 400, 800), attitude),
    (explicit, 0.3, (200, 400, 800), attitude),
], ids=["squeezer", "heavy top", "heavy top with multipliers"])
def test_second_order_with_alternating_steps(build, t_end, counts, read):
    assert 1.8 < order(1 / np.array(counts), errors(build, t_end, counts, read)) < 2.4


@pytest.mark.parametrize("build", [heavy_top.build, explicit])
def test_the_offset_of_auxiliary_accelerations_must_be_carried_over(build):
    """Taken over as they are they cost an order."""
    counts = (400, 800, 1600)
    found = errors(build, 0.3, counts, attitude, carried=False)
    assert order(1 / np.array(counts), found) < 1.25


def test_index_3_does_not_allow_changing_steps(monkeypatch):
    """Constrained directions have other rates for every step: errors are 100 times larger."""
    with pytest.raises(InputError, match="with constraints of index 3 errors grow where the step"):
        Simulation(explicit().model, 0.01, generalized_alpha(), tolerance=Tolerance(1e-3))
    scheme = generalized_alpha(tolerance=1e-12, index=2)
    monkeypatch.setitem(globals(), "STRICT", scheme)
    stable = errors(explicit, 0.3, (400,), attitude)[0]
    monkeypatch.setattr(simulation, "fitting", lambda given, *_: given)
    monkeypatch.setitem(globals(), "STRICT", scheme._replace(stabilized=False))
    assert errors(explicit, 0.3, (400,), attitude)[0] > 100 * stable


def test_corners_of_tables_are_met():
    """The torque of the hinged beam has corners at 2.5, 5 and 7.5."""
    run = Simulation(hinged_beam.build().model, 1.0, tolerance=Tolerance(1e-3))
    assert run.system.corners.tolist() == [0.0, 2.5, 5.0, 7.5]
    record = Record.of(run.state, 40)
    times = [0.0]
    while run.time < 9.0:
        loop.advance(run.system, run.state, record, run.scheme, 30, 1, run.dense)
        if run.time > times[-1]:
            times.append(run.time)
    assert {2.5, 5.0, 7.5} <= set(times)
    steps = np.diff(times)
    assert steps.min() > 1e-3 * steps.max()     # no slivers beside them


def test_output_between_steps_is_of_third_order():
    """On a grid finer than the steps; against the same steps recorded where they end."""
    found, shares = [], (1.0, 0.5, 0.25)
    for share in shares:
        h = 0.004 * share
        run = Simulation(heavy_top.build().model, h / 4, tolerance=Tolerance(1.0))
        run.state.error_weights[:] = 0.0
        run.state.clock.chosen, run.state.control.recorded = h, 0
        run.scheme = run.scheme._replace(tolerance=1e-12)
        record = Record.of(run.state, 8)
        loop.advance(run.system, run.state, record, run.scheme, 8, 1, run.dense)
        start, end = run.state.R_old.copy(), run.state.R.copy()
        assert run.state.clock.current_step == h == run.state.clock.time
        R = record.rows[:4, run.state.recorded_parts["R"]]
        # the increment again, through cubics and a logarithm: some hundred EPS
        assert R[3] == pytest.approx(end, abs=1e-13) and not np.allclose(R[1], start)
        fine = Simulation(heavy_top.build().model, h / 400).run_to(h / 2)
        found.append(np.abs(R[1] - fine.state.R).max())
    assert order(shares, found) > 2.7     # that of one step


def test_rows_are_those_of_a_run_that_ends_there():
    """The last row does not depend on how far the last step goes beyond it."""
    long = Simulation(hinged_beam.build().model, 0.05, tolerance=Tolerance(1e-4)).run_to(6.0)
    short = Simulation(hinged_beam.build().model, 0.05, tolerance=Tolerance(1e-4)).run_to(3.0)
    assert np.array_equal(short.result().rows, long.result().rows[:61])
    assert short.time >= 3.0
    assert np.array_equal(short.run_to(6.0).result().rows, long.result().rows)
    # products of the step, of six: their rounding
    assert np.allclose(long.result().t, 0.05 * np.arange(121), rtol=0, atol=1e-12)


def test_work_and_energy_between_steps():
    result = Simulation(hinged_beam.build().model, 0.01, tolerance=Tolerance(1e-5)).run_to(
        10.0).result()
    assert result.energy_balance() < 1e-3
    assert len(result.t) == 1001 and result.steps < 1001 * 2


def logged(model, grid, t_end, tolerance):
    """Ends and lengths of steps that their errors choose one by one."""
    run = Simulation(model, grid, tolerance=Tolerance(tolerance), plan=Plan(logged=LOGGED))
    return run.run_to(t_end).log.rows().T[:2]


def test_a_function_between_corners_shortens_the_steps():
    """Half a sine in a single step of 0.1 would be no force at all."""
    ends, lengths = logged(spherical_beam_strong.build(modes=0).model, 0.05, 15.2, 1e-3)
    calm = lengths[ends < 14.9][-1]
    assert calm > 0.1
    assert lengths[(ends > 15.0) & (ends < 15.1)].max() < 0.5 * calm


def test_steps_shrink_in_an_impulse_and_grow_at_once_after_it():
    """The errors of an event say nothing of the motion after it."""
    model = Model(planar=True)
    model.rigid_body("body", model.node("centre", (1.0, 0.3)), 2.0, 0.7)
    wall = model.node("wall", (0.0, 0.0), keeps="translation")
    model.fix(wall, "position")
    model.spring("centre", wall, 8.0)
    model.initial_velocity("centre", (0.4, 0.2))
    model.force("centre", (0.0, 1.0), [(5.0, 0.0), (5.003, 200.0), (5.01, 0.0)])
    ends, lengths = logged(model, 0.1, 8.0, 1e-4)
    calm = lengths[ends < 5.0 - lengths.max()].max()
    assert lengths[(ends > 5.0) & (ends < 5.02)].min() < 0.2 * calm
    assert lengths[ends > 5.0101][:12].max() > 0.5 * calm


@pytest.mark.parametrize("width", [1e-4, 0.02])
@pytest.mark.parametrize("joined", [False, True])
def test_a_short_pulse_of_a_table_makes_its_impulse(width, joined):
    """Far shorter than the steps before and after it; the body is free, or turns about a hinge."""
    begins, impulse, arm = 0.3047, 1.5, np.array([0.4, 0.3, 0.0])
    table = [(0.0, 0.0), (begins, 0.0), (begins + 0.3 * width, 2.0 * impulse / width),
             (begins + width, 0.0)]
    model = Model()
    hinge = model.node("hinge", (1.0, 0.3, -2.0))
    model.rigid_body("body", hinge, 2.0, (0.7, 0.8, 0.9))
    struck = model.attach("struck", np.add(hinge.point, arm), hinge)
    if joined:
        model.revolute(hinge, (0.0, 0.0, 1.0))
    model.force(struck, (0.0, 2.0, 0.0), table)
    result = simulate(model, 0.1, 1.0, tolerance=Tolerance(1e-3))
    # one step for a flank, from an acceleration without its rate: 0.24 % of h^2 times that rate
    spin = 2.0 * impulse * arm[0] / 0.9
    assert result["hinge.angular_velocity"][-1, 2] == pytest.approx(spin, rel=2.5e-3)
    if not joined:
        assert result["hinge.velocity"][-1] == pytest.approx([0.0, impulse, 0.0],
                                                             abs=2.5e-3 * impulse)
    assert result.steps < 200


# scene, end, grid, steps of the reference in it, quantity, largest error of any position and
# rotation in the tolerance: the spin of the struck beam about its axis is nearly chaotic
SCENES = {
    "strong": (lambda: spherical_beam_strong.build(modes=0), 30.0, 0.05, 320, "tip.position", 6.0),
    "squeezer": (squeezer.build, 0.03, 1e-4, 80, "crank.rotation", 1.2),
    "top": (heavy_top.build, 2.0, 0.01, 400, "centre.position", 1.2),
}


@pytest.mark.parametrize("name", SCENES)
def test_the_error_of_a_run_is_within_its_tolerance(name):
    """No step is given; the reference has equal steps, far shorter than any that is chosen."""
    build, t_end, grid, parts, quantity, worst = SCENES[name]
    fine = Simulation(build().model, grid / parts, output_every=parts).run_to(t_end).result()
    exact = fine[quantity]
    for allowed in (1e-2, 1e-3, 1e-4):
        result = simulate_within(build().model, grid, t_end, Tolerance(allowed))
        error = np.linalg.norm(result[quantity] - exact) / np.linalg.norm(exact)
        assert error <= 3.0 * allowed
        assert result.error <= 1.0
        assert difference(result, fine, Tolerance(allowed)) < worst


def test_a_chaotic_motion_is_said_to_be_one():
    """One body with option B, struck hard: a push of 1e-10 grows to the size of the beam."""
    def tip(push):
        scene = spherical_beam_strong.build(inertia="material")
        scene.model.force("tip", (0, 0, push), [(14.0, 0.0), (14.1, 1.0), (14.2, 0.0)])
        run = Simulation(scene.model, 0.0025, output_every=40).run_to(30.0).result()
        return run["tip.position"]
    apart = np.linalg.norm(tip(2e-7) - tip(0.0), axis=1) / 141.42
    assert apart[:150].max() < 1e-7 and apart[200:].max() > 1e-3
    with pytest.raises(SimulationError, match="does not decrease with the step.*may be chaotic"):
        simulate_within(spherical_beam_strong.build(inertia="material").model, 0.1, 30.0,
                        Tolerance(1e-3))


def test_tolerances_of_positions_and_rotations():
    tolerance = Tolerance(1e-3, position=0.5, rotation=0.01)
    allowed = tolerance.allowed(np.array([100.0, 1.0, 0.0]), np.array([False, True, False]))
    assert allowed == pytest.approx([0.6, 0.011, 0.5])
    for wrong, message in ((Tolerance(-1.0), "tolerance relative is -1.0: give a number >= 0"),
                           (Tolerance(0.0, 1.0), "allows no error: give a relative error"),
                           (Tolerance(1e-3, np.nan), "tolerance position is nan")):
        with pytest.raises(InputError, match=message):
            Simulation(hinged_beam.build().model, 0.1, tolerance=wrong)


@pytest.mark.parametrize("build", [planar_hinged_beam.build, hinged_beam.build])
def test_absolute_tolerances_know_rotations(build):
    """One of 50 for positions is no limit; that of rotations sets the step."""
    steps = [Simulation(build().model, 0.1, tolerance=Tolerance(0.0, 50.0, turn)).run_to(
        10.0).result().steps for turn in (1e-3, 1e-6)]
    assert steps[1] > 4 * steps[0]


def test_an_error_that_cannot_be_kept_stops_the_run():
    scene = spherical_beam_strong.build()
    with pytest.raises(SimulationError, match="error of a step is above the tolerance") as caught:
        Simulation(scene.model, 0.1, tolerance=Tolerance(1e-40)).run_to(1.0)
    assert len(caught.value.result.t) >= 1


def test_work_within_steps_follows_the_power():
    """A constant force on a mass: ``W = F^2 t^2 / 2 m``, exact on any grid and with any steps."""
    push, mass = 3.0, 2.0
    model = Model(planar=True)
    model.point_mass("ball", model.node("ball", (1.0, 0.0), keeps="translation"), mass)
    model.force("ball", (0.0, push))
    result = simulate(model, 0.01, 2.0, tolerance=Tolerance(1e-3))
    assert result.steps < len(result.t) / 3
    exact = push**2 * result.t**2 / (2 * mass)
    assert result["force on ball.position.work"] == pytest.approx(exact, rel=1e-9, abs=1e-12)


def test_the_number_of_steps_does_not_depend_on_the_unit_of_time():
    """A weight on a hardening spring, in units in which all bits but the exponents are the same."""
    taken = []
    for second in (1.0, 1024.0):
        model = Model(planar=True)
        model.point_mass("ball", model.node("ball", (1.3, 0.2), keeps="translation"), 2.0)
        model.fix(model.node("wall", (0.0, 0.0), keeps="translation"), "position")
        model.spring("ball", "wall", stiffness=80.0 / second**2, cubic=300.0 / second**2,
                     length=1.0)
        model.initial_velocity("ball", np.array([0.5, 0.8]) / second)
        result = simulate(model, 0.125 * second, 8.0 * second, tolerance=Tolerance(1e-4))
        taken.append(result.steps)
    assert taken[0] == taken[1] > 60
