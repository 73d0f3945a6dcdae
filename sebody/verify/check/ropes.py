"""States of ropes: the law of a stretch and friction in every branch, sheaves that are apart."""

from types import ModuleType

import numpy as np

from sebody.contract.layout import ENERGY, POWERS, RESIDUAL, STRAIN, TANGENT
from sebody.verify.check.states import (
    Case,
    along_path,
    changed,
    constants_of,
    derivative,
    difference,
    evaluate,
    gradient,
)

APART = 0.1             # of the radii: sheaves do not overlap
SLOW = 0.5              # factor of velocities: differences in time see sharp bends near sheaves
SMALL = 1e-4            # step of differences: branches end further away
BRANCHES = {"taut": (0.5, 0.05), "taut, damping at its limit": (0.5, 50.0),
            "slack": (-0.5, 0.05)}      # elongation and damping
# coefficient, speed of the smooth law, and strains and tensions on both sides
RUBBING = {"sticks": (3.0, 0.0, (0.3, 0.4), (1.0, 1.2)),
           "slips": (1e-2, 0.0, (0.3, 0.4), (1.0, 2.2)),
           "slips the other way": (1e-2, 0.0, (0.3, 0.4), (2.2, 1.0)),
           "smooth": (0.3, 1.0, (0.3, 0.4), (1.0, 2.2)),
           "slack on one side": (0.3, 0.0, (-0.3, 0.4), (0.0, 2.2)),
           "slack": (0.3, 0.0, (-0.3, -0.4), (0.0, 0.0))}


def rubs(module: ModuleType) -> bool:
    """Tell whether a kernel is the friction of a rope on a sheave."""
    return "wrap" in {part.name for part in module.CONSTANTS}


def rubbing(case: Case) -> dict[str, Case]:
    """The case of friction on a sheave in every branch."""
    found, values = {}, constants_of(case)
    for branch, (coefficient, speed, strains, tensions) in RUBBING.items():
        q = case.q.copy()
        q[[3, 4, 6, 7]] *= 0.1
        for k, strain in enumerate(strains):
            length, near, far = range(2 + 3 * k, 5 + 3 * k)
            material = (values[f"material_{k + 1}"] - q[near]
                        + values[f"given_{k + 1}"] * q[far])
            q[length] = float(material) * (1.0 + strain)
        q[8:10] = tensions
        found[branch] = changed(case._replace(q=q), coefficient=coefficient,
                                static=1.1 * coefficient, speed=speed)
    return found


def is_law(module: ModuleType) -> bool:
    """Tell whether a kernel is the law of a rope."""
    return "given_a" in {part.name for part in module.CONSTANTS}


def apart(case: Case) -> Case:
    """The case with sheaves that do not overlap, whose planes are nearly that of the rope."""
    values = constants_of(case)
    own = {name: APART * value for name, value in values.items() if name in ("r_a", "r_b")}
    if not own:
        return case
    d = case.q[case.dimension:2 * case.dimension] - case.q[:case.dimension]
    for k, name in enumerate("ab"):
        if f"e1_{name}" not in values:
            continue
        if case.planar:
            own[f"e1_{name}"] = values[f"e1_{name}"] / np.linalg.norm(values[f"e1_{name}"])
            continue
        seen = case.R[9 * k:9 * k + 9].reshape(3, 3).T @ d / np.linalg.norm(d)
        across = np.cross(seen, values[f"e1_{name}"])
        ray = seen + across + 0.1 * values[f"e2_{name}"]
        own[f"e1_{name}"] = ray / np.linalg.norm(ray)
        other = np.cross(np.cross(seen, across), own[f"e1_{name}"])
        own[f"e2_{name}"] = other / np.linalg.norm(other)
    return changed(case._replace(v=SLOW * case.v), **own)


def cases(case: Case) -> dict[str, Case]:
    """The case of a law in every branch."""
    found = {}
    for branch, (elongation, damping) in BRANCHES.items():
        values = constants_of(case)
        q = case.q.copy()
        q[1:3] *= 0.1
        material = values["material"] + values["given_a"] * q[1] + values["given_b"] * q[2]
        q[0] = float(material) + elongation
        found[branch] = changed(case._replace(q=q), damping=damping)
    return found


def force(case: Case) -> float:
    """Force at rest against the gradient of energy and ``lambda . phi``."""
    case = case._replace(v=0.0 * case.v)
    m = case.n - case.module.MULTIPLIERS
    exact = gradient(case, lambda c: case.q[m:] @ evaluate(c, RESIDUAL)[0][m:]
                     + evaluate(c, ENERGY)[2][STRAIN], SMALL)
    return difference(evaluate(case, RESIDUAL)[0][:m], exact[:m])


def power(case: Case) -> float:
    """Power against the rate of the energy less that of the force, times the velocities."""
    m = case.n - case.module.MULTIPLIERS
    case = case._replace(q=np.r_[case.q[:m], 0.0 * case.q[m:]],
                         v=np.r_[case.v[:m], 0.0 * case.v[m:]])
    rate = derivative(lambda t: evaluate(along_path(case, t), ENERGY)[2][STRAIN], SMALL)
    exact = rate - evaluate(case, RESIDUAL)[0] @ case.v
    return float(abs(evaluate(case, ENERGY)[2][POWERS] - exact) / max(abs(exact), 1e-3))


def tangent_rate(case: Case) -> float:
    """Columns of velocities against differences of the force."""
    exact = np.array([derivative(lambda s, d=d: evaluate(
        case._replace(v=case.v + s * d), RESIDUAL)[0], SMALL) for d in np.eye(case.n)]).T
    found = evaluate(case, TANGENT, (0, 2.0, 0, 1, 0))[1]
    return float(np.abs(found - 2.0 * exact).max() / max(np.abs(exact).max(), 1.0))


LAW = {"force = gradient of energy and lambda.phi": force, "power": power,
       "tangent, velocity": tangent_rate}
