"""Kernels compiled for lanes, kept beside those for numbers."""

from collections.abc import Callable
from pathlib import Path

from sebody.compiler.inside.cache import FunctionCache, is_kept
from sebody.compiler.inside.names import CFunc, normalize_signature
from sebody.compiler.inside.pipeline import KernelPasses


class _Cache(FunctionCache):
    def __init__(self, function: Callable, made_from: str, kind: str):
        super().__init__(function, made_from)
        self.kind = kind


def kernel_in_lanes(function: Callable, signature, options: dict, made_from: str,
                    kind: str) -> CFunc:
    """A kernel of a signature with lanes; the attribute `address` is that of its machine code.

    Parameters
    ----------
    kind : str
        Of versions of the kernel, in the names of files.
    """
    made = CFunc(function, normalize_signature(signature), {}, options, KernelPasses)
    made._cache = _Cache(function, made_from, kind)
    made.compile()
    return made


def is_kept_in_lanes(path: Path, made_from: str, kind: str) -> bool:
    """Tell if the kernel of a file was compiled for lanes; the file is not imported."""
    return is_kept(path, "kernel", made_from, kind)
