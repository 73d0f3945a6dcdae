"""Kernels compiled for lanes, kept beside those for numbers."""

from collections.abc import Callable
from pathlib import Path

from sebody.compiler.inside.cache import FunctionCache, is_kept
from sebody.compiler.inside.names import CFunc, normalize_signature
from sebody.compiler.inside.pipeline import KernelPasses


class _Own(FunctionCache):
    kind = "lanes"


class _Shared(FunctionCache):
    kind = "shared"


def kernel_in_lanes(function: Callable, signature, options: dict, made_from: str,
                    shared: bool) -> CFunc:
    """A kernel of a signature with lanes; the attribute `address` is that of its machine code."""
    made = CFunc(function, normalize_signature(signature), {}, options, KernelPasses)
    made._cache = (_Shared if shared else _Own)(function, made_from)
    made.compile()
    return made


def is_kept_in_lanes(path: Path, made_from: str, shared: bool) -> bool:
    """Whether the kernel of a file was compiled for lanes; the file is not imported."""
    return is_kept(path, "kernel", made_from, (_Shared if shared else _Own).kind)
