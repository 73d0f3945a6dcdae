"""Criteria of loads on bodies: the forces from their definition, their power and matrix."""

from types import ModuleType

import numpy as np
from numpy.typing import NDArray

from sebody.contract.layout import ENERGY, POWERS, RESIDUAL
from sebody.verify.check.definitions import frame_rotation
from sebody.verify.check.elements import AMPLITUDES, element_tangent
from sebody.verify.check.states import (
    LIMIT,
    STATES,
    Case,
    CheckRow,
    constants_of,
    difference,
    evaluate,
    tangent_mass,
    tangent_rate,
    with_constants,
)
from sebody.verify.check.superelement_cases import Nodes, nodes_of, placed_case


def body_load_case(module: ModuleType, seed: int, nodes: Nodes) -> Case:
    """A generic state and load, with a series of as many columns as the number of the state."""
    case, values, random = placed_case(module, seed, nodes=nodes)
    names = {part.name for part in module.CONSTANTS}
    kept = {name: value for name, value in values.items() if name in names}
    index = np.r_[case.index, len(AMPLITUDES), seed]        # behind the amplitudes of the port
    loads = np.r_[AMPLITUDES, random.normal(size=seed)]
    case = case._replace(loads=loads, index=index, series=seed)
    return with_constants(case, kept | {"P": random.normal(size=case.n),
                                        "columns": random.normal(size=(case.n, seed))})


def _forces(case: Case) -> NDArray:
    """Forces of the load, ``-G``, by rotations of SciPy: its vectors turn with the frame."""
    constants, R0 = constants_of(case), frame_rotation(case).as_matrix()
    P = AMPLITUDES[0] * constants["P"] + constants["columns"] @ case.loads[len(AMPLITUDES):]
    d, forces = case.dimension, P.copy()
    on_positions = P[:case.first_rotation].reshape(-1, d) @ R0[:d, :d].T
    forces[:case.first_rotation] = on_positions.ravel()
    for j, at in enumerate(case.rotations):
        forces[at:at + 3] = case.R[9 * j:9 * j + 9].reshape(3, 3).T @ R0 @ P[at:at + 3]
    return forces


def turning_force(case: Case) -> float:
    """Force against its definition."""
    return difference(evaluate(case, RESIDUAL)[0], -_forces(case))


def power(case: Case) -> float:
    """Power against that of the force by its definition."""
    return abs(evaluate(case, ENERGY)[2][POWERS] / (_forces(case) @ case.v) - 1)


CRITERIA = {"force turns with the frame": turning_force, "power": power,
            "tangent": element_tangent, "tangent, velocity": tangent_rate,
            "tangent, mass": tangent_mass}


def check_body_load(name: str, module: ModuleType) -> list[CheckRow]:
    """All criteria, with some numbers of nodes and modes."""
    return [CheckRow(name, criterion, seed, measure(body_load_case(module, seed, nodes)), None,
                     LIMIT, nodes)
            for nodes in nodes_of(module) for seed in range(STATES)
            for criterion, measure in CRITERIA.items()]
