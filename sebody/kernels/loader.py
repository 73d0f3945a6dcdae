"""Find and load generated kernels by name: the shipped ones, then the user's directory."""

import gc
import importlib.util
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from importlib import import_module
from pathlib import Path
from types import ModuleType

from sebody.errors import InputError


def user_directory() -> Path:
    """Where kernels of other layouts go when the package's own folder cannot be written.

    ``SEBODY_KERNELS``, or ``~/.sebody/kernels``.
    """
    return Path(os.environ.get("SEBODY_KERNELS") or Path.home() / ".sebody" / "kernels")


@contextmanager
def without_collector() -> Iterator[None]:
    """No garbage collection: it takes a quarter of a compilation and frees nothing there."""
    collecting = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if collecting:
            gc.enable()


@cache
def load(name: str) -> ModuleType | None:
    """The module of a kernel, compiled (or read from Numba's cache) on import; None if absent."""
    with without_collector():
        return _load(name)


def _load(name: str) -> ModuleType | None:
    try:
        return import_module(f"sebody.generated.{name}")
    except ModuleNotFoundError as error:
        if error.name != f"sebody.generated.{name}":
            raise
    path = user_directory() / f"{name}.py"
    if not path.exists():
        return None
    spec = importlib.util.spec_from_file_location(f"sebody_user_kernels.{name}", path)
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


def superelement_kernel(layout: str, frame: str, inertia: str, modes: int,
                        damped: bool = False) -> ModuleType:
    """The kernel of a layout, frame and inertia option: one for this number of modes, or for any.

    Structural damping has kernels of its own.

    Raises
    ------
    InputError
        If it has not been generated; the message gives the command that makes it.
    """
    d = "d" * damped
    names = [f"superelement_{layout}{pinned}{d}_{frame}_{inertia}".replace("-", "_")
             for pinned in (f"m{modes}", "")]
    module = load(names[0]) or load(names[1])
    if module is None:
        raise InputError(f"there is no kernel for layout {layout + d!r}, frame {frame!r}, inertia "
                         f"{inertia!r}: make it with\n    python -m sebody.derive "
                         f"{layout}{d}:{frame}:{inertia}")
    return module


def element_kernel(name: str) -> ModuleType:
    """The kernel of a joint or load."""
    if name == "user_force":
        return import_module("sebody.kernels.user_force")   # the one kernel that is not generated
    module = load(f"element_{name}")
    if module is None:
        raise InputError(f"there is no kernel for element {name!r}: reinstall sebody or run "
                         "python -m sebody.derive")
    return module
