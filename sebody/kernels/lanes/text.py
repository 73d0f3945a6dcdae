"""Texts of kernels as they are compiled for lanes.

Most ensembles make matrices one by one: what a kernel does for matrices, most of its text, is left
out for these. Kernels for matrices of eight members, or of equal bodies of a model, keep it.
"""

import ast
from collections.abc import Callable, Collection, Iterator
from functools import cache
from pathlib import Path
from types import ModuleType

from sebody.compiler.inside.lanes import lanes_at
from sebody.kernels.dense import add_block_times
from sebody.kernels.lanes.constant_products import add_straight_times, straight_times

_IN_LANES = "{}_in_lanes"
# products of constant matrices that straight code makes where all members share them
_TIMES, _ALL, _MORE = "columns_times", "columns_times_all", "add_blocks_times"


def kernel_text(module: ModuleType, own: tuple[str, ...] | None, matrices: bool) -> Callable:
    """The kernel of a module.

    Parameters
    ----------
    own : tuple of str or None
        Parts of its constants whose first number is the address of lanes, which are read in place
        of the part. None if all constants are lanes.
    matrices : bool
        Whether the kernel keeps what it does for matrices.
    """
    path = Path(module.__file__)
    found = next(one for one in _parsed(path).body
                 if isinstance(one, ast.FunctionDef) and one.name == "kernel")
    found.decorator_list = []
    found = _InLanes(found, own or (), matrices, _parts(module)).visit(found)
    text = ast.Module([_Straight(straight_parts(module, own, matrices)).visit(found)], [])
    names = {**vars(module), **{one.__name__: one for one in (
        lanes_at, straight_times, add_straight_times, add_block_times)}}
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


@cache
def straight_parts(module: ModuleType, own: tuple[str, ...] | None, matrices: bool
                   ) -> frozenset[str]:
    """Matrices among the constants whose products are straight code; arguments of `kernel_text`.

    Those in padded columns that members share, and that nothing else reads. The first number of
    such a part is the address of an array of the addresses of its code.
    """
    if own is None or matrices:
        return frozenset()
    text, columns = _parsed(Path(module.__file__)), {
        part.name for part in module.CONSTANTS if part.columns} - {*own}
    text = _InLanes(text, (), matrices, set()).visit(text)
    passed = {id(name) for name in _followed(text, _parts(module))} | {
        id(call.args[0]) for call in ast.walk(text) if _is_straight(call, columns)}
    read = {name.id for name in ast.walk(text) if isinstance(name, ast.Name)
            and isinstance(name.ctx, ast.Load) and id(name) not in passed}
    return frozenset(call.args[0].id for call in ast.walk(text)
                     if _is_straight(call, columns - read))


def _is_straight(call: ast.AST, parts: Collection[str]) -> bool:
    return (isinstance(call, ast.Call) and getattr(call.func, "id", None) in (_TIMES, _ALL, _MORE)
            and getattr(call.args[0], "id", None) in parts)


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


class _Straight(ast.NodeTransformer):
    """Calls straight code for the products of some matrices."""

    def __init__(self, parts: Collection[str]):
        self._parts = parts

    def visit_Expr(self, one: ast.Expr) -> ast.AST | list[ast.AST]:  # noqa: N802  of Python
        """A product is a statement; one of several products becomes several."""
        call = one.value
        if not _is_straight(call, self._parts):
            return one
        if call.func.id == _TIMES:
            return _called(one, straight_times, call.args[:4])
        if call.func.id == _ALL:
            A, x, y, z, of_x, of_y, of_z, rows, _ = call.args
            return [_called(one, straight_times, [A, given, out, rows])
                    for given, out in ((x, of_x), (y, of_y), (z, of_z))]
        A, x, B, y, out, rows, _, columns, height = call.args
        return [_called(one, add_straight_times, [A, x, out]),
                _called(one, add_block_times, [B, y, out, rows, columns, height])]


def _called(one: ast.Expr, function: Callable, arguments: list[ast.expr]) -> ast.Expr:
    call = ast.Call(ast.Name(function.__name__, ast.Load()), arguments, [])
    return ast.copy_location(ast.Expr(call), one)
