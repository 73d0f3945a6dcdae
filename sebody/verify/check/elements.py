"""Criteria of joints, rigid bodies, loads, springs and drives."""

from types import ModuleType

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from sebody.contract.layout import (
    ACCELERATION,
    ENERGY,
    KINETIC,
    MOMENTUM,
    POTENTIAL,
    POWERS,
    RESIDUAL,
    STRAIN,
    TANGENT,
    VELOCITY,
    Row,
)
from sebody.kernels.tables import SIZE
from sebody.model.spring_laws import Law
from sebody.verify.check import laws, ropes
from sebody.verify.check.states import (
    LIMIT,
    STATES,
    Case,
    CheckRow,
    along_path,
    derivative,
    difference,
    evaluate,
    gradient,
    index_row,
    momenta,
    tangent_mass,
    tangent_rate,
)

TURNED = 2.0 * np.pi    # angle that an element keeps: it has turned once
AMPLITUDES = np.array([0.7, 0.3, -0.4])     # of a load or drive, with its rates


def element_case(module: ModuleType, seed: int) -> Case:
    """A generic state: rotations of a radian, less than half a turn against each other."""
    random = np.random.default_rng(seed)
    n, nrot, kept = module.WIDTH, module.N_ROTATIONS, len(module.MEMORY)
    base = Rotation.from_rotvec(random.normal(size=3))
    R = np.array([(base * Rotation.from_rotvec(0.5 * r)).as_matrix()
                  for r in random.normal(size=(nrot, 3))])
    q = random.normal(size=n)
    size = Row(module.__name__, module.CONSTANTS).size({})
    seen = random.normal(size=getattr(module, "SEES", 0))
    index = np.r_[index_row(n, module.N_POSITIONS, nrot), 9 + kept]     # where those are
    case = Case(module, n, index,
                _constants(module, size, random), q, R.ravel(),
                random.normal(size=n), random.normal(size=n),
                np.r_[np.full(9, TURNED), np.zeros(kept), seen],
                np.r_[np.zeros(9 + kept), seen],
                random.normal(size=3), AMPLITUDES)
    return ropes.apart(case)


def _constants(module: ModuleType, size: int, random: np.random.Generator) -> NDArray:
    """Numbers about one; rows of tables ascend over the elongations of these states.

    Of several laws, whose rows differences would pass now and then, each is one cubic.
    Dampers are linear, as other criteria have them; `curved_damper` is of one that is not.
    """
    constants = 1.0 + 0.5 * random.uniform(-1, 1, size=max(size, 1))
    tables = {name: part for name, part in Row(module.__name__, module.CONSTANTS).slices({}).items()
              if part.stop - part.start == SIZE}
    places = np.linspace(-4.0, 3.0, 6) if len(tables) == 2 else np.array([-20.0, 20.0])
    for name, part in tables.items():
        forces, slopes = random.normal(size=(2, len(places)))
        law = (Law.straight(abs(forces[0])) if name.startswith("damper") else
               Law(places, forces, slopes, slopes))
        constants[part] = law.packed()
    return constants


def joint_force(case: Case) -> float:
    """Force against the gradient of ``lambda . phi``."""
    m = case.module.MULTIPLIERS
    lam = case.q[case.n - m:]
    exact = gradient(case, lambda c: lam @ evaluate(c, RESIDUAL)[0][case.n - m:], 0.02)
    return difference(evaluate(case, RESIDUAL)[0][:case.n - m], exact[:case.n - m])


def _phi_later(case: Case, t: float) -> NDArray:
    """``phi`` at a later time, on a path of the coordinates and of the amplitude."""
    m = case.module.MULTIPLIERS
    still = case._replace(v=np.r_[case.v[:-m], np.zeros(m)], a=np.r_[case.a[:-m], np.zeros(m)])
    value, rate, second = case.loads
    moved = along_path(still, t)._replace(
        loads=np.array([value + rate * t + second * t * t / 2, 0.0, 0.0]))
    return evaluate(moved, RESIDUAL)[0][-m:]


def joint_velocity(case: Case) -> float:
    """``phi`` differentiated in time against differences along a path."""
    rate = derivative(lambda t: _phi_later(case, t), 0.005)
    return difference(evaluate(case, VELOCITY)[0][-len(rate):], rate)


def joint_acceleration(case: Case) -> float:
    """``phi`` differentiated twice in time against differences along a path."""
    h, weights = 0.005, (1.5, -0.15, 1.0 / 90.0)
    second = (-49.0 / 18.0 * _phi_later(case, 0.0) + sum(
        w * (_phi_later(case, k * h) + _phi_later(case, -k * h))
        for k, w in enumerate(weights, 1))) / h**2
    return difference(evaluate(case, ACCELERATION)[0][-len(second):], second)


def drive_power(case: Case) -> float:
    """Power of a drive against its constraint force times the velocities."""
    m = case.module.MULTIPLIERS
    power = -evaluate(case, RESIDUAL)[0][:-m] @ case.v[:-m]
    return abs(evaluate(case, ENERGY)[2][POWERS] / power - 1)


def element_tangent(case: Case) -> float:
    """Matrix against differences of the residual, with the coefficient of constraints."""
    place, constraint, m = 2.0, 3.0, case.n - case.module.MULTIPLIERS
    exact = constraint * gradient(case, lambda c: evaluate(c, RESIDUAL)[0], 0.005)
    exact[:m, :m] *= place / constraint
    matrix = evaluate(case, TANGENT, (0, 0, place, 1, constraint))[1]
    if not np.abs(exact).max() > 1e-12:
        return float(np.abs(matrix).max())
    return difference(matrix, exact)


def _potential_force(case: Case) -> NDArray:
    return gradient(case, lambda c: evaluate(c, ENERGY)[2][[STRAIN, POTENTIAL]].sum(), 0.005)


def power(case: Case) -> float:
    """Power of loads and dampers against the power of their force less that of the potential."""
    exact = -(evaluate(case, RESIDUAL)[0] - _potential_force(case)) @ case.v
    return abs(evaluate(case, ENERGY)[2][POWERS] / exact - 1)


def force_at_rest(case: Case) -> float:
    """Force of springs at rest against the gradient of their energy.

    Coefficients that couple two axes are taken alike in both directions: others have no energy.
    """
    case = case._replace(v=0 * case.v, constants=_symmetric(case))
    exact = _potential_force(case)
    if not np.abs(exact).max() > 1e-12:     # a load: none
        return 0.0
    return difference(evaluate(case, RESIDUAL)[0], exact)


def _symmetric(case: Case) -> NDArray:
    """Constants in which `k12` is `k21`, and so on."""
    constants = case.constants.copy()
    at = Row(case.module.__name__, case.module.CONSTANTS).slices({})
    for name, part in at.items():
        key, first, second = name[:-2], *name[-2:].rjust(2)
        other = {"ut": "tu", "tu": "ut"}.get(key[1:], key[1:])
        if (opposite := f"{key[:1]}{other}{second}{first}") in at:
            constants[part] = constants[at[max(name, opposite)]]
    return constants


def _dampers(module: ModuleType) -> list[slice]:
    """Places of the tables of dampers."""
    return [part for name, part in Row(module.__name__, module.CONSTANTS).slices({}).items()
            if name.startswith("damper") and part.stop - part.start == SIZE]


def curved_damper(case: Case) -> float:
    """Velocity tangent of a damper by a table against differences in small steps of the rates."""
    constants = case.constants.copy()
    law = Law(np.array([-20.0, 20.0]), np.array([-14.0, 18.0]), *np.array([[2.0, 0.7]] * 2))
    for part in _dampers(case.module):
        constants[part] = law.packed()
    case = case._replace(constants=constants)
    exact = [derivative(lambda s, d=d: evaluate(case._replace(v=case.v + s * d), RESIDUAL)[0], 0.1)
             for d in np.eye(case.n)]
    return difference(evaluate(case, TANGENT, (0, 1, 0, 1, 1))[1], np.array(exact).T)


def hamilton(case: Case) -> float:
    """Force against Hamilton's principle: rate of dT/dv, d(T - V)/dq, Hamel's term."""
    force = derivative(lambda t: momenta(along_path(case, t)), 0.003)
    force -= gradient(case, lambda c: evaluate(c, ENERGY)[2][KINETIC], 0.01)
    force += _potential_force(case)
    p = momenta(case)
    for at in case.rotations:
        force[at:at + 3] += np.cross(case.v[at:at + 3], p[at:at + 3])
    return difference(evaluate(case, RESIDUAL)[0], force)


def body_momentum(case: Case) -> float:
    """Momentum and its moment against ``dT/dv`` along rigid velocities (Noether)."""
    p, d = momenta(case), case.dimension
    linear, moment, first = np.zeros(3), np.zeros(3), case.first_rotation
    places = first == d * case.module.N_POSITIONS       # rigid motions leave scalars as they are
    for at in range(0, first, d) if places else ():
        x, of_point = (np.r_[values[at:at + d], np.zeros(3 - d)] for values in (case.q, p))
        linear, moment = linear + of_point, moment + np.cross(x, of_point)
    if case.planar:
        moment[2] += p[first:].sum()
    for j, at in enumerate(case.rotations):
        moment += case.R[9 * j:9 * j + 9].reshape(3, 3) @ p[at:at + 3]
    momentum, exact = evaluate(case, ENERGY)[2][MOMENTUM:POTENTIAL], np.r_[linear, moment]
    return float(np.abs(momentum - exact).max() / np.abs(p).max())     # both may vanish


def criteria(module: ModuleType) -> dict:
    """The criteria for a kernel of this kind."""
    chosen = {"tangent": element_tangent}
    if module.MULTIPLIERS:
        chosen |= {"force = gradient of lambda.phi": joint_force, "velocity": joint_velocity,
                   "acceleration": joint_acceleration}
        return chosen | ({"power": drive_power} if module.POWER else {})
    if module.INERTIAL:
        chosen |= {"Hamilton's force": hamilton, "momentum = rigid dT/dv": body_momentum,
                   "tangent, mass": tangent_mass}
    else:
        chosen |= {"power": power, "force = dV/dq": force_at_rest}
    if _dampers(module):
        chosen |= {"tangent, velocity, of a curved damper": curved_damper}
    return chosen | {"tangent, velocity": tangent_rate}


def check_element(name: str, module: ModuleType) -> list[CheckRow]:
    """All criteria of a joint, body or force kernel."""
    rows = []
    if laws.follows(module):
        return laws.check_law(name, module, element_case)
    if ropes.is_law(module):
        return _of_rope(name, module)
    for seed in range(STATES):
        for criterion, measure in criteria(module).items():
            error = measure(element_case(module, seed))
            rows.append(CheckRow(name, criterion, seed, error, None, LIMIT))
    return rows


def _of_rope(name: str, module: ModuleType) -> list[CheckRow]:
    """All criteria of the law of a rope, in all branches."""
    own = {"tangent": element_tangent, "velocity": joint_velocity,
           "acceleration": joint_acceleration, **ropes.LAW}
    return [CheckRow(name, f"{criterion}, {branch}", seed, measure(case), None, LIMIT)
            for seed in range(STATES)
            for branch, case in ropes.cases(element_case(module, seed)).items()
            for criterion, measure in own.items()]
