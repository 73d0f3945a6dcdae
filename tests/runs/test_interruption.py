"""Runs that are stopped from outside: nothing is lost, and they go on as if nothing had been."""

from types import SimpleNamespace

import numpy as np
import pytest
from helpers import multipliers_first

from sebody import Interrupted, LimitWarning, Simulation, Tolerance, simulate, simulate_within
from sebody.analysis import resume, save_state
from sebody.assembly import build as assembly
from sebody.engine.state import CHUNK, DONE
from sebody.runs import simulation
from sebody.runs.aid import Aid
from sebody.scenes import chain, hinged_beam


class Stop(Exception):
    pass


@pytest.fixture
def stepwise(monkeypatch):
    """The loop comes back to Python after every step."""
    monkeypatch.setattr(simulation, "LOOK", 0.0)
    monkeypatch.setattr(simulation, "FIRST_CHUNK", 1)


def small(**options):
    return Simulation(hinged_beam.build(modes=2, elements=4).model, 0.01, **options)


@pytest.mark.parametrize("options", [{}, {"output_every": 7}, {"tolerance": Tolerance(1e-4)}],
                         ids=["fixed", "thinned", "variable"])
def test_what_progress_raises_leaves_no_gap(stepwise, options):
    whole, run, calls = small(**options).run_to(0.5).result(), small(**options), 0

    def progress(fraction):
        nonlocal calls
        calls += 1
        if calls in (5, 17):
            raise Stop
    for _ in range(2):
        with pytest.raises(Stop):
            run.run_to(0.5, progress)
        assert 0.0 < run.time < 0.4
    assert np.array_equal(run.run_to(0.5, progress).result().rows, whole.rows)


def test_ctrl_c_in_python_keeps_what_there_is(stepwise, tmp_path):
    def progress(fraction):
        if fraction > 0.3:
            raise KeyboardInterrupt
    with pytest.raises(Interrupted, match="interrupted at t = 0.16: results up to this time are "
                                          "kept"
                       ) as caught:
        simulate(hinged_beam.build(modes=2, elements=4).model, 0.01, 0.5, progress=progress)
    result = caught.value.result
    assert np.array_equal(result.rows, small().run_to(0.16).result().rows)
    assert "FAILED               interrupted at t = 0.16" in result.summary()


@pytest.mark.parametrize("asked", range(1, 8))
def test_interrupted_where_the_loop_asks_for_factors_or_a_solution(monkeypatch, tmp_path, asked):
    """The step goes on with what it asked for; the run goes on from memory and from a file."""
    monkeypatch.setattr(assembly, "number", multipliers_first(assembly.number))
    first, whole = (Simulation(chain.build(links=8).model, 0.01) for _ in range(2))
    whole.run_to(0.05)
    exchange, left = Aid._exchange, [asked]

    def interrupted(self, run, what):
        left[0] -= 1
        if left[0] == 0:
            raise KeyboardInterrupt
        exchange(self, run, what)
    monkeypatch.setattr(Aid, "_exchange", interrupted)
    with pytest.raises(Interrupted):
        first.run_to(0.05)
    second = resume(chain.build(links=8).model, save_state(first, tmp_path / "state.npz"))
    for run in (first, second):
        assert np.array_equal(run.run_to(0.05).result().rows, whole.result().rows)


def test_within_a_tolerance_the_last_whole_run_is_kept(stepwise):
    scene, seen = hinged_beam.build(modes=2, elements=4), []

    def progress(fraction):
        if seen and fraction < seen[-1] == 1.0:     # the second run
            raise KeyboardInterrupt
        seen.append(fraction)
    with pytest.raises(Interrupted, match="interrupted at t = .*the result is that of the "
                                          "previous run"
                       ) as caught:
        simulate_within(scene.model, 0.01, 0.2, Tolerance(1e-3), progress=progress)
    assert caught.value.result.t[-1] == pytest.approx(0.2)


@pytest.mark.parametrize("of_a_step", [1e-6, 1e-3, 0.5])
def test_the_loop_returns_several_times_a_second(monkeypatch, of_a_step):
    """Whatever a step takes; by a clock of our own, which only the loop moves on."""
    run, now, chunks = small(), 0.0, []

    def advance(run, record, last, chunk):
        nonlocal now
        now += chunk * of_a_step
        chunks.append(chunk)
        return DONE if now > 100.0 else CHUNK
    monkeypatch.setattr(simulation, "advance", advance)
    monkeypatch.setattr(simulation, "time", SimpleNamespace(perf_counter=lambda: now))
    run.run_to(0.5)
    steps_in_time = simulation.LOOK / of_a_step
    assert max(chunks) <= max(steps_in_time, 1.0)
    # the first chunks grow by a factor of eight, the others come close to the time allowed
    assert len(chunks) <= 100.0 / simulation.LOOK + 10


def test_an_end_off_the_grid_is_said():
    with pytest.warns(LimitWarning, match="t = 0.126 is not a multiple of the step 0.01: the run "
                                          "ends at t = 0.13"):
        result = small().run_to(0.126).result()
    assert result.t[-1] == pytest.approx(0.13, rel=1e-14)
    assert any("not a multiple of the step" in line for line in result.summary().splitlines())
