"""Load time functions: tables and compiled functions, and what is said about those that fail."""

import functools

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from sebody import InputError, Model, Simulation, simulate
from sebody.engine import evaluate
from sebody.model.histories import time_function, with_corners
from sebody.model.motions import motion
from sebody.model.time_functions import TimeFunction
from sebody.scenes.hinged_beam import build

TABLE = [(0.0, 0.0), (0.05, 1.0e4), (0.15, -2.0e3)]


def ramps(t):
    """The table as a function."""
    if t < 0.05:
        return 2.0e5 * t
    return max(1.0e4 - 1.2e5 * (t - 0.05), -2.0e3)


def two_nodes():
    model = Model()
    model.node("base", (0, 0, 0))
    model.node("tip", (60, 0, 0))
    return model


@pytest.mark.parametrize("table, message", [
    ([(0.0, 1.0), (2.0, 1.0), (1.0, 3.0)], "times of a time function of a load must not decrease, "
                                           "after t = 2 "
                                           "they do: sort the rows"),
    ([(0.0, 1.0), (3.0, 2.0), (3.0, 1.0), (3.0, 0.0)],
     "time function of a load has more than two rows at t = 3: give the value before a jump and "
     "the value "
     "after it"),
    ([1.0, 2.0], r"time function of a load has shape \(2,\): give rows \(t, value\)"),
    ([(0.0, 1.0, 2.0)], r"time function of a load has shape \(1, 3\): give rows"),
    ([], "time function of a load has shape .*: give rows"),
    (np.nan, "time function of a load is nan: give a finite number"),
    ([(0.0, np.nan)], "time function of a load contains NaN or infinite entries: give finite "
                      "numbers"),
    ([(np.inf, 1.0)], "NaN or infinite entries"),
])
def test_wrong_tables(table, message):
    with pytest.raises(InputError, match=message):
        time_function(table)


def opens_a_file(t):
    return open(t)


def returns_nothing(t):
    return None


@pytest.mark.parametrize("function", [opens_a_file, returns_nothing, lambda t: 1j * t])
def test_function_that_cannot_be_compiled(function):
    with pytest.raises(InputError, match=f"time function of a load '{function.__name__}' cannot "
                                         f"be compiled: "
                                         "use only arithmetic, math and numpy in it"):
        time_function(function)


@pytest.mark.parametrize("source", [
    pytest.param(lambda a, b: a, id="two arguments"),
    pytest.param(functools.partial(max, 1.0), id="partial"),
    pytest.param("abc", id="text"), pytest.param([(0, 1), (1,)], id="ragged rows")])
def test_histories_to_be_refused(source):
    with pytest.raises(InputError, match="time function of a load"):
        time_function(source)


@pytest.mark.parametrize("action, message", [
    (lambda m: m.force("base", (0, 1)), "force on base.position is .0, 1.: give 3 finite numbers"),
    (lambda m: m.force("base", (0, 0, np.inf)), "force on base.position is .*finite numbers"),
    (lambda m: m.torque("base", (0, 0)), "torque on base.rotation is .*give 3 finite"),
    (lambda m: m.torque("base", (0, np.nan, 0)), "torque on base.rotation is .*give 3 finite"),
    (lambda m: m.force("far", (0, 0, 1)), "node 'far' is unknown: the model has base, tip"),
    (lambda m: m.force("tip", (0, 0, 1), [(0.5, 1.0), (0.0, 2.0)]),
     "must not decrease, after t = 0.5"),
])
def test_wrong_loads(action, message):
    model = two_nodes()
    with pytest.raises(InputError, match=message):
        action(model)
    assert not model.loads


def test_planar_torque_is_one_number():
    model = Model(planar=True)
    model.node("base", (0, 0))
    with pytest.raises(InputError, match="torque on base.rotation is .*: give 1 finite number"):
        model.torque("base", (0, 0, 1))
    model.torque("base", 2.0)
    assert model.loads[0].direction == [2.0]


def test_histories():
    assert time_function(None) == TimeFunction((0.0,), ((1.0, 0.0, 0.0, 0.0),))
    table = time_function(np.array(TABLE))
    assert table.times == (0.0, 0.05, 0.15)
    assert [row[0] for row in table.pieces] == [0.0, 1.0e4, -2.0e3]
    assert table.addresses == (0, 0, 0) and time_function(table) is table
    assert time_function(ramps).addresses[0] != 0


def amplitudes(run, t):
    """Amplitude and rates of every item at a time."""
    loads = np.zeros_like(run.state.loads)
    evaluate.set_loads(run.system, run.state.frames, loads, t)
    return loads.reshape(-1, 3)


def test_amplitudes_in_the_loop():
    """Linear between the rows, end values outside, functions as they are."""
    model = build().model
    for source in (TABLE, ramps, None, [(0.1, 7.0)]):
        model.force("tip", (0, 0, 1), source)
    run = Simulation(model, 0.01)
    for t in (-1.0, 0.0, 0.02, 0.05, 0.0999, 0.15, 9.0):
        expected = np.interp(t, *zip(*TABLE, strict=True))
        of_table, of_function, constant, single = amplitudes(run, t)[1:]
        assert of_table[0] == pytest.approx(expected, abs=1e-9)
        assert of_function == pytest.approx([ramps(t), 0.0, 0.0])
        assert (constant[0], single[0]) == (1.0, 7.0)


def test_a_constant_load_is_a_number():
    """Of every kind of load, of every kind of number, in any phase: as by a table of one row."""
    model = build().model
    for value in (5.0, -3, np.float32(0.25), np.int64(2), 0):
        model.force("tip", (0, 0, 1), value)
        model.torque("base", (0, 0, 1), value, follower=True)
        model.mode_force("beam", 0, 2.0, value)
    run = Simulation(model, 0.01)
    for t in (-1.0, 0.0, 7.0):
        values = amplitudes(run, t)[1:]
        assert values[:, 0].tolist() == list(np.repeat([5.0, -3.0, 0.25, 2.0, 0.0], 3))
        assert not values[:, 1:].any()

    def swung(amplitude):
        model = Model(planar=True)
        model.rigid_body("arm", model.node("end", (1.0, 0.0)), 2.0, 0.1)
        model.torque("end", 1.0, amplitude)
        return simulate(model, 0.01, 1.0)["end.rotation"]
    assert np.array_equal(swung(0.5), swung([(0.0, 0.5)]))
    assert swung(0.5)[-1] == pytest.approx(0.5 * 0.5 / 0.1, rel=1e-9)     # M t^2 / 2 J


def test_a_drive_that_does_not_move_is_refused():
    model = Model(planar=True)
    model.rigid_body("arm", model.node("end", (1.0, 0.0)), 2.0, 0.1)
    with pytest.raises(InputError, match="motion of a drive is the constant 0.5: give a table, "
                                         "a function of time or a ready profile, or fix the node"):
        model.move("end", 1.0, 0.5, what="rotation")


def wave(t):
    return np.sin(3.0 * t)


def wave_rate(t):
    return 3.0 * np.cos(3.0 * t)


def wave_second(t):
    return -9.0 * np.sin(3.0 * t)


def test_motions_in_the_loop():
    """Tables become splines at rest at both ends; rates are those of what moves."""
    rows = [(0.0, 0.0), (0.5, 0.4), (1.0, 1.0), (2.0, 0.7)]
    model = Model(planar=True)
    model.node("a", (0.0, 0.0))
    model.point_mass("ball", "a", 1.0)
    for k, source in enumerate((rows, (wave, wave_rate, wave_second))):
        model.node(f"moved {k}", (1.0, 0.0))
        model.move(f"moved {k}", (1.0, 0.0), source)
        model.fix(f"moved {k}", "rotation")
    model.fix("a", "rotation")
    run = Simulation(model, 0.01)
    spline = CubicSpline(*zip(*rows, strict=True), bc_type="clamped")
    for t in (0.0, 0.3, 0.5, 1.7, 2.0):
        of_table, of_functions = amplitudes(run, t)
        # at the start the acceleration is that with which the motion begins
        expected = [float(spline(t, k)) * (k < 2 or t < 2) for k in range(3)]
        assert of_table == pytest.approx(expected, abs=1e-12)       # cubics of order one
        assert of_functions == pytest.approx([wave(t), wave_rate(t), wave_second(t)])
    assert amplitudes(run, 5.0)[0] == pytest.approx([0.7, 0.0, 0.0])


@pytest.mark.parametrize("source, message", [
    (lambda t: t if t < 1.0 else 1.0, r"'<lambda>' cannot be differentiated \(cannot determine "
     r"truth .*no `if` on the time, or give three functions \(value, rate, second rate\), a table"),
    ((wave, wave, wave_second), "second function is not the derivative of the first: at t = 0.137"),
    ((wave, wave_rate, wave), "third function is not the derivative of the second"),
    ([(0.0, 0.0)], "has one row: give at least two rows"),
    ("abc", "motion of a drive cannot be read as numbers")])
def test_wrong_motions(source, message):
    model = Model(planar=True)
    model.node("a", (0.0, 0.0))
    with pytest.raises(InputError, match=message):
        model.move("a", (1.0, 0.0), source)
    assert not model.nodes["a"].position.fixed


def test_compiled_history_gives_the_run_of_the_table():
    results = []
    for source in (TABLE, ramps):
        scene = build()
        scene.model.loads.clear()
        scene.model.torque("base", (0, 0, 1), source)
        results.append(simulate(scene.model, 0.01, 0.2))
    tips = [r["tip.position"] for r in results]
    assert np.abs(tips[0] - tips[0][0]).max() > 1e-2
    # loads that differ by rounding: EPS of a path of 100, over 20 steps
    assert np.abs(tips[0] - tips[1]).max() < 1e-10
    assert results[0]["energy.external_work"] == pytest.approx(
        results[1]["energy.external_work"], rel=1e-9, abs=1e-9)


def test_a_dead_torque_stays_in_space_while_its_node_turns():
    """A body of equal moments: ``J dw/dt = m`` in space, whatever its attitude.

    It starts with a spin across the torque. One that turned with the node would be another vector
    after a tenth of a turn, and its work another number.
    """
    inertia, moment = 2.0, np.array([0.0, 0.5, 1.5])
    start = np.array([3.0, -1.0, 0.4])
    model = Model()
    model.rigid_body("ball", model.node("centre", (0, 0, 0)), 1.0, (inertia,) * 3)
    model.initial_velocity("centre", angular=start)
    model.torque("centre", moment)
    result = simulate(model, 1e-3, 2.0)
    t = result.t[:, None]
    assert result["centre.angular_velocity"] == pytest.approx(start + moment / inertia * t,
                                                              abs=2e-5)
    work = (start @ moment * t + moment @ moment / (2 * inertia) * t**2)[:, 0]
    assert result["torque on centre.rotation.work"] == pytest.approx(work, abs=1e-4)
    turned = np.trace(result["centre.rotation"], axis1=1, axis2=2).min()
    assert turned < -0.9        # it has turned by half a turn on the way


def test_a_function_keeps_the_corners_it_is_given():
    found = with_corners(ramps, [0.05, 0.15])
    assert found.corners == (0.05, 0.15) and found.addresses[0] != 0
    assert time_function(ramps).corners == ()
    model = two_nodes()
    model.fix("base")
    model.rigid_body("body", "tip", 1.0, (1.0, 1.0, 1.0))
    model.force("tip", (0, 0, 1), found)
    system = Simulation(model, 0.01).system     # variable steps end at quarters in between, too
    assert system.corners == pytest.approx([0.05, 0.075, 0.1, 0.125, 0.15], rel=1e-15)
    assert not system.jumps.any()               # it bends there
    with pytest.raises(InputError, match="corners are .*: give a list of times"):
        with_corners(ramps, [[0.05]])


def test_further_arguments_keep_their_defaults():
    """As users bind the variable of a loop: ``lambda t, F=F: ...``; arrays and helpers, too."""
    powers = np.array([1.0, 3.0])

    def helped(t, scale=2.0, powers=powers):
        return scale * raised(t, powers[1])

    def raised(x, k):
        return x**k
    made = [time_function(lambda t, F=F, w=0.5: F * np.cos(w * t)) for F in (1.0, -2.5, 4.0)]
    times = np.array([0.0, 0.7, 2.0])
    for F, one in zip((1.0, -2.5, 4.0), made, strict=True):
        assert one.values(times) == pytest.approx(F * np.cos(0.5 * times), rel=1e-15)
    assert time_function(helped).values(times) == pytest.approx(2.0 * times**3, rel=1e-15)
    driven = motion(lambda t, A=0.3: A * np.sin(2.0 * t))
    assert driven.at(0.4) == pytest.approx(0.3 * np.array(
        [np.sin(0.8), 2.0 * np.cos(0.8), -4.0 * np.sin(0.8)]), rel=1e-14)
    cornered = motion(with_corners(lambda t, A=0.3: A * t**3, [1.0]))
    assert cornered.at(0.5) == pytest.approx([0.0375, 0.225, 0.9], rel=1e-14)


def test_a_force_keeps_the_defaults_of_further_arguments():
    rest = np.array([0.1, -0.2, 0.3])

    def constraint_columns(t, x, v, force, k=7.0, rest=rest):
        for i in range(3):
            force[i] = k * (rest[i] - x[i])
    model = Model()
    model.point_mass("body", model.node("body", (1.0, 2.0, 3.0), "translation"), 2.0)
    model.user_force("pull", ["body"], constraint_columns)
    start = Simulation(model, 0.01).result()["body.acceleration"][0]
    assert start == pytest.approx(3.5 * np.array([-0.9, -2.2, -2.7]), rel=1e-14)


@pytest.mark.parametrize("function, arguments", [
    (lambda t, u: t, "t, u"), (lambda t, u, F=1.0: t, "t, u, F")])
def test_further_arguments_without_a_value_are_named(function, arguments):
    with pytest.raises(InputError, match=f"time function of a load '<lambda>' has the arguments "
                                         rf"\({arguments}\): give a function of \(t\); further "
                                         "arguments need defaults"):
        time_function(function)
