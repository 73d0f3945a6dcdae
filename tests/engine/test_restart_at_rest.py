"""The start of stiff bodies at rest, whose forces are rounding and nothing else."""

import sys
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sebody import InputError, Model, Simulation, Tolerance, simulate
from sebody.fem import circle, frame
from sebody.reduction import craig_bampton
from sebody.verify.outside import bricard

sys.path.insert(0, str(Path(__file__).parents[1]))
from many_interfaces import patched_block


@pytest.mark.parametrize("h", [1e-2, 1e-5])
def test_a_stiff_block_rests(h):
    """On five patches, in its default frame, turned; whatever the step, nothing moves."""
    body = patched_block(40, 0.3, 2)
    model = Model()
    nodes = [model.node(f"n{k}", point) for k, point in enumerate(body.coordinates)]
    model.superelement("block", body, nodes)
    result = simulate(model, h, 5 * h)
    for k in range(len(nodes)):
        place = result[f"n{k}.position"]
        assert np.abs(place - place[0]).max() < 1e-11


@pytest.mark.parametrize("kind", ["T", "square"])
def test_bodies_at_rest_begin_with_any_step(kind):
    """In random places, beside steps from 1e-6 to 30 of their first period (47 ms).

    The frame is found to rounding, whose forces, over the mass, exceed 1/h^2 of that of positions.
    """
    points, members, kept = {
        "T": ([(0, 0, 0), (1, 0, 0), (-.8, .05, 0), (0, .9, .1)], [(0, 1), (0, 2), (0, 3)],
              (1, 2, 3)),
        "square": ([(0, 0, 0), (1, 0, 0), (1.1, .9, 0), (0, 1, .1)],
                   [(0, 1), (1, 2), (2, 3), (3, 0)], (0, 1, 2, 3))}[kind]
    points = np.array(points, dtype=float)
    fe = frame(points, members, circle(0.01, 2.1e11, 0.3, 7800.0), 5, up=(0.3, 0.2, 1.0))
    body = craig_bampton(fe, [(k, "full") for k in kept], 8)
    for seed in range(5):
        turn = Rotation.random(random_state=seed).as_matrix()
        places = points @ turn.T + np.random.default_rng(seed).uniform(-3, 3, 3)
        model = Model()
        nodes = [model.node(f"n{k}", places[k]) for k in kept]
        model.superelement("body", body, nodes, rotation=turn)
        for h in (5e-8, 5e-4, 0.05, 1.5):
            run = Simulation(model, h)
            assert np.abs(run.state.a).max() < 1e-4     # of 1e8 / s^2 times rounding of places


def test_a_torque_on_what_has_no_inertia_is_still_refused():
    """About the axis of a thin rod: that is no rounding."""
    model = Model()
    node = model.node("a", (0.0, 0.0, 0.0))
    model.rigid_body("rod", node, 1.0, np.diag([0.0, 1.0, 1.0]))
    model.revolute(node, (1.0, 0.0, 0.0))
    model.torque(node, (1.0, 0.0, 0.0))
    with pytest.raises(InputError, match=r"a.rotation\[0\] moves no mass, and nothing stiff holds"):
        Simulation(model, 0.01, tolerance=Tolerance(1e-4))


@pytest.mark.parametrize("turned", [False, True])
def test_rods_without_inertia_about_their_axes_begin_with_variable_steps(turned):
    """In the axes it is published in, too, where an entry of the masses is exactly zero."""
    turn = Rotation.random(random_state=2).as_matrix() if turned else np.eye(3)
    result = simulate(bricard.build(turn), 0.01, 0.5, tolerance=Tolerance(1e-6))
    exact = bricard.path(result.t[-1:])[0]
    assert np.abs(result["p2.position"][-1] @ turn - exact).max() < 1e-4
