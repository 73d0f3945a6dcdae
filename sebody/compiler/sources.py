"""Hashes of the sources that compiled code depends on, without comments and docstrings."""

import ast
from collections.abc import Callable
from functools import cache
from hashlib import sha256
from pathlib import Path

from sebody.compiler import store

PACKAGE = Path(__file__).parents[1]
CONTRACT, COMPILER, KERNELS, ENGINE = "contract", "compiler", "kernels", "engine"
TEXT = CONTRACT, KERNELS                    # what the text of a kernel depends on
KERNEL_CODE = CONTRACT, COMPILER, KERNELS   # what the machine code of a kernel depends on
CODE = *KERNEL_CODE, ENGINE                 # and that of the loop
_DIGITS = 12


@cache
def folder_hash(*folders: str) -> str:
    """Hash of the syntax of all modules of some folders of the package, constants included.

    Parameters
    ----------
    *folders : str
        Folders below ``sebody/``, such as ``"kernels"``.

    Raises
    ------
    FileNotFoundError
        A folder without modules: stale compiled code would not be noticed.
    """
    paths = []
    for folder in folders:
        files = sorted((PACKAGE / folder).rglob("*.py"))
        if not files:
            raise FileNotFoundError(f"{PACKAGE / folder} holds no modules: its hash would be empty")
        paths += files
    return _syntax_hash("-".join(folders), *paths)


def in_folder(function: Callable, folder: str) -> bool:
    """Tell if a function is written in a folder of the package."""
    return _is_in_folder(function.__code__.co_filename, folder)


@cache      # of the two hundred functions that a run needs many are in one module
def _is_in_folder(path: str, folder: str) -> bool:
    return Path(path).is_relative_to(PACKAGE / folder)


def function_hash(function: Callable) -> str:
    """Hash of all sources that a compiled function of the runtime may depend on.

    Functions in ``kernels/`` call each other; all others call ``kernels/``, ``engine/`` and the
    modules of their own folder that have compiled functions.
    """
    if in_folder(function, KERNELS):
        return folder_hash(*KERNEL_CODE)
    if in_folder(function, ENGINE):
        return folder_hash(*CODE)
    path = Path(function.__code__.co_filename)
    return f"{folder_hash(*CODE)} {_syntax_hash(path.stem, path, *_neighbours(path))}"


@cache
def _neighbours(path: Path) -> list[Path]:
    """Other modules of a folder that have compiled functions."""
    return [one for one in sorted(path.parent.glob("*.py"))
            if one != path and b"@compiled" in one.read_bytes()]


def kernel_hash(path: Path) -> str:
    """Hash of all sources that a kernel may depend on: what it calls, and its own file."""
    # byte by byte: nobody edits the comments of generated files, and parsing these takes long
    return f"{folder_hash(*KERNEL_CODE)} {sha256(path.read_bytes()).hexdigest()[:_DIGITS]}"


@cache
def _syntax_hash(name: str, *paths: Path) -> str:
    """Hash of the syntax of modules; kept in a file, because parsing takes 0.07 s."""
    texts = {_place(path): path.read_bytes() for path in paths}
    parser = Path(__file__).read_bytes()
    content = sha256(repr((texts, parser)).encode()).hexdigest()
    for kept in store.read(paths[0], f"{name}.sources", content):
        return kept.decode()
    described = repr({place: syntax(text) for place, text in texts.items()})
    made = sha256(described.encode()).hexdigest()[:_DIGITS]
    store.write(paths[0], f"{name}.sources", content, made.encode())
    return made


def _place(path: Path) -> str:
    """A module by where it is in the package: compiled code of a moved one names the old module."""
    if path.is_relative_to(PACKAGE):
        return path.relative_to(PACKAGE).as_posix()
    return f"{path.parent.name}/{path.name}"


def syntax(text: str | bytes) -> str:
    """The syntax tree of a module as text, the same for every version of Python.

    Empty fields are left out, since new versions of Python add some; so are docstrings.
    """
    return _described(ast.parse(text))


def _described(node: object) -> str:
    if isinstance(node, list):
        return "[" + ",".join(map(_described, node)) + "]"
    if not isinstance(node, ast.AST):
        return repr(node)
    fields = []
    for name in node._fields:
        value = getattr(node, name, None)
        if name == "body" and isinstance(value, list) and _is_docstring(node, value):
            value = value[1:]
        if value is not None and value != []:
            fields.append(f"{name}={_described(value)}")
    return f"{type(node).__name__}({','.join(fields)})"


def _is_docstring(node: ast.AST, body: list) -> bool:
    scopes = ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef
    return (isinstance(node, scopes) and bool(body) and isinstance(body[0], ast.Expr)
            and isinstance(body[0].value, ast.Constant) and isinstance(body[0].value.value, str))
