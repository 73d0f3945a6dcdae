"""Awkward bodies: half turns, nodes on a line, rotations without mass, negative weights."""

import numpy as np

from sebody.basics.errors import InputError
from sebody.contract.layout import RESIDUAL
from sebody.engine.evaluate import assemble
from sebody.fem import straight_beam
from sebody.kernels.rotations import NEAR_PI, exp_map
from sebody.model.model import Model
from sebody.reduction.body import ReducedBody
from sebody.reduction.craig_bampton import craig_bampton
from sebody.runs.simulation import Simulation
from sebody.runs.whole_runs import simulate
from sebody.scenes.hinged_beam import SECTION
from sebody.verify.atlas.finding import PROGRAM, Finding, Row

LIMIT = np.degrees(np.arccos(NEAR_PI))      # rotation whose logarithm is refused


def _beam(model: Model, length: float = 10.0, first: int = 0, last: int = 4,
          frame: str = "converged_mean") -> None:
    """A beam of four elements whose boundary nodes may lie inside."""
    fe_model = straight_beam((0, 0, 0), (length, 0, 0), SECTION, 4)
    body = craig_bampton(fe_model, [(first, "full"), (last, "full")], 0)
    ends = [model.node(name, (length * k / 4, 0, 0)) for name, k in (("a", first), ("b", last))]
    model.superelement("beam", body, ends, frame=frame)


def _rotated(model: Model, angle: float) -> tuple[Simulation, int]:
    """A run with the second node rotated [deg], and the status of the kernel."""
    run = Simulation(model, 0.01)
    k = run.numbering.rotations[model.nodes["b"].rotation]
    run.state.R[9 * k:9 * k + 9] = exp_map(0.0, 0.0, np.radians(angle))
    return run, assemble(RESIDUAL, RESIDUAL, run.system, run.state, run.state.residual)


def _refused(model: Model, angle: float) -> bool:
    return _rotated(model, angle)[1] != 0


def _turn(frame: str, angle: float) -> float:
    """Rotation of the frame [deg] where the second node is rotated; NaN if this is refused."""
    model = Model()
    _beam(model, frame=frame)
    run, status = _rotated(model, angle)
    axes = run.state.frames[:9].reshape(3, 3)
    return float(np.degrees(np.arctan2(axes[1, 0], axes[0, 0]))) if status == 0 else np.nan


def half_turn() -> Finding:
    """Relative rotations of the ends of a body up to half a turn, and what its frame does."""
    finding = Finding(
        "relative rotations near 180 degrees",
        "a mean frame follows half the rotation, up to 180 degrees",
        "The local rotation is the logarithm of a rotation, which jumps at 180 degrees; a mean "
        f"frame jumps with it. Rotations are refused earlier, from {LIMIT:.1f} degrees between "
        "the ends of a body with two nodes, for every frame.",
        "The run stops with a message that names the reason; sebody warns much earlier, at 0.3 "
        "rad.",
        "rotation of one node relative to the other [deg]", "rotation of the frame [deg]")
    angles = np.arange(10.0, 180.0, 2.5)
    for frame, share in (("converged_mean", 0.5), ("mean", 0.5), ("node", 0.0)):
        turns = np.array([_turn(frame, angle) for angle in angles])
        last = int(np.flatnonzero(np.isfinite(turns))[-1])
        finding.rows += [
            Row(f"{frame}: first refused [deg]", LIMIT, angles[last + 1], 2.5 / LIMIT),
            Row(f"{frame}: last rotation of the frame [deg]", share * angles[last], turns[last],
                1e-9)]
        finding.curves[frame] = angles[:last + 1], turns[:last + 1]
    finding.predict("half the rotation, which jumps", (0.0, 180.0, 180.0, 270.0),
                    (0.0, 90.0, -90.0, -45.0))
    return finding


def collinear() -> Finding:
    """Frame by positions whose nodes nearly lie on a line."""
    finding = Finding(
        "nearly collinear nodes",
        "nodes close to a line: deflections rotate the frame more",
        "A best-fit frame rotates about the line of its nodes by the deflection of the node beside "
        "the line divided by the distance of this node from the line: as the distance goes to "
        "zero, the rotation for a given deflection goes to infinity.",
        "sebody warns if nodes spread across the line by less than 1e-3 of their length, and "
        "refuses less than 1e-6.",
        "distance from the line / length", "rotation of the frame for a deflection of 1e-6 [rad]",
        logarithmic="xy")
    offsets, turns = (0.3, 0.1, 0.03, 0.01, 1e-3, 1e-4), []
    for offset in offsets:
        model = triangle(offset)
        run = Simulation(model, 0.01)
        at = run.numbering.dof_blocks[model.nodes["c"].position]
        run.state.q[at + 2] += 1e-6
        assemble(RESIDUAL, RESIDUAL, run.system, run.state, run.state.residual)
        frame = run.state.frames[:9].reshape(3, 3)
        turns.append(np.arctan2(frame[2, 1], frame[2, 2]))
        finding.rows.append(Row(f"offset {offset:g}: turn", np.arctan(1e-6 / offset), turns[-1],
                                1e-3))
    finding.curves["frame"] = offsets, turns
    finding.predict("deflection / distance", offsets, 1e-6 / np.array(offsets))
    try:
        triangle(1e-8)
        refused = 0.0
    except InputError:
        refused = 1.0
    finding.rows.append(Row("offset 1e-08: refused", 1.0, refused, 0.0, PROGRAM))
    return finding


def triangle(offset: float) -> Model:
    """A plate of springs on three nodes, the third beside the line of the others."""
    points = np.array([[0.0, 0, 0], [2.0, 0, 0], [1.0, offset, 0]])
    body = _of_springs(points)
    model = Model()
    nodes = [model.node("a", points[0]), model.node("b", points[1]),
             model.node("c", points[2], "translation")]
    model.superelement("plate", body, nodes, frame="positions")
    return model


def _of_springs(points: np.ndarray) -> ReducedBody:
    """Two full nodes and one position, masses in them, stiff against all but rigid motion."""
    n = 15
    mass = np.diag([1.0] * 9 + [0.1] * 6)
    centre = points.mean(axis=0)
    rigid = np.zeros((n, 6))
    for i, point in enumerate(points):
        rigid[3 * i:3 * i + 3, :3] = np.eye(3)
        rigid[3 * i:3 * i + 3, 3:] = np.cross(np.eye(3), point - centre).T
    for j in range(2):
        rigid[9 + 3 * j:12 + 3 * j, 3:] = np.eye(3)
    basis = np.linalg.qr(rigid)[0]
    return ReducedBody(100.0 * (np.eye(n) - basis @ basis.T), mass, points,
                       ("full", "full", "translation"))


def massless_rotations() -> Finding:
    """Inertia of the rotation about a beam's axis, down to none."""
    finding = Finding(
        "nearly massless rotations",
        "the effect of a small rotary inertia is proportional to it",
        "A rotation with little inertia has a high frequency, which the scheme damps; the effect "
        "of this inertia on the motion is proportional to the inertia. Without inertia the "
        "acceleration is undetermined.",
        "sebody integrates down to 1e-10 of the beam's own inertia with option B, to 1e-8 with D, "
        "and refuses a rotation without inertia, which the message names.",
        "inertia about the beam's axis / exact inertia", "relative change of the tip's motion",
        logarithmic="xy")
    shares = np.array([1e-1, 1e-2, 1e-3, 1e-4])
    least = _struck(1e-10)
    changes = [np.abs(_struck(share) - least).max() / 10.0 for share in shares]
    order = np.polyfit(np.log(shares), np.log(changes), 1)[0]
    finding.rows.append(Row("order of the change in the share", 1.0, order, 0.1))
    finding.curves["tip"] = shares, changes
    finding.predict("first order", shares, changes[1] * shares / shares[1])
    try:
        _struck(0.0)
        refused = 0.0
    except InputError:
        refused = 1.0
    finding.rows.append(Row("no inertia: refused", 1.0, refused, 0.0, PROGRAM))
    return finding


def _struck(share: float) -> np.ndarray:
    """Tip of a beam on a spherical joint, pushed across, with less inertia about its axis."""
    body = craig_bampton(straight_beam((0, 0, 0), (10.0, 0, 0), SECTION, 4),
                         [(0, "full"), (4, "full")], 0)
    mass = body.mass.copy()
    for i in (6, 9):            # rotations about the axis
        mass[i, :] *= np.sqrt(share)
        mass[:, i] *= np.sqrt(share)
    model = Model()
    ends = model.node("a", (0, 0, 0)), model.node("b", (10.0, 0, 0))
    model.superelement("beam", ReducedBody(body.stiffness, mass, body.coordinates, body.keeps),
                       ends, inertia="material")
    model.fix("a", "position")
    model.rigid_velocity((0.0, 0.0, 0.0), (2.0, 0.5, 1.0))
    model.force("b", (0, 1.0, 0), [(0.0, 0.0), (0.5, 40.0), (1.0, 0.0)])
    return simulate(model, 0.01, 2.0)["b.position"]


def negative_weights() -> Finding:
    """A body whose centre of mass lies outside its nodes."""
    finding = Finding(
        "negative weights of the frame",
        "the energy drift is of second order in the step",
        "Nodes at 1/4 and 1/2 of a beam have the weights 0 and 1; nodes at 0 and 1/4 would need -1 "
        "and 2. The farther the centre, the more would one node rotate relative to the frame for "
        "a rotation relative to the other node. Energy is conserved to second order, as with any "
        "weights.",
        "sebody keeps weights within 1, as the root of the sum of squares, of equal ones, which "
        "every centre between the nodes allows: here -0.21 and 1.21. The limit of 180 degrees is "
        "reached at the relative rotation divided by the larger weight.",
        "step [s]", "relative drift of energy", logarithmic="xy")
    model = Model()
    _beam(model, 10.0, 0, 1)
    weights = model.bodies["beam"].alpha
    larger = 0.5 + np.sqrt(0.5)
    finding.rows += [Row("weight of the first node", 1.0 - larger, weights[0], 1e-9),
                     Row("weight of the second node", larger, weights[1], 1e-9)]
    angles = np.arange(110.0, 160.0, 1.0)
    refused = [_refused(model, angle) for angle in angles]
    finding.rows.append(Row("first refused relative rotation [deg]", LIMIT / larger,
                            angles[int(np.argmax(refused))], 1.0 / (LIMIT / larger)))
    steps = (0.02, 0.01, 0.005, 0.0025)
    drifts = [_tumbling(h) for h in steps]
    finding.curves["measured"] = steps, drifts
    finding.predict("second order", steps, drifts[-1] * (np.array(steps) / steps[-1])**2)
    order = np.polyfit(np.log(steps), np.log(drifts), 1)[0]
    finding.rows.append(Row("order of the drift of energy", 2.0, order, 0.15))
    return finding


def _tumbling(h: float) -> float:
    model = Model()
    _beam(model, 10.0, 0, 1)
    model.rigid_velocity((0.0, 0.0, 0.0), (0.2, 1.0, 0.6))
    model.force("b", (0.0, 0.0, 1.0), [(0.0, 0.0), (0.5, 60.0), (1.0, 0.0)])
    return simulate(model, h, 3.0).energy_balance()
