"""Scenes in a user's own files, and errors in them in words that name file and line."""

import ast
import sys
import traceback
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

from sebody.basics.errors import InputError

MODULE = "sebody_scene_file"        # name of the module that a file becomes
REMEDY = "write 'def build() -> Scene' as in examples/hinged_beam.py"


def is_file(scene: str) -> bool:
    """Tell whether a scene is given as a file, not by its name."""
    return scene.endswith(".py")


def load(path: str) -> ModuleType:
    """A file as a module; its folder is searched for what it imports, as by ``python FILE.py``.

    Raises
    ------
    InputError
        The file cannot be read, is no Python, raises an error, or has no function `build`.
    """
    from sebody.basics.files.reading import content

    source = content(path, "scene file", "give the name of a scene or the path of a file",
                     (".py",))
    _refuse_scripts(path, source)
    file = Path(path).resolve()
    module = ModuleType(MODULE)
    module.__file__ = str(file)
    sys.modules[MODULE] = module        # where dataclasses and pickle look for it
    sys.path.insert(0, str(file.parent))
    call(str(file), lambda: exec(compile(source, str(file), "exec", dont_inherit=True),
                                 vars(module)))
    if not callable(getattr(module, "build", None)):
        raise InputError(f"scene file {path} has no function build: {REMEDY}")
    return module


def _refuse_scripts(path: str, source: bytes) -> None:
    """Refuse a file that defines no `build` before anything in it runs.

    Raises
    ------
    InputError
    """
    try:
        statements = list(ast.walk(ast.parse(source)))
    except (SyntaxError, ValueError):
        return                          # told when the file is compiled
    names = {one.name for one in statements
             if isinstance(one, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef)}
    names |= {one.id for one in statements
              if isinstance(one, ast.Name) and isinstance(one.ctx, ast.Store)}
    names |= {alias.asname or alias.name for one in statements
              if isinstance(one, ast.Import | ast.ImportFrom) for alias in one.names}
    if not names & {"build", "*"} and b"globals" not in source:
        raise InputError(f"scene file {path} has no function build: {REMEDY}; 'sebody new {path}' "
                         "writes one to begin with, in a file that is not there yet, and 'python "
                         f"{path}' runs a script")


def call(file: str, function: Callable[[], Any]) -> Any:
    """Call what a file defines; its errors become input errors that name file and line.

    Raises
    ------
    InputError
        The function raises an error or ends the program.
    """
    try:
        return function()
    except SyntaxError as error:
        where = _place(error.filename or file, error.lineno)
        raise InputError(f"{where}: {error.msg}") from error
    except (Exception, SystemExit) as error:
        lines = [frame.lineno for frame in traceback.extract_tb(error.__traceback__)
                 if frame.filename == file]
        what = "" if isinstance(error, InputError) else f"{type(error).__name__}: "
        where = _place(file, lines[-1] if lines else None)
        raise InputError(f"{where}: {what}{error}") from error


def _place(file: str, line: int | None) -> str:
    """File and line in words, the file as short as it can be named from here."""
    path = Path(file)
    shown = path.relative_to(Path.cwd()) if path.is_relative_to(Path.cwd()) else path
    return f"{shown}, line {line}" if line else str(shown)
