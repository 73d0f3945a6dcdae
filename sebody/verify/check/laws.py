"""Criteria of friction, stops and contacts: laws with branches, and with numbers that are kept.

A generic state is moved into every branch: bristles that stick and slip, contacts that press and
that are open. Tangents are compared with differences small enough to stay in the branch, with the
kept numbers of the last step as they are, so that the numbers which the law itself keeps take part.
"""

from collections.abc import Callable
from types import ModuleType

import numpy as np
from numpy.typing import NDArray

from sebody.contract.layout import AT_FRAME, ENERGY, POWERS, RESIDUAL, STRAIN, TANGENT
from sebody.verify.check import ropes
from sebody.verify.check.states import (
    LIMIT,
    STATES,
    Case,
    CheckRow,
    changed,
    constants_of,
    derivative,
    difference,
    evaluate,
    gradient,
)

SMALL = 1e-4            # step of differences: branches end further away
# factors of constants that lead to a branch
BRANCHES = {"sticks": {"coefficient": 1e3, "static": 2e3, "speed": 0.0},
            "slips": {"coefficient": 1e-2, "static": 2e-2, "speed": 0.0},
            "slips, smooth": {"speed": 1.0}}
PRESSED = {"radius": 9.0, "size": 9.0, "upper": -9.0}
OPEN = {"level": -9.0, "size": 0.01, "radius": 0.01, "upper": 99.0, "lower": -99.0}


def follows(module: ModuleType) -> bool:
    """Tell whether a kernel has a law of friction or contact."""
    return bool({"bent", "bent_1", "rate"} & set(module.MEMORY))


def cases(module: ModuleType, case: Case) -> dict[str, Case]:
    """The case in every branch of its law."""
    names = {part.name for part in module.CONSTANTS}
    case = _remembering(module, case)
    if ropes.rubs(module):
        return ropes.rubbing(case)
    directions = {name: constants_of(case)[name] for name in names & {"e", "n"}}
    case = changed(case, **{name: v / np.linalg.norm(v) for name, v in directions.items()})
    contact = "level" in names or "size" in names or "upper" in names
    branches = {"": _with(case, PRESSED) if contact else case}
    if "static" in names:
        branches = {branch: _with(branches[""], factors) for branch, factors in BRANCHES.items()}
    if contact:
        branches["open"] = _with(case, OPEN)
    return branches


def _with(case: Case, factors: dict[str, float]) -> Case:
    """The case with some constants times factors."""
    values = constants_of(case)
    return changed(case, **{name: values[name] * factor for name, factor in factors.items()
                            if name in values})


def _remembering(module: ModuleType, case: Case) -> Case:
    """The case with kept numbers near those of the state, as after a step."""
    memory = case.reference.copy()
    random = np.random.default_rng(len(module.MEMORY))
    first = case.index[AT_FRAME]
    memory[first:first + len(module.MEMORY)] = 0.1 * random.normal(size=len(module.MEMORY))
    if "begun" in module.MEMORY:
        memory[first + module.MEMORY.index("begun")] = 1.0
    return case._replace(reference=memory)


def tangent(case: Case) -> float:
    """Columns of positions, rotations and multipliers against differences of the force."""
    place, constraint, m = 2.0, 3.0, case.n - case.module.READS
    exact = constraint * gradient(case, lambda c: evaluate(c, RESIDUAL)[0], SMALL)
    exact[:, :m] *= place / constraint
    return _compared(evaluate(case, TANGENT, (0, 0, place, 1, constraint))[1], exact)


def velocity_tangent(case: Case) -> float:
    """Columns of velocities against differences of the force."""
    exact = np.array([derivative(lambda s, d=d: evaluate(
        case._replace(v=case.v + s * d), RESIDUAL)[0], SMALL) for d in np.eye(case.n)]).T
    return _compared(evaluate(case, TANGENT, (0, 2.0, 0, 1, 0))[1], 2.0 * exact)


def power(case: Case) -> float:
    """Power against the force less that of the stored energy, times the velocities."""
    stored = gradient(case, lambda c: evaluate(c, ENERGY)[2][STRAIN], SMALL)
    lost = -(evaluate(case, RESIDUAL)[0] - stored) @ case.v
    forces, _, sums = evaluate(case, ENERGY)
    scale = max(np.abs(evaluate(case, RESIDUAL)[0] * case.v).max(),
                np.abs(stored * case.v).max(), 1e-9)
    return float(max(abs(sums[POWERS] - lost), abs(-forces @ case.v - lost)) / scale)


def balance(case: Case) -> float:
    """Force and moment on the bodies together: none, since nothing else is acted upon.

    The moment is seen from a rigid rotation of all: it does no work.
    """
    if case.planar or not case.rotations:
        return 0.0
    force, places = evaluate(case, RESIDUAL)[0], case.positions
    x, f = (np.array([values[at:at + 3] for at in places]).reshape(-1, 3)
            for values in (case.q, force))
    total = np.abs(f.sum(axis=0)).max() if places else 0.0
    moment = np.cross(x, f).sum(axis=0) if places else np.zeros(3)
    for j, at in enumerate(case.rotations):
        moment = moment + case.R[9 * j:9 * j + 9].reshape(3, 3) @ force[at:at + 3]
    axes = len(case.rotations) > 1
    return float(max(total, np.abs(moment).max() * axes) / max(np.abs(force).max(), 1e-9))


def _compared(matrix: NDArray, exact: NDArray) -> float:
    if not np.abs(exact).max() > 1e-9:
        return float(np.abs(matrix).max())
    return difference(matrix, exact)


CRITERIA = {"tangent": tangent, "tangent, velocity": velocity_tangent, "power": power,
            "forces in balance": balance}


def check_law(name: str, module: ModuleType, case_of: Callable[[ModuleType, int], Case]
              ) -> list[CheckRow]:
    """All criteria in all branches."""
    rows = []
    for seed in range(STATES):
        for branch, case in cases(module, case_of(module, seed)).items():
            for criterion, measure in CRITERIA.items():
                rows.append(CheckRow(name, f"{criterion}, {branch}".rstrip(", "), seed,
                                     measure(case), None, LIMIT))
    return rows
