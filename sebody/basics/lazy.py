"""Packages that load what they offer when it is asked for, so that programs start fast.

A package lists its names as imports under ``if TYPE_CHECKING:``, where editors and type checkers
find them, and calls `load_on_demand`.
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
    """Let a package load names on demand: those it imports under ``if TYPE_CHECKING:``.

    Parameters
    ----------
    package : str
        Its ``__name__``, while it is imported.
    """
    module = sys.modules[package]
    tree = ast.parse(module.__loader__.get_source(package))
    vars(module)["_offered"] = {
        alias.asname or alias.name: statement.module
        for block in tree.body
        if isinstance(block, ast.If) and ast.unparse(block.test) == "TYPE_CHECKING"
        for statement in block.body if isinstance(statement, ast.ImportFrom)
        for alias in statement.names}
    module.__class__ = _Package
