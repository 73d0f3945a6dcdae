"""Runs in threads of one process: the loop lets others run, and nothing is shared."""

from threading import Barrier, Thread

import numpy as np
import pytest

from sebody import Simulation
from sebody.analysis.tolerance import Tolerance
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


def in_chunks(run, t_end, chunk):
    run.run_to(t_end, chunk=chunk)
    return run.result().rows


@pytest.mark.parametrize("one, other", [("hinged", "planar"), ("chain", "loops"),
                                        ("strong", "chain")])
def test_two_runs_in_two_threads_are_those_of_one_thread(one, other):
    alone = [in_chunks(*RUNS[name](), 10**6) for name in (one, other)]
    pairs, rows, together = [RUNS[name]() for name in (one, other)], [None, None], Barrier(2)

    def work(k):
        together.wait()
        rows[k] = in_chunks(*pairs[k], 5)       # comes back to Python hundreds of times
    threads = [Thread(target=work, args=(k,)) for k in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for found, expected in zip(rows, alone, strict=True):
        assert len(expected) > 100 and np.array_equal(found, expected)


def test_other_threads_run_while_the_loop_does():
    """All steps in one call of the loop; only without Python's lock is its time seen to change."""
    run, t_end = Simulation(hinged_beam.build().model, 0.0002), 10.0
    thread = Thread(target=run.run_to, args=(t_end,), kwargs={"chunk": 10**9})
    thread.start()
    seen = set()
    while thread.is_alive():
        seen.add(run.time)
    assert any(0.0 < t < t_end - run.h for t in seen)
