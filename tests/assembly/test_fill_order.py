"""The order of elimination: little fill however bodies are created, and the same motion."""

import numpy as np
import pytest
from benchmarks import bench_order

from sebody import Model, Simulation
from sebody.assembly.elimination_order import sequence
from sebody.assembly.fill_order import Coupling, elimination_order
from sebody.assembly.numbering import number

# bodies, and how far fill may be above that of SuperLU's minimum degree on the unknowns
FILL = {"tree": (60, 1.15), "star": (60, 1.15), "grid": (100, 1.3), "ladder": (60, 1.3)}


@pytest.mark.parametrize("name", FILL)
def test_fill_does_not_depend_on_the_order_of_creation(name):
    count, most = FILL[name]
    graph, _ = bench_order.GRAPHS[name]
    for order, created in bench_order.orders(count, random=1).items():
        own, other = bench_order.fill(graph(created))
        assert own <= most * other, order


def test_the_best_order_of_a_path_is_kept():
    """A path is eliminated from its ends; springs and joints couple as shared DOF blocks do."""
    bodies = [{k: 3} for k in range(6)]
    path = [0, 3, 1, 5, 2, 4]
    couplings = [Coupling(pair) for pair in zip(path, path[1:], strict=False)]
    order = elimination_order(bodies, couplings)
    left = list(path)
    for body in order:
        assert body in (left[0], left[-1])
        left.remove(body)
    assert sorted(order) == list(range(6))
    kept = elimination_order(bodies, [Coupling((k, k + 1)) for k in range(5)])
    assert kept == list(range(6))


def test_an_order_is_remembered_by_structure_and_size():
    """Keys of DOF blocks differ from model to model; an order may not be that of another model."""
    path = [0, 3, 1, 5, 2, 4]

    def ordered(keys, path, size=3):
        bodies = [{key: size} for key in keys]
        return elimination_order(bodies, [Coupling((keys[i], keys[k]), 1, (keys[i],))
                                          for i, k in zip(path, path[1:], strict=False)])
    found = ordered(range(6), path)
    assert ordered(range(70, 10, -10), path) == found
    found.reverse()                                 # of the caller's own list
    assert ordered(range(6), path) == found[::-1]
    assert ordered(range(6), sorted(path)) == list(range(6))


def pinned(pairs, order=None, masses=None):
    """Rigid bodies on a circle, pinned to each other halfway; -1 is the ground."""
    count = 1 + max(max(pair) for pair in pairs)
    model = Model(planar=True)
    points = np.array([[np.cos(t), np.sin(t)] for t in 2.0 * np.arange(count)])
    for k, point in enumerate(points):
        model.node(f"node {k}", point)
    for k in order or range(count):
        model.rigid_body(f"body {k}", f"node {k}", (masses or {}).get(k, 1.0), 0.1)
    for a, b in pairs:
        place = (points[a] + (points[b] if b >= 0 else 0.0)) / 2
        model.attach(f"{a} to {b}", place, to=f"node {a}")
        if b >= 0:
            model.attach(f"{b} to {a}", place, to=f"node {b}")
        model.revolute(f"{a} to {b}", to=f"{b} to {a}" if b >= 0 else None, explicit=True,
                       name=f"pin {a} {b}")
    model.gravity((0.0, -9.81))
    return model


def followed(model):
    """Of every joint the bodies whose DOF blocks its multipliers wait for."""
    names = {t: body.name for body in model.rigid_bodies.values() for t in body.dof_blocks}
    awaited = sequence(model)[1]
    return {joint.name: {names[key] for c in joint.constraints for key in awaited[c]}
            for joint in model.joints}


def test_multipliers_wait_for_both_bodies_only_where_loops_or_the_ground_hold_them():
    assert followed(pinned([(0, -1), (1, 0), (2, 1), (3, 1), (4, 0)])) == {
        "pin 0 -1": {"body 0"}, "pin 1 0": {"body 1"}, "pin 2 1": {"body 2"},
        "pin 3 1": {"body 3"}, "pin 4 0": {"body 4"}}
    assert followed(pinned([(0, 1), (1, 2), (2, 0), (3, 0)])) == {
        "pin 0 1": {"body 0", "body 1"}, "pin 1 2": {"body 1", "body 2"},
        "pin 2 0": {"body 0", "body 2"}, "pin 3 0": {"body 3"}}
    assert followed(pinned([(0, -1), (1, 0), (1, -1)]))["pin 1 0"] == {"body 0", "body 1"}


@pytest.mark.parametrize("pairs", [
    [(0, -1), *((k, 0) for k in range(1, 10))], [(0, -1), *((k, k // 2) for k in range(1, 10))],
    [(k, (k + 1) % 10) for k in range(10)]], ids=["star", "tree", "loop"])
def test_any_order_gives_the_same_motion(pairs):
    """A hub and arms of very unequal mass, a tree, a loop: no row exchanges, and one motion."""
    masses = {0: 1e4, 3: 1e-2, 9: 1e3}
    one, other = (Simulation(pinned(pairs, order, masses), 0.01).run_to(0.3)
                  for order in (range(10), (3, 9, 0, 7, 1, 8, 2, 6, 4, 5)))
    assert number(one.model).names != number(other.model).names
    for run in (one, other):
        assert not run.state.control.pivoted
    for k in range(10):
        a, b = (run.result()[f"node {k}.position"] for run in (one, other))
        # Newton's tolerance is 1e-8 of a step's increment, and there are 30 steps
        assert np.abs(a - b).max() < 1e-7 * np.abs(a - a[0]).max()
