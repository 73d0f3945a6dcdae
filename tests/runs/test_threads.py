"""Steps that threads share: the same bits for any number of threads, and no thread is left."""

import os
import signal
import threading
import warnings

import numpy as np
import pytest
from scipy.sparse import csc_matrix
from scipy.sparse.linalg import spsolve

from sebody import InputError, Interrupted, Model, Simulation, SimulationError
from sebody.analysis import resume, save_state
from sebody.assembly.allocation import allocate
from sebody.engine.mailbox import CALL
from sebody.engine.matrix import refactorize, solve, sum_matrices
from sebody.engine.state import ROTATED
from sebody.runs import simulation, threads as sharing
from sebody.scenes import chain

LINKS = 100     # with 1500 unknowns, two shares of 64 bodies


def tree(ends=6, links=12, order=1, loop=False):
    """Chains of links of two sizes that hang from one body, turned and joined in another order."""
    body, other = chain.link_body(4), chain.link_body(2)
    model = Model()
    model.gravity((1.0, -9.0, 2.0))
    base = model.node("base", (0.0, 0.0, 0.0))
    model.revolute(base, axis=(0.0, 0.0, 1.0))
    hub = model.node("hub", (1.0, 0.0, 0.0))
    model.superelement("trunk", body, [base, hub], inertia="material")
    last = dict.fromkeys(range(ends), hub)
    for k in range(links):
        for arm in list(range(ends))[::order]:
            start = model.node(f"start {arm} {k}", (k + 1.0, 0.0, 0.0), at=last[arm])
            model.revolute(last[arm], (0.0, 0.0, 1.0), to=start)
            end = model.node(f"end {arm} {k}", (k + 2.0, 0.0, 0.0))
            model.superelement(f"link {arm} {k}", (body, other)[(arm + k) % 2], [start, end],
                               inertia="material")
            last[arm] = end
    model.force(last[0], (0.0, 50.0, 20.0))
    if loop:
        model.spherical(last[0], to=last[1])
    return model


MODELS = {
    "chain": lambda: chain.build(links=LINKS, inertia="material").model,
    "tree": tree,
    "tree in another order, with a loop": lambda: tree(ends=5, links=15, order=-1, loop=True),
}


def rows(model, threads, until=0.1):
    run = Simulation(model, 0.01, threads=threads)
    assert len(run.system.shared.work) == (threads if threads > 1 else 0)
    return run.run_to(until).rows.all(), run


@pytest.mark.parametrize("name", MODELS)
def test_any_number_of_threads_gives_the_same_bits(name):
    model = MODELS[name]()
    one, run = rows(model, 1)
    assert len(run.system.part_blocks) > 2      # there are parts to share
    assert run.state.control.iterations > 20 and run.state.control.matrices > 1
    for threads in (2, 3):
        other, run = rows(model, threads)
        assert np.array_equal(one, other)
        assert threading.active_count() == 1


def test_parts_do_not_wait_for_each_other():
    """Entries of the matrix and of its factors couple a part with itself and the rest alone."""
    system = Simulation(tree(), 0.01).system
    part = np.searchsorted(system.part_blocks, np.arange(len(system.block_diagonal)), "right") - 1
    rest = len(system.part_blocks) - 1
    columns = np.repeat(part, np.diff(system.block_starts))
    own = part[system.block_rows]
    assert np.all((own == columns) | (own == rest) | (columns == rest))
    sizes = np.bincount(part)
    assert len(sizes) == 7 and sizes[:-1].max() < 0.25 * sizes.sum()
    assert sizes[-1] < 0.1 * sizes.sum()


def test_a_solution_in_parts_is_that_of_scipy():
    """The corrections that threads find, against a sparse solution of the matrix they summed."""
    run = Simulation(tree(), 0.01, threads=2).run_to(0.05)
    system, state, n = run.system, run.state, run.numbering.free
    sum_matrices(system, state, state.forces, False)
    kept = (system.rows < n) & (system.columns < n)
    entries = state.matrix[:-1][kept]
    matrix = csc_matrix((entries, (system.rows[kept], system.columns[kept])), shape=(n, n))
    state.residual[:n] = matrix @ np.sin(np.arange(n))
    assert refactorize(system, state, ROTATED, False) and state.control.pivoted == 0
    right = state.residual[:n].copy()
    solve(system, state, False)
    exact = spsolve(matrix, right)
    scale = state.weight[:n]
    # without row exchanges: pivots of the scaled matrix down to 1e-11 may cost as many digits
    error = np.abs((state.correction[:n] - exact) * scale).max()
    assert error < 1e-7 * np.abs(exact * scale).max()


class Stopped(Exception):
    pass


@pytest.mark.parametrize("raised, seen", [(Stopped, Stopped), (KeyboardInterrupt, Interrupted)])
def test_no_thread_is_left_when_a_run_stops(raised, seen):
    model = MODELS["chain"]()
    whole, _ = rows(model, 1)
    run = Simulation(model, 0.01, threads=2)

    def stop(share):
        raise raised
    with pytest.raises(seen):
        run.run_to(0.1, stop)
    assert threading.active_count() == 1 and 0.0 < run.time < 0.1
    assert np.array_equal(run.run_to(0.1).rows.all(), whole)


def test_a_signal_stops_all_threads(interruptible):
    run = Simulation(MODELS["chain"](), 0.01, threads=3)
    timer = threading.Timer(0.1, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    with pytest.raises(Interrupted, match="interrupted at t ="):
        run.run_to(1000.0)
    timer.join()
    assert threading.active_count() == 1 and run.time < 1000.0


def test_no_thread_is_left_when_a_run_fails():
    run = Simulation(MODELS["chain"](), 0.01, threads=3).run_to(0.02)
    run.state.v[:] = np.nan
    with pytest.raises(SimulationError, match="stopped at t = 0.02"):
        run.run_to(0.1)
    assert threading.active_count() == 1


@pytest.mark.skipif(not hasattr(os, "sched_setaffinity"), reason="no choice of processors")
def test_more_threads_than_processors_finish():
    one, _ = rows(MODELS["chain"](), 1)
    free = os.sched_getaffinity(0)
    os.sched_setaffinity(0, {min(free)})
    try:
        assert np.array_equal(rows(MODELS["chain"](), 4)[0], one)
    finally:
        os.sched_setaffinity(0, free)


def test_helpers_that_never_come_are_not_waited_for(monkeypatch):
    monkeypatch.setattr(sharing, "_help", lambda *arguments: None)
    assert np.array_equal(rows(MODELS["chain"](), 2)[0], rows(MODELS["chain"](), 1)[0])


@pytest.mark.parametrize("given", [0, 1])
def test_a_system_without_more_threads_has_the_loop_do_the_work(monkeypatch, given):
    begin, started = threading.Thread.start, []

    def start(thread):
        if len(started) == given:
            raise RuntimeError("can't start new thread")
        started.append(thread)
        begin(thread)
    expected = rows(MODELS["chain"](), 1)[0]
    monkeypatch.setattr(threading.Thread, "start", start)
    assert np.array_equal(rows(MODELS["chain"](), 3)[0], expected)
    assert len(started) == given and threading.active_count() == 1


def test_helpers_that_a_second_interrupt_left_take_nothing_of_a_later_call(monkeypatch):
    """A call that is interrupted before it has told its helpers that it ends."""
    whole, _ = rows(MODELS["chain"](), 1)
    run, join, left = Simulation(MODELS["chain"](), 0.01, threads=2), threading.Thread.join, []
    mail = run.system.shared.mail

    def interrupted(thread):
        left.append(thread)
        mail[CALL] -= 1                 # as if the end had not been told
        raise KeyboardInterrupt
    monkeypatch.setattr(threading.Thread, "join", interrupted)
    run.run_to(0.05)                    # the interrupt comes when all steps are done
    monkeypatch.setattr(threading.Thread, "join", join)
    assert len(left) == 1 and left[0].is_alive()
    assert np.array_equal(run.run_to(0.1).rows.all(), whole)
    left[0].join(10.0)
    assert not left[0].is_alive() and threading.active_count() == 1


def test_short_pieces_have_helpers_where_they_take_long(monkeypatch):
    """A loop in Python that sets an input after every two steps."""
    used = []

    def counted(*arguments):
        used.append(arguments)
        return sharing.helping(*arguments)
    monkeypatch.setattr(simulation, "helping", counted)
    model = MODELS["chain"]()
    model.actuator("push", node=list(model.nodes.values())[-1], direction=(0.0, 1.0, 0.0))

    def run(threads):
        one = Simulation(model, 0.01, threads=threads)
        for k in range(1, 5):
            one.set_input("push", 10.0 * k)
            one.run_to(0.02 * k)
        return one.result()["push.force"], one.state.now.copy()
    expected = run(1)
    assert not used
    assert all(map(np.array_equal, run(2), expected)) and not used      # two steps of 1500 unknowns
    monkeypatch.setattr(sharing, "WORTH_IT", 2000)
    assert all(map(np.array_equal, run(2), expected)) and len(used) == 4
    assert threading.active_count() == 1


def test_helpers_leave_other_states_alone():
    """What is evaluated in another state during a run is not theirs, nor do they forget their own.
    """
    model = MODELS["chain"]()
    (whole, alone), run = rows(model, 1), Simulation(model, 0.01, threads=2)
    other = allocate(model, run.system, run.numbering, 0.01, False)
    other.J[:] = np.sin(np.arange(other.J.size))
    expected = allocate(model, alone.system, alone.numbering, 0.01, False)
    expected.J[:] = other.J
    sum_matrices(alone.system, expected, expected.forces, False)

    def look(share):
        sum_matrices(run.system, other, other.forces, False)
        assert np.array_equal(other.matrix, expected.matrix)
    assert np.array_equal(run.run_to(0.1, look).rows.all(), whole)


def test_a_run_continues_with_other_threads(tmp_path):
    model = MODELS["chain"]()
    whole, _ = rows(model, 1)
    run = Simulation(model, 0.01, threads=3).run_to(0.05)
    path = save_state(run, tmp_path / "state.npz")
    for threads in (1, 2):
        assert np.array_equal(resume(model, path, threads).run_to(0.1).rows.all(), whole)


@pytest.mark.parametrize("threads", [0, 1.5, 1000, "two"])
def test_a_wrong_number_of_threads_is_refused(threads):
    with pytest.raises(InputError, match=r"threads.*cores"):
        Simulation(chain.build(links=1).model, 0.01, threads=threads)


def test_a_small_model_says_that_it_has_one_thread():
    with pytest.warns(match="threads = 2 is not used: .* 1000 unknowns or more, this one has 15"):
        run = Simulation(chain.build(links=1).model, 0.01, threads=2)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        assert run.run_to(0.02).result().steps == 2
