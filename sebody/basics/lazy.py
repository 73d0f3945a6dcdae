"""Packages that load what they offer when it is asked for, so that programs start fast.

A package lists its names once, as imports under ``if TYPE_CHECKING:``, and calls `load_on_demand`.
Names are imported ``as`` themselves, by which type checkers know them as names for users (PEP 484).
"""

import ast
import sys
from importlib import import_module
from types import ModuleType

from sebody.basics.collector import without_collector


class _Package(ModuleType):
    """A package whose names are loaded at first use (PEP 562).

    A submodule with the name of a function, such as ``sebody.pictures.report``, does not hide it,
    although the import system sets every submodule as an attribute of its package.
    """

    _offered: dict[str, str]        # full names of modules by names

    def __getattr__(self, name: str) -> object:
        if name not in self._offered:
            raise AttributeError(f"module {self.__name__!r} has no attribute {name!r}")
        with without_collector():
            value = vars(self)[name] = getattr(import_module(self._offered[name]), name)
        return value

    def __setattr__(self, name: str, value: object) -> None:
        if not (name in self._offered and isinstance(value, ModuleType)):
            super().__setattr__(name, value)

    def __dir__(self) -> list[str]:
        return sorted({*vars(self), *self._offered})


def load_on_demand(package: str) -> None:
    """Let a package load names on demand, and offer them: those under ``if TYPE_CHECKING:``.

    They are its ``__all__``, too, but for such as ``__version__``.

    Parameters
    ----------
    package : str
        Its ``__name__``, while it is imported.
    """
    module = sys.modules[package]
    tree = ast.parse(module.__loader__.get_source(package))
    offered = {alias.name: statement.module
               for block in tree.body
               if isinstance(block, ast.If) and ast.unparse(block.test) == "TYPE_CHECKING"
               for statement in block.body if isinstance(statement, ast.ImportFrom)
               for alias in statement.names}
    vars(module).update(_offered=offered,
                        __all__=sorted(name for name in offered if not name.startswith("__")))
    module.__class__ = _Package
