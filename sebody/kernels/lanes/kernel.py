"""Kernels compiled for lanes, from the text they have."""

from functools import cache
from pathlib import Path
from types import ModuleType

from numba import types

from sebody.compiler.decorators import OF_KERNELS
from sebody.compiler.inside.lane_kernels import SHARED, is_kept_in_lanes, kernel_in_lanes
from sebody.compiler.inside.lanes import lanes
from sebody.compiler.sources import kernel_hash
from sebody.contract.layout import ARGUMENTS
from sebody.kernels.lanes import frame_search, products, rotations

CALLED = frame_search, products, rotations      # imported: puts in place what kernels call

_POINTERS = {"int64": types.CPointer(types.int64), "float64": types.CPointer(lanes)}
SIGNATURE = types.int64(*[types.int64] * 4, *[_POINTERS[kind] for _, kind, _ in ARGUMENTS])
# the same where all members have the same constants: numbers
OF_EQUAL = types.int64(*[types.int64] * 4, *[
    types.CPointer(types.float64) if name == "constants" else _POINTERS[kind]
    for name, kind, _ in ARGUMENTS])


@cache
def address_in_lanes(module: ModuleType) -> int:
    """Address of a kernel for lanes; compiled, or read from the cache, where it is asked for."""
    return kernel_in_lanes(module.kernel.__wrapped__, SIGNATURE, OF_KERNELS,
                           kernel_hash(Path(module.__file__))).address


@cache
def address_for_equal(module: ModuleType) -> int:
    """The same of members with the same constants."""
    return kernel_in_lanes(module.kernel.__wrapped__, OF_EQUAL, OF_KERNELS,
                           kernel_hash(Path(module.__file__)), SHARED).address


def is_compiled(path: Path) -> bool:
    """Whether the kernel in a file was compiled for lanes; the file is not imported."""
    return is_kept_in_lanes(path, kernel_hash(path))


def is_compiled_for_equal(path: Path) -> bool:
    """The same of `address_for_equal`."""
    return is_kept_in_lanes(path, kernel_hash(path), SHARED)
