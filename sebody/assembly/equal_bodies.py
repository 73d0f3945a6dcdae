"""Equal bodies of large models, whose kernel gets eight at a time: see `kernels.equal_bodies`.

Which are depends on the model and on the way to compile, never on what was compiled before.
"""

from collections import Counter
from collections.abc import Iterable
from importlib import import_module
from pathlib import Path
from types import ModuleType

from sebody.compiler.choice import why_no_lanes
from sebody.contract.counts import scratch_size
from sebody.contract.equal_row import BEHIND, OWN, room
from sebody.engine.system import System
from sebody.kernels.loader import load
from sebody.model.mechanism import Mechanism
from sebody.model.parts import Superelement

FEWEST = 64     # equal bodies from which on a kernel for eight is worth compiling
FRAME = "converged_mean"    # of bodies that gain by it as measured; others are taken one by one


def likeness(body: Superelement) -> tuple:
    """What equal bodies have in common: their kernel and all constants it reads."""
    return (body.reduced, body.kernel, body.stiffening, tuple(body.alpha), tuple(body.alpha_r))


def many_alike(model: Mechanism) -> set[tuple]:
    """The likenesses of bodies that are as many as a kernel for eight is worth compiling for."""
    if len(model.bodies) < FEWEST:
        return set()
    counts = Counter(likeness(body) for body in model.bodies.values() if body.frame == FRAME)
    return {like for like, count in counts.items() if count >= FEWEST}


def evaluated_together(model: Mechanism) -> set[tuple]:
    """The likenesses of bodies that are evaluated eight at a time."""
    return set() if why_no_lanes() else many_alike(model)


def kernels_together(models: Iterable[Mechanism]) -> set[str]:
    """Names of kernels that models need for eight bodies at a time."""
    return {kernel for model in models for _, kernel, *_ in evaluated_together(model)}


def kernel_together() -> ModuleType:
    """The kernel that calls others with eight bodies at a time, compiled when it is asked for."""
    return import_module("sebody.kernels.equal_bodies")


def compile_together(name: str) -> None:
    """Compile what eight bodies at a time need of a kernel, or find it in the cache."""
    from sebody.kernels.lanes.kernel import address_in_lanes

    kernel_together()
    address_in_lanes(load(name), shared=True)


def is_compiled_together(path: Path) -> bool:
    """Whether the kernel of a file was compiled for eight bodies; the file is not imported."""
    from sebody.kernels.lanes.kernel import is_compiled

    return is_compiled(path, shared=True)


def behind_row(body: Superelement) -> list[int]:
    """What index rows of equal bodies end with."""
    from sebody.kernels.lanes.kernel import address_in_lanes  # only where lanes are used

    kernel = load(body.kernel)
    return [kernel.kernel.address, address_in_lanes(kernel, shared=True),
            0 if kernel.PLANAR else len(body.rotations)]


def room_of(model: Mechanism) -> int:
    """Scratch memory for eight of the equal bodies of a model, the same on every machine."""
    many, sizes = many_alike(model), [0]
    for body in {likeness(body): body for body in model.bodies.values()}.values():
        if likeness(body) in many:
            kernel, rotations = load(body.kernel), len(body.rotations)
            n = len(body.reduced.stiffness)
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
