"""Runs in threads of one process: the loop lets others run, and nothing is shared."""

from threading import Barrier, Thread

import numpy as np
import pytest

from sebody import Simulation
from sebody.runs import simulation
from sebody.runs.tolerance import Tolerance
from sebody.scenes import chain, four_bar, hinged_beam, planar_hinged_beam, spherical_beam_strong

# small and large systems, steps that are chosen, a history that is a compiled function
RUNS = {
    "hinged": lambda: (Simulation(hinged_beam.build().model, 0.002), 8.0),
    "planar": lambda: (Simulation(planar_hinged_beam.build().model, 0.002), 8.0),
    "loops": lambda: (Simulation(four_bar.build().model, 1e-3), 3.0),
    "chain": lambda: (Simulation(chain.build(links=16).model, 0.005), 1.0),
    "strong": lambda: (Simulation(spherical_beam_strong.build(modes=0).model, 0.05,
                                  tolerance=Tolerance(1e-3)), 20.0),
}


def rows_of(run, t_end):
    return run.run_to(t_end).result().rows


@pytest.mark.parametrize("one, other", [("hinged", "planar"), ("chain", "loops"),
                                        ("strong", "chain")])
def test_two_runs_in_two_threads_are_those_of_one_thread(one, other, monkeypatch):
    alone = [rows_of(*RUNS[name]()) for name in (one, other)]
    monkeypatch.setattr(simulation, "LOOK", 0.0)        # comes back to Python after every step
    pairs, rows, together = [RUNS[name]() for name in (one, other)], [None, None], Barrier(2)

    def work(k):
        together.wait()
        rows[k] = rows_of(*pairs[k])
    threads = [Thread(target=work, args=(k,)) for k in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for found, expected in zip(rows, alone, strict=True):
        assert len(expected) > 100 and np.array_equal(found, expected)


def test_other_threads_run_while_the_loop_does(monkeypatch):
    """All steps in one call of the loop; only without Python's lock is its time seen to change."""
    run, t_end = Simulation(hinged_beam.build().model, 0.0002), 10.0
    monkeypatch.setattr(simulation, "FIRST_CHUNK", 10**9)
    thread = Thread(target=run.run_to, args=(t_end,))
    thread.start()
    seen = set()
    while thread.is_alive():
        seen.add(run.time)
    assert any(0.0 < t < t_end - run.h for t in seen)
