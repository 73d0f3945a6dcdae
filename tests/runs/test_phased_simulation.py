"""Runs with parts that let go and lock, in pieces: stopped, saved and resumed."""

import json

import numpy as np
import pytest

from sebody import (
    InputError,
    Interrupted,
    PhasedSimulation,
    Simulation,
    SimulationError,
    Tolerance,
    simulate,
)
from sebody.analysis import resume, save_state
from tests.runs.test_phases import FORCE, INERTIAS, clutch, displaced, holding, pendulum
from tests.runs.test_taken_over import H

VARIABLE = {"tolerance": Tolerance(1e-6)}


def latch():
    """A latch of a flexible arm opens and locks again, between the steps."""
    return holding(True, until=0.0513, from_=0.1207)


def breaking():
    """A weld breaks at t = 0.4699."""
    return pendulum(False, breaks_at=FORCE)


def same(run, other):
    """Tell whether results have the same bits."""
    return (np.array_equal(run.rows, other.rows) and run.events == other.events and
            np.array_equal(run.forces.elements, other.forces.elements) and
            np.array_equal(run.energies, other.energies))


@pytest.mark.parametrize("build, h, times, how, events", [
    (latch, H, (0.04, 0.052, 0.1, 0.2), {}, (0, 1, 1, 2)),
    (latch, H, (0.04, 0.052, 0.1, 0.2), VARIABLE, (0, 1, 1, 2)),
    (breaking, 0.01, (0.46, 0.47, 0.6), {}, (0, 1, 1)),
    (breaking, 0.01, (0.46, 0.47, 0.6), VARIABLE, (0, 1, 1)),
], ids=["times", "times, variable", "threshold", "threshold, variable"])
def test_bit_for_bit(tmp_path, build, h, times, how, events):
    """Saved and resumed before and after each event, and again and again."""
    pieces = PhasedSimulation(build(), h, **how)
    run = PhasedSimulation(build(), h, **how)
    for t, count in zip(times, events, strict=True):
        pieces.run_to(t)
        run.run_to(t)
        assert len(run.events) == count
        run = resume(build(), save_state(run, tmp_path / "state.npz"))
        assert run.time == pieces.time and run.events == pieces.events
    assert same(run.result(), pieces.result())
    if build is latch or not how:       # steps do not end where a call ends
        whole = PhasedSimulation(build(), h, **how).run_to(times[-1]).result()
        assert same(whole, pieces.result())
    if not how:
        assert same(simulate(build(), h, times[-1]), pieces.result())


def test_a_switch_at_the_end_of_a_piece():
    """The state at that time is the one after it, as in a run that does not stop."""
    run = PhasedSimulation(clutch(True, from_=0.1), 0.01).run_to(0.1)
    assert [event.what for event in run.events] == ["clutch locked"]
    assert run.read("a.angular_velocity") == pytest.approx(run.read("b.angular_velocity"))
    assert same(run.run_to(0.2).result(), simulate(clutch(True, from_=0.1), 0.01, 0.2))


def test_inputs_hold_from_phase_to_phase(tmp_path):
    """A motor that Python sets, before and after something locks."""
    def build():
        model = clutch(True, from_=0.1)
        model.actuator("motor", joint="hinge a")
        return model

    def driven(stops):
        run = PhasedSimulation(build(), 0.01)
        for k in range(20):
            if stops:
                run = resume(build(), save_state(run, tmp_path / "state.npz"))
            run.set_input("motor", 0.1 * (k // 5))
            run.run_to(0.01 * (k + 1))
        return run
    run = driven(False)
    result = run.result()
    assert run.events[0].what == "clutch locked" and len(result.t) == 21
    assert result["motor.value"][-1] == pytest.approx(0.3)
    spin = result["a.angular_velocity"]
    assert spin[-1] - spin[-2] == pytest.approx(0.3 * 0.01 / sum(INERTIAS), rel=1e-9)
    assert same(driven(True).result(), result)


def test_interrupted_runs_go_on():
    """Stopped after a step, and in the search for an instant: the bits do not change."""
    whole = PhasedSimulation(breaking(), 0.01).run_to(0.6).result()
    for when in (0.305, 0.46991):     # the second is a trial of the search, near the instant
        run = PhasedSimulation(breaking(), 0.01)
        phase = run.phases[0]
        phase.read_now = interrupting(phase, when)
        with pytest.raises(Interrupted, match="interrupted at t = 0.") as stop:
            run.run_to(0.6)
        assert stop.value.result.failure and abs(stop.value.result.t[-1] - when) < 0.011
        assert run.time < when and not run.events
        assert same(run.run_to(0.6).result(), whole) and not run.result().failure


def interrupting(phase, when):
    """`read_now` of a phase, which Ctrl-C interrupts once, at a time."""
    read, stopped = phase.read_now, []

    def read_now(name):
        if phase.time > when and not stopped:
            stopped.append(name)
            raise KeyboardInterrupt
        return read(name)
    return read_now


def test_a_joint_that_does_not_fit_stops_the_run_again():
    run = PhasedSimulation(displaced(), 0.01)
    for _ in range(2):
        with pytest.raises(SimulationError, match=r"locked at t = 0\.1, but") as stop:
            run.run_to(0.2)
        assert stop.value.result.t[-1] == pytest.approx(0.1) and not run.events


def test_a_model_without_switches_has_one_phase():
    run = PhasedSimulation(pendulum(True), 0.01).run_to(0.2)
    assert not run.events and len(run.phases) == 1
    np.testing.assert_array_equal(run.result().rows,
                                  Simulation(pendulum(True), 0.01).run_to(0.2).result().rows)


def test_it_is_described():
    run = PhasedSimulation(clutch(True, from_=0.1), 0.01).run_to(0.2)
    assert repr(run).startswith("<PhasedSimulation of a planar model:")
    assert repr(run).endswith("step 0.01, t = 0.2, events: 1>")


@pytest.fixture
def saved(tmp_path):
    """The file of a run in its second phase."""
    return save_state(PhasedSimulation(breaking(), 0.01).run_to(0.5), tmp_path / "state.npz")


def changed(path, **members):
    """The file with other members; functions change what is there, None leaves a member out."""
    with np.load(path) as file:
        arrays = dict(file)
    settings = json.loads(str(arrays["settings"]))
    for name, change in members.items():
        if name == "settings":
            change(settings)
        elif change is None:
            del arrays[name]
        else:
            arrays[name] = change(arrays[name].copy())
    arrays["settings"] = json.dumps(settings)
    np.savez(path, **arrays)
    return path


def put(place, value):
    """A change of one number."""
    def change(array):
        array[place] = value
        return array
    return change


@pytest.mark.parametrize("members, said", [
    ({"1/q_old": None}, r"it differs in 1/q_old\): run the model again"),
    ({"0/now": put(3, 0.5)}, "differs from what was saved in now"),
    ({"1/now": put(3, np.nan)}, "holds numbers in now that are not finite"),
    ({"1/rows": put((0, 0), 0.2)}, "states from t = 0.2 on, of a phase that begins at t = 0.4699"),
    ({"0/clock": put(0, 9.0)}, "holds the time 9 after 46 steps"),
    ({"settings": lambda said: said.update(reached=3)}, "has 3 for what was reached"),
    ({"settings": lambda said: said.update(reached=[])}, "differs in 1/"),
    ({"settings": lambda said: said.update(reached=[[["hinge", "broke"]]])},
     r"lets go of \['hinge', 'broke'\] at t = 0.4699.*, which this model does not"),
    ({"settings": lambda said: said.update(reached=[[["weld", "flew"]]])}, "lets go of .*'flew'"),
    ({"settings": lambda said: said.update(reached=[[]])}, "changes nothing at t = 0.4699"),
], ids=lambda given: next(iter(given)) if isinstance(given, dict) else "")
def test_damaged_files(saved, members, said):
    with pytest.raises(InputError, match=f"restart file .*state.npz.*{said}"):
        resume(breaking(), changed(saved, **members))


def test_files_of_other_models(saved, tmp_path):
    """Another limit, no limit, and a file of a run without phases."""
    for other in (pendulum(False, breaks_at=FORCE + 1.0), pendulum(False), pendulum(
            False, breaks_at=FORCE, until=0.9)):
        with pytest.raises(InputError, match="is of another model: build the one"):
            resume(other, saved)
    single = save_state(Simulation(pendulum(False), 0.01).run_to(0.1), tmp_path / "single.npz")
    with pytest.raises(InputError, match="single.npz is of another model: build the one"):
        resume(breaking(), single)
    with pytest.raises(InputError, match="give a Simulation or a PhasedSimulation"):
        save_state(breaking(), tmp_path / "none.npz")


def test_wrong_arguments():
    with pytest.raises(InputError, match="give a sebody.Model"):
        PhasedSimulation(3, 0.01)
    with pytest.raises(InputError, match="the time step is 0"):
        PhasedSimulation(breaking(), 0)
    with pytest.raises(InputError, match="output_every is 0"):
        PhasedSimulation(breaking(), 0.01, output_every=0)
    run = PhasedSimulation(breaking(), 0.01).run_to(0.5)
    with pytest.raises(InputError, match="cannot run to t"):
        run.run_to(0.3)
    assert not np.any(run.read("weld.force"))       # which broke
    with pytest.raises(InputError, match="'push' is unknown"):
        run.read("weld.push")
