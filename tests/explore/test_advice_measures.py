"""What advice keeps: histories, their peaks, means and ends, slow parts; in units; from rest."""

import numpy as np
import pytest
from advised_crane import SOFT, T_END, H, crane

from sebody import InputError, Model, simulate
from sebody.analysis import advise, equilibrium
from sebody.basics.errors import SebodyError
from sebody.explore.advice.measures import Measure, absolute

t = np.linspace(0.0, 2.0, 401)
SLOW, FAST = np.sin(2 * np.pi * 3.0 * t), 0.3 * np.sin(2 * np.pi * 40.0 * t)


def test_measures_of_two_histories():
    one, other = np.stack([t, t**2], axis=1), np.stack([t, 1.1 * t**2], axis=1)
    found = {kind: Measure.of(f"tip.position{kind}").difference(one, other)[0]
             for kind in ("", " peak", " rms", " final")}
    assert found[""] == pytest.approx(0.4, rel=1e-12)
    assert found[" final"] == pytest.approx(0.4, rel=1e-12)
    assert found[" peak"] == pytest.approx(np.hypot(2, 4.4) - np.hypot(2, 4), rel=1e-12)
    assert found[" rms"] == pytest.approx(0.1 * np.sqrt(np.mean(t**4)), rel=1e-12)
    assert Measure.of("tip.position rms").size(one) == pytest.approx(np.sqrt(np.mean(t**2 + t**4)))


def test_what_is_faster_than_a_limit_is_left_out():
    measure = Measure.of("tip.position < 12 Hz peak")
    assert measure == ("tip.position", "peak", 12.0)
    found = measure.filtered(SLOW + FAST, t[1], t[1])
    inside = slice(40, -40)
    assert np.abs(found - SLOW)[inside].max() < 5e-3        # of 0.3: (12 / 40)^8 and (3 / 12)^8
    # a grid that is too coarse to have anything faster
    assert np.array_equal(measure.filtered(SLOW + FAST, t[1], 0.04), SLOW + FAST)


@pytest.mark.parametrize(("text", "units", "expected"), [
    ("1e-3", "", (1e-3, False)), ("2mm", "", (2e-3, True)), ("2 mm", "mm t N s", (2.0, True)),
    ("0.5 deg", "", (np.pi / 360, True)), ("3kN", "mm t N s", (3000.0, True)),
    ("1 MPa", "m kg N s", (1e6, True))])
def test_tolerances_with_units(text, units, expected):
    assert absolute(text, units) == pytest.approx(expected)


@pytest.mark.parametrize(("given", "message"), [
    ({"tolerance": "2 furlong"}, "the unit 'furlong' is unknown: give one of m, dm"),
    ({"tolerance": "much"}, "tolerance is 'much': give a number, such as 1e-3, or one with a unit"),
    ({"tolerance": "1..2"}, "tolerance is '1..2': give a number, such as 1e-3, or one with a unit"),
    ({"tolerance": "-1"}, "tolerance is -1.0: give a finite number > 0 and < 1"),
    ({"tolerance": "-1 mm"}, "tolerance is -0.001: give a positive number"),
    ({"tolerance": "2mm", "quantities": "frequency 1"}, "tolerances of frequencies are relative"),
    ({"quantities": "tip.position mean"}, "'position mean' is unknown: did you mean"),
    ({"quantities": "tip.position < fast Hz"}, "frequency is 'fast': give a number above 0"),
    ({"quantities": "tip.position < 0 Hz"}, "frequency is '0': give a number above 0"),
    ({"start": "rest"}, "start is 'rest': give 'equilibrium' or nothing")])
def test_what_cannot_be_measured_is_said(given, message):
    whole = {"quantities": "tip.position"} | given
    with pytest.raises(InputError, match=message):
        advise(crane(), H, T_END, **whole)


def exact() -> np.ndarray:
    """The tip of the crane as it is, with short steps."""
    return simulate(crane(), H / 8, T_END, output_every=8)["tip.position"]


@pytest.mark.parametrize("kind", ["rms", "peak", "final"])
def test_a_measure_is_kept_and_asks_for_no_more_than_the_whole_history(kind):
    advice = advise(crane(), H, T_END, f"tip.position {kind}", 1e-2)
    assert advice.confirmed
    every = max(round(H / advice.step), 1)
    one = simulate(advice.model, advice.step, T_END, output_every=every)["tip.position"]
    whole = exact()[::(len(exact()) - 1) // (len(one) - 1)]
    change, off = (np.linalg.norm(x, axis=1) for x in (whole - whole[0], one - whole))
    error = {"rms": np.sqrt(np.mean(off**2) / np.mean(change**2)),
             "final": off[-1] / change.max(),
             "peak": abs(np.linalg.norm(one - one[0], axis=1).max() / change.max() - 1)}[kind]
    assert error <= 1e-2
    assert abs(error - advice.error) <= 2e-3


def test_an_absolute_tolerance_is_kept_in_the_models_unit():
    change = np.linalg.norm(exact() - exact()[0], axis=1).max()
    advice = advise(crane(), H, T_END, "tip.position", "1mm")
    one = simulate(advice.model, advice.step, T_END)["tip.position"]
    stride = round(advice.step / H) or 1
    off = np.linalg.norm(one[::max(round(H / advice.step), 1)] - exact()[::stride], axis=1).max()
    assert off <= 1e-3
    assert advice.tolerance == pytest.approx(1e-3 / change, rel=1e-2)
    line = advice.summary().splitlines()[0]
    assert line.startswith("Keeps tip.position within 0.00")
    assert " % of " in line
    assert "worst at t = " in line
    assert "; limited by " in line


def test_no_step_need_be_given():
    advice = advise(crane(), None, T_END, "tip.position", 1e-2)
    assert advice.confirmed
    assert advice.step > T_END / 128        # longer steps are enough


def loaded() -> Model:
    """A beam that bears its weight and a mass, and is then pulled slowly."""
    model = Model(planar=True)
    model.node("root", (12.0, 9.0)), model.node("tip", (50.0, 2.0))
    model.beam("arm", ("root", "tip"), SOFT, 16, 1, modes=4)
    model.point_mass("weight", "tip", 0.02)
    model.weld("root", name="clamp", explicit=True)
    model.gravity((0.0, -9.81))
    model.force("tip", (0.02, 0.01), [(0, 0), (0.3, 1.0), (1.0, 1.0)])
    return model


def test_runs_that_start_from_equilibrium_do_not_ring():
    advice = advise(loaded(), H, T_END, "tip.position", 2e-2, start="equilibrium")
    assert advice.confirmed
    made = {"loaded": loaded}
    exec(advice.code(["model = loaded()"]), made)
    start = equilibrium(loaded())["tip.position"][-1]
    assert made["result"]["tip.position"][0] == pytest.approx(start, rel=1e-3)
    # rung by its weight, which is applied at once, the tip moves by far more
    calm, ringing = made["result"], simulate(loaded(), H, T_END)
    assert np.ptp(calm["tip.position"], axis=0).max() < 0.2 * np.ptp(
        ringing["tip.position"], axis=0).max()


def test_a_refusal_names_quantity_time_reason_and_the_tolerance_that_would_pass():
    model = loaded()
    model.force("tip", (0.0, -3.0), [(0.0, 1.0), (1.0, 1.0)])     # at once
    with pytest.raises(SebodyError) as caught:
        advise(model, H, T_END, ["tip.position", "clamp.force"], 1e-4)
    message = str(caught.value)
    assert "clamp.force is known to " in message
    assert " at t = " in message
    passing = float(message.partition("a tolerance of ")[2].partition(" would pass")[0])
    assert passing > 1e-4
    if passing < 0.5:
        assert advise(model, H, T_END, ["tip.position", "clamp.force"], passing).error <= passing
