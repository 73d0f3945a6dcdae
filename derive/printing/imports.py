"""Imports of a kernel file: every name from the module of the runtime that defines it."""

import ast
from collections.abc import Iterable
from functools import cache
from pathlib import Path

from sebody.derive.printing.expressions import WIDTH
from sebody.kernels import layout

MODULES = ("layout", "abi", "dense", "frame_search", "packed_products", "coordinates", "pipeline",
           "rotations")


@cache
def homes() -> dict[str, str]:
    """Module of every public name that kernels may use; the first of `MODULES` that has it."""
    found: dict[str, str] = {}
    for module in MODULES:
        path = Path(layout.__file__).with_name(f"{module}.py")
        for node in ast.parse(path.read_text(encoding="utf-8")).body:
            for name in _defined(node):
                found.setdefault(name, f"sebody.kernels.{module}")
    return {name: module for name, module in found.items() if not name.startswith("_")}


def _defined(node: ast.stmt) -> list[str]:
    if isinstance(node, ast.FunctionDef | ast.ClassDef):
        return [node.name]
    targets = node.targets if isinstance(node, ast.Assign) else []
    return [n.id for target in targets for n in ast.walk(target) if isinstance(n, ast.Name)]


def import_lines(names: Iterable[str]) -> str:
    """Imports of some names in the order of isort, wrapped.

    Raises
    ------
    KeyError
        A name that no module of the runtime defines.
    """
    wanted: dict[str, list[str]] = {}
    for name in sorted(set(names), key=_rank):
        wanted.setdefault(homes()[name], []).append(name)
    lines = []
    for module in sorted(wanted):
        line = f"from {module} import {', '.join(wanted[module])}"
        if len(line) > WIDTH:
            line = "\n".join([f"from {module} import (",
                              *(f"    {name}," for name in wanted[module]), ")"])
        lines.append(line)
    return "\n".join(lines)


def _rank(name: str) -> tuple[int, str]:
    """Constants, then classes, then functions."""
    return (0 if name.isupper() else 1 if name[0].isupper() else 2), name
