"""Loads that jump: steps end there with the left limit, then accelerations are solved for anew."""

from functools import cache

import numpy as np
import pytest
from helpers import multipliers_first, order
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from sebody import (
    LimitWarning,
    Model,
    Simulation,
    Tolerance,
    generalized_alpha,
    piecewise,
    simulate,
    trapezoidal,
    with_corners,
)
from sebody.analysis import Ensemble, linearize, resume, save_state
from sebody.assembly import batches
from sebody.assembly import build as assembly
from sebody.compiler.sources import TEXT, room_hash
from sebody.fem import Section, straight_beam
from sebody.fem.loads import line_load
from sebody.kernels import loader
from sebody.model.parts import Element, positions
from sebody.reduction import craig_bampton, reduce

J = 0.1                                     # of a rotor
AXIS = np.array([2.0, -1.0, 2.0]) / 3.0
FINE = {index: generalized_alpha(index=index, tolerance=1e-11) for index in (2, 3)}
SOFT = Section(area=1e-4, inertia_y=1e-6, inertia_z=1.5e-6, torsion=2e-6, youngs_modulus=7e6,
               poisson_ratio=0.3, density=2.7e3)    # no vibration too fast for a step of 1e-3


def stepped(t):
    return 1.0 if t >= 0.5 else 0.0


def pushing(t, x, v, force):
    if t >= 0.5:
        force[0] = 20.0


LOADS = {"profile": piecewise((0.0, 0.0), (0.5, 1.0)),
         "table": [(0.0, 0.0), (0.5, 0.0), (0.5, 1.0), (2.0, 1.0)],
         "first rows": [(0.5, 0.0), (0.5, 1.0)],
         "function": with_corners(stepped, [0.5])}


def rotor(load, planar=True):
    """A rotor with a torque, and what the angle of its node is, from result to array."""
    model = Model(planar=planar)
    hub = model.node("hub", (0.3, -0.2) if planar else (0.3, -0.2, 0.1))
    model.rigid_body("rotor", hub, 2.0, J if planar else (J, J, J))
    model.revolute(hub, (0, 0, 1) if planar else AXIS, explicit=not planar)
    model.torque(hub, 1.0 if planar else AXIS, load, name="motor")
    return model


def angle(result):
    if result.model.planar:
        return result["hub.rotation"]
    R = result["hub.rotation"]
    sines = np.array([R[:, 2, 1] - R[:, 1, 2], R[:, 0, 2] - R[:, 2, 0], R[:, 1, 0] - R[:, 0, 1]])
    return np.unwrap(np.arctan2(AXIS @ sines / 2, (np.trace(R, axis1=1, axis2=2) - 1) / 2))


@pytest.mark.parametrize("how", [{"h": 0.01}, {"h": 0.03125}, {"h": 0.0147}, {
    "h": 0.25, "tolerance": Tolerance(1e-5)}], ids=["on the grid", "long", "off it", "variable"])
@pytest.mark.parametrize("planar", [True, False])
@pytest.mark.parametrize("load", LOADS)
def test_a_torque_that_sets_in(load, planar, how):
    """``angle = (t - 0.5)^2 / (2 J)``: exact, for it is constant on either side."""
    run = Simulation(rotor(LOADS[load], planar), **how)
    result = run.run_to(1.0 if how["h"] != 0.0147 else 68 * 0.0147).result()
    behind = np.maximum(result.t - 0.5, 0.0)
    assert np.abs(angle(result) - behind**2 / (2.0 * J)).max() < 1e-10
    # at the time of the jump a row shows what is behind it, as the load itself does there
    spin = result["hub.angular_acceleration"] @ (1.0 if planar else AXIS) if not planar else (
        result["hub.angular_acceleration"])
    assert np.abs(np.ravel(spin) - (result.t >= 0.5) / J).max() < 1e-7
    assert result["motor.work"][-1] == pytest.approx(angle(result)[-1], rel=1e-9)
    assert result.steps <= 100


def test_forces_of_a_user_jump_at_their_corners():
    """Of a function of time, positions and velocities the corners are given with it."""
    for corners, error in (([0.5], 1e-12), ([], 0.02)):
        model = Model()
        node = model.node("mass", (1.0, 2.0, 3.0))
        model.point_mass("mass", node, 4.0)
        model.fix(node, "rotation")
        model.user_force("push", [node], pushing, corners=corners)
        x = simulate(model, 0.01, 1.0)["mass.position"][-1, 0] - 1.0
        assert abs(x - 0.625) < error and (corners or abs(x - 0.625) > 0.5 * error)


def test_a_jump_nobody_told_of_is_pointed_out():
    message = (r"function of motor jumps from 0 to 1 at t = 0.5, which is not declared: give it "
               r"as with_corners\(function, times\)")
    with pytest.warns(LimitWarning, match=message):
        simulate(rotor(stepped), 0.01, 1.0)


# a rigid body on a ball joint, in general position

CENTRE, ARM, MASS = np.array([0.2, 0.5, -0.3]), np.array([-0.4, 0.3, 0.6]), 3.0
INERTIA = np.array([[0.3, 0.02, -0.05], [0.02, 0.4, 0.03], [-0.05, 0.03, 0.25]])
PIVOT, TORQUE, FORCE = np.array([1.0, -2.0, 0.5]), np.array([0.6, -0.9, 0.4]), np.array([3., 2, -4])


def pulses(times):
    """Amplitudes of torque and force: both jump at the first time, one at the second."""
    return ([(0.0, 0.5), (times[0], 0.8), (times[0], -1.0), (9.0, -1.0)],
            piecewise((0.0, 0.2), (times[0], 1.0), (times[1], -0.5)))


def top(times, linked=True):
    model = Model()
    foot = model.node("foot", PIVOT)
    model.rigid_body("body", foot, MASS, INERTIA, centre=PIVOT + CENTRE)
    model.spherical(foot, name="ball")
    model.attach("end", PIVOT + ARM, foot)
    model.gravity((0.5, 0.0, -9.81))
    torque, force = pulses(times)
    model.torque(foot, TORQUE, torque)
    model.force("end", FORCE, force)
    return model


@cache
def swung(times, t_end):
    """Position of the end, by Euler's equations, piece by piece."""
    about = INERTIA + MASS * (CENTRE @ CENTRE * np.eye(3) - np.outer(CENTRE, CENTRE))

    def rate(t, y, piece):
        R, spin = y[:9].reshape(3, 3), y[9:]
        first = 0.5 + 0.3 * t / times[0] if piece == 0 else -1.0
        moment = first * TORQUE + np.cross(R @ ARM, (0.2, 1.0, -0.5)[piece] * FORCE) + np.cross(
            R @ CENTRE, MASS * np.array([0.5, 0.0, -9.81]))
        W = np.array([[0, -spin[2], spin[1]], [spin[2], 0, -spin[0]], [-spin[1], spin[0], 0]])
        return np.concatenate([(R @ W).ravel(), np.linalg.solve(
            about, R.T @ moment - np.cross(spin, about @ spin))])
    y, begin = np.concatenate([np.eye(3).ravel(), np.zeros(3)]), 0.0
    for piece, end in enumerate((*times, t_end)):
        y = solve_ivp(rate, (begin, end), y, args=(piece,), method="DOP853", rtol=1e-12,
                      atol=1e-13).y[:, -1]
        begin = end
    return PIVOT + y[:9].reshape(3, 3) @ ARM


@pytest.mark.parametrize("index", [2, 3])
@pytest.mark.parametrize("times", [(0.2, 0.4), (0.21237, 0.39901), (0.2, 0.2000003)],
                         ids=["on the grid", "off it", "at nearly one time"])
def test_order_two_in_general_position(times, index):
    """Jumps of several loads at once, on a node and on the end of a rigid link."""
    steps, exact = (0.02, 0.01, 0.005), swung(times, 0.6)
    errors = [np.abs(simulate(top(times), h, 0.6, FINE[index])["end.position"][-1] - exact).max()
              for h in steps]
    assert 1.8 < order(steps, errors) < 2.2 and errors[1] < 2e-4
    variable = simulate(top(times), 0.3, 0.6, tolerance=Tolerance(1e-6))
    assert np.abs(variable["end.position"][-1] - exact).max() < 1e-4


def test_pieces_of_a_step_however_short():
    """A jump just before or behind a grid point: forces of the joint do not show it."""
    def run(when, h, index):
        scheme = FINE[index]
        return simulate(top((when, 0.4)), h, 0.3, scheme, output_every=round(0.01 / h))
    for share in (1e-5, 1e-2, 0.5, 0.99, 1.0 - 1e-5):
        when = 0.2 + 0.01 * share
        fine = run(when, 0.01 / 16, 2)["ball.multipliers"]
        for index in (2, 3):
            apart = np.abs(run(when, 0.01, index)["ball.multipliers"] - fine).max(axis=1)
            # of the order of the step: a twentieth of what forces change by at the jump
            assert apart.max() < 0.05 * np.linalg.norm(FORCE) + (index == 3) * 0.3, (share, index)


# flexible bodies, against matrix exponentials of their linearised motion

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
        run = Simulation(model, h, FINE[index])
        found = run.run_to(0.2).result()[f"{tip}.position"][-1] - model.nodes[tip].point
        errors.append(np.abs(found - exact).max() / np.abs(exact).max())
    assert bool(run.state.control.pivoted) == exchanged
    assert 1.8 < order(steps, errors) < 2.2 and errors[-1] < 2e-3


def test_redundant_constraints():
    """A weight on two hinges of one axis: as on one of them, when a force jumps."""
    def swing(redundant):
        model = Model()
        a = model.node("a", (0.1, 0.2, 0.3))
        model.rigid_body("door", a, 3.0, (0.1, 0.2, 0.3), centre=(0.5, 0.1, 0.2))
        model.revolute(a, AXIS, explicit=True)
        if redundant:
            model.revolute(model.attach("b", a.point + 0.7 * AXIS, a), AXIS, explicit=True)
        model.torque(a, AXIS, piecewise((0.0, 1.0), (0.1037, -2.0)))
        run = Simulation(model, 5e-3, FINE[3])
        assert bool(run.start.redundant) == redundant
        return run.run_to(0.3).result()["a.rotation"]
    assert np.abs(swing(True) - swing(False)).max() < 1e-8


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


# drives

@pytest.mark.parametrize("how", [{"h": 0.01}, {"h": 0.0147}, {
    "h": 0.05, "tolerance": Tolerance(1e-6)}], ids=["on the grid", "off it", "variable"])
@pytest.mark.parametrize("moved", [False, True])
def test_drives_whose_acceleration_jumps(moved, how):
    """The torque is ``J s''``, at once behind every corner of the rate; its work ``J s'^2 / 2``."""
    profile = trapezoidal(1.0, 2.0, 10.0, start=0.1)        # corners at 0.1, 0.3, 0.6, 0.8
    model = Model()
    hub = model.node("hub", (0.3, -0.2, 0.1))
    model.rigid_body("rotor", hub, 2.0, (J, J, J))
    model.fix(hub, "position")
    if moved:
        model.move(hub, AXIS, profile, "rotation", name="motor")
        model.point_mass("dust", model.node("dust", (5.0, 0, 0), keeps="translation"), 1.0)
    else:
        model.revolute(hub, AXIS, explicit=True)
        model.drive_angle(hub, profile, AXIS, name="motor")
    result = Simulation(model, **how).run_to(69 * 0.0147 if how["h"] == 0.0147 else 1.0).result()
    exact = np.array([profile.at(t) for t in result.t])
    near = np.min(np.abs(result.t[:, None] - profile.times), axis=1) < 1e-9     # rounding decides
    assert np.abs(angle(result) - exact[:, 0]).max() < 1e-9
    assert np.abs(result["motor.torque"] - J * exact[:, 2])[~near].max() < 1e-5
    assert np.abs(result["motor.work"] - 0.5 * J * exact[:, 1]**2).max() < 1e-6


# runs in pieces

def one(load=None):
    model, tip = hinged(1, load)
    model.gravity((1.0, -2.0, -9.81))
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


def test_ensembles_meet_jumps():
    """Runs that begin with a copy of all numbers, and those that are built anew."""
    table = [(0.0, 0.0), (0.05, 0.0), (0.05, 1.0), (0.12, 1.0), (0.1203, 1.0), (0.1203, -0.6)]
    values = np.array([0.0, 0.1, 0.8, 1.0, 1.2, -0.5])
    model = one(table)
    outcome = Ensemble(model, 1e-3).run({"push.table": [values], "push.amplitude": [2.0]}, 0.2,
                                        {"tip": "b0.position"}, threads=1)
    rows = np.column_stack([[t for t, _ in table], 2.0 * values])
    alone = simulate(one(rows), 1e-3, 0.2)["b0.position"]
    assert np.abs(outcome["tip"][0] - alone).max() < 1e-12
    built = Ensemble(model, 1e-3, generalized_alpha(index=2)).run(
        {"push.table": [values]}, 0.2, {"tip": "b0.position"}, threads=1)
    rows[:, 1] = values
    alone = simulate(one(rows), 1e-3, 0.2, generalized_alpha(index=2))["b0.position"]
    assert np.abs(built["tip"][0] - alone).max() < 1e-12


def test_corners_that_do_not_jump_cost_nothing():
    """Bends of a table off the grid leave fixed steps as they are."""
    times = np.sort(np.random.default_rng(1).uniform(0.0, 1.0, 50))
    table = np.column_stack([times, np.sin(20.0 * times)])
    result = simulate(rotor(table), 0.01, 1.0)
    assert result.steps == 100 and result.state.control.matrices == 1


# forces that depend on multipliers

GRIP = '''
from math import sqrt

from sebody.kernels.abi import at
from sebody.contract.layout import AT_CONSTANTS, C_CONSTRAINT, HEADER, OK, TANGENT, Part
from sebody.compiler.decorators import kernel_function

PLANAR, N_POSITIONS, N_ROTATIONS, MULTIPLIERS, WIDTH = False, 1, 0, 0, 4
CONSTANTS = (Part("mu", (), ""), Part("N0", (), ""), Part("e", (3,), ""))
INERTIAL = POWER = DRIVEN = False
READS = 0
MEMORY = ()
WORK_ROWS, OPERATIONS = 0, {"residual": (0, 0, 0, 0), "column": (0, 0, 0, 0)}
ROOM = "HASH"


@kernel_function
def kernel(task, count, stride, width, index, constants, q, R, v, a, references, frames, T, loads,
           coefficients, forces, matrices, work, energies):
    for element in range(count):
        unknowns, g = at(index, element*stride + HEADER), at(forces, element*WIDTH)
        c = at(constants, index[element*stride + AT_CONSTANTS])
        pressure = q[unknowns[3]]
        size = sqrt(pressure*pressure + c[1]*c[1])
        g[3] = 0.0
        for i in range(3):
            g[i] = c[0]*size*c[2 + i]
        if task == TANGENT:
            J = at(matrices, element*WIDTH*WIDTH)
            for i in range(16):
                J[i] = 0.0
            for i in range(3):
                J[4*i + 3] = coefficients[C_CONSTRAINT]*c[0]*pressure/size*c[2 + i]
    return OK
'''


@pytest.mark.parametrize("how", [{"h": 0.05}, {"h": 0.0314}, {"h": 0.5, "tolerance": Tolerance(
    1e-6)}, {"h": 0.05, "scheme": FINE[2]}], ids=["fixed", "off the grid", "variable", "index 2"])
def test_forces_that_depend_on_multipliers(how, tmp_path, monkeypatch):
    """A weight slides down a slope with ``mu sqrt(N^2 + N0^2)`` against it, N by a multiplier.

    A pressure on it sets in at 0.5: accelerations are constant on either side, so all is exact.
    """
    text = GRIP.replace("HASH", room_hash(*TEXT))
    (tmp_path / "element_grip.py").write_text(text)
    monkeypatch.setenv("SEBODY_KERNELS", str(tmp_path))
    monkeypatch.setattr(loader, "load", loader.load.__wrapped__)       # not remembered
    own = batches.element_unknowns

    def with_pressure(numbering, element):
        found = own(numbering, element)
        return found + [numbering.multipliers[ground]] if element.kind == "grip" else found
    monkeypatch.setattr(batches, "element_unknowns", with_pressure)
    normal, down = np.array([1.0, 2.0, 2.0]) / 3.0, np.array([2.0, 1.0, -2.0]) / 3.0
    model, mass, mu, N0 = Model(), 2.5, 0.3, 4.0
    node = model.node("weight", (0.7, -0.4, 0.9))
    model.rigid_body("weight", node, mass, (0.1, 0.2, 0.3))
    joint = model.planar_joint(node, normal)
    ground = joint.constraints[0]
    model.gravity(9.0 * down - 5.0 * normal)
    model.force(node, -7.0 * normal, piecewise((0.0, 0.0), (0.5, 1.0)))
    model.loads.append(Element("grip", "grip", positions(node), {"mu": mu, "N0": N0, "e": down}))
    result = Simulation(model, **how).run_to(32 * 0.0314 if how["h"] == 0.0314 else 1.0).result()
    slow = [9.0 - mu * np.hypot(N, N0) / mass for N in (5.0 * mass, 5.0 * mass + 7.0)]
    t, late = result.t, np.maximum(result.t - 0.5, 0.0)
    exact = 0.5 * slow[0] * t**2 + 0.5 * (slow[1] - slow[0]) * late**2
    assert np.abs((result["weight.position"] - node.point) @ down - exact).max() < 1e-9
    pressure = np.abs(result[f"{joint.name}.multipliers"][:, 0])
    assert np.abs(pressure - np.where(t < 0.5, 5.0 * mass, 5.0 * mass + 7.0)).max() < 1e-6
