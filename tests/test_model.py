"""Bad input to the model, the loads and the start: errors name the thing and the remedy."""

import numpy as np
import pytest

from sebody import InputError, Model, Simulation, generalized_alpha, hht, simulate
from sebody.fem import Section, frame, planar_beam, straight_beam
from sebody.reduction import ReducedBody, craig_bampton
from sebody.scenes.hinged_beam import SECTION, build

END = (60.0, 0.0, 0.0)


def beam(keeps=("full", "full"), modes=0, middle=None):
    boundary = [(0, keeps[0]), (8, keeps[1])] + ([(4, middle)] if middle else [])
    return craig_bampton(straight_beam(np.zeros(3), END, SECTION, 8), boundary, modes)


def model_with_nodes(planar=False):
    model = Model(planar=planar)
    d = 2 if planar else 3
    model.node("base", np.zeros(3)[:d])
    model.node("tip", np.array(END)[:d])
    return model


def placed():
    model = model_with_nodes()
    model.superelement("beam", beam(), ["base", "tip"])
    return model


@pytest.mark.parametrize("action, message", [
    (lambda m: m.node("base", (1, 0, 0)), "node 'base' exists already: give every node its own"),
    (lambda m: m.node("x", (1, 0)), "point of node 'x' is .1, 0.: give 3 finite numbers"),
    (lambda m: m.node("x", (1, 0, np.nan)), "point of node 'x' is .*give 3 finite numbers"),
    (lambda m: m.node("x", (1, 0, 0), "half"), "keeps 'half': use full, translation or rotation"),
    (lambda m: m.node("x", (1, 0, 0), at=m.nodes["base"]), "cannot share .*both the same point"),
    (lambda m: m.fix("nobody"), "node 'nobody' is unknown: the model has base, tip"),
    (lambda m: m.fix("base", "all"), "cannot fix 'all': use position, rotation or both"),
    (lambda m: m.superelement("b", beam(), ["base"]), "2 boundary nodes and 1 were given"),
    (lambda m: m.superelement("b", beam(), ["tip", "base"]), "pass rotation=, the matrix"),
    (lambda m: m.superelement("b", beam(), ["base", "tip"], frame="mine"),
     "frame 'mine' is unknown: use one of converged_mean"),
    (lambda m: m.superelement("b", beam(), ["base", "tip"], inertia="z"),
     "inertia 'z' is unknown: use one of a, b"),
    (lambda m: m.superelement("b", beam(), ["base", "tip"], frame="positions"),
     "lie on a line, so the frame 'positions'.*use 'converged_mean'"),
    (lambda m: m.superelement("b", craig_bampton(planar_beam((0, 0), (60, 0), SECTION, 4),
                                                 [(0, "full"), (4, "full")], 0),
                              ["base", "tip"]), "is planar and the model is spatial: use one kind"),
    (lambda m: m.revolute("base", (0, 0, 0)), "axis of the revolute joint at 'base' is zero"),
    (lambda m: m.torque("base", (0, 0)), "torque on base.rotation is .*give 3 finite"),
    (lambda m: m.force("base", (0, 0, np.inf)), "force on base.position is .*finite numbers"),
    (lambda m: m.force("base", (0, 0, 1), [(0.0, 1.0), (0.0, 2.0)]),
     "times of a load history must increase: sort the rows"),
    (lambda m: m.force("base", (0, 0, 1), [1.0, 2.0]), "give rows .t, value."),
    (lambda m: m.force("base", (0, 0, 1), [(0.0, np.nan)]), "NaN or infinite entries"),
    (lambda m: m.force("base", (0, 0, 1), lambda t: open(t)), "cannot be compiled: use only"),
])
def test_model_refuses(action, message):
    with pytest.raises(InputError, match=message):
        action(model_with_nodes())


def test_no_rotation_needs_the_positions_frame():
    points = np.array([[0.0, 0, 0], [60, 0, 0], [60, 40, 0]])
    body = craig_bampton(frame(points, [(0, 1), (1, 2)], SECTION, 4),
                         [(k, "translation") for k in range(3)], 0)
    model = Model()
    nodes = [model.node(f"n{k}", p, "translation") for k, p in enumerate(points)]
    with pytest.raises(InputError, match="keeps no rotation, so its frame cannot be "
                                         "'converged_mean': use frame='positions'"):
        model.superelement("b", body, nodes)


def test_missing_kernel_says_the_command_that_makes_it():
    model = model_with_nodes()
    model.node("middle", (30.0, 0, 0), "rotation")
    with pytest.raises(InputError, match=r"python -m sebody.derive f2r1:mean:a"):
        model.superelement("b", beam(middle="rotation"), ["base", "tip", "middle"], frame="mean",
                           inertia="a")


def test_node_without_the_triplet_a_body_needs():
    model = Model()
    model.node("base", (0, 0, 0), "translation")
    model.node("tip", END)
    with pytest.raises(InputError, match="node 'base' has no rotation: make it with keeps='full'"):
        model.superelement("b", beam(), ["base", "tip"])


def test_massless_body():
    with pytest.raises(InputError, match="density is 0.0; give a positive number"):
        Section(9.0, 6.75, 6.75, 11.387, 2.1e6, 0.3, 0.0)
    heavy = beam()
    with pytest.raises(InputError, match="mass"):
        ReducedBody(heavy.stiffness, 0 * heavy.mass, heavy.coordinates, heavy.keeps)


@pytest.mark.parametrize("step", [0.0, -0.01, np.nan])
def test_step(step):
    with pytest.raises(InputError, match="the time step is .*: give a positive number"):
        Simulation(placed(), step)


@pytest.mark.parametrize("make, message", [
    (lambda: generalized_alpha(1.5), "rho is 1.5: use a spectral radius between 0 and 1"),
    (lambda: hht(0.1), "alpha is 0.1: HHT needs a value between -1/3 and 0"),
    (lambda: generalized_alpha(0.9, tolerance=0.0), "tolerance is 0.0: use a number between"),
    (lambda: generalized_alpha(0.9, tangent="none"), "tangent 'none' is unknown: use 'consist"),
])
def test_scheme(make, message):
    with pytest.raises(InputError, match=message):
        make()


def test_empty_model():
    with pytest.raises(InputError, match="no superelement: add one with model.superelement"):
        Simulation(Model(), 0.01)


def test_node_without_a_body():
    model = placed()
    model.node("far", (0, 9, 0))
    with pytest.raises(InputError, match="far.position belongs to no superelement.*attach a body"):
        Simulation(model, 0.01)


def test_redundant_joint_names_an_unknown():
    model = placed()
    model.revolute("base")
    model.revolute("base")
    with pytest.raises(InputError, match="singular at multiplier .* of revolute_ground at base.*"
                                         "remove the redundant joint"):
        Simulation(model, 0.01)


def test_velocity_against_the_hinge():
    model = placed()
    model.revolute("base")
    model.initial_velocity("base", angular=(1.0, 0.0, 0.0))
    with pytest.raises(InputError, match="initial velocity violates multiplier"):
        Simulation(model, 0.01)


def test_half_turn_between_nodes_is_refused():
    """A twist of 3.1 rad between the ends: the logarithm is stopped before it breaks."""
    from sebody import loop
    run = Simulation(placed(), 0.01)
    run.state.R[:9] = [1, 0, 0, 0, -1, 0, 0, 0, -1]
    run.state.frames[:] = np.eye(3).ravel()
    run.state.R[9:18] = [1, 0, 0, 0, np.cos(0.05), -np.sin(0.05), 0, np.sin(0.05), np.cos(0.05)]
    assert loop.run_kernels(0, 0, 1, run.system, run.state) == loop.HALF_TURN


def constant_then_off(t):
    return 1.2e4 * t / 2.5


def test_compiled_history_gives_the_run_of_the_table():
    table, function = build(), build()
    function.model.loads.clear()
    function.model.torque("base", (0, 0, 1), constant_then_off)
    tips = [simulate(s.model, 0.01, 0.5)["tip.position"] for s in (table, function)]
    assert np.abs(tips[0] - tips[1]).max() < 1e-10


def test_initial_acceleration_is_consistent():
    """A torque at t = 0 on a body with no internal modes: M a = F on the free coordinates."""
    model = placed()
    model.revolute("base")
    model.torque("base", (0, 0, 1), [(0.0, 50.0)])
    run = Simulation(model, 0.01)
    body = model.bodies["beam"].body
    keep = [3, 4, 5, 8, 11]             # tip position, base and tip rotation about z
    force = np.zeros(5)
    force[3] = 50.0
    expected = np.linalg.solve(body.mass[np.ix_(keep, keep)], force)
    result = run.result()
    assert result["tip.acceleration"][0] == pytest.approx(expected[:3], rel=1e-9, abs=1e-9)


def test_multiplier_resists_what_the_hinge_blocks():
    """A torque across the hinge is carried by the multipliers from the start."""
    model = placed()
    model.revolute("base")
    model.torque("base", (70.0, 0, 0), [(0.0, 1.0)])
    run = Simulation(model, 0.01)
    multipliers = run.state.q[run.system.is_multiplier > 0]
    assert np.linalg.norm(multipliers) == pytest.approx(70.0, rel=1e-6)
    assert np.abs(run.state.a).max() < 1e-6
