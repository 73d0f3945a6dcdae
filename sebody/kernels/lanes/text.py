"""Texts of kernels as they are compiled for lanes.

Most ensembles make matrices one by one: what a kernel does for matrices, most of its text, is left
out for these. Kernels for matrices of eight members, or of equal bodies of a model, keep it.
"""

import ast
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from types import ModuleType

from sebody.compiler.inside.lanes import lanes_at

_IN_LANES = "{}_in_lanes"


def kernel_text(module: ModuleType, own: tuple[str, ...], matrices: bool) -> Callable:
    """The kernel of a module.

    Parameters
    ----------
    own : tuple of str
        Parts of its constants whose first number is the address of lanes, which are read in place
        of the part.
    matrices : bool
        Whether the kernel keeps what it does for matrices.
    """
    path = Path(module.__file__)
    found = next(one for one in _parsed(path).body
                 if isinstance(one, ast.FunctionDef) and one.name == "kernel")
    found.decorator_list = []
    text = ast.Module([_InLanes(found, own, matrices, _parts(module)).visit(found)], [])
    names = {**vars(module), lanes_at.__name__: lanes_at}
    exec(compile(ast.fix_missing_locations(text), str(path), "exec"), names)
    return names["kernel"]


@cache
def read_parts(module: ModuleType) -> frozenset[str]:
    """Parts of the constants that a kernel reads; of others it only finds what follows them."""
    text, parts = _parsed(Path(module.__file__)), _parts(module)
    names = [name for name in ast.walk(text) if isinstance(name, ast.Name)]
    passed = {id(name) for name in _followed(text, parts)}
    found = {name.id for name in names if isinstance(name.ctx, ast.Store)}
    read = {name.id for name in names if isinstance(name.ctx, ast.Load) and id(name) not in passed}
    return frozenset(part for part in parts if part in read or part not in found)


def _parts(module: ModuleType) -> set[str]:
    return {part.name for part in module.CONSTANTS}


def _parsed(path: Path) -> ast.Module:
    return ast.parse(path.read_text(encoding="utf-8"))


def _followed(text: ast.AST, parts: set[str]) -> Iterator[ast.Name]:
    """Parts in ``M = at(S, ...)``, where the place of a part is computed from that of another."""
    for one in ast.walk(text):
        if (isinstance(one, ast.Assign) and getattr(one.targets[0], "id", None) in parts
                and isinstance(one.value, ast.Call) and isinstance(one.value.func, ast.Name)
                and one.value.func.id == "at" and isinstance(one.value.args[0], ast.Name)):
            yield one.value.args[0]


class _InLanes(ast.NodeTransformer):
    """Leaves out what is done for matrices, if asked; reads some of the constants from lanes."""

    def __init__(self, text: ast.AST, own: tuple[str, ...], matrices: bool, parts: set[str]):
        self._own, self._matrices = own, matrices
        self._followed = {id(name) for name in _followed(text, parts)}

    def visit_If(self, branch: ast.If) -> ast.AST | None:  # noqa: N802  of Python
        """Leave out ``if task == TANGENT``."""
        if not self._matrices and ast.unparse(branch.test) == "task == TANGENT":
            assert not branch.orelse, "what is left out has no other branch"
            return None
        return self.generic_visit(branch)

    def visit_Assign(self, one: ast.Assign) -> ast.AST | list[ast.AST]:  # noqa: N802
        """Find the lanes of a part where its own place is found."""
        self.generic_visit(one)
        name = getattr(one.targets[0], "id", None)
        if name not in self._own:
            return one
        found = ast.parse(f"{_IN_LANES.format(name)} = {lanes_at.__name__}({name})").body[0]
        return [one, ast.copy_location(found, one)]

    def visit_Name(self, name: ast.Name) -> ast.AST:  # noqa: N802
        """Read the lanes of a part."""
        if name.id in self._own and isinstance(name.ctx, ast.Load) and (
                id(name) not in self._followed):
            name.id = _IN_LANES.format(name.id)
        return name
