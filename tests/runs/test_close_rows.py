"""Loads whose rows lie closer together than steps: the impulse is the integral of the table."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sebody import (
    LimitWarning,
    Model,
    Simulation,
    Tolerance,
    rest_to_rest,
    simulate,
    with_corners,
)
from sebody.analysis import Ensemble, equilibrium, final, gradient
from sebody.runs.schemes import generalized_alpha

END = 3.0
OFF = 0.00371828        # of all times, so that no row is on a grid
TURN = Rotation.from_euler("xyz", [0.4, -0.7, 1.1]).as_matrix()
INERTIA = 1.7


def wheel(*torques):
    """One freedom, no multipliers."""
    model = Model(planar=True)
    model.node("hub", (0.3, -0.2))
    model.rigid_body("wheel", "hub", 1.0, INERTIA)
    model.revolute("hub", name="pin")
    for torque in torques:
        model.torque("hub", 1.0, torque)
    return model


def turned_cart(*forces):
    """A cart in space that slides along a turned axis, with a weight on it, and multipliers."""
    model = Model()
    axis = TURN[2]
    model.node("hub", (1.0, 2.0, 3.0))
    model.node("rim", (1.0, 2.0, 3.0) + 0.8 * TURN[0], keeps="translation")
    model.rigid_body("cart", "hub", INERTIA - 0.6, np.eye(3))
    model.point_mass("weight", "rim", 0.6)
    model.prismatic("hub", axis=axis, name="rail")
    model.spherical("rim", to=model.attach("spoke", model.nodes["rim"].point, "hub"))
    for force in forces:
        model.force("hub", axis, force)
    return model


def reversal(apart, begin=1.0):
    """Forwards, backwards, nothing: jumps as two rows that are some time apart."""
    times = np.array([0.0, begin, begin + apart, begin + 1.0, begin + 1.0 + apart, 9.0])
    return np.column_stack([times, [1.0, 1.0, -1.0, -1.0, 0.0, 0.0]])


def blows(apart, begin=1.0):
    """Three blows of an impulse of one, as triangles and rectangles, and a zigzag of many rows."""
    t = begin + apart * np.array([0.0, 1.0, 3.0, 1e5, 1e5 + 1, 1e5 + 2, 1e5 + 3])
    many = begin + 1.2 + np.linspace(0.0, 0.05, 42)
    values = np.array([0.0, 2.0 / 3.0, 0.0, 0.0, 0.5, 0.5, 0.0]) / apart
    zigzag = np.concatenate([[0.0], np.tile([3.0, -2.0, 7.0], 14)[:40], [0.0]])
    return np.column_stack([np.concatenate([t, many, [9.0]]),
                            np.concatenate([values, zigzag, [0.0]])])


def integrals(table, times):
    """First and second integral of a table at some times, exact for lines."""
    points = np.union1d(times, table[:, 0][table[:, 0] < times[-1]])
    points = points[points >= 0.0]
    middle = np.interp((points[1:] + points[:-1]) / 2, *table.T)
    values, step = np.interp(points, *table.T), np.diff(points)
    first = np.append(0.0, np.cumsum(step * (values[1:] + values[:-1]) / 2))
    within = step * (first[:-1] + step * (values[:-1] + 2.0 * middle) / 6.0)
    second = np.append(0.0, np.cumsum(within))
    at = np.searchsorted(points, times)
    return first[at], second[at]


def assert_integrals(result, *tables, rate=1e-12, angle=1e-9):
    found = [integrals(np.asarray(table), result.t) for table in tables]
    first, second = np.sum(found, axis=0) / INERTIA
    if "rail" in {joint.name for joint in result.model.joints}:
        speed, way = ((result[name] - result[name][0]) @ TURN[2]
                      for name in ("rim.velocity", "rim.position"))
    else:
        speed, way = result["pin.rate"], result["pin.angle"]
    assert np.abs(speed - first).max() < rate * max(1.0, np.abs(first).max())
    assert np.abs(way - second).max() < angle


@pytest.mark.parametrize("apart", [1e-9, 1e-6, 1e-3, 0.009])
@pytest.mark.parametrize("begin", [1.0, 1.0 + OFF])
@pytest.mark.parametrize("h", [0.01, 0.0025])
def test_jumps_written_as_two_rows(apart, begin, h):
    """At all steps of the grid, the last rows as well as those beside the jumps."""
    if apart > h:
        apart = 0.9 * h
    table = reversal(apart, begin)
    assert_integrals(simulate(wheel(table), h, END), table)


@pytest.mark.parametrize("make", [wheel, turned_cart])
@pytest.mark.parametrize("stabilized", [False, True])
def test_blows_and_several_tables_at_once(make, stabilized):
    tables = blows(1e-6), reversal(1e-6), reversal(1e-4, 1.0 + OFF)
    scheme = generalized_alpha(0.9, index=2 if stabilized else 3, tolerance=1e-13)
    result = simulate(make(*tables), 0.01, END, scheme)
    # constraints see positions of four lengths: their rounding in parts of steps, h / 512
    assert_integrals(result, *tables, rate=1e-12 if make is wheel else 1e-9)


@pytest.mark.parametrize("apart", [1e-9, 1e-6])
def test_chosen_steps(apart):
    tables = reversal(apart, 1.0 + OFF), blows(2e-6)[[0, 1, 2, -1]]
    result = simulate(wheel(*tables), 0.01, END, tolerance=Tolerance(1e-6))
    assert_integrals(result, *tables)


def test_a_load_that_begins_within_the_first_step():
    """At the start it is what the table says."""
    table = np.array([(-1e-3, 0.0), (1e-3, 2.0), (2e-3, 1.0), (9.0, 1.0)])
    result = simulate(wheel(table), 0.01, 0.5)
    assert result["hub.angular_acceleration"][0] == pytest.approx(1.0 / INERTIA, rel=1e-14)
    assert_integrals(result, np.vstack([(0.0, 1.0), table[1:]]))


def test_profiles_and_functions():
    """Of a profile the shape is known, of a function with corners steps end at these."""
    rise = rest_to_rest(-2.0, 1e-6, start=1.0, origin=1.0)
    rate = simulate(wheel(rise), 0.01, 2.0)["pin.rate"][-1]
    assert rate == pytest.approx(1e-6 / INERTIA, abs=1e-12)      # without the rise, whose mean is 0

    def falls(t):
        return 1.0 - 2.0 * min(max((t - 1.0) / 1e-3, 0.0), 1.0)
    rate = simulate(wheel(with_corners(falls, [1.0, 1.001])), 0.01, 2.0)["pin.rate"][-1]
    assert rate == pytest.approx(0.001 / INERTIA, abs=1e-5)


def test_members_of_an_ensemble_go_on_in_lanes():
    """Amplitudes and tables vary; every run equals the integral of its own table."""
    many = Ensemble(wheel(reversal(1e-6), reversal(1e-3, 1.0 + OFF)), 0.01)
    first, second = many.model.loads
    factors, tables = np.linspace(0.5, 3.0, 16), np.array([reversal(1e-3, 1.0 + OFF)[:, 1]] * 16)
    tables *= np.linspace(-1.0, 2.0, 16)[:, None]
    done = many.run({f"{first.name}.amplitude": factors, f"{second.name}.table": tables}, END,
                    {"rate": final("pin.rate")})
    wanted = [(factor * 5e-7 + (integrals(np.column_stack([reversal(1e-3, 1.0 + OFF)[:, 0], table]),
                                          np.array([0.0, END]))[0][1])) / INERTIA
              for factor, table in zip(factors, tables, strict=True)]
    assert np.abs(np.ravel(done.values["rate"]) - wanted).max() < 1e-12


@pytest.mark.parametrize("mode", ["adjoint", "forward"])
def test_gradients_are_those_of_the_integral(mode):
    table = reversal(1e-6)
    model = wheel(table)
    name = model.loads[0].name
    found = gradient(model, 0.01, END, {"rate": final("pin.rate")},
                     [f"{name}.amplitude", f"{name}.table"], mode=mode)
    assert found.matrix[0, 0] == pytest.approx(5e-7 / INERTIA, abs=1e-12)
    by_rows = [np.subtract(*(simulate(wheel(table + change * np.outer(one, (0, 1))), 0.01, END)[
        "pin.rate"][-1] for change in (0.5, -0.5))) for one in np.eye(len(table))]
    assert np.abs(found.matrix[0, 1:] - by_rows).max() < 1e-12        # runs are linear in a table


def test_what_no_step_follows_has_the_table_as_given():
    """An equilibrium, whatever the distance of rows, within the rise of a load."""
    model = wheel([(0.0, 0.0), (0.25, 5.0), (0.3, 0.0)])
    model.torsion_spring("hub", 10.0, name="coil")
    assert equilibrium(model, t=0.1)["pin.angle"][-1] == pytest.approx(0.2, rel=1e-9)


def test_many_divided_steps_are_said():
    """A table with rows ten times as dense as steps; its integral is kept in few parts of each."""
    t = np.linspace(0.0, 2.0, 2001)
    table = np.column_stack([t, np.sin(40.0 * t) + 0.3 * np.sin(1500.0 * t)])
    table[-1, 1] = 0.0
    with pytest.warns(LimitWarning, match="rows of the table of torque on hub.rotation are closer "
                      "than the step of 0.01 in 200 steps: .* divided into as many as four"):
        run = Simulation(wheel(table), 0.01).run_to(END)
        result = run.result()
    assert_integrals(result, table, rate=1e-11)
    assert run.state.control.steps <= 200 * 4 + 100


def test_steps_end_at_the_rows_and_the_run_begins_with_the_table():
    """A run of a table with far rows makes the steps it made; one with close rows some more."""
    def steps(table):
        run = Simulation(wheel(table), 0.01)
        run.run_to(END)
        return int(run.state.control.steps)
    assert steps([(0.0, 0.0), (1.004, 1.0), (1.5, 0.0)]) == 300
    assert 300 < steps(reversal(1e-6)) <= 300 + 2 * 4
