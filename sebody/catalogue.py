"""The scenes and kernels that exist, found by name without running or compiling them."""

import ast
import re
from collections.abc import Callable
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import NamedTuple

from sebody.basics.spelling import unknown
from sebody.contract.names import PREFIXES, PRODUCTS
from sebody.kernels.loader import user_directory


class Kernel(NamedTuple):
    """A generated kernel as its file describes it."""

    name: str           # of the file and module
    layout: str         # empty for joints and loads
    frame: str
    inertia: str
    size: int           # of its text


def scenes() -> dict[str, str]:
    """Names of the shipped scenes and the first lines of their descriptions."""
    found = {}
    for path in _files("sebody.scenes"):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        if any(isinstance(node, ast.FunctionDef) and node.name == "build" for node in tree.body):
            lines = (ast.get_docstring(tree) or "").splitlines()
            found[path.stem.replace("_", "-")] = lines[0] if lines else ""
    return found


def builder(scene: str) -> Callable:
    """The `build` of a scene.

    Raises
    ------
    InputError
        An unknown scene.
    """
    known = scenes()
    if scene not in known:
        raise unknown("scene", scene, known)
    return import_module(f"sebody.scenes.{scene.replace('-', '_')}").build


def kernel_files() -> dict[str, Path]:
    """Files of the kernels by name; those of the package precede those of the user's directory."""
    return _kernel_files(PREFIXES)


def product_files() -> dict[str, Path]:
    """The same of products with their derivatives, which are compiled for gradients alone."""
    return _kernel_files((PRODUCTS,))


def _kernel_files(prefixes: tuple[str, ...]) -> dict[str, Path]:
    found = {path.stem: path for folder in (sorted(user_directory().glob("*.py")),
                                            _files("sebody.generated")) for path in folder}
    return {name: found[name] for name in sorted(found) if name.startswith(prefixes)}


def kernels() -> list[Kernel]:
    """Kernels as their files describe them."""
    return [_describe(path) for path in kernel_files().values()]


def _describe(path: Path) -> Kernel:
    text = path.read_text(encoding="utf-8")     # of which the whole tree takes 20 ms
    constants = dict(re.findall(r'^(LAYOUT|FRAME|INERTIA) = "(.*)"$', text, re.M))
    return Kernel(path.stem, *(constants.get(k, "") for k in ("LAYOUT", "FRAME", "INERTIA")),
                  len(text))


def _files(package: str) -> list[Path]:
    """Modules of a package, without importing them."""
    folders = find_spec(package).submodule_search_locations
    return sorted(p for folder in folders for p in Path(folder).glob("*.py") if p.stem[0] != "_")
