"""Criteria of superelement kernels: energies, forces, tangents, momenta, the paper's own forms."""

from types import ModuleType
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from sebody.contract.counts import first_mode
from sebody.contract.layout import (
    ENERGY,
    KINETIC,
    MOMENTUM,
    POTENTIAL,
    POWERS,
    RESIDUAL,
    STRAIN,
    TANGENT,
)
from sebody.generated.options import INERTIA_OPTIONS
from sebody.verify.check import rigid_part
from sebody.verify.check.definitions import (
    frame_rotation,
    frame_traits,
    local_coordinates,
    local_velocities,
    mean_rotation,
)
from sebody.verify.check.floating import (
    FOLLOWING,
    first_moment,
    generic_constants,
    is_floating,
    kinetic_terms,
    stiffness,
    strain,
    without_stiffness,
)
from sebody.verify.check.rigid_part import has_rigid_part
from sebody.verify.check.states import (
    LIMIT,
    STATES,
    Case,
    CheckRow,
    along_path,
    changed,
    constants_of,
    derivative,
    difference,
    evaluate,
    gradient,
    index_row,
    mode_coupling,
    momenta,
    tangent_mass,
    tangent_rate,
    with_constants,
)

SIZE = "geometric term, its size"       # reported, without a limit
LIMITS = {"K - K^T = skew(G)": 1e-10, "energies (24), (34)": 1e-10,
          "momentum = rigid dT/dv": 1e-10, SIZE: np.inf}


class Nodes(NamedTuple):
    """What the generic states of a kernel have."""

    positions: int
    rotations: int
    modes: int


# what general kernels are checked with, as far as their frames can be carried: f5, f1t2r3 without
# modes, t4, f1
NODES = Nodes(5, 5, 3), Nodes(3, 4, 0), Nodes(4, 0, 2), Nodes(1, 1, 1)


def nodes_of(module: ModuleType) -> tuple[Nodes, ...]:
    """The nodes a kernel is made for, or several examples where it takes any."""
    if module.N_POSITIONS is not None:
        modes = 3 if module.N_MODES is None else module.N_MODES
        return (Nodes(module.N_POSITIONS, module.N_ROTATIONS, modes),)
    traits = frame_traits(module)
    return tuple(n for n in NODES if (n.rotations or not traits.needs_rotations)
                 and n.positions >= traits.fewest_positions[module.PLANAR])


def placed_case(module: ModuleType, seed: int, psi: float = 0.3, beta: float = 0.3,
                nodes: Nodes | None = None
                ) -> tuple[Case, dict[str, NDArray], np.random.Generator]:
    """A generic state, without constants; those of the frame and two matrices, by name."""
    random = np.random.default_rng(seed)
    npos, nrot, modes = nodes or nodes_of(module)[0]
    planar = module.PLANAR
    d, n = 2 if planar else 3, first_mode(npos, nrot, planar) + modes
    X, alpha, alpha_r = _nodes(random, npos, nrot, d)
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
    v, a = random.normal(size=n), random.normal(size=n)
    case = Case(module, n, index_row(n, npos, nrot), np.zeros(0), q, R, v, a, frame, frame.copy())
    values = {"alphas": alpha, "fits": np.full(npos, 1 / npos), "alpha_rs": alpha_r, "X": X,
              "S": S, "M": M}
    if any(part.name == "Gam" for part in module.CONSTANTS):
        values["Gam"] = _mean_rotation(random, case, X)
    return case, values, random


def _mean_rotation(random: np.random.Generator, case: Case, X: NDArray) -> NDArray:
    """Any weights of local coordinates in the mean rotation, one of a rigid rotation, (n, r)."""
    axes = np.eye(3)[2:] if case.planar else np.eye(3)
    arms = np.column_stack([X, np.zeros(len(X))]) if case.planar else X
    rigid = np.array([np.r_[np.cross(axis, arms)[:, :case.dimension].ravel(),
                            np.tile(axis[-len(axes):], case.n_rotations),
                            np.zeros(case.n - case.first_mode)] for axis in axes]).T
    weights = rigid + 0.2 * random.normal(size=rigid.shape)
    weights[case.first_mode:] *= 0.5
    return weights @ np.linalg.inv(rigid.T @ weights)


def superelement_case(module: ModuleType, seed: int, psi: float = 0.3, beta: float = 0.3,
                      gravity: float = 0.0, damping: float = 0.0,
                      nodes: Nodes | None = None) -> Case:
    """A generic state of a superelement kernel, with the first of its `nodes_of` by default."""
    case, values, random = placed_case(module, seed, psi, beta, nodes)
    n, d, M = case.n, case.dimension, values["M"]
    of_translations, moment = random.normal(size=(n, d)), random.normal(size=d)
    values |= {"mass_columns": of_translations, "mass_rows": of_translations.T, "mc": moment,
               "full": [n], "masses": [1.3]}
    if module.DAMPED:
        values["C"] = damping * M @ M     # any positive matrix
    case = case._replace(field=gravity * random.normal(size=3))
    if is_floating(case):
        slaved, resultants = FOLLOWING[seed % len(FOLLOWING)]
        case = case._replace(slaved=slaved, resultants=resultants, damped=damping > 0)
        values |= generic_constants(random, case, values, damping)
    elif has_rigid_part(case):
        case = case._replace(damped=damping > 0)
        values |= rigid_part.generic_constants(random, case, M, damping)
    return with_constants(case, values | _declared(case, values, random))


def _nodes(random: np.random.Generator, positions: int, rotations: int,
           d: int) -> tuple[NDArray, NDArray, NDArray]:
    """Nodes in the undeformed frame, and the weights of their positions and rotations."""
    around = 2 * np.pi * np.arange(positions) / positions      # on a circle: good for all frames
    X = np.column_stack([np.cos(around), np.sin(around), 0 * around])[:, :d]
    X = X + 0.2 * random.normal(size=(positions, d))
    alpha, alpha_r = (np.ones(k) / max(k, 1) + 0.1 * random.normal(size=k)
                      for k in (positions, rotations))
    alpha += (1 - alpha.sum()) / positions
    alpha_r += (1 - alpha_r.sum()) / max(rotations, 1)
    return X - alpha @ X, alpha, alpha_r


def _declared(case: Case, values: dict, random: np.random.Generator) -> dict[str, NDArray]:
    """Generic values of the constants that the frame and inertia option add."""
    counts = case.counts
    return {part.name: random.normal(size=[counts.get(s, s) for s in part.shape])
            for part in case.module.CONSTANTS if part.name not in values}


def without(case: Case, what: str) -> Case:
    """The case with no stiffness and no gravity, or no inertia."""
    name = {"stiffness": "S", "inertia": "M"}[what]
    without_it = changed(case, **{name: np.zeros((case.n, case.n))})
    if what == "stiffness" and is_floating(case):
        without_it = changed(without_it, **without_stiffness(case))
    return without_it._replace(field=0 * case.field) if what == "stiffness" else without_it


def elastic_force(case: Case) -> float:
    """Force at rest against the derivative of the strain energy and the potential of gravity."""
    rest = case._replace(v=0 * case.v, a=0 * case.a)
    exact = gradient(rest, lambda c: evaluate(c, ENERGY)[2][[STRAIN, POTENTIAL]].sum(), 0.01)
    return difference(evaluate(rest, RESIDUAL)[0], exact)


def tangent_place(case: Case) -> float:
    """Configuration tangent against differences of the whole force."""
    exact = gradient(case, lambda c: evaluate(c, RESIDUAL)[0], 0.01)
    return difference(evaluate(case, TANGENT, (0, 0, 1, 1, 1))[1], exact)


def inertia_force(case: Case) -> float:
    """Force without stiffness against Hamilton's principle: rate of dT/dv, dT/dq, Hamel's term."""
    case = without(case, "stiffness")
    force = derivative(lambda t: momenta(along_path(case, t)), 0.003)
    force -= gradient(case, lambda c: evaluate(c, ENERGY)[2][KINETIC], 0.01)
    p = momenta(case)
    for at in case.rotations:
        force[at:at + 3] += np.cross(case.v[at:at + 3], p[at:at + 3])
    return difference(evaluate(case, RESIDUAL)[0], force)


def asymmetry(case: Case) -> float:
    """``K - K^T = blockdiag(skew(G_theta))`` of the elastic tangent on rotations, else zero."""
    rest = case._replace(v=0 * case.v, a=0 * case.a)
    g, K, _ = evaluate(rest, TANGENT, (0, 0, 1, 1, 1))
    expected = np.zeros_like(K)
    for at in rest.rotations:
        x, y, z = g[at:at + 3]
        expected[at:at + 3, at:at + 3] = [[0, -z, y], [z, 0, -x], [-y, x, 0]]
    return float(np.abs(K - K.T - expected).max() / np.abs(K).max())


def energies(case: Case) -> float:
    """Strain (24), kinetic energy (34) and potential against coordinates found by other means.

    The error of the kinetic energy is relative to the sum of its terms' magnitudes, which bounds
    what rounding makes of them: generic constants of option C are indefinite, and terms may cancel.
    """
    constants, y = constants_of(case), local_coordinates(case)
    computed = evaluate(case, ENERGY)[2]
    d, V = case.dimension, y @ constants["S"] @ y / 2
    if is_floating(case):
        terms, V, moment = kinetic_terms(case), strain(case, y), first_moment(case, y)
    elif has_rigid_part(case):
        terms, moment = rigid_part.kinetic_terms(case), rigid_part.first_moment(case, y)
    else:
        yd = local_velocities(case)
        terms = np.array([yd @ constants["M"] @ yd / 2])
        moment = constants["mc"] + constants["mass_columns"].T @ y
    x = case.q[:case.first_rotation].reshape(-1, d)
    origin, R0 = constants["alphas"] @ x, frame_rotation(case).as_matrix()[:d, :d]
    potential = -(case.field[:d] @ (constants["masses"][0] * origin + R0 @ moment))
    kinetic = abs(computed[KINETIC] - terms.sum()) / np.abs(terms).sum()
    return max(kinetic, abs(computed[STRAIN] / V - 1),
               abs(computed[POTENTIAL] - potential) / max(abs(potential), 1e-300))


def damping_power(case: Case) -> float:
    """Power of the structural damping against its force on the unknowns times their velocity."""
    return abs(evaluate(case, ENERGY)[2][POWERS] / (-_damping_force(case) @ case.v) - 1)


def damping_of_rigid_motion(case: Case) -> float:
    """Force of the structural damping in a rigid motion, which must vanish."""
    d, x = case.dimension, case.q[:case.first_rotation]
    spin, v = np.array([0.3, -0.5, 0.7]), 0 * case.v
    if case.planar:
        spin[:2] = 0.0
        v[case.first_rotation:case.first_mode] = spin[2]
    place = np.zeros((len(x) // d, 3))
    place[:, :d] = x.reshape(-1, d)
    v[:len(x)] = (np.cross(spin, place) + [0.2, 0.1, -0.4])[:, :d].ravel()
    for j, at in enumerate(case.rotations):
        v[at:at + 3] = case.R[9 * j:9 * j + 9].reshape(3, 3).T @ spin
    force = _damping_force(case._replace(v=v))
    return float(np.abs(force).max() / np.abs(_damping_force(case)).max())


def _damping_force(case: Case) -> NDArray:
    """Difference of the forces with and without the damping matrix."""
    name = "Cz" if is_floating(case) else "C"
    undamped = changed(case, **{name: np.zeros_like(constants_of(case)[name])})
    return evaluate(case, RESIDUAL)[0] - evaluate(undamped, RESIDUAL)[0]


def total_momentum(case: Case) -> float:
    """Momentum and its moment against ``dT/dv`` along rigid velocities (Noether)."""
    p, d = momenta(case), case.dimension
    x = np.zeros((case.n_positions, 3))
    x[:, :d] = case.q[:case.first_rotation].reshape(-1, d)
    rigid = np.zeros((6, case.n))
    for k, e in enumerate(np.eye(3)):
        rigid[k, :x.shape[0] * d] = np.tile(e[:d], len(x))
        rigid[3 + k, :x.shape[0] * d] = np.cross(e, x)[:, :d].ravel()
        for j, at in enumerate(case.rotations):
            rigid[3 + k, at:at + 3] = case.R[9 * j:9 * j + 9].reshape(3, 3).T @ e
    if case.planar:
        rigid[2:5] = 0.0
        rigid[5, case.first_rotation:case.first_mode] = 1.0
    return difference(evaluate(case, ENERGY)[2][MOMENTUM:POTENTIAL], rigid @ p)


def paper_tangent(case: Case) -> float:
    """(31) against ``Upsilon^T Sbar Upsilon``, Upsilon from differences of `local_coordinates`."""
    rest = case._replace(v=0 * case.v, a=0 * case.a)
    upsilon = gradient(rest, local_coordinates, 0.01)
    paper = evaluate(rest, TANGENT, (0, 0, 1, 0, 1))[1]
    elastic = (stiffness(rest, local_coordinates(rest)) if is_floating(rest) else
               constants_of(case)["S"])
    return difference(paper, upsilon.T @ elastic @ upsilon)


def power(case: Case) -> float:
    """Power of the force on the unknowns against the rate of the energy along a path."""
    rate = derivative(lambda t: evaluate(along_path(case, t), ENERGY)[2][
        [KINETIC, STRAIN, POTENTIAL]].sum(), 0.003)
    return abs(evaluate(case, RESIDUAL)[0] @ case.v / rate - 1)


def geometric_term(case: Case) -> float:
    """Size of ``d(Upsilon^T)/dq : Sbar y``, the term of the consistent tangent that (31) lacks."""
    rest = case._replace(v=0 * case.v, a=0 * case.a)
    paper, consistent = (evaluate(rest, TANGENT, (0, 0, 1, c, 1))[1] for c in (0, 1))
    return difference(paper, consistent)


EXACT_FORCE = {"force = dV/dq (30)": elastic_force, "Hamilton's force (45), (57)": inertia_force,
               "power = rate of the energy": power,
               "K - K^T = skew(G)": asymmetry, "tangent (31)": paper_tangent}
MODES_APART = {"modes apart": mode_coupling}
DAMPING = {"power of damping": damping_power, "damping of rigid motion": damping_of_rigid_motion}
ENERGY_SUMS = {"energies (24), (34)": energies, "momentum = rigid dT/dv": total_momentum}
TANGENTS = {"tangent, configuration": tangent_place, "tangent, velocity (61)": tangent_rate,
            "tangent, mass (60)": tangent_mass}
DAMPED = (*DAMPING.values(), *TANGENTS.values(), *MODES_APART.values(), energies)


def small_increment_slope(module: ModuleType, seed: int, nodes: Nodes) -> tuple[float, float]:
    """Difference of the force of (20) from dV/dq at beta_0 = 0, and its order in psi."""
    sizes, errors = (0.2, 0.1, 0.05), []
    for psi in sizes:
        case = superelement_case(module, seed, psi, nodes=nodes)
        case = case._replace(v=0 * case.v, a=0 * case.a)
        case = case._replace(reference=mean_rotation(case))
        errors.append(elastic_force(case))
    return errors[0], float(np.polyfit(np.log(sizes), np.log(errors), 1)[0])


def check_superelement(name: str, module: ModuleType) -> list[CheckRow]:
    """All criteria of a superelement kernel."""
    if module.N_POSITIONS is not None:
        return _check(name, module, *nodes_of(module))
    return [row._replace(nodes=nodes) for nodes in nodes_of(module)
            for row in _check(name, module, nodes)]


def _check(name: str, module: ModuleType, nodes: Nodes) -> list[CheckRow]:
    """All criteria, with some nodes and modes."""
    rows = []
    traits = frame_traits(module)
    small, damping = not traits.exact, module.DAMPED is not False
    for seed in range(STATES):
        case = superelement_case(module, seed, gravity=1.0, nodes=nodes)
        damped = superelement_case(module, seed, gravity=1.0, damping=0.1 * damping,
                                   nodes=nodes)
        criteria = ({} if small else EXACT_FORCE) | TANGENTS | ENERGY_SUMS | {SIZE: geometric_term}
        if damping and not small:
            criteria |= DAMPING
        apart = INERTIA_OPTIONS[module.INERTIA].modes_apart and not frame_traits(module).modes
        if apart and nodes.modes > 1:
            criteria |= MODES_APART
        if traits.incremental:      # a mean of increments does not follow a rigid motion
            criteria.pop("damping of rigid motion", None)
        for criterion, measure in criteria.items():
            error = measure(damped if measure in DAMPED else case)
            rows.append(CheckRow(name, criterion, seed, error, None,
                                 LIMITS.get(criterion, LIMIT)))
        if small and nodes.rotations > 1:       # of one rotation the mean has no error
            error, slope = small_increment_slope(module, seed, nodes)
            rows.append(CheckRow(name, "force of (20) against dV/dq", seed, error, slope, 1.8))
    return rows
