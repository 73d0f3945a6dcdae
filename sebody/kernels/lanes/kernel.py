"""Kernels compiled for lanes, from the text they have."""

from functools import cache
from pathlib import Path
from types import ModuleType

from numba import types

from sebody.compiler.decorators import OF_KERNELS
from sebody.compiler.inside.lane_kernels import is_kept_in_lanes, kernel_in_lanes
from sebody.compiler.inside.lanes import lanes
from sebody.compiler.sources import kernel_hash
from sebody.contract.layout import ARGUMENTS

_POINTERS = {"int64": types.CPointer(types.int64), "float64": types.CPointer(lanes)}
SIGNATURE = types.int64(*[types.int64] * 4, *[_POINTERS[kind] for _, kind, _ in ARGUMENTS])


@cache
def address_in_lanes(module: ModuleType) -> int:
    """Address of a kernel for lanes; compiled, or read from the cache, where it is asked for."""
    return kernel_in_lanes(module.kernel.__wrapped__, SIGNATURE, OF_KERNELS,
                           kernel_hash(Path(module.__file__))).address


def is_compiled(path: Path) -> bool:
    """Whether the kernel in a file was compiled for lanes; the file is not imported."""
    return is_kept_in_lanes(path, kernel_hash(path))
