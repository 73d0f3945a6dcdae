"""Criteria of superelement kernels: energies, forces, tangents, momenta, the paper's own forms."""

from types import ModuleType

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from sebody.kernels.abi import padded
from sebody.kernels.layout import ENERGY, POTENTIAL, POWERS, RESIDUAL, TANGENT, padded_columns
from sebody.studies.check.states import (
    LIMIT,
    STATES,
    Case,
    CheckRow,
    along_path,
    derivative,
    difference,
    evaluate,
    gradient,
    momenta,
    tangent_mass,
    tangent_rate,
)

SIZE = "geometric term, its size"       # shown, not judged
LIMITS = {"K - K^T = skew(G)": 1e-10, "energies (24), (34)": 1e-10,
          "momentum = rigid dT/dv": 1e-10, SIZE: np.inf}


def superelement_case(module: ModuleType, seed: int, psi: float = 0.3, beta: float = 0.3,
                      gravity: float = 0.0, damping: float = 0.0) -> Case:
    """A generic state of a superelement kernel."""
    random = np.random.default_rng(seed)
    planar = module.LAYOUT.startswith("planar")
    d, npos, nrot, modes = (2 if planar else 3), module.N_POSITIONS, module.N_ROTATIONS, (
        3 if module.N_MODES is None else module.N_MODES)
    n = module.MODES + modes
    around = 2 * np.pi * np.arange(npos) / npos       # spread out: no frame is ill-conditioned
    X = np.column_stack([np.cos(around), np.sin(around), 0 * around])[:, :d]
    X = X + 0.2 * random.normal(size=(npos, d))
    alpha, alpha_r = (np.ones(k) / max(k, 1) + 0.1 * random.normal(size=k) for k in (npos, nrot))
    alpha, alpha_r = alpha + (1 - alpha.sum()) / npos, alpha_r + (1 - alpha_r.sum()) / max(nrot, 1)
    X -= alpha @ X
    S, M = (A @ A.T for A in random.normal(size=(2, n, n)))
    angle = random.normal()
    base = (Rotation.from_rotvec([0, 0, angle]) if planar
            else Rotation.from_rotvec(random.normal(size=3)))
    u = (psi / 3) * random.normal(size=(npos, d))
    x = (X + u) @ base.as_matrix()[:d, :d].T + random.normal(size=d)
    turns = random.uniform(-1, 1, size=(nrot, 1 if planar else 3)) * psi / (1 if planar else 1.8)
    R = (np.zeros(0) if planar else
         np.array([(base * Rotation.from_rotvec(t)).as_matrix() for t in turns]).ravel())
    rotations = angle + turns.ravel() if planar else np.zeros(3 * nrot)
    q = np.concatenate([x.ravel(), rotations, random.normal(size=modes)])
    about = np.array([0.0, 0.0, beta]) if planar else beta * random.normal(size=3) / 1.8
    frame = (base * Rotation.from_rotvec(about)).as_matrix().ravel()
    index = np.array([0, 0, 0, *range(nrot), *range(n)])
    v, a = random.normal(size=n), random.normal(size=n)
    of_translations, moment = random.normal(size=(n, d)), random.normal(size=d)
    C = damping * M @ M     # any positive matrix
    constants = constants_row(alpha, np.full(npos, 1 / npos), alpha_r, X, S, M, of_translations,
                              moment, 1.3, C)
    return Case(module, n, index, constants, q, R, v, a, frame, frame.copy(),
                gravity * random.normal(size=3))


def constants_row(alpha, fit, alpha_r, X, S, M, of_translations, moment, mass,
                  C=None) -> NDArray:
    """Constants of a superelement as its kernel reads them; see `Constants`."""
    return np.concatenate([alpha, fit, alpha_r, X.ravel(), padded_columns(S), padded_columns(M),
                           padded_columns(of_translations), padded_columns(of_translations.T),
                           moment, [mass], padded_columns(np.zeros_like(S) if C is None else C)])


def without(case: Case, what: str) -> Case:
    """The case with no stiffness and no gravity, or no inertia."""
    constants, size = case.constants.copy(), case.n * padded(case.n)
    first = constant_ends(case)[3] + (0 if what == "stiffness" else size)
    constants[first:first + size] = 0.0
    return case._replace(constants=constants,
                         field=0 * case.field if what == "stiffness" else case.field)


def elastic_force(case: Case) -> float:
    """Force at rest against the derivative of the strain energy and the potential of gravity."""
    rest = case._replace(v=0 * case.v, a=0 * case.a)
    exact = gradient(rest, lambda c: evaluate(c, ENERGY)[2][[1, POTENTIAL]].sum(), 0.01)
    return difference(evaluate(rest, RESIDUAL)[0], exact)


def tangent_place(case: Case) -> float:
    """Configuration tangent against differences of the whole force."""
    exact = gradient(case, lambda c: evaluate(c, RESIDUAL)[0], 0.01)
    return difference(evaluate(case, TANGENT, (0, 0, 1, 1, 1))[1], exact)


def inertia_force(case: Case) -> float:
    """Force without stiffness against Hamilton's principle: rate of dT/dv, dT/dq, Hamel's term."""
    case = without(case, "stiffness")
    force = derivative(lambda t: momenta(along_path(case, t)), 0.003)
    force -= gradient(case, lambda c: evaluate(c, ENERGY)[2][0], 0.01)
    p = momenta(case)
    for at in case.turning:
        force[at:at + 3] += np.cross(case.v[at:at + 3], p[at:at + 3])
    return difference(evaluate(case, RESIDUAL)[0], force)


def asymmetry(case: Case) -> float:
    """``K - K^T = blockdiag(skew(G_theta))`` of the elastic tangent on rotations, else zero."""
    rest = case._replace(v=0 * case.v, a=0 * case.a)
    g, K, _ = evaluate(rest, TANGENT, (0, 0, 1, 1, 1))
    expected = np.zeros_like(K)
    for at in rest.turning:
        x, y, z = g[at:at + 3]
        expected[at:at + 3, at:at + 3] = [[0, -z, y], [z, 0, -x], [-y, x, 0]]
    return float(np.abs(K - K.T - expected).max() / np.abs(K).max())


def local_coordinates(case: Case) -> NDArray:
    """``y``, (11), by other means than the kernels: SciPy's rotations, an SVD for the best fit."""
    module, weights = case.module, Constants(case)
    x = case.q[:module.ROTATIONS].reshape(module.N_POSITIONS, -1)
    R0 = frame_rotation(case).as_matrix()[:x.shape[1], :x.shape[1]]
    u = (x - weights.alpha @ x) @ R0 - weights.X
    if case.planar:
        psi = case.q[module.ROTATIONS:module.MODES] - np.arctan2(R0[1, 0], R0[0, 0])
        psi = (psi + np.pi) % (2 * np.pi) - np.pi
    elif module.N_ROTATIONS:
        psi = Rotation.from_matrix(R0.T @ case.R.reshape(-1, 3, 3)).as_rotvec()
    else:
        psi = np.zeros(0)
    return np.concatenate([u.ravel(), psi.ravel(), case.q[module.MODES:]])


def local_velocities(case: Case) -> NDArray:
    """``ydot`` of option A or B, (33) and (36) or (52)."""
    module, v = case.module, case.v.copy()
    d = 2 if case.planar else 3
    R0 = frame_rotation(case).as_matrix()
    positions = v[:module.ROTATIONS].reshape(-1, d) @ R0[:d, :d]
    v[:module.ROTATIONS] = positions.ravel()
    if module.INERTIA == "a":
        for j, at in enumerate(case.turning):
            v[at:at + 3] = R0.T @ case.R[9 * j:9 * j + 9].reshape(3, 3) @ v[at:at + 3]
    return v


def constant_ends(case: Case) -> NDArray:
    """Where the constants of a superelement end: weights, nodes, matrices, first moments, mass."""
    module, n, d = case.module, case.n, 2 if case.planar else 3
    npos, matrix = module.N_POSITIONS, n * padded(n)
    return np.cumsum([npos, npos, module.N_ROTATIONS, module.ROTATIONS, matrix, matrix,
                      d * padded(n), n * padded(d), d, 1, matrix])


class Constants:
    """What the constants of a superelement mean."""

    def __init__(self, case: Case):
        n, column = case.n, padded(case.n)
        (self.alpha, self.fit, self.alpha_r, X, S, M, of_translations, _, self.moment, mass,
         *_) = np.split(case.constants, constant_ends(case)[:-1])
        self.X = X.reshape(case.module.N_POSITIONS, -1)
        self.S, self.M, self.of_translations = (A.reshape(-1, column)[:, :n].T
                                                for A in (S, M, of_translations))
        self.mass = mass[0]


def frame_rotation(case: Case) -> Rotation:
    """``R0`` from its definition, (14)-(16) or the best fit, without the search of the kernels."""
    module, weights = case.module, Constants(case)
    if module.FRAME == "positions":
        x = case.q[:module.ROTATIONS].reshape(module.N_POSITIONS, -1)
        arms = x - weights.alpha @ x
        if not case.planar:
            return Rotation.align_vectors(arms, weights.X, weights.fit)[0]
        turns = (arms @ [1, 1j]) * (weights.X @ [1, -1j])
        return Rotation.from_rotvec([0, 0, np.angle(weights.fit @ turns)])
    if case.planar:
        angles = case.q[module.ROTATIONS:module.MODES]
        return Rotation.from_rotvec([0, 0, weights.alpha_r @ angles])
    if module.FRAME == "converged_mean":
        return Rotation.from_matrix(_mean_rotation(case).reshape(3, 3))
    last = Rotation.from_matrix(case.reference.reshape(3, 3))
    increments = (last.inv() * Rotation.from_matrix(case.R.reshape(-1, 3, 3))).as_rotvec()
    return last * Rotation.from_rotvec(weights.alpha_r @ increments)


def energies(case: Case) -> float:
    """Strain (24), kinetic energy (34) and potential against coordinates found by other means."""
    weights, y, yd = Constants(case), local_coordinates(case), local_velocities(case)
    computed = evaluate(case, ENERGY)[2]
    d = 2 if case.planar else 3
    moment = weights.moment + weights.of_translations.T @ y
    x = case.q[:case.module.ROTATIONS].reshape(-1, d)
    place = weights.mass * weights.alpha @ x + frame_rotation(case).as_matrix()[:d, :d] @ moment
    potential = -(case.field[:d] @ place)
    return max(abs(computed[0] / (yd @ weights.M @ yd / 2) - 1),
               abs(computed[1] / (y @ weights.S @ y / 2) - 1),
               abs(computed[POTENTIAL] - potential) / max(abs(potential), 1e-300))


def damping_power(case: Case) -> float:
    """Power of the structural damping against its force on the unknowns times their velocity."""
    return abs(evaluate(case, ENERGY)[2][POWERS] / (-_damping_force(case) @ case.v) - 1)


def damping_of_rigid_motion(case: Case) -> float:
    """Force of the structural damping in a rigid motion, which must be none."""
    d, x = 2 if case.planar else 3, case.q[:case.module.ROTATIONS]
    spin, v = np.array([0.3, -0.5, 0.7]), 0 * case.v
    if case.planar:
        spin[:2] = 0.0
        v[case.module.ROTATIONS:case.module.MODES] = spin[2]
    place = np.zeros((len(x) // d, 3))
    place[:, :d] = x.reshape(-1, d)
    v[:len(x)] = (np.cross(spin, place) + [0.2, 0.1, -0.4])[:, :d].ravel()
    for j, at in enumerate(case.turning):
        v[at:at + 3] = case.R[9 * j:9 * j + 9].reshape(3, 3).T @ spin
    force = _damping_force(case._replace(v=v))
    return float(np.abs(force).max() / np.abs(_damping_force(case)).max())


def _damping_force(case: Case) -> NDArray:
    """The force less that without the damping matrix."""
    constants = case.constants.copy()
    constants[constant_ends(case)[9]:] = 0.0
    return (evaluate(case, RESIDUAL)[0]
            - evaluate(case._replace(constants=constants), RESIDUAL)[0])


def total_momentum(case: Case) -> float:
    """Momentum and its moment against ``dT/dv`` along rigid velocities (Noether)."""
    p, d = momenta(case), 2 if case.planar else 3
    x = np.zeros((case.module.N_POSITIONS, 3))
    x[:, :d] = case.q[:case.module.ROTATIONS].reshape(-1, d)
    rigid = np.zeros((6, case.n))
    for k, e in enumerate(np.eye(3)):
        rigid[k, :x.shape[0] * d] = np.tile(e[:d], len(x))
        rigid[3 + k, :x.shape[0] * d] = np.cross(e, x)[:, :d].ravel()
        for j, at in enumerate(case.turning):
            rigid[3 + k, at:at + 3] = case.R[9 * j:9 * j + 9].reshape(3, 3).T @ e
    if case.planar:
        rigid[2:5] = 0.0
        rigid[5, case.module.ROTATIONS:case.module.MODES] = 1.0
    return difference(evaluate(case, ENERGY)[2][2:8], rigid @ p)


def paper_tangent(case: Case) -> float:
    """(31) against ``Upsilon^T Sbar Upsilon``, Upsilon from differences of `local_coordinates`."""
    rest = case._replace(v=0 * case.v, a=0 * case.a)
    upsilon = gradient(rest, local_coordinates, 0.01)
    paper = evaluate(rest, TANGENT, (0, 0, 1, 0, 1))[1]
    return difference(paper, upsilon.T @ Constants(case).S @ upsilon)


def geometric_term(case: Case) -> float:
    """What (31) lacks of the consistent tangent, ``d(Upsilon^T)/dq : Sbar y``: its size."""
    rest = case._replace(v=0 * case.v, a=0 * case.a)
    paper, consistent = (evaluate(rest, TANGENT, (0, 0, 1, c, 1))[1] for c in (0, 1))
    return difference(paper, consistent)


EXACT_FORCE = {"force = dV/dq (30)": elastic_force, "Hamilton's force (45), (57)": inertia_force,
               "K - K^T = skew(G)": asymmetry, "tangent (31)": paper_tangent}
DAMPING = {"power of damping": damping_power, "damping of rigid motion": damping_of_rigid_motion}
ENERGY_SUMS = {"energies (24), (34)": energies, "momentum = rigid dT/dv": total_momentum}
TANGENTS = {"tangent, configuration": tangent_place, "tangent, velocity (61)": tangent_rate,
            "tangent, mass (60)": tangent_mass}


def small_increment_slope(module: ModuleType, seed: int) -> tuple[float, float]:
    """Difference of the force of (20) from dV/dq at beta_0 = 0, and its order in psi."""
    sizes, errors = (0.2, 0.1, 0.05), []
    for psi in sizes:
        case = superelement_case(module, seed, psi)
        case = case._replace(v=0 * case.v, a=0 * case.a)
        case = case._replace(reference=_mean_rotation(case))
        errors.append(elastic_force(case))
    return errors[0], float(np.polyfit(np.log(sizes), np.log(errors), 1)[0])


def _mean_rotation(case: Case) -> NDArray:
    """Frame in which the weighted rotation vectors of the nodes vanish, by fixed-point search."""
    weights = Constants(case).alpha_r
    nodes = Rotation.from_matrix(case.R.reshape(-1, 3, 3))
    frame = nodes[0]
    for _ in range(60):
        step = weights @ (frame.inv() * nodes).as_rotvec()
        frame = frame * Rotation.from_rotvec(step)
        if np.abs(step).max() < 1e-16:
            break
    return frame.as_matrix().ravel()


def check_superelement(name: str, module: ModuleType) -> list[CheckRow]:
    """All criteria of a superelement kernel."""
    rows = []
    small = module.FRAME.endswith("_small")
    for seed in range(STATES):
        case = superelement_case(module, seed, gravity=1.0)
        damped = superelement_case(module, seed, gravity=1.0, damping=0.1 * module.DAMPED)
        criteria = ({} if small else EXACT_FORCE) | TANGENTS | ENERGY_SUMS | {SIZE: geometric_term}
        if module.DAMPED and not small:
            criteria |= DAMPING
        if module.FRAME == "mean" and module.DAMPED:    # its increments are no rigid rotation
            del criteria["damping of rigid motion"]
        for criterion, measure in criteria.items():
            error = measure(damped if measure in (*DAMPING.values(), *TANGENTS.values(), energies)
                            else case)
            rows.append(CheckRow(name, criterion, seed, error, None,
                                 LIMITS.get(criterion, LIMIT)))
        if small:
            error, slope = small_increment_slope(module, seed)
            rows.append(CheckRow(name, "force of (20) against dV/dq", seed, error, slope, 1.8))
    return rows
