"""Runs that start from an equilibrium or from the end of a run."""

from functools import cache

import numpy as np
import pytest

from sebody import (
    InputError,
    Model,
    Simulation,
    Tolerance,
    generalized_alpha,
    piecewise,
    ramp,
    simulate,
    simulate_within,
)
from sebody.analysis import Ensemble, equilibrium, resume, save_state
from sebody.fem import Section, straight_beam
from sebody.reduction import craig_bampton

WEAK = Section(area=1e-4, inertia_y=8e-10, inertia_z=6e-10, torsion=1.4e-9, youngs_modulus=7e9,
               poisson_ratio=0.3, density=2.7e3)
AXIS = np.array([1.0, -2.0, 0.5]) / np.sqrt(5.25)
FOOT, WAY = np.array([0.2, 0.3, -0.1]), np.array([2.0, 1.0, 0.5]) / np.sqrt(5.25)


@cache
def half(k):
    return craig_bampton(straight_beam(FOOT + k * WAY, FOOT + (k + 1) * WAY, WEAK, elements=4),
                         [(0, "full"), (4, "full")], modes=4)


def bar(load=(0.1, 0.3, -0.2)):
    """A bar of two bodies that sags by half its length; a weight and a force at its end."""
    model = Model()
    nodes = [model.node(name, FOOT + k * WAY) for k, name in enumerate(("foot", "middle", "tip"))]
    for k in range(2):
        model.superelement(f"half {k}", half(k), nodes[k:k + 2])
    model.rigid_body("weight", "tip", 0.05, (1e-4, 2e-4, 1.5e-4))
    model.fix("foot")
    model.force("tip", load, name="push")
    model.gravity((0.0, 0.0, -9.81))
    return model


@cache
def sagged():
    model = bar()
    return model, equilibrium(model)


@pytest.mark.parametrize("how", [{}, {"scheme": generalized_alpha(index=2)},
                                 {"tolerance": Tolerance(1e-6)}], ids=["3", "2", "variable"])
def test_nothing_rings(how):
    model, rest = sagged()
    place = rest["tip.position"][-1]
    assert np.linalg.norm(place - FOOT - 2 * WAY) > 1.0
    result = simulate(model, 5e-3, 0.3, start=rest, **how)
    assert np.abs(result["tip.position"] - place).max() < 1e-9
    assert np.abs(simulate(model, 5e-3, 0.3, **how)["tip.position"] - place).max() > 0.5


def test_within_a_tolerance():
    model, rest = sagged()
    result = simulate_within(model, 0.05, 0.3, Tolerance(1e-4), start=rest)
    assert result.steps < 100
    assert np.abs(result["tip.position"] - rest["tip.position"][-1]).max() < 1e-9


def test_a_load_that_sets_in_moves_it_alone():
    """Vibration about the equilibrium, from when the load jumps on."""
    model = bar()
    model.force("tip", (0.0, 0.0, 0.05), piecewise((0.0, 0.0), (0.02, 1.0)), name="kick")
    result = simulate(model, 2e-3, 0.3, start=equilibrium(model))
    before, after = result["tip.position"][:10], result["tip.position"][10:]
    assert np.abs(before - before[0]).max() < 1e-9 and np.ptp(after[:, 2]) > 1e-3
    assert result.energy_balance() < 1e-2


def test_velocities_that_the_model_gives_stay():
    """In global axes, though the node is turned; others are solved for, or rest."""
    model = bar()
    model.initial_velocity("tip", (0.1, 0.2, 0.3), (1.0, 2.0, 3.0))
    result = Simulation(model, 1e-3, start=equilibrium(model)).result()
    assert result["tip.velocity"][0] == pytest.approx([0.1, 0.2, 0.3])
    assert result["tip.angular_velocity"][0] == pytest.approx([1.0, 2.0, 3.0])
    assert np.abs(result["middle.velocity"][0]).max() == 0.0


def test_a_rigid_motion_and_rates_of_modes_stay():
    """Velocities of `rigid_velocity` for the whole model, and of one mode of several."""
    def build():
        model = bar((0.0, 0.0, 0.0))
        model.nodes["foot"].position.fixed = model.nodes["foot"].rotation.fixed = False
        model.gravity((0.0, 0.0, 0.0))
        return model

    rest, model, spin = simulate(build(), 1e-3, 2e-3), build(), np.array([1.0, 2.0, 3.0])
    model.rigid_velocity((0.1, 0.2, 0.3), spin)
    model.bodies["half 1"].mode_rates[1] = 0.04
    run = Simulation(model, 1e-3, start=rest)
    for node in ("foot", "middle", "tip"):
        expected = [0.1, 0.2, 0.3] + np.cross(spin, model.nodes[node].point)
        assert run.result()[f"{node}.velocity"][0] == pytest.approx(expected, rel=1e-12)
    first = run.numbering.modes["half 1"]
    assert run.state.v[first:first + 4] == pytest.approx([0.0, 0.04, 0.0, 0.0])


def test_steady_rotation_goes_on():
    """Drives that start with speed, from an equilibrium that rotates with them."""
    speed = 5.0
    model = Model()
    hub = model.node("hub", (0.0, 0.0, 0.0))
    way = np.cross(AXIS, (0.0, 0.0, 1.0)) + 0.3 * AXIS
    way /= np.linalg.norm(way)
    model.rigid_body("hub", hub, 1.0, (0.01, 0.01, 0.01))
    tip = model.node("tip", way)
    body = craig_bampton(straight_beam((0, 0, 0), way, WEAK, elements=4),
                         [(0, "full"), (4, "full")], modes=4)
    model.superelement("arm", body, [hub, tip])
    model.revolute(hub, AXIS, explicit=True)
    model.drive_angle(hub, ramp(speed), AXIS)
    rest = equilibrium(model, spin=speed * AXIS)
    for start, spread in ((rest, 1e-5), (None, None)):
        place = simulate(model, 1e-3, 0.5, start=start)["tip.position"]
        along = place @ AXIS
        found = np.ptp(along) + np.ptp(np.linalg.norm(place - np.outer(along, AXIS), axis=1))
        assert found < spread if spread else found > 1e-2


def test_the_end_of_a_run_is_a_start():
    """Without a load that was there before: energy as it was."""
    model = bar()
    first = simulate(model, 1e-3, 0.2)
    free = bar(load=(0.0, 0.0, 0.0))
    second = simulate(free, 1e-3, 0.2, start=first)
    assert second["tip.position"][0] == pytest.approx(first["tip.position"][-1], abs=1e-12)
    assert second["tip.velocity"][0] == pytest.approx(first["tip.velocity"][-1], abs=1e-12)
    assert second["middle.rotation"][0] == pytest.approx(first["middle.rotation"][-1], abs=1e-12)
    whole = simulate(model, 1e-3, 0.4)
    again = simulate(model, 1e-3, 0.2, start=first)
    assert np.abs(again["tip.position"] - whole["tip.position"][200:]).max() < 1e-4


def test_saved_runs_go_on_bit_for_bit(tmp_path):
    model = bar()
    model.initial_velocity("tip", (0.1, 0.2, 0.3))
    whole = Simulation(model, 1e-3, start=equilibrium(model)).run_to(0.1).result()
    half_way = Simulation(model, 1e-3, start=equilibrium(model)).run_to(0.05)
    save_state(half_way, tmp_path / "state.npz")
    assert np.array_equal(resume(model, tmp_path / "state.npz").run_to(0.1).result().rows,
                          whole.rows)


@pytest.mark.parametrize("parameter", ["push.amplitude", "half 0.stiffness"])
def test_ensembles_start_there(parameter):
    """Runs that begin with a copy, and those of other bodies, built anew."""
    model, rest = sagged()
    ensemble = Ensemble(model, 2e-3, start=rest)
    found = ensemble.run({parameter: [1.0, 1.2]}, 0.1, {"tip": "tip.position"}, threads=1)["tip"]
    place = rest["tip.position"][-1]
    assert np.abs(found[0] - place).max() < 1e-9 and np.abs(found[1] - place).max() > 1e-4
    assert np.abs(found[1, 0] - place).max() < 1e-12
    with pytest.raises(InputError, match=r"tip.position cannot be varied: all runs begin at the "
                                         r"start that was given; leave it out"):
        ensemble.run({"tip.position": [FOOT]}, 0.1, {"tip": "tip.position"})


def test_what_is_no_start():
    model, rest = sagged()
    with pytest.raises(InputError, match="start is 3: give the Result of an equilibrium or of a"):
        simulate(model, 1e-3, 0.1, start=3)
    shaken = bar()
    shaken.nodes["foot"].position.start = FOOT + 0.1
    with pytest.raises(InputError, match="start: foot.position is not where the model holds or "
                                         "moves it at t = 0: give a state at which drives"):
        simulate(shaken, 1e-3, 0.1, start=rest)
