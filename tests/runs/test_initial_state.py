"""The start of a run: what is refused, and accelerations and multipliers at t = 0."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sebody import (
    InputError,
    Model,
    Simulation,
    generalized_alpha,
    harmonic,
    hht,
    ramp,
    simulate,
)
from sebody.contract.layout import HALF_TURN, RESIDUAL
from sebody.engine import evaluate
from sebody.fem import straight_beam
from sebody.reduction import craig_bampton
from sebody.scenes.hinged_beam import SECTION

LENGTH = 60.0
TORQUE = 50.0
# about z through an end: consistent for a beam with rotary inertia
INERTIA = SECTION.density * (SECTION.area * LENGTH**3 / 3 + SECTION.inertia_z * LENGTH)


def placed(stiffer=1.0):
    section = replace(SECTION, youngs_modulus=stiffer * SECTION.youngs_modulus)
    end = (LENGTH, 0.0, 0.0)
    body = craig_bampton(straight_beam(np.zeros(3), end, section, 8), [(0, "full"), (8, "full")], 0)
    model = Model()
    nodes = [model.node("base", np.zeros(3)), model.node("tip", end)]
    model.superelement("beam", body, nodes)
    return model


def hinged(torque=(0, 0, TORQUE), stiffer=1.0):
    model = placed(stiffer)
    model.revolute("base")
    model.torque("base", torque, [(0.0, 1.0)])
    return model


def accelerations(run):
    """In the order of the reduced body: positions, then rotations; zero where fixed."""
    nodes, at = run.model.nodes.values(), run.numbering.dof_blocks
    dof_blocks = [n.position for n in nodes] + [n.rotation for n in nodes]
    return np.concatenate([run.state.a[at[t]:at[t] + 3] for t in dof_blocks])


@pytest.mark.parametrize("h", [0.0, -0.01, np.nan, np.inf])
def test_step(h):
    with pytest.raises(InputError, match="the time step is .*: give a positive number"):
        Simulation(placed(), h)


def test_output_interval():
    with pytest.raises(InputError, match="output_every is 0: give a whole number of steps >= 1"):
        Simulation(placed(), 0.01, output_every=0)


@pytest.mark.parametrize("t_end", [np.nan, np.inf, -1.0])
def test_end_of_the_run(t_end):
    with pytest.raises(InputError, match="cannot run to t = .* from t = 0.0: give a later time"):
        Simulation(placed(), 0.01).run_to(t_end)


@pytest.mark.parametrize("make, message", [
    (lambda: generalized_alpha(1.5), "rho is 1.5: use a spectral radius between 0 and 1"),
    (lambda: generalized_alpha(-0.1), "rho is -0.1: use a spectral radius between 0 and 1"),
    (lambda: generalized_alpha(np.nan), "rho is nan: use a spectral radius"),
    (lambda: hht(0.1), "alpha is 0.1: HHT needs a value between -1/3 and 0"),
    (lambda: hht(-0.34), "alpha is -0.34: HHT needs a value between"),
    (lambda: generalized_alpha(0.9, tolerance=0.0), "tolerance is 0.0: use a number between 0 and "
                                                    "1, such as 1e-8"),
    (lambda: hht(tolerance=1.0), "tolerance is 1.0: use a number between"),
    (lambda: hht(tolerance=np.nan), "tolerance is nan: use a number between"),
    (lambda: generalized_alpha(0.9, tangent="none"), "tangent 'none' is unknown: use 'consistent' "
                                                     "or 'paper'"),
])
def test_scheme(make, message):
    with pytest.raises(InputError, match=message):
        make()


def test_ends_of_the_ranges_are_allowed():
    assert generalized_alpha(0.0).alpha_f == 0.0 and generalized_alpha(1.0).alpha_f == 0.5
    assert hht(0.0).gamma == 0.5 and hht(-1 / 3).alpha_f == pytest.approx(1 / 3)


def test_empty_model():
    with pytest.raises(InputError, match="no body: add one with model.superelement"):
        Simulation(Model(), 0.01)


def test_forces_beyond_the_largest_number():
    model = hinged()
    model.gravity((0, -1e308, 0))
    with pytest.raises(InputError, match="^the force on '.*' is too large for a number in the "
                                         "initial state: check loads, gravity"):
        Simulation(model, 0.01)


def test_node_without_a_body():
    model = placed()
    model.node("far", (0, 9, 0))
    with pytest.raises(InputError, match="^node 'far' is not connected to anything: "
                                         "attach a body or fix it"):
        Simulation(model, 0.01)


def test_load_on_a_fixed_node_without_a_body():
    model = placed()
    model.node("far", (0, 9, 0))
    model.fix("far")
    model.force("far", (0, 0, 1))
    with pytest.raises(InputError, match="force on far.position: the load acts on a node "
                                         "without a body: attach one"):
        Simulation(model, 0.01)


def hinge_twice(model):
    model.revolute("base")
    model.revolute("base")


def ball_twice(model):
    model.spherical("base")
    model.spherical("base")


@pytest.mark.parametrize("joints, name", [(hinge_twice, "revolute"), (ball_twice, "spherical")])
def test_redundant_joints_share_their_force(joints, name):
    """Multipliers of least norm: each of two equal joints bears half; the run says so."""
    model, single = placed(), placed()
    joints(model)
    getattr(single, name)("base")
    for m in (model, single):
        m.force("tip", (3.0, 4.0, 5.0))
    exact = generalized_alpha(tolerance=1e-12)
    run = Simulation(model, 0.01, exact)
    assert run.start.redundant == (f"{name} at base (2)",)
    twice, once = run.run_to(0.5).result(), simulate(single, 0.01, 0.5, exact)
    assert np.abs(twice["tip.position"] - once["tip.position"]).max() < 1e-8
    assert (f"redundant            constraints of {name} at base (2); multipliers of {name} at "
            f"base, {name} at base (2) are not unique, given are those of least norm") in (
        twice.summary())
    one = once[f"{name} at base.multipliers"]
    for half in (twice[f"{name} at base{which}.multipliers"] for which in ("", " (2)")):
        assert np.abs(half - one / 2).max() < 1e-6 * np.abs(one).max()


def test_hinge_at_a_fixed_node():
    """The hinge has nothing to bear: its constraints act on nothing that can move."""
    hinged_too, fixed = placed(), placed()
    for model in (hinged_too, fixed):
        model.fix("base")
        model.force("tip", (3.0, 4.0, 5.0))
    hinged_too.revolute("base")
    run = Simulation(hinged_too, 0.01)
    assert run.start.redundant == ("revolute at base",)
    result = run.run_to(0.5).result()
    assert not result["revolute at base.multipliers"].any()
    exact = simulate(fixed, 0.01, 0.5)["tip.position"]
    assert np.abs(result["tip.position"] - exact).max() < 1e-8 * LENGTH     # Newton's tolerance


def test_hinge_to_itself():
    with pytest.raises(InputError, match="revolute joint: node 'base' is joined to itself"):
        placed().revolute("base", to="base")


@pytest.mark.parametrize("joints", [0, 1])
def test_nothing_left_to_move(joints):
    model = placed()
    for _ in range(joints):
        model.revolute("base")
    model.fix("base")
    model.fix("tip")
    with pytest.raises(InputError, match="every node of the model is fixed: nothing is left to "
                                         "move, free one"):
        Simulation(model, 0.01)


def test_velocity_against_the_hinge():
    model = placed()
    model.revolute("base")
    model.initial_velocity("base", angular=(1.0, 0.0, 0.0))
    with pytest.raises(InputError, match=r"the given initial velocity of base.rotation, "
                                         r"\(1, 0, 0\), contradicts joints, drives or other "
                                         r"initial "
                                         r"velocities, which demand \(0, 0, 0\): leave some of "):
        Simulation(model, 0.01)


def test_velocities_that_are_not_given_are_solved_for():
    """Turning about the hinge is given, turning across it is not: that goes."""
    model = placed()
    model.revolute("base")
    model.rigid_velocity((0, 0, 0), (0.5, 0.0, 1.0))
    run = Simulation(model, 0.01)
    assert run.start.changed["base.rotation"] == pytest.approx(0.5, rel=1e-6)
    assert run.state.v[run.numbering.dof_blocks[model.nodes["base"].rotation]] == (
        pytest.approx(0.0, abs=1e-12))      # one regular solution, of velocities of order one
    assert "solved for           initial velocity of base.rotation (by 0.5)" in (
        run.run_to(0.02).result().summary())


def test_velocity_along_the_hinge():
    model = placed()
    model.revolute("base")
    model.rigid_velocity((0, 0, 0), (0.0, 0.0, 1.0))
    assert Simulation(model, 0.01).result()["tip.velocity"][0] == pytest.approx([0, LENGTH, 0])


def test_position_off_the_joint():
    model = placed()
    model.spherical("base")
    model.nodes["base"].position.start = np.array([0.0, 1e-3, 0.0])
    with pytest.raises(InputError, match="the initial position violates "
                                         "'spherical at base' by 0.001"):
        Simulation(model, 0.01)


def test_half_turn_between_nodes_is_refused():
    """A twist of 3.1 rad between the ends: the logarithm is stopped before it breaks."""
    run = Simulation(placed(), 0.01)
    c, s = np.cos(0.05), np.sin(0.05)
    run.state.R[:9] = [1, 0, 0, 0, -1, 0, 0, 0, -1]
    run.state.R[9:18] = [1, 0, 0, 0, c, -s, 0, s, c]
    run.state.frames[:] = np.eye(3).ravel()
    assert evaluate.run_kernels(RESIDUAL, 0, 1, run.system, run.state) == HALF_TURN


def test_initial_acceleration_from_the_mass_matrix():
    """A torque at t = 0 on a beam without internal modes: M a = F on the free coordinates."""
    run = Simulation(hinged(), 0.01)
    keep = [3, 4, 5, 8, 11]             # tip position, base and tip rotation about z
    force = np.array([0.0, 0.0, 0.0, TORQUE, 0.0])
    mass = run.model.bodies["beam"].reduced.mass
    expected = np.linalg.solve(mass[np.ix_(keep, keep)], force)
    assert accelerations(run)[keep] == pytest.approx(expected, rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("spin", [0.0, 0.8])
def test_initial_acceleration_of_the_rigid_motion(spin):
    """Moment of the accelerations about the hinge: torque over the inertia of a rigid beam.

    A steady spin adds forces, but no moment about the hinge.
    """
    model = hinged()
    model.rigid_velocity((0, 0, 0), (0, 0, spin))
    body = model.bodies["beam"].reduced
    turning = body.rigid_modes[:, 5]
    run = Simulation(model, 0.01)
    # rigid motion through a condensation of condition 4e2, times EPS
    assert turning @ body.mass @ turning == pytest.approx(INERTIA, rel=1e-12)
    moment = turning @ body.mass @ accelerations(run)
    assert moment / INERTIA == pytest.approx(TORQUE / INERTIA, rel=1e-9)


def test_stiff_beam_turns_as_a_rigid_one():
    """Torque on from t = 0: angular velocity M t / J, vibrations damped out within some steps."""
    result = simulate(hinged(stiffer=1e4), 0.01, 1.0, generalized_alpha(0.0))
    later = result.t >= 0.5
    rate = result["base.angular_velocity"][later, 2]
    assert rate == pytest.approx(TORQUE / INERTIA * result.t[later], rel=1e-6)


def test_multiplier_resists_what_the_hinge_blocks():
    """A torque across the hinge is carried by the multipliers from the start."""
    run = Simulation(hinged((70.0, 0, 0)), 0.01)
    multipliers = run.state.q[np.flatnonzero(run.system.is_multiplier)]
    assert np.linalg.norm(multipliers) == pytest.approx(70.0, rel=1e-6)
    assert np.abs(run.state.a).max() < 1e-6


def test_start_does_not_depend_on_the_step():
    fine, coarse = (Simulation(hinged(), h) for h in (1e-4, 1e-1))
    assert np.array_equal(fine.state.a, coarse.state.a)
    assert np.array_equal(fine.state.q, coarse.state.q)


@pytest.mark.parametrize("planar", [False, True])
@pytest.mark.parametrize("how", ["moved", "driven", "moved along", "on a link"])
def test_flexible_bodies_follow_drives_that_start_from_speed(how, planar):
    """Two beams behind a turned joint: every node starts in the rigid motion of the drive."""
    d, speed = 2 if planar else 3, 0.7
    axis = np.array([0.0, 0, 1]) if planar else np.array([2.0, -1.0, 2.0]) / 3.0
    model = Model(planar=planar)
    points = np.array([[0.3, 0.1, 0.2], [40.3, 30.1, 0.2], [40.3, 80.1, 0.2]])[:, :d]
    nodes = [model.node(name, p) for name, p in zip("abc", points, strict=True)]
    for name, pair in (("first", nodes[:2]), ("second", nodes[1:])):
        model.beam(name, pair, SECTION, 4, bodies=1, modes=2)
    base = "a"
    if how == "on a link":
        base = model.node("hub", points[0] - 1.0)
        model.rigid_body("hub", base, 1.0, 0.1 if planar else (0.1, 0.2, 0.2))
        model.attach("seat", points[0], base)
        model.weld("seat", to="a")
    if how == "driven":
        model.revolute(base, axis)
        model.drive_angle(base, ramp(speed, origin=3.0), axis)
    elif how == "moved along":
        model.fix(base, "rotation")
        model.move(base, (speed * np.array([0.6, 0.8, 0.0]))[:d], ramp(1.0))
    else:
        model.fix(base, "position")
        model.move(base, 1.0 if planar else axis, ramp(speed), "rotation")
    run = Simulation(model, 1e-3)
    pivot = model.nodes[base if isinstance(base, str) else base.name].point
    result = run.result()
    for node in "bc":
        arm = np.zeros(3)
        arm[:d] = model.nodes[node].point - pivot
        expected = (speed * np.array([0.6, 0.8, 0.0]) if how == "moved along" else
                    speed * np.cross(axis, arm))[:d]
        assert result[f"{node}.velocity"][0] == pytest.approx(expected, abs=1e-6)
        spin = 0.0 * axis if how == "moved along" else speed * axis
        assert result[f"{node}.angular_velocity"][0] == pytest.approx(
            spin[2] if planar else spin, abs=1e-6)
        assert f"{node}.position" in run.start.changed


def hung_on_two_balls(distance, turn):
    """A rod that its weight would turn across the line between them."""
    model = Model()
    model.gravity(turn @ (0.0, -9.81, 0.0))
    model.rigid_body("rod", model.node("a", (1.0, -2.0, 0.5)), 2.0, np.diag([0.1, 0.2, 0.3]),
                     centre=(1.0, -2.0, 0.5) + turn @ (1.0, 0.1, 0.0))
    model.spherical("a", name="first")
    model.spherical(model.attach("c", (1.0, -2.0, 0.5) + turn @ (distance, 0.0, 0.0), "a"),
                    name="second")
    return model


@pytest.mark.parametrize("turn", [np.eye(3), Rotation.from_rotvec((0.4, -0.9, 0.3)).as_matrix()])
def test_joints_that_nearly_repeat_each_other(turn):
    """Two balls hold what a hinge does; very close ones are named, and contradict nothing."""
    result = simulate(hung_on_two_balls(3e-4, turn), 0.01, 0.2)
    # the moment of the weight about the first: m g 1 m
    assert np.linalg.norm(result["second.force"][-1]) == pytest.approx(2 * 9.81 / 3e-4, rel=1e-3)
    assert result.warnings == ()
    for distance in (1e-4, 3e-6):
        with pytest.raises(InputError, match="constraints of first, second nearly repeat each "
                                             "other: .*put them further apart"):
            simulate(hung_on_two_balls(distance, turn), 0.01, 0.2)


def driven_twice(*motions):
    model = Model()
    model.rigid_body("arm", model.node("n", (1.0, 2.0, 3.0)), 2.0, np.diag([0.1, 0.2, 0.3]),
                     centre=(1.2, 2.1, 3.0))
    model.revolute("n", (0.3, -0.2, 1.0), name="hinge")
    for name, motion in zip(("one", "other"), motions, strict=True):
        model.drive_angle("hinge", motion, name=name)
    return model


@pytest.mark.parametrize("build", [lambda a: harmonic(a, 4.0), ramp,
                                   lambda a: harmonic(a, 4.0, phase=np.pi / 2)])
def test_drives_of_different_motions(build):
    """Refused in words of drives: in the last case they begin at rest but for rounding."""
    with pytest.raises(InputError, match="(drives|constraints of) one, other contradict each "
                                         "other: .* (remove one, or give) .*the same motion"):
        Simulation(driven_twice(build(0.3), build(0.5)), 0.01)
    Simulation(driven_twice(build(0.3), build(0.3)), 0.01)


def test_what_has_no_accelerations_is_named():
    """Two balls that are 3e-7 apart between bodies that move."""
    model = Model()
    model.gravity((0.0, -9.81, 0.0))
    first = model.node("a", (0.0, 0.0, 0.0))
    model.rigid_body("b", first, 2.0, np.diag([0.1, 0.2, 0.3]), centre=(1.0, 0.1, 0.0))
    pin = model.attach("pin", (1.0, 0.0, 0.0), first)
    second = model.node("p", (1.0, 0.0, 0.0))
    model.rigid_body("c", second, 2.0, np.diag([0.1, 0.2, 0.3]), centre=(1.5, 0.1, 0.0))
    model.spherical(second, pin, name="one")
    model.spherical(model.attach("f", (1.0 + 3e-7, 0.0, 0.0), second),
                    model.attach("e", (1.0 + 3e-7, 0.0, 0.0), first), name="other")
    model.spherical(first)
    with pytest.raises(InputError, match="no accelerations: .* as the forces of one, other do not "
                                         "settle: their constraints nearly repeat"):
        simulate(model, 0.01, 1.0)
