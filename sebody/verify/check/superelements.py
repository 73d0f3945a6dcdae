"""Criteria of superelement kernels: energies, forces, tangents, momenta, the paper's own forms."""

from types import ModuleType

import numpy as np
from numpy.typing import NDArray

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
    first_moment,
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
    mode_coupling,
    momenta,
    tangent_mass,
    tangent_rate,
)
from sebody.verify.check.superelement_cases import Nodes, nodes_of, superelement_case

SIZE = "geometric term, its size"       # reported, without a limit
LIMITS = {"K - K^T = skew(G)": 1e-10, "energies (24), (34)": 1e-10,
          "momentum = rigid dT/dv": 1e-10, SIZE: np.inf}


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
