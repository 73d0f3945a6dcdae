"""Types whose operations are looked for once in a process: see `lookups`."""

from numba import types

_kinds = [types.Number, types.Boolean, types.RawPointer, types.Array, types.BaseTuple]


def plain(arguments: tuple[types.Type, ...]) -> bool:
    """Tell if operations on some types are remembered."""
    kinds = tuple(_kinds)
    return all(isinstance(kind, kinds) for kind in arguments)


def remember_operations_on(*kinds: type[types.Type]) -> None:
    """Remember operations on types of these kinds, too."""
    _kinds.extend(kinds)
