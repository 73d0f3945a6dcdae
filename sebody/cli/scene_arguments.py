"""Reading and checking of arguments: scenes with their parameters, files to be written."""

import ast
import sys
from collections.abc import Callable, Mapping, Sequence
from inspect import Parameter, getdoc, signature
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any, NamedTuple

from sebody.basics.collector import without_collector
from sebody.basics.errors import InputError
from sebody.cli import scene_files

if TYPE_CHECKING:
    from sebody.results.result import Result
    from sebody.scenes.scene import Scene


class Source(NamedTuple):
    """The source of a scene."""

    build: Callable
    summary: str        # first line of its file's description
    file: str           # empty for a shipped scene


def source(scene: str) -> Source:
    """A shipped scene by its name, or one in a file.

    Raises
    ------
    InputError
        An unknown scene, or a file without one.
    """
    if scene_files.is_file(scene):
        module = scene_files.load(scene)
        return Source(module.build, _first_line(module), module.__file__)
    with without_collector():
        from sebody.catalogue import builder

        build = builder(scene)
    return Source(build, _first_line(sys.modules[build.__module__]), "")


def build_scene(name: str, changes: Sequence[str]) -> "Scene":
    """A scene by name or from a file, with parameters given as ``NAME=VALUE``.

    Raises
    ------
    InputError
        An unknown scene or parameter, a value that cannot be read, or an error in a file.
    """
    build, _, file = source(name)
    arguments = given_arguments(name, build, changes)
    if not file:
        return build(**arguments)
    return checked_scene(scene_files.call(file, lambda: build(**arguments)), name)


def checked_scene(scene: object, name: str) -> "Scene":
    """Scene that the `build` of a file returned, if that is a scene that can be run.

    Raises
    ------
    InputError
        It is none.
    """
    from sebody import Model
    from sebody.basics import inputs
    from sebody.scenes.scene import Scene

    what = f"what build of {name} returned"
    inputs.instance(scene, what, Scene, "return Scene(name, summary, model, h, t_end), from "
                                        "sebody.scenes.scene")
    inputs.instance(scene.model, f"the model of {name}", Model, "give Scene a sebody.Model")
    inputs.number(scene.h, f"h of the scene of {name}", above=0.0)
    inputs.number(scene.t_end, f"t_end of the scene of {name}", least=0.0)
    return scene


def parameters(build: Callable) -> dict[str, Parameter]:
    """Parameters of a scene that can be given by name."""
    return {name: one for name, one in signature(build).parameters.items()
            if one.kind in (Parameter.POSITIONAL_OR_KEYWORD, Parameter.KEYWORD_ONLY)}


def described(parameter: Parameter) -> str:
    """A parameter and its default, as ``--set`` is given it."""
    return parameter.name + ("" if parameter.default is Parameter.empty else
                             f"={parameter.default}")


def check_picture(path: Path | None) -> None:
    """Refuse a picture that cannot be written before anything is computed for it."""
    if path:
        from sebody.pictures import plots

        plots.check_picture(path)


def labelled_results(paths: Sequence[str]) -> "dict[str, Result]":
    """Saved results by the names of their files, by the whole paths where names are the same.

    Raises
    ------
    InputError
        No such file, one that is no result, or one that is given twice.
    """
    from sebody.results.result import Result

    names = [Path(path).stem for path in paths]
    labels = names if len(set(names)) == len(names) else list(paths)
    if len(set(labels)) < len(labels):
        raise InputError(f"results {', '.join(paths)}: one is given twice, leave it out")
    return {label: Result.load(path) for label, path in zip(labels, paths, strict=True)}


def default_output(result: str, ending: str) -> Path:
    """The file of a command that is given no ``--output``: beside its result, of the same name."""
    path = Path(result)
    return path.parent / ((path.stem or "result") + ending)


def check_distinct(targets: Mapping[str, Path | None]) -> None:
    """Refuse two options that name the same file, of which one would replace the other.

    Raises
    ------
    InputError
        They do.
    """
    options_of: dict[Path, str] = {}
    for option, path in targets.items():
        if path and (other := options_of.setdefault(path.resolve(), option)) != option:
            raise InputError(f"{other} and {option} are the same file, {path}: give each its own")


def _first_line(module: ModuleType) -> str:
    return (getdoc(module) or "").partition("\n")[0]


def given_arguments(scene: str, build: Callable, changes: Sequence[str]) -> dict[str, Any]:
    """Keyword arguments of a scene given as ``NAME=VALUE``, of the type of their defaults.

    Raises
    ------
    InputError
        An unknown parameter, one that is missing, or a value that cannot be read.
    """
    known = parameters(build)
    existing = ", ".join(map(described, known.values())) or "none"
    values = {}
    for change in changes:
        name, equals, text = change.partition("=")
        if not equals:
            raise InputError(f"cannot read --set {change}: write --set NAME=VALUE")
        if name not in known:
            raise InputError(f"scene {scene!r} has no parameter {name!r}: there are {existing}")
        values[name] = _value(name, text, known[name].default)
    missing = [name for name, one in known.items()
               if one.default is Parameter.empty and name not in values]
    if missing:
        raise InputError(f"scene {scene!r} needs {', '.join(missing)}: give --set "
                         f"{missing[0]}=VALUE")
    return values


def _value(name: str, text: str, default: Any) -> Any:
    if isinstance(default, str):
        return text
    try:
        value = ast.literal_eval(text)
    except (ValueError, SyntaxError, TypeError, MemoryError, RecursionError):
        value = text
    if isinstance(default, float) and type(value) is int:
        value = float(value)
    if isinstance(default, list | tuple) and isinstance(value, list | tuple):
        value = type(default)(value)
    if default is None or default is Parameter.empty or type(value) is type(default):
        return value
    raise InputError(f"parameter {name} is {text!r}: give a value of type "
                     f"{type(default).__name__}, such as {default}")
