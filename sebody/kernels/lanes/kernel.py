"""Kernels compiled for lanes, from the text they have."""

from functools import cache
from inspect import unwrap
from pathlib import Path
from types import ModuleType

from numba import types

from sebody.compiler.decorators import OF_KERNELS
from sebody.compiler.inside.lane_kernels import is_kept_in_lanes, kernel_in_lanes
from sebody.compiler.inside.lanes import lanes
from sebody.compiler.sources import kernel_hash
from sebody.contract.layout import ARGUMENTS
from sebody.kernels.lanes import (
    frame_search,
    member_by_member,
    packed_products,
    products,
    rotations,
)
from sebody.kernels.loader import load, takes_one_member

# imported: puts in place what kernels call
CALLED = frame_search, packed_products, products, rotations

_POINTERS = {"int64": types.CPointer(types.int64), "float64": types.CPointer(lanes)}


def module_in_lanes(name: str) -> ModuleType:
    """The kernel that lanes call in the place of one of some name."""
    return member_by_member if takes_one_member(name) else load(name)


@cache
def address_in_lanes(module: ModuleType, shared: bool = False) -> int:
    """Address of a kernel for lanes; compiled, or read from the cache, where it is asked for.

    Parameters
    ----------
    shared : bool
        Whether constants of elements are numbers that all members share.
    """
    return kernel_in_lanes(unwrap(module.kernel), _signature(shared), OF_KERNELS,
                           kernel_hash(Path(module.__file__)), shared).address


def is_compiled(path: Path, shared: bool = False) -> bool:
    """Whether the kernel in a file was compiled for lanes; the file is not imported."""
    return is_kept_in_lanes(path, kernel_hash(path), shared)


def _signature(shared: bool) -> types.Type:
    given = [types.CPointer(types.float64) if shared and name == "constants" else _POINTERS[kind]
             for name, kind, _ in ARGUMENTS]
    return types.int64(*[types.int64] * 4, *given)
