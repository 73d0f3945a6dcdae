"""Equal bodies of large models, whose kernel gets eight at a time: see `kernels.equal_bodies`.

Which are depends on the model and on the way to compile, never on what was compiled before.
"""

from collections import Counter
from collections.abc import Iterable
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.compiler.choice import why_no_lanes
from sebody.contract.counts import scratch_size
from sebody.contract.equal_row import BEHIND, OWN, TURN, room
from sebody.engine.system import System
from sebody.generated.options import INERTIA_OPTIONS
from sebody.kernels.loader import load
from sebody.model.mechanism import Mechanism
from sebody.model.parts import Superelement

FEWEST = 4      # equal bodies from which on eight at a time take less time than one by one
# squares of their coordinates, summed: kernels take seconds to compile, and short ones gain less
WORTH_IT, WORTH_SHORT = 1_000, 8_000
DIGITS = 12     # of frame weights, which rotations change by rounding


def constants_key(body: Superelement) -> tuple:
    """Key of the constants that the kernel of a superelement reads."""
    return (body.reduced, body.kernel, body.stiffening, tuple(body.alpha), tuple(body.alpha_r))


def likeness(body: Superelement) -> tuple:
    """Key that equal bodies have in common, however each of them is oriented at the start."""
    weights = (tuple(np.round(a, DIGITS).tolist()) for a in (body.alpha, body.alpha_r))
    return (body.reduced.unrotated[0], body.kernel, body.stiffening, *weights)


class Group(NamedTuple):
    """Equal bodies, as many as a kernel for eight is worth compiling for."""

    kernel: str
    model: Superelement         # whose constants they have, as it is or rotated
    turned: bool                # whether they are oriented differently


def many_alike(model: Mechanism) -> dict[str, Group]:
    """The group of each of the bodies, by name, that belong to one."""
    if len(model.bodies) < FEWEST:
        return {}
    alike: dict[tuple, list[Superelement]] = {}
    for body in model.bodies.values():
        alike.setdefault(likeness(body), []).append(body)
    groups: dict[str, Group] = {}
    for bodies in alike.values():
        first = bodies[0]
        worth_it = WORTH_IT if INERTIA_OPTIONS[first.inertia].rates else WORTH_SHORT
        if len(bodies) >= FEWEST and len(bodies) * len(first.reduced.mass) ** 2 >= worth_it:
            turned = any(body.reduced is not first.reduced for body in bodies)
            common = replace(first, reduced=first.reduced.unrotated[0]) if turned else first
            groups |= dict.fromkeys((body.name for body in bodies),
                                    Group(first.kernel, common, turned))
    return groups


def lanes_exist() -> bool:
    """Tell whether bodies can be evaluated eight at a time at all."""
    return not why_no_lanes()


def evaluated_together(model: Mechanism) -> dict[str, Group]:
    """The groups of bodies that are evaluated eight at a time, by the names of bodies."""
    return many_alike(model) if lanes_exist() else {}


def most_together(model: Mechanism) -> int:
    """The number of bodies in the largest group of them that is evaluated eight at a time."""
    groups = Counter(id(group) for group in evaluated_together(model).values())
    return max(groups.values(), default=0)


def kernels_together(models: Iterable[Mechanism]) -> set[str]:
    """Names of kernels that models need for eight bodies at a time."""
    return {group.kernel for model in models for group in evaluated_together(model).values()}


def kernel_together() -> ModuleType:
    """The kernel that calls others with eight bodies at a time, compiled when it is asked for."""
    return import_module("sebody.kernels.equal_bodies")


def compile_together(name: str) -> None:
    """Compile what eight bodies at a time need of a kernel, or find it in the cache."""
    from sebody.kernels.lanes.kernel import address_in_lanes

    kernel_together()
    address_in_lanes(load(name), (), matrices=True)


def is_compiled_together(path: Path) -> bool:
    """Tell whether the kernel of a file was compiled for eight bodies; the file is not imported."""
    from sebody.kernels.lanes.kernel import is_compiled

    return is_compiled(path, (), matrices=True)


def behind_row(body: Superelement, common: int, turn: int) -> list[int]:
    """End of the index rows of equal bodies.

    Parameters
    ----------
    common, turn : int
        Where the constants that they have in common begin, and the row TURN of this one.
    """
    from sebody.kernels.lanes.kernel import address_in_lanes  # only where lanes are used

    kernel = load(body.kernel)
    return [kernel.kernel.address, address_in_lanes(kernel, (), matrices=True),
            2 if kernel.PLANAR else 3, common, turn]


def turn_row(body: Superelement) -> NDArray:
    """The row TURN of a body."""
    rotation, whole = body.reduced.unrotated[1], np.eye(3)
    whole[:len(rotation), :len(rotation)] = rotation
    return TURN.pack({}, {"rotation": whole.ravel(),
                          "angle": np.arctan2(whole[1, 0], whole[0, 0])})


def room_of(model: Mechanism) -> int:
    """Scratch memory for eight of the equal bodies of a model, the same on every machine."""
    sizes = [0]
    for group in {id(group): group for group in many_alike(model).values()}.values():
        kernel, rotations = load(group.kernel), len(group.model.rotations)
        n = len(group.model.reduced.stiffness)
        sizes.append(room(n, rotations, scratch_size(
            kernel.WORK_ROWS, kernel.WORK_SQUARES, n, rotations)))
    return max(sizes)


def evaluate_alone(model: Mechanism, system: System) -> None:
    """Have the system of a model call the kernels of single bodies, as exports of it do."""
    if not evaluated_together(model):
        return
    together = kernel_together().kernel.address
    for b in range(int(system.first_joint[0])):
        if system.address[b] == together:
            rows = system.index[system.at_index[b]:system.at_index[b + 1]].reshape(
                system.count[b], -1)
            system.address[b] = rows[0, -OWN]
            rows[:, -BEHIND:] = 0
