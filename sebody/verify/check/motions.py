"""Criteria of motions of bodies: the frame from its definition, rates against differences."""

from types import ModuleType

import numpy as np
from numpy.typing import NDArray

from sebody.basics.errors import InputError
from sebody.contract.layout import MOTION, OK, RESIDUAL
from sebody.verify.check.definitions import frame_rotation, local_coordinates
from sebody.verify.check.states import (
    STATES,
    Case,
    CheckRow,
    along_path,
    arguments,
    called,
    constants_of,
    derivative,
    difference,
    with_constants,
)
from sebody.verify.check.superelement_cases import Nodes, nodes_of, placed_case

STEP = 0.003        # of differences in time
MOTION_LIMIT = 1e-10    # searches and differences of sixth order: 1e-13 in these states


def motion_case(module: ModuleType, seed: int, nodes: Nodes) -> Case:
    """A generic state."""
    case, values, _ = placed_case(module, seed, nodes=nodes)
    names = {part.name for part in module.CONSTANTS}
    return with_constants(case, {name: value for name, value in values.items() if name in names})


def moved(case: Case) -> dict[str, NDArray]:
    """Numbers that the kernel writes, by name; the rotation as a matrix."""
    slices = MOTION.slices(case.counts)
    given = arguments(case)._replace(forces=np.zeros(MOTION.size(case.counts)))
    if called(case, RESIDUAL, given) != OK:
        raise InputError(f"kernel {case.module.__name__} refuses the check's state")
    written = {name: given.forces[place] for name, place in slices.items()}
    d = case.dimension
    return written | {"rotation": written["rotation"].reshape(3, 3)[:d, :d]}


def _along(case: Case, of: str) -> NDArray:
    """Rate of something that the kernel writes, by differences along a path."""
    return derivative(lambda t: moved(along_path(case, t))[of], STEP)


def _definition(case: Case) -> tuple[NDArray, NDArray]:
    """Place and rotation of the frame, by SciPy."""
    d = case.dimension
    x = case.q[:case.first_rotation].reshape(case.n_positions, d)
    return constants_of(case)["alphas"] @ x, frame_rotation(case).as_matrix()[:d, :d]


def place(case: Case) -> float:
    """Origin and rotation of the frame."""
    (origin, R0), found = _definition(case), moved(case)
    return max(difference(found["origin"], origin), difference(found["rotation"], R0))


def coordinates(case: Case) -> float:
    """Local coordinates."""
    return difference(moved(case)["y"], local_coordinates(case))


def rates(case: Case) -> float:
    """Rates of the local coordinates."""
    exact = derivative(lambda t: local_coordinates(along_path(case, t)), STEP)
    return difference(moved(case)["y_rate"], exact)


def second_rates(case: Case) -> float:
    """Second rates of the local coordinates, against those of the rates."""
    return difference(moved(case)["y_second"], _along(case, "y_rate"))


def frame_rates(case: Case) -> float:
    """Velocity of the origin and spin of the frame."""
    def origin(t: float) -> NDArray:
        return _definition(along_path(case, t))[0]

    def rotation(t: float) -> NDArray:
        return _definition(along_path(case, t))[1]
    found, R0 = moved(case), rotation(0.0)
    turned = R0.T @ derivative(rotation, STEP)
    spin = [turned[1, 0]] if case.planar else [turned[2, 1], turned[0, 2], turned[1, 0]]
    return max(difference(found["velocity"], R0.T @ derivative(origin, STEP)),
               difference(found["spin"], np.array(spin)))


def frame_second_rates(case: Case) -> float:
    """Acceleration of the origin and rate of the spin, against those of velocity and spin."""
    found, R0 = moved(case), _definition(case)[1]

    def velocity(t: float) -> NDArray:
        state = along_path(case, t)
        return _definition(state)[1] @ moved(state)["velocity"]
    return max(difference(found["acceleration"], R0.T @ derivative(velocity, STEP)),
               difference(found["spin_rate"], _along(case, "spin")))


CRITERIA = {"place of the frame": place, "local coordinates": coordinates,
            "their rates": rates, "their second rates": second_rates,
            "velocity and spin of the frame": frame_rates,
            "acceleration, rate of the spin": frame_second_rates}


def check_motion(name: str, module: ModuleType) -> list[CheckRow]:
    """All criteria, with some numbers of nodes and modes."""
    return [CheckRow(name, criterion, seed, measure(motion_case(module, seed, nodes)), None,
                     MOTION_LIMIT, nodes)
            for nodes in nodes_of(module) for seed in range(STATES)
            for criterion, measure in CRITERIA.items()]
