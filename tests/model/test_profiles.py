"""Ready time functions: closed forms, rates against SymPy and differences, starts and jumps."""

import math
import re
import warnings

import numpy as np
import pytest
import sympy as sp
from numba import njit
from scipy.interpolate import CubicSpline

from sebody import (
    InputError,
    LimitWarning,
    Model,
    Simulation,
    harmonic,
    piecewise,
    ramp,
    rest_to_rest,
    simulate,
    spline,
    trapezoidal,
    with_corners,
)
from sebody.engine.evaluate import set_loads
from sebody.model.histories import time_function
from sebody.model.motions import motion

t = sp.Symbol("t")
u = (t - sp.Rational(1, 4)) / 2
ROWS = [(0.0, 0.2, 1.5), (0.5, 0.4, -0.3), (1.3, -0.1, 0.0)]
# its rate jumps at 0.5
BENT = (lambda t: max(t, 2.0 * t - 0.5), lambda t: 2.0 if t > 0.5 else 1.0, lambda t: 0.0 * t)
# a profile, and its formula on an interval, as far as it has one
FORMULAS = {
    "rest to rest": (rest_to_rest(-3.0, 2.0, start=0.25, origin=0.5),
                     [(0.25, 2.25, sp.Rational(1, 2) - 3 * (10 * u**3 - 15 * u**4 + 6 * u**5)),
                      (0.0, 0.25, sp.Rational(1, 2)), (2.25, 9.0, -sp.Rational(5, 2))]),
    "ramp": (ramp(0.7, 2.0, start=1.0, origin=-0.2),
             [(0.0, 1.0, -0.2 + 0 * t), (1.0, 3.0, -0.2 + 0.7 * (t - 1)), (3.0, 9.0, 1.2 + 0 * t)]),
    "endless ramp": (ramp(-0.7), [(0.0, 9.0, -0.7 * t)]),
    "harmonic": (harmonic(0.3, 5.0, phase=0.4, mean=2.0),
                 [(0.0, 9.0, 2 + 0.3 * sp.sin(5 * t + 0.4))]),
    "trapezoidal": (trapezoidal(-2.0, 0.5, 1.0, start=1.0, origin=0.1),
                    [(1.0, 1.5, 0.1 - (t - 1)**2 / 2), (1.5, 5.0, 0.1 - 0.125 - (t - 1.5) / 2),
                     (5.0, 5.5, -1.9 + (5.5 - t)**2 / 2), (5.5, 9.0, -1.9 + 0 * t)]),
    "triangular": (trapezoidal(2.0, 9.0, 0.5),
                   [(0.0, 2.0, t**2 / 4), (2.0, 4.0, 2 - (4 - t)**2 / 4)]),
    "pieces": (piecewise((0.0, harmonic(0.3, 5.0, mean=1.0)), (1.0, 0.25),
                         (2.0, rest_to_rest(-3.0, 2.0, start=0.25, origin=0.5)), (3.0, ramp(1.5))),
               [(0.0, 1.0, 1 + 0.3 * sp.sin(5 * t)), (1.0, 2.0, 0.25 + 0 * t),
                (2.0, 2.25, sp.Rational(1, 2) - 3 * (10 * u**3 - 15 * u**4 + 6 * u**5)),
                (2.25, 3.0, -sp.Rational(5, 2)), (3.0, 9.0, 1.5 * t)]),
    "later pieces": (piecewise((0.5, ramp(1.0, start=1.0)), (3.0, harmonic(1.0, 2.0))),
                     [(0.0, 1.0, 0 * t), (1.0, 3.0, t - 1), (3.0, 9.0, sp.sin(2 * t))])}


def amplitudes(source, times):
    """Value and rates in the compiled loop."""
    model = Model(planar=True)
    model.point_mass("ball", model.node("ball", (0.0, 0.0), keeps="translation"), 1.0)
    model.force("ball", (1.0, 0.0), harmonic(9.0, 9.0))
    model.force("ball", (1.0, 0.0), source)
    run = Simulation(model, 0.01)
    found = np.zeros((len(times), run.state.loads.size))
    for row, time in zip(found, times, strict=True):
        set_loads(run.system, run.state.frames, row, time)
    return found[:, 3:]


@pytest.mark.parametrize("name", FORMULAS)
def test_profiles_are_their_formulas(name):
    """Values and rates in the loop and in the model, against SymPy's derivatives of the formula."""
    profile, formulas = FORMULAS[name]
    for first, last, formula in formulas:
        times = first + (last - first) * np.array([0.0, 0.113, 0.5, 0.977])
        expected = np.array([[float(sp.diff(formula, t, k).subs(t, time)) for k in range(3)]
                             for time in times])
        assert amplitudes(profile, times) == pytest.approx(expected, abs=1e-12)
        assert np.array([profile.at(time) for time in times]) == pytest.approx(expected, abs=1e-12)
        assert profile.values(times) == pytest.approx(expected[:, 0], abs=1e-12)


def test_a_table_with_its_rates():
    profile = spline(ROWS)
    at = np.array([profile.at(row[0]) for row in ROWS])
    assert at[:, :2] == pytest.approx(np.array(ROWS)[:, 1:], abs=1e-14)
    free = spline([row[:2] for row in ROWS], rates=(1.5, 0.0))
    assert free.at(0.0)[1] == pytest.approx(1.5)
    second = free.of_piece(0, 0.5)[2], free.of_piece(1, 0.5)[2]
    assert second[0] == pytest.approx(second[1])        # a spline bends without a jump
    for one in (profile, free):     # differences: error h^2 / 6 of the third derivative, about 10
        for time in (0.1, 0.49, 0.7, 1.2):
            low, high = one.at(time - 1e-5), one.at(time + 1e-5)
            assert (high - low)[:2] / 2e-5 == pytest.approx(one.at(time)[1:], abs=1e-8)
    assert profile.at(9.0) == pytest.approx([-0.1, 0.0, 0.0])


def test_corners():
    """Variable steps end where value, rate or acceleration jumps, but not at the start."""
    assert FORMULAS["trapezoidal"][0].corners == pytest.approx((1.0, 1.5, 5.0, 5.5))
    assert FORMULAS["rest to rest"][0].corners == () and FORMULAS["harmonic"][0].corners == ()
    assert ramp(0.7, 2.0).corners == (2.0,) and ramp(0.7, 2.0, start=1.0).corners == (1.0, 3.0)
    assert FORMULAS["pieces"][0].corners == (1.0, 2.0, 3.0)


@njit
def square(time):
    return time**2


def helped(time):
    return 0.05 * square(time)


def plain(time):
    return 0.3 + 0.2 * math.sin(4.0 * time) * np.exp(-time) + helped(time)


def test_a_plain_function_drives():
    """SymPy derives its rates, through what it calls; its value at the start is taken off."""
    drive, scale = motion(plain), 3.0
    formula = 0.2 * sp.sin(4.0 * t) * sp.exp(-t) + 0.05 * t**2
    for time in (0.0, 0.3, 1.7):
        expected = [float(sp.diff(formula, t, k).subs(t, time)) for k in range(3)]
        assert drive.at(time) == pytest.approx(expected, abs=1e-12)
    inner = motion(with_corners(lambda time: scale * time, [0.5]))
    assert inner.at(0.7) == pytest.approx([2.1, 3.0, 0.0]) and inner.corners == (0.5,)
    assert time_function((plain, plain, plain)).at(2.0)[0] == pytest.approx(plain(2.0))


def test_profiles_of_any_numbers_drive():
    """Rates that meet but for rounding are no jumps, also where they are near zero."""
    rng = np.random.default_rng(4)
    for distance, speed, acceleration, start in rng.uniform(0.1, 20.0, (200, 4)):
        drive = motion(trapezoidal(-distance, speed, acceleration, start=start))
        assert drive.at(1e4) == pytest.approx([-distance, 0.0, 0.0])
    drive = motion(trapezoidal(0.9, 2.0, 12.0))     # 0.9 / 2 + 2 / 12 rounds to a rate of -9e-16
    assert drive.at(0.3) == pytest.approx([0.9 - 2.0 * (0.45 + 1.0 / 12.0 - 0.3), 2.0, 0.0])


@pytest.mark.parametrize("make, message", [
    (lambda: motion(lambda time: np.interp(time, [0, 1], [0, 1])), "cannot be differentiated"),
    (lambda: motion(lambda time: abs(time - 1.0)), "cannot be differentiated .*no derivative in"),
    (lambda: ramp(0.0, 0.0),
     r"duration is 0.0: give a positive number: ramp\(rate=..., duration=...\)"),
    (lambda: motion(ramp(1.0, 2.0)), r"rate jumps from 1 to 0 at t = 2, which no body can follow: "
     "use rest_to_rest, trapezoidal or a spline; only at t = 0 may a drive begin with a speed"),
    (lambda: motion(piecewise((0, 0.0), (1, 2.0))), "position jumps from 0 to 2 at t = 1"),
    (lambda: motion(ramp(1.0, start=0.5)), "rate jumps from 0 to 1 at t = 0.5"),
    (lambda: motion(with_corners(BENT, [0.5])), "rate jumps from 1 to 2 at t = 0.5, which no body"),
    (lambda: rest_to_rest(1.0, 0.0), "duration is 0.0: give a positive number"),
    (lambda: rest_to_rest("far", 1.0), "distance is 'far': give a finite number"),
    (lambda: trapezoidal(1.0, -2.0, 1.0), "speed is -2.0: give a positive number"),
    (lambda: trapezoidal(0.0, 2.0, 1.0), "distance is 0: give one that is not zero"),
    (lambda: ramp(math.nan), "rate is nan: give a finite number"),
    (lambda: harmonic(1.0, math.inf), "omega is inf: give a finite number"),
    (lambda: spline([(0.0, 1.0)]), r"table is .*: give at least two rows \(t, value\) or"),
    (lambda: spline([(0.0, 1.0), (0.0, 2.0)]), "times of a table must increase"),
    (lambda: spline(3.0), "table is 3.0: give at least two rows"),
    (lambda: piecewise(), "parts of a piecewise function are missing: give pairs"),
    (lambda: piecewise((0, 1, 2)), r"is \(0, 1, 2\): give a pair \(time, profile\)"),
    (lambda: piecewise((1, 0.0), (0, 1.0)), r"times of parts .* must increase: they are \[1.0, 0"),
    (lambda: piecewise((0, "up")), "part of a piecewise function is 'up': give a ready profile or"),
    (lambda: piecewise((0, with_corners(plain, []))), "is a compiled function: give a ready"),
])
def test_what_is_refused(make, message):
    with pytest.raises(InputError, match=message):
        make()


@pytest.mark.parametrize("planar", [False, True])
@pytest.mark.parametrize("profile", [
    pytest.param(harmonic(0.4, 3.0, phase=0.5, mean=2.0), id="harmonic"),
    pytest.param(ramp(1.2, origin=5.0), id="ramp")])
def test_drives_start_away_from_zero_and_from_speed(profile, planar):
    """By an equation and without unknown: the start has the rates, the motion begins at the model.

    The body driven by an equation is solved for at the start, with the acceleration of the drive.
    """
    d, axis = (2, 1.0) if planar else (3, np.array([2.0, -1.0, 2.0]) / 3.0)
    model = Model(planar=planar)
    for name, x in (("driven", 1.0), ("moved", 3.0)):
        place = np.array([x, 0.5, -0.2])[:d]
        model.rigid_body(name, model.node(name, place), 2.0, 0.3 if planar else (0.3, 0.3, 0.3))
    model.revolute("driven", axis)
    model.drive_angle("driven", profile, axis, name="motor")
    model.fix("moved", "rotation")
    model.move("moved", np.array([0.6, 0.8, 0.0])[:d], profile)
    run = Simulation(model, 5e-3)
    start, rate, second = profile.at(0.0)
    assert rate != 0.0 and "driven.rotation" in run.start.changed
    result = run.run_to(0.4).result()
    spin = np.atleast_2d(axis if not planar else 1.0)
    for name, value in (("angular_velocity", rate), ("angular_acceleration", second)):
        found = result[f"driven.{name}"][0]
        assert found == pytest.approx((value * spin[0] if not planar else value), abs=1e-9)
    for k, name in enumerate(("position", "velocity", "acceleration")):
        along = result[f"moved.{name}"] @ np.array([0.6, 0.8, 0.0])[:d]
        expected = np.array([profile.at(time)[k] for time in result.t])
        if not k:
            expected = expected - start + 3.0 * 0.6 + 0.5 * 0.8
        assert along == pytest.approx(expected, abs=1e-9)
    angle = np.array([profile.at(time)[0] for time in result.t]) - start
    turned = (result["driven.rotation"] if planar else
              np.arccos((np.trace(result["driven.rotation"], axis1=1, axis2=2) - 1.0) / 2.0))
    # the arc cosine of nearly one loses half the digits
    assert np.abs(np.abs(turned) - np.abs(angle)).max() < 1e-6
    # at the start the torque is the inertia times the acceleration of the drive
    assert result["motor.torque"][0] == pytest.approx(0.3 * second, abs=1e-9)


def test_loads_follow_profiles():
    """A mass pushed by a quintic: its momentum is the integral, half of the duration's amount."""
    model = Model(planar=True)
    model.point_mass("ball", model.node("ball", (0.0, 0.0), keeps="translation"), 2.0)
    model.force("ball", (1.0, 0.0), rest_to_rest(6.0, 0.5))
    result = simulate(model, 1e-2, 0.7)
    # 0.5 * 6 * 0.5 by symmetry, then 6 * 0.2; the trapezoidal rule is exact to its order
    assert 2.0 * result["ball.velocity"][-1, 0] == pytest.approx(1.5 + 1.2, rel=1e-3)


@pytest.mark.parametrize("duration", np.linspace(0.1, 7.0, 30))
def test_rest_is_rest_but_for_rounding(duration):
    """The last rates of the polynomial cancel; what is left is no jump."""
    assert not motion(rest_to_rest(2 * math.pi, float(duration))).corners


@pytest.mark.parametrize("origin, size", [(0.0, 1.0), (-7.0, -1e-3)])
def test_a_spline_that_leaves_the_range_of_its_rows(origin, size):
    """A step up: the cubic overshoots, by what SciPy's spline does on a fine grid."""
    times = np.array([0.0, 1.0, 2.0, 3.0, 4.0])
    values = np.array([0.0, 0.0, 1.0, 1.0, 1.0])
    exact = CubicSpline(times, values, bc_type="clamped")(np.linspace(0.0, 4.0, 40001)).max() - 1.0
    rows = np.stack([times, origin + size * values], axis=1)
    for build in (spline, motion):
        with pytest.warns(LimitWarning, match="leaves their range by") as caught:
            build(rows)
        share, = re.findall("by ([0-9.]+) %", str(caught[0].message))
        assert float(share) == pytest.approx(100.0 * exact, rel=0.05)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        turns = np.linspace(0.0, 2.0 * np.pi, 9)
        spline(np.stack([turns, origin + size * np.cos(turns)], axis=1))
