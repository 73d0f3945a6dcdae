"""Reading and checking of arguments: scenes with their parameters, files to be written."""

import ast
import inspect
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sebody.errors import InputError
from sebody.studies.catalogue import builder

if TYPE_CHECKING:
    from sebody.scenes.scene import Scene


def build_scene(name: str, changes: Sequence[str]) -> "Scene":
    """A scene by name, with parameters given as ``NAME=VALUE``.

    Raises
    ------
    InputError
        An unknown scene or parameter, or a value that cannot be read.
    """
    build = builder(name)
    return build(**_parameters(name, build, changes))


def check_picture(path: Path | None) -> None:
    """Refuse a picture that cannot be written before anything is computed for it."""
    if path:
        from sebody.results import plots

        plots.check_picture(path)


def _parameters(scene: str, build: Callable, changes: Sequence[str]) -> dict[str, Any]:
    """Keyword arguments of a scene, of the type of their defaults."""
    known = inspect.signature(build).parameters
    existing = ", ".join(f"{p.name}={p.default}" for p in known.values()) or "none"
    values = {}
    for change in changes:
        name, equals, text = change.partition("=")
        if not equals:
            raise InputError(f"cannot read --set {change}: write --set NAME=VALUE")
        if name not in known:
            raise InputError(f"scene {scene!r} has no parameter {name!r}: there are {existing}")
        values[name] = _value(name, text, known[name].default)
    return values


def _value(name: str, text: str, default: Any) -> Any:
    if isinstance(default, str):
        return text
    try:
        value = ast.literal_eval(text)
    except (ValueError, SyntaxError):
        value = text
    if isinstance(default, float) and type(value) is int:
        value = float(value)
    if default is None or type(value) is type(default):
        return value
    raise InputError(f"parameter {name} is {text!r}: give a value of type "
                     f"{type(default).__name__}, such as {default}")
