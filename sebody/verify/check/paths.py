"""Criteria of points on paths of bodies, and of nodes that turn with them.

Those of joints, where the path is or its angle, and the balance.

The path is placed a second time by splines and rotations of SciPy, from the definition of the
body's frame. In the first state the body has all of the path, in the second a part of it.
"""

from types import ModuleType, SimpleNamespace

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicHermiteSpline
from scipy.spatial.transform import Rotation

from sebody.contract.layout import AT_FRAME, AT_ROTATIONS, ENERGY, FRAME_CONSTANTS, POWERS, RESIDUAL
from sebody.kernels.paths import HEAD
from sebody.verify.check.definitions import frame_rotation, local_coordinates
from sebody.verify.check.elements import (
    element_tangent,
    joint_acceleration,
    joint_force,
    joint_velocity,
)
from sebody.verify.check.states import (
    LIMIT,
    STATES,
    Case,
    CheckRow,
    constants_of,
    difference,
    evaluate,
    gradient,
    index_row,
    with_constants,
)
from sebody.verify.check.superelement_cases import Nodes, nodes_of, placed_case

KNOTS = np.array([0.0, 2.1, 4.3, 6.2])
WAY, OFFSET = 8.3, 5.0      # in the second interval
BLENDED = (-9.0, -9.0, 99.0, 99.0), (2.0, 5.5, 1.5, 8.0)    # edges of the weight
FOLLOWERS = 2
KINDS = 3       # of nodes, of those that general kernels are checked with


def body_path_case(module: ModuleType, seed: int, nodes: Nodes) -> Case:
    """A generic state of a body and, behind it, of a point or angle, the way, and multipliers."""
    body, values, random = placed_case(module, seed, nodes=nodes)
    n, equations, turns = body.n, module.MULTIPLIERS, getattr(module, "CARRIERS", 0)
    d = equations if body.planar else 3
    path, behind = _numbers(random, n, d, seed), d + 1 + equations
    if equations < d:       # a direction of the path, at every knot with its slope
        path = np.r_[path, random.normal(size=6 * len(KNOTS))]
    q, v, a = (np.r_[own, random.normal(size=behind)] for own in (body.q, body.v, body.a))
    q[n + d] = WAY
    index = np.r_[index_row(len(q), nodes.positions, nodes.rotations + turns), 0]
    index[AT_ROTATIONS] = nodes.rotations
    index[AT_FRAME], kept = len(body.frames), np.zeros(len(module.MEMORY))
    R = Rotation.from_rotvec(random.normal(size=(turns, 3))).as_matrix().ravel()
    case = Case(module, len(q), index, np.zeros(0), q, np.r_[body.R, R], v, a,
                np.r_[body.reference, kept], np.r_[body.frames, kept], path=len(path))
    values |= {"path": path, "held": random.normal(size=3) if turns else np.array(0.3)}
    return with_constants(case, {part.name: values[part.name] for part in module.CONSTANTS})


def _numbers(random: np.random.Generator, n: int, d: int, seed: int) -> NDArray:
    """The numbers of a generic path."""
    rows = 0.5 * random.normal(size=(len(KNOTS), 2, d * (1 + n + FOLLOWERS)))
    Q = 0.3 * random.normal(size=(FOLLOWERS, n, n))
    return np.r_[len(KNOTS), FOLLOWERS, OFFSET, BLENDED[seed % len(BLENDED)], -20.0, 99.0,
                 1.0, KNOTS,
                 rows.ravel(), (Q + Q.transpose(0, 2, 1)).ravel()]


def _body(case: Case) -> Case:
    """The body alone, as the definitions of frames read it."""
    parts = tuple(p for p in case.module.CONSTANTS if p in FRAME_CONSTANTS or p.name == "Gam")
    module = SimpleNamespace(FRAME=case.module.FRAME, PLANAR=case.planar, CONSTANTS=parts,
                             __name__="body")
    index = index_row(case.own, case.n_positions, case.n_rotations)
    made = Case(module, case.own, index, np.zeros(0), case.q[:case.own],
                case.R[:9 * case.n_rotations], case.v[:case.own], case.a[:case.own],
                case.reference[:9], case.frames[:9])
    constants = constants_of(case)
    return with_constants(made, {part.name: constants[part.name] for part in parts})


def _place(case: Case, way: float | None = None) -> NDArray:
    """The place on the path at a way, by default that of the point.

    By splines and rotations of SciPy.
    """
    body, d = _body(case), case.dimension
    origin = constants_of(case)["alphas"] @ body.q[:body.first_rotation].reshape(-1, d)
    return origin + frame_rotation(body).as_matrix()[:d, :d] @ _row(case, d, way)


def _row(case: Case, d: int, way: float | None = None) -> NDArray:
    """The first numbers of the path at a way, in the frame of the body."""
    body, path, n = _body(case), constants_of(case)["path"], case.own
    rows = path[HEAD + len(KNOTS):][:2 * len(KNOTS) * d * (1 + n + FOLLOWERS)].reshape(
        len(KNOTS), 2, 1 + n + FOLLOWERS, d)
    way = case.q[n + d] if way is None else way
    here = CubicHermiteSpline(KNOTS, rows[:, 0], rows[:, 1])(way - OFFSET)
    y = local_coordinates(body)
    Q = path[HEAD + len(KNOTS) + rows.size:][:FOLLOWERS * n * n].reshape(FOLLOWERS, n, n)
    z = np.r_[1.0, y, np.einsum("i,bij,j->b", y, Q, y) / 2]
    found: NDArray = z @ here
    return found


def _between(case: Case) -> float:
    """Angle from a node to the tangent of the path that it turns with."""
    tangent = frame_rotation(_body(case)).as_rotvec()[2] + float(_row(case, 1)[0])
    return tangent - case.q[case.own] - float(constants_of(case)["held"])


def _directions(case: Case) -> tuple[NDArray, NDArray]:
    """Directions in global axes: that of a node in space, and that of the section of the path."""
    section = frame_rotation(_body(case)) * Rotation.from_rotvec(_row(case, 3))
    return case.R[-9:].reshape(3, 3) @ constants_of(case)["held"], section.apply(_edge(case))


def _edge(case: Case) -> NDArray:
    """The direction of the path, undeformed."""
    edges = constants_of(case)["path"][-6 * len(KNOTS):].reshape(len(KNOTS), 2, 3)
    found: NDArray = CubicHermiteSpline(KNOTS, edges[:, 0], edges[:, 1])(
        case.q[case.own + 3] - OFFSET)
    return found


def part(case: Case) -> float:
    """The equation of a point that is held in one direction against the definition."""
    forces, d, n = evaluate(case, RESIDUAL)[0], case.dimension, case.own
    edge = frame_rotation(_body(case)).apply(_edge(case))
    weight = forces[n:n + d] @ edge / case.q[-1] / (edge @ edge)
    if np.ptp(constants_of(case)["path"][3:5]) > 0:
        assert 0.01 < weight < 0.99
    return difference(forces[-1:], np.array([weight * edge @ (case.q[n:n + d] - _place(case))]))


def direction(case: Case) -> float:
    """The equation against the definition; its weight is that of the moment on the node."""
    forces, (held, edge) = evaluate(case, RESIDUAL)[0], _directions(case)
    moment = case.R[-9:].reshape(3, 3) @ forces[case.own:case.own + 3]
    weight = moment @ np.cross(held, edge) / case.q[-1] / np.sum(np.cross(held, edge)**2)
    if np.ptp(constants_of(case)["path"][3:5]) > 0:
        assert 0.01 < weight < 0.99
    return difference(forces[-1:], weight * np.array([held @ edge]))


def angle(case: Case) -> float:
    """The equation against the definition; its weight is that of the moment on the node."""
    forces, between = evaluate(case, RESIDUAL)[0], _between(case)
    weight = -forces[case.own] / (case.q[-1] * np.cos(between))
    if np.ptp(case.constants[-case.path:][3:5]) > 0:
        assert 0.01 < weight < 0.99
    return difference(forces[-1:], weight * np.array([np.sin(between)]))


def place(case: Case) -> float:
    """The equations against the definition; their weight is that of the force on the point."""
    d, n = case.dimension, case.own
    forces, lam = evaluate(case, RESIDUAL)[0], case.q[-case.dimension:]
    weight = forces[n] / lam[0]
    if np.ptp(case.constants[-case.path:][3:5]) > 0:
        assert 0.01 < weight < 0.99
    return difference(forces[-d:], weight * (case.q[n:n + d] - _place(case)))


def balance(case: Case) -> float:
    """Forces on body and point add up to zero, and so do their moments.

    Where the gap is closed, unless the point is free across.
    """
    d, n = case.dimension, case.own
    points, angles = [*range(0, case.first_rotation, d)], [*range(case.first_rotation,
                                                                  case.first_mode)]
    if "held" in constants_of(case):
        angles += [] if case.carriers else [n]
    else:
        points.append(n)
        if case.module.VECTOR:
            case = case._replace(q=np.r_[case.q[:n], _place(case), case.q[n + d:]])
    forces = evaluate(case, RESIDUAL)[0]
    total, moment = np.zeros(3), np.zeros(3)
    for at in points:
        x, f = (np.r_[values[at:at + d], np.zeros(3 - d)] for values in (case.q, forces))
        total, moment = total + f, moment + np.cross(x, f)
    if case.planar:
        moment[2] += forces[angles].sum()
    for j, at in enumerate(case.rotations):
        moment += Rotation.from_matrix(case.R[9 * j:9 * j + 9].reshape(3, 3)).apply(
            forces[at:at + 3])
    return float(np.abs(np.r_[total, moment]).max() / np.abs(forces).max())


CRITERIA = {"tangent": element_tangent, "force = gradient of lambda.phi": joint_force,
            "velocity": joint_velocity, "acceleration": joint_acceleration,
            "forces in balance": balance}


def check_body_path(name: str, module: ModuleType) -> list[CheckRow]:
    """All criteria, with some numbers of nodes and modes."""
    turns = any(part.name == "held" for part in module.CONSTANTS)
    own = ({"place on the path": place} if module.VECTOR else {"part of the gap": part}
           if not turns else {"angle of the path": angle} if module.PLANAR else
           {"direction of the path": direction})
    return [CheckRow(name, criterion, seed, measure(body_path_case(module, seed, nodes)), None,
                     LIMIT, nodes)
            for nodes in nodes_of(module)[:KINDS] for seed in range(STATES)
            for criterion, measure in (CRITERIA | own).items()]


AXLES = np.array([[0.0, 1.0], [1.3, 0.7], [30.0, 5.0]])     # the last one is not on the path


def path_load_case(module: ModuleType, seed: int, nodes: Nodes) -> Case:
    """A generic state of a body, and three loads on its path."""
    case, values, random = placed_case(module, seed, nodes=nodes)
    path = np.r_[_numbers(random, case.n, case.dimension, seed), len(AXLES), AXLES.ravel()]
    index = np.r_[case.index, 0]
    case = case._replace(index=index, path=len(path), loads=np.array([WAY, 0.4, -0.3]))
    values |= {"path": path, "load": random.normal(size=case.dimension)}
    return with_constants(case, {part.name: values[part.name] for part in module.CONSTANTS})


def _potential(case: Case) -> float:
    """Minus the work of the forces, by splines and rotations of SciPy."""
    constants, found = constants_of(case), 0.0
    edges = constants["path"][3:7]
    for behind, factor in AXLES[:2]:
        way = case.loads[0] - behind
        u, v = (np.clip((way - OFFSET - edges[k]) / max(edges[k + 1] - edges[k], 1e-9), 0, 1)
                for k in (0, 2))
        rise, fall = (x**3 * (10 - 15 * x + 6 * x * x) for x in (u, v))
        found -= factor * rise * (1 - fall) * constants["load"] @ _place(case, way)
    return found


def potential_force(case: Case) -> float:
    """Forces against differences of the potential."""
    exact = gradient(case, _potential, 0.005)
    return difference(evaluate(case, RESIDUAL)[0], exact)


def power(case: Case) -> float:
    """Power of the forces against these times the velocities."""
    exact = -evaluate(case, RESIDUAL)[0] @ case.v
    return abs(evaluate(case, ENERGY)[2][POWERS] / exact - 1)


LOAD_CRITERIA = {"force = dV/dq": potential_force, "power": power, "tangent": element_tangent}


def check_path_load(name: str, module: ModuleType) -> list[CheckRow]:
    """All criteria of forces that move along a path."""
    return [CheckRow(name, criterion, seed, measure(path_load_case(module, seed, nodes)), None,
                     LIMIT, nodes)
            for nodes in nodes_of(module)[:KINDS] for seed in range(STATES)
            for criterion, measure in LOAD_CRITERIA.items()]
