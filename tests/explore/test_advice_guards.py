"""Guards of the reference, the step of trials, what a search costs and when it has paid."""

import re

import numpy as np
import pytest

from sebody import Model
from sebody.analysis import advise
from sebody.cli.entry import main
from sebody.explore.advice.guards import GROWTH, TOLD
from sebody.fem import rectangle

MOMENTS = np.array([1.0, 2.0, 3.0])


def brick(axis: int) -> Model:
    """A rigid brick, held at its centre, that spins about one of its axes, in general position."""
    rotation = np.linalg.qr(np.random.default_rng(8).standard_normal((3, 3)))[0]
    model = Model()
    centre = model.node("centre", (1.0, 2.0, 3.0))
    model.rigid_body("brick", centre, 2.0, rotation @ np.diag(MOMENTS) @ rotation.T)
    model.fix(centre, "position")
    model.initial_velocity(centre, angular=10.0 * rotation[:, axis])
    model.torque(centre, rotation[:, axis], [(0, 0), (0.5, 1.0), (1.0, 0.0)])
    return model


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_a_spin_about_the_middle_axis_is_unstable(axis):
    """It grows as exp(w t sqrt((J2 - J1) (J3 - J2) / (J1 J3))); nothing travels."""
    advice = advise(brick(axis), 0.01, 1.2, "centre.angular_velocity", 1e-2)
    assert advice.confirmed is (axis != 1)
    assert ("the motion is unstable" in advice.summary()) is (axis == 1)


def test_a_disturbance_that_grows_a_little_is_said():
    """Over a second by e^5.8; of the random disturbance a few per cent have this direction."""
    told = [advise(brick(axis), 0.01, 1.0, "centre.angular_velocity", 1e-2) for axis in (0, 1)]
    assert all(one.confirmed for one in told)
    grown = [re.search(r"a small disturbance grows to (\S+) times its size until the end: the "
                       "motion may be unstable over longer times", one.summary()) for one in told]
    assert grown[0] is None and TOLD < float(grown[1][1]) < GROWTH


def links() -> Model:
    """Two damped links in millimetres, which swing down."""
    model = Model(planar=True, units="mm t N s")
    model.gravity((900.0, -9810.0))
    base, elbow = model.node("base", (300.0, 100.0)), model.node("elbow", (1000.0, 400.0))
    model.node("begin", (1000.0, 400.0), at="elbow"), model.node("tip", (1500.0, 900.0))
    aluminium = 7e4, 0.3, 2.7e-9
    model.beam("upper", (base, elbow), rectangle(20.0, 20.0, *aluminium), 16, 1, 2, damping=0.02)
    model.beam("lower", ("begin", "tip"), rectangle(6.0, 20.0, *aluminium), 16, 1, 2, damping=0.02)
    model.fix(base, "position")
    return model


@pytest.fixture(scope="module")
def advice():
    return advise(links(), 0.005, 0.6, "tip.position", 1e-2)


def test_guards_are_runs_of_the_search(advice):
    guards = [one for one in advice.table if one.kind == "guard"]
    assert [one.change for one in guards[:2]] == [
        "the reference model off the grid of all others", "the reference model slightly disturbed"]
    assert all(one.seconds > 0.0 and 0.0 < one.error < 1e-2 for one in guards)
    runs = int(re.search(r": (\d+) runs, as much as", advice.summary())[1])
    assert runs >= len(advice.table)


def test_trials_run_with_the_longest_step_that_resolves_the_motion(advice):
    steps = {one.step: one.error for one in advice.table if one.kind == "reference"}
    alone = {one.step for one in advice.table if one.kind == "alone" and not one.local}
    assert alone == {max(h for h, error in steps.items() if h <= 0.005 or error <= 5e-3)}


def test_the_first_line_has_units_and_the_search_says_when_it_has_paid(advice):
    first = re.fullmatch(
        r"Keeps tip.position within (\S+) mm \(\S+ % of (\S+) mm\), worst at t = .*",
        advice.summary().splitlines()[0])
    error, size = map(float, first.groups())
    assert error / size == pytest.approx(advice.error, rel=0.1) and size > 100.0
    told = re.search(r"it pays after (\d+) runs instead of those of the reference model",
                     advice.summary())
    reference = next(one for one in advice.table if one.kind == "reference")
    spent = sum(one.seconds for one in advice.table)        # and what made the models
    assert int(told[1]) >= spent / (reference.seconds - advice.seconds) - 1


def test_the_step_may_be_left_to_the_search(capsys):
    assert main(["advise", "planar-hinged-beam", "--quantity", "tip.position", "--tolerance",
                 "0.05", "--t-end", "2", "--step", "auto"]) == 0
    out = capsys.readouterr().out
    assert "confirmed error" in out.splitlines()[-1]
    assert f"{2 / 128 / 4:9.3g} " in out        # a quarter of a 128th of the time
    with pytest.raises(SystemExit):
        main(["advise", "planar-hinged-beam", "--quantity", "tip.position", "--step", "soon"])
    assert "step is 'soon': give a number, or auto" in capsys.readouterr().err
