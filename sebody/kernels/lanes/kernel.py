"""Kernels compiled for lanes from their own text: for ensembles, or for equal bodies of a model.

Those for most ensembles leave out what they do for matrices, see `sebody.kernels.lanes.text`.
"""

from functools import cache
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
from sebody.kernels.lanes.text import kernel_text
from sebody.kernels.loader import load, takes_one_member

# imported: puts in place what kernels call
CALLED = frame_search, packed_products, products, rotations

_POINTERS = {"int64": types.CPointer(types.int64), "float64": types.CPointer(lanes)}


Own = tuple[str, ...] | None     # parts of the constants in lanes; None: all of them


def module_in_lanes(name: str) -> ModuleType:
    """The kernel that lanes call in the place of one of some name."""
    return member_by_member if takes_one_member(name) else load(name)


@cache
def address_in_lanes(module: ModuleType, own: Own = None, matrices: bool = False) -> int:
    """Address of a kernel for lanes; compiled, or read from the cache, where it is asked for.

    Parameters
    ----------
    own : tuple of str or None
        The parts of the constants that are lanes; all others are numbers that members share.
        None: all constants are lanes.
    matrices : bool
        Whether it makes matrices, too, as equal bodies of a model and some ensembles need it.
    """
    text = module.kernel if module is member_by_member else kernel_text(module, own, matrices)
    return kernel_in_lanes(text, _signature(own is not None), OF_KERNELS,
                           kernel_hash(Path(module.__file__)), _kind(own, matrices)).address


def is_compiled(path: Path, own: Own = None, matrices: bool = False) -> bool:
    """Tell if the kernel in a file was compiled for lanes; the file is not imported."""
    return is_kept_in_lanes(path, kernel_hash(path), _kind(own, matrices))


def _kind(own: Own, matrices: bool) -> str:
    return "-".join(filter(None, ("lanes" if own is None else "shared", *(own or ()),
                                  "matrices" * matrices)))


def _signature(shared: bool) -> types.Type:
    given = [types.CPointer(types.float64) if shared and name == "constants" else _POINTERS[kind]
             for name, kind, _ in ARGUMENTS]
    return types.int64(*[types.int64] * 4, *given)
