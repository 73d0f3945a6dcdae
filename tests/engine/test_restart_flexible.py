"""Loads on flexible bodies that jump, and runs with jumps in pieces and in ensembles.

References are matrix exponentials of the linearised motion.
"""

from functools import cache

import numpy as np
import pytest
from helpers import multipliers_first, order
from noise import noise
from scipy.linalg import expm

from sebody import Model, Simulation, Tolerance, generalized_alpha, piecewise, simulate
from sebody.analysis import Ensemble, linearize, resume, save_state
from sebody.assembly import batches, build as assembly
from sebody.fem import Section, straight_beam
from sebody.fem.loads import line_load
from sebody.reduction import craig_bampton, reduce

AXIS = np.array([2.0, -1.0, 2.0]) / 3.0
SOFT = Section(area=1e-4, inertia_y=1e-6, inertia_z=1.5e-6, torsion=2e-6, youngs_modulus=7e6,
               poisson_ratio=0.3, density=2.7e3)    # no vibration too fast for a step of 1e-3
PIECES = [(0.0, 0.0), (0.0503, 1.0), (0.12, -0.6)]


@cache
def bar():
    ends = np.array([[0.3, -0.2, 0.1], [0.8, 0.5, -0.3]])
    beam = straight_beam(*ends, SOFT, elements=6)
    wind = {"wind": line_load(beam, 1e-6 * np.array([0.5, 1.0, -2.0]))}
    return ends, craig_bampton(beam, [(0, "full"), (6, "full")], modes=2, loads=wind)


def hinged(bodies=1, load=None, distributed=False):
    """Bars in a row, a hinge about a turned axis in between and at the beginning; name of the tip.

    The load is a force at the tip, or one along the last bar.
    """
    model, (ends, body) = Model(), bar()
    way = ends[1] - ends[0]
    for k in range(bodies):
        a, b = model.node(f"a{k}", ends[0] + k * way), model.node(f"b{k}", ends[1] + k * way)
        model.superelement(f"bar {k}", body, [a, b], stiffening=False)
        model.revolute(a, AXIS, to=f"b{k - 1}" if k else None, explicit=True)
        model.torsion_spring(a, 2.0, 0.01, AXIS, f"b{k - 1}" if k else None)
    load = piecewise(*PIECES) if load is None else load
    if distributed:
        model.body_load(f"bar {bodies - 1}", "wind", load, name="push")
    else:
        model.force(b, 1e-6 * np.array([0.3, -1.0, 0.8]), load, name="push")
    return model, f"b{bodies - 1}"


def exponential(model, tip, pieces, t_end):
    """Displacement of the tip of the linearised model, forces constant in each piece."""
    run = Simulation(model, 1.0)
    M, C, K, free = linearize(run)[:4]
    first = run.numbering.dof_blocks[model.nodes[tip].position]
    push = model.element("push")
    unknowns = batches.element_unknowns(run.numbering, push)
    f = np.linalg.solve(M, free[unknowns].T @ push.constants["P" if push.body else "d"])
    n, minus = len(M), -np.linalg.solve(M, np.hstack([K, C]))
    A = np.block([[np.zeros((n, n)), np.eye(n), np.zeros((n, 1))], [minus, f[:, None]],
                  [np.zeros((1, 2 * n + 1))]])
    y = np.zeros(2 * n + 1)
    for (begin, amplitude), end in zip(pieces, [*(t for t, _ in pieces[1:]), t_end], strict=True):
        y[-1] = amplitude
        y = expm((end - begin) * A) @ y
    return free[first:first + 3] @ y[:n]


@pytest.mark.parametrize("bodies, index, distributed, exchanged", [
    (1, 3, True, False), (3, 3, False, False), (3, 2, True, False), (2, 3, False, True)])
def test_flexible_bodies_in_space(bodies, index, distributed, exchanged, monkeypatch):
    """Small matrices and large ones, and those that need row exchanges."""
    if exchanged:
        monkeypatch.setattr(assembly, "number", multipliers_first(assembly.number))
    model, tip = hinged(bodies, distributed=distributed)
    exact = exponential(model, tip, PIECES, 0.2)
    steps, errors = (5e-4, 2.5e-4, 1.25e-4), []
    for h in steps:
        run = Simulation(model, h, generalized_alpha(index=index, tolerance=1e-11))
        found = run.run_to(0.2).result()[f"{tip}.position"][-1] - model.nodes[tip].point
        errors.append(np.abs(found - exact).max() / np.abs(exact).max())
    assert bool(run.state.control.pivoted) == exchanged
    assert 1.8 < order(steps, errors) < 2.2 and errors[-1] < 2e-3


def test_motions_without_mass():
    """MacNeal's bodies have stiffness without mass: nothing is accelerated there, but it follows.

    Against Craig-Bampton's modes of the same bar: what the last mode of six leaves.
    """
    (start, end), _ = bar()
    beam, found = straight_beam(start, end, SOFT, elements=6), []
    for body in (reduce(beam, [(0, "full"), (6, "full")], 4, "macneal"),
                 craig_bampton(beam, [(0, "full"), (6, "full")], modes=12)):
        model = Model()
        ends = model.node("a", start), model.node("b", end)
        model.superelement("bar", body, ends, inertia="rigid_part", stiffening=False)
        model.fix("a")
        model.force("b", 1e-3 * np.array([0.3, -1.0, 0.8]), piecewise((0.0, 0.2), (0.0503, 1.0)))
        run = Simulation(model, 1e-3)
        found.append(run.run_to(0.2).result()["b.position"] - end)
        if len(found) == 1:
            assert run.system.massless[0] == 1
    assert np.abs(found[0] - found[1]).max() < 0.03 * np.abs(found[1]).max()


def one(load=None, gravity=(1.0, -2.0, -9.81)):
    model, tip = hinged(1, load)
    model.gravity(gravity)
    return model


@pytest.mark.parametrize("how", [{"h": 1e-3}, {"h": 5e-3, "tolerance": Tolerance(1e-5)}],
                         ids=["fixed", "variable"])
def test_stopped_at_jumps_and_continued(how, tmp_path):
    """Bit for bit, when the file is written at a jump, and step by step."""
    whole = Simulation(one(), **how).run_to(0.2).result()
    first = Simulation(one(), **how).run_to(0.12)
    save_state(first, tmp_path / "state.npz")
    rest = resume(one(), tmp_path / "state.npz").run_to(0.2).result()
    assert np.array_equal(rest.rows, whole.rows)
    stepped = Simulation(one(), **how)
    for k in range(round(0.2 / how["h"])):
        stepped.run_to((k + 1) * how["h"])
    assert np.array_equal(stepped.result().rows, whole.rows)


@pytest.mark.parametrize("level", [0.9, 1.5])
def test_ensembles_meet_jumps(level):
    """Runs that begin with a copy of all numbers, and those that are built anew.

    With a level of 1.5 the table as built is straight at 0.12, a close row, where that of the run
    bends: no run begins with a copy then.
    """
    table = [(0.0, 0.0), (0.05, 0.0), (0.05, 1.5), (0.12, level), (0.1203, 1.5), (0.1203, -0.6)]
    values = np.array([0.0, 0.1, 0.8, 1.0, 1.2, -0.5])
    model, ensemble = one(table), Ensemble(one(table), 1e-3)
    outcome = ensemble.run({"push.table": [values], "push.amplitude": [2.0]}, 0.2,
                           {"tip": "b0.position"}, threads=1)
    image, = ensemble._images.values()
    assert image.linear == (level != 1.5)
    times, gravity, index2 = [t for t, _ in table], (1.0, -2.0, -9.81), generalized_alpha(index=2)
    built = Ensemble(model, 1e-3, index2).run({"push.table": [values]}, 0.2,
                                              {"tip": "b0.position"}, threads=1)
    for found, loads, scheme in ((outcome, 2.0 * values, None), (built, values, index2)):
        def alone(loads, gravity, scheme=scheme):
            return simulate(one(np.column_stack([times, loads]), gravity), 1e-3, 0.2,
                            scheme)["b0.position"]
        bound = noise(alone, loads, gravity, most=1e-10).max()
        assert np.abs(found["tip"][0] - alone(loads, gravity)).max() < bound
