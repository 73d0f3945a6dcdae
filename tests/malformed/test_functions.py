"""Functions of users that raise, give NaN or write elsewhere stop the run, in words."""

import math
import warnings

import numpy as np
import pytest
from numba import njit

from sebody import (
    InputError,
    LimitWarning,
    Model,
    Simulation,
    SimulationError,
    Tolerance,
    generalized_alpha,
    simulate,
    with_corners,
)
from sebody.analysis import equilibrium, linearize, resume, save_state
from sebody.runs.fingerprint import described

BEGIN = 0.5     # of the trouble
LAST = 1e-3     # of a step: how near to it runs get


def ball(*forces) -> Model:
    """A mass of 2 in a plane that starts at rest in the origin."""
    model = Model(planar=True)
    model.point_mass("body", model.node("ball", (0.0, 0.0), keeps="translation"), 2.0)
    for force in forces:
        force(model)
    return model


def load(function):
    return lambda model: model.force("ball", (1.0, 0.0), function, name="push")


def user(function):
    return lambda model: model.user_force("own", ["ball"], function)


def raises(t):
    if t > BEGIN:
        raise ValueError("too late")
    return 1.0


def divides(t):
    return 1.0 / (1.0 if t <= BEGIN else 0.0)


def leaves(t):
    return math.sqrt(BEGIN - t)


def not_a_number(t):
    return np.sqrt(BEGIN - t)


def infinite(t):
    return 1.0 if t <= BEGIN else math.inf


def beyond(t):
    return np.array([1.0, 2.0])[0 if t <= BEGIN else 2]


def moved_too_far(t, x, v, force):
    if x[0] > 0.0625:                   # of a push of one, at the time BEGIN
        raise ValueError("too far")
    force[0] = 1.0


def writes_late(t, x, v, force):
    force[0] = 1.0
    if t > BEGIN:
        force[int(1e9)] = 1.0


def reads_late(t, x, v, force):
    force[0] = 1.0 if t <= BEGIN else x[2]


def sets_nan(t, x, v, force):
    force[0] = 1.0
    force[1] = 0.0 if t <= BEGIN else np.nan


LATE = [(load(raises), "the function of 'push' raised ValueError: too late at t = 0.5"),
        (load(divides), "the function of 'push' raised ZeroDivisionError"),
        (load(leaves), "the function of 'push' raised ValueError: "),
        (load(not_a_number), "the function of 'push' gave nan at t = 0.5"),
        (load(infinite), "the function of 'push' gave inf at t = 0.5"),
        (load(beyond), "the function of 'push' raised IndexError"),
        (user(moved_too_far), "user force 'own' raised ValueError: too far at t = "),
        (user(writes_late), "user force 'own' raised IndexError: index 1000000000 is out of"),
        (user(reads_late), "user force 'own' raised IndexError: index 2 is out of"),
        (user(sets_nan), "user force 'own' gave [1.0, nan] at t = 0.5")]


@pytest.mark.parametrize("force, said", LATE)
def test_a_fault_stops_the_run(force, said):
    """It stops where the trouble begins, and keeps the motion until then."""
    h = 0.125
    for tolerance in (None, Tolerance(1e-3)):
        with pytest.raises(SimulationError) as caught:
            simulate(ball(force), h, 1.0, tolerance=tolerance)
        assert str(caught.value).startswith("stopped at t = 0.")
        assert said in str(caught.value) and ": correct it; results" in str(caught.value)
        t = caught.value.result.t[-1]
        assert BEGIN - h <= t <= BEGIN + LAST * h
        if force not in (LATE[2][0], LATE[3][0]):       # constant until then: x = t^2 / 4
            # the first step has an error of h^2 / 4 in all further places
            assert caught.value.result["ball.position"][-1, 0] == pytest.approx(
                t**2 / 4, abs=h**2 / 4)


def wall(*forces) -> Model:
    """The ball, and a fixed mass beside it that forces act on."""
    model = ball()
    model.force("ball", (0.5, 1.0), 1.0)
    model.point_mass("stone", model.node("wall", (2.0, 1.0), keeps="translation"), 3.0)
    model.fix("wall", "position")
    for force in forces:
        force(model)
    return model


def motor(model):
    model.actuator("motor", node="wall", direction=(0.0, 1.0))
    law_of("motor")(model)


def law_of(output):
    """A continuous law that writes beyond its outputs, late."""
    def law(t, y, x, rates, u, parameters):
        u[0] = 1.0
        if t > BEGIN:
            u[5] = 1.0
    return lambda model: model.controller("law", law, ["ball.position.x"], [output])


ON_FIXED = [(lambda model: model.user_force("own", ["wall"], writes_late),
             "user force 'own' raised IndexError: index 1000000000 is out of bounds"),
            (lambda model: model.force("wall", (1.0, 0.0), not_a_number, name="push"),
             "the function of 'push' gave nan"),
            (motor, "controller 'law' raised IndexError: index 5 is out of bounds"),
            (law_of("signal"), "controller 'law' raised IndexError: index 5 is out of bounds")]


@pytest.mark.parametrize("force, said", ON_FIXED)
@pytest.mark.parametrize("options", [{}, {"tolerance": Tolerance(1e-3)},
                                     {"scheme": generalized_alpha(index=2)}])
def test_a_fault_of_what_moves_nothing_stops_the_run(force, said, options):
    """A force on what is fixed, or a signal: no unknown tells of it."""
    with pytest.raises(SimulationError) as caught:
        simulate(wall(force), 0.125, 1.0, **options)
    assert str(caught.value).startswith(f"stopped at t = {BEGIN}") or options
    assert f"{said}" in str(caught.value) and "at t = 0.5" in str(caught.value)
    result = caught.value.result
    assert BEGIN - 0.125 <= result.t[-1] <= BEGIN + LAST * 0.125
    if not options:     # the trapezoidal rule's, of a constant force
        np.testing.assert_allclose(result["ball.position"][-1], result.t[-1]**2 * np.array(
            (0.25, 0.5)) / 2, rtol=1e-9)


def test_a_fault_of_what_is_fixed_stops_statics_and_members():
    model = wall(ON_FIXED[0][0])
    model.spring("ball", "wall", stiffness=5.0)
    assert equilibrium(model, t=0.25).t[-1] == pytest.approx(1.0)     # all of the load
    with pytest.raises(SimulationError, match="no equilibrium .* user force 'own' raised IndexErr"):
        equilibrium(model, t=1.0)
    result = simulate(model, 0.125, 0.5)
    linearize(result)
    result.state.loads[::3] = 2.0       # the time that the force is given
    with pytest.raises(InputError, match="the state cannot be evaluated: user force 'own' raised"):
        linearize(result)


TABLE = np.array([1.0, 2.0, 3.0])


def entry(k):
    return TABLE[int(k)]


@njit(boundscheck=False)
def entry_of_another(k):
    return entry(k) + 0.0


def behind_a_default(t, look=entry):
    return look(5.0 * t)


def by_a_default(t, table=TABLE):
    return table[int(5.0 * t)]


def in_a_force(t, x, v, force):
    force[1] = entry_of_another(5.0 * t)


def in_a_law(t, y, x, rates, u, parameters):
    u[0] = entry(5.0 * t)


def in_a_law_of_samples(t, y, x, u, parameters):
    u[0] = entry(5.0 * t)


def derivatives(t, y, x, derivatives, parameters):
    derivatives[0, len(y)] = 0.0


def push_by(law, **options):
    def build(model):
        model.actuator("motor", node="ball", direction=(0.0, 1.0))
        model.controller("law", law, ["ball.position.x"], ["motor"], **options)
    return build


def of_law(change, **options):
    """A continuous law with one of everything, which goes wrong after the time BEGIN."""
    def law(t, y, x, rates, u, parameters):
        u[0], rates[0] = parameters[0], y[0] - x[0]
        if t > BEGIN:
            change(t, y, x, rates, u, parameters)
    return push_by(law, states=[0.0], parameters=[1.0], **options)


def writes_far(t, y, x, rates, u, parameters):
    u[10**7] = 1.0


def writes_beyond(t, y, x, rates, u, parameters):
    u[5] = 1.0


def writes_rates(t, y, x, rates, u, parameters):
    rates[1] = 1.0          # which would be the output


def reads_readings(t, y, x, rates, u, parameters):
    u[0] = y[3]


def reads_states(t, y, x, rates, u, parameters):
    u[0] = x[-2]


def reads_parameters(t, y, x, rates, u, parameters):
    u[0] = parameters[7]


TOO_FAR = [(load(lambda t: entry(5.0 * t)), "the function of 'push'", 3, 3),
           (load(lambda t: entry_of_another(5.0 * t)), "the function of 'push'", 3, 3),
           (load(behind_a_default), "the function of 'push'", 3, 3),
           (load(by_a_default), "the function of 'push'", 3, 3),
           (user(in_a_force), "user force 'own'", 3, 3),
           (push_by(in_a_law), "controller 'law'", 3, 3),
           (push_by(in_a_law_of_samples, period=0.125), "controller 'law'", 3, 3),
           (of_law(writes_far), "controller 'law'", 10**7, 1),
           (of_law(writes_beyond), "controller 'law'", 5, 1),
           (of_law(writes_rates), "controller 'law'", 1, 1),
           (of_law(reads_readings), "controller 'law'", 3, 1),
           (of_law(reads_states), "controller 'law'", -2, 1),
           (of_law(reads_parameters), "controller 'law'", 7, 1)]


@pytest.mark.parametrize("force, what, index, size", TOO_FAR)
def test_reading_and_writing_beyond_an_end_stops_the_run(force, what, index, size):
    """In continuous laws and in helpers, too, with the words of the outer function."""
    with pytest.raises(SimulationError) as caught:
        simulate(ball(force), 0.0625, 1.0)
    told = f"{what} raised IndexError: index {index} is out of bounds for axis"
    assert told in str(caught.value) and f"with size {size} at t = " in str(caught.value)
    when = 0.6 if size == 3 else BEGIN
    assert when - 0.0626 <= caught.value.result.t[-1] <= when + 1e-3


def test_derivatives_beyond_their_end_stop_the_run():
    model = ball(push_by(lambda t, y, x, rates, u, parameters: None, derivatives=derivatives))
    with pytest.raises(SimulationError, match="derivatives of controller 'law' raised IndexError: "
                       "index 1 is out of bounds for axis 1 with size 1 at t = "):
        simulate(model, 0.0625, 1.0)


@pytest.mark.parametrize("force, said", [
    (load(lambda t: 1.0 / t), "the function of 'push' raised ZeroDivisionError"),
    (load(lambda t: np.log(t)), "the function of 'push' gave -inf at t = 0"),
    (user(lambda t, x, v, force: (force.fill(v[0] / np.sqrt(v[0] ** 2)), None)[1]),
     "user force 'own'"),
])
def test_a_fault_at_the_start_is_refused(force, said):
    with pytest.raises(InputError) as caught:
        Simulation(ball(force), 0.1)
    assert "the initial state cannot be evaluated: " in str(caught.value)
    assert said in str(caught.value)


def far(t, x, v, force):
    force[int(1e9)] = 1.0


def before(t, x, v, force):
    force[-3] = 1.0


@pytest.mark.parametrize("function", [far, before])
def test_writing_outside_is_refused_everywhere(function):
    model = ball(user(function))
    for begin in (lambda: Simulation(model, 0.1), lambda: equilibrium(model)):
        with pytest.raises(InputError, match="user force 'own' raised IndexError: index .* is out"):
            begin()


def writes_to_places(t, x, v, force):
    x[0] = 1.0


def writes_to_rates(t, x, v, force):
    v[0] = 1.0


def opens(t, x, v, force):
    open("file")


@pytest.mark.parametrize("function", [writes_to_places, writes_to_rates, opens, lambda t: 1.0])
def test_what_is_no_force_is_refused_at_once(function):
    model = ball()
    with pytest.raises(InputError, match="user force 'own' (cannot be compiled: write function|"
                                         r"has the arguments \(t\): give a function of )"):
        user(function)(model)
    assert not model.loads and not model.own_names - {"body"}


def test_a_fault_of_one_run_is_not_that_of_the_next():
    """The same model, whose function raises late: a run that ends before is whole."""
    model = ball(load(raises))
    with pytest.raises(SimulationError, match="raised ValueError"):
        simulate(model, 0.125, 1.0)
    assert simulate(model, 0.125, 0.5).t[-1] == 0.5


def test_a_linearization_at_a_fault_is_refused():
    result = simulate(ball(user(sets_nan)), 0.125, 0.5)
    result.state.loads[0] = 2.0         # the time that the force is given
    with pytest.raises(InputError, match="the state cannot be evaluated: user force 'own' gave"):
        linearize(result)


def pulse(t):
    return 1.0 if 0.21 < t < 0.24 else 0.0


def test_a_pulse_between_steps_is_said():
    """One of a function with corners; of a table with close rows no step misses anything."""
    with warnings.catch_warnings():
        warnings.simplefilter("error", LimitWarning)
        simulate(ball(load([(0.0, 0.0), (0.21, 0.0), (0.22, 5.0), (0.24, 0.0)])), 0.1, 0.5)
    for force, value, at in ((load(with_corners(pulse, [0.21, 0.24])), "1", "0.225"),):
        with pytest.warns(LimitWarning, match=f"push is {value} at t = {at}, between two steps of "
                                              "0.1, at which it is -?0 and -?0: choose steps"):
            simulate(ball(force), 0.1, 0.5)
        with warnings.catch_warnings():
            warnings.simplefilter("error", LimitWarning)
            simulate(ball(force), 0.005, 0.5)               # steps that resolve it
            simulate(ball(force), 0.1, 0.2)                 # it comes later
            warnings.filterwarnings("ignore", "energy balance", LimitWarning)
            warnings.filterwarnings("ignore", ".* characteristic length", LimitWarning)
            simulate(ball(force), 0.1, 0.5, tolerance=Tolerance(1e-3))


def test_jumps_and_bends_between_steps_are_no_pulses():
    for rows in ([(0.0, 0.0), (0.21, 0.0), (0.2101, 5.0)], [(0.0, 0.0), (0.25, 5.0), (0.55, 5.0)],
                 [(0.0, 1.0), (0.33, 4.0), (0.66, 0.0)]):
        with warnings.catch_warnings():
            warnings.simplefilter("error", LimitWarning)
            simulate(ball(load(rows)), 0.1, 1.0)


def slow(t):
    return 2.0 * t


def also_slow(t):
    return t * 2.0


def fast(t):
    return 3.0 * t


def test_a_state_goes_on_with_its_own_functions_only(tmp_path):
    """One that computes the same by other code is another one."""
    path = save_state(Simulation(ball(load(slow)), 0.1).run_to(0.2), tmp_path / "state.npz")
    assert resume(ball(load(slow)), path).time == pytest.approx(0.2)
    for other in (also_slow, fast):
        with pytest.raises(InputError, match="state.npz is of another model"):
            resume(ball(load(other)), path)


def times(factor):
    def function(t):
        return factor * t
    return function


def behind(function):
    return lambda t: 1.0 + function(t)


def test_a_function_is_known_by_what_it_refers_to():
    """Constants it was made with, and functions it calls."""
    for make, one, other in ((times, 2.0, 3.0), (times, np.ones(2), np.zeros(2)),
                             (behind, slow, fast), (behind, times(2.0), times(3.0))):
        assert described(make(one)) == described(make(one)) != described(make(other))
    assert described(njit(slow)) == described(slow)
