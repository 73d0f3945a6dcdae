"""``sebody list``: scenes and kernels there are; what a scene, a result or a sweep's table has."""

import argparse
import inspect
import re
import textwrap
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from sebody.basics.errors import InputError
from sebody.cli.scene_arguments import described, parameters, source

if TYPE_CHECKING:
    from sebody.explore.sweep.table import Table

RESULTS = ".npz", ".h5"         # files of results


def add(commands: argparse._SubParsersAction) -> argparse.ArgumentParser:
    """The parser of the command."""
    parser = commands.add_parser("list", help="list scenes and kernels, or parameters of a scene")
    parser.add_argument("scene", nargs="?", metavar="SCENE",
                        help="name of a scene or FILE.py: list its parameters; FILE.npz: list the "
                             "quantities of a result, or what a sweep has varied and kept")
    return parser


def run(options: argparse.Namespace) -> int:
    """Print the lists."""
    given = options.scene
    if given and given.endswith(RESULTS):
        _list_file(given)
    elif given and Path(given).suffix not in ("", ".py"):
        there = "there is no such file" if not Path(given).exists() else "it is no file of these"
        raise InputError(f"cannot list {given}: {there}; give the name of a scene, FILE.py, or a "
                         f"result or table of a sweep with the ending {' or '.join(RESULTS)}")
    elif given:
        _list_parameters(given)
    else:
        _list_all()
    return 0


def _list_file(path: str) -> None:
    if path.endswith(RESULTS[0]):
        from sebody.explore.sweep.table import Table

        if Table.is_in(Path(path)):
            return _list_table(Table.load(Path(path)))
    from sebody.results.result import Result

    print("\n".join(Result.load(path).names()))


def _list_table(table: "Table") -> None:
    """Print what a sweep has varied, and its outputs."""
    for name, values in table.parameters.items():
        distinct = dict.fromkeys(values.tolist())
        print(f"{name}: {len(distinct)} values, " + (
            f"{min(values):.6g} to {max(values):.6g}" if values.dtype.kind in "if" else
            ", ".join(map(str, distinct))))
    print(table.summary())


def _list_parameters(scene: str) -> None:
    build, summary, _ = source(scene)
    known, meanings = parameters(build), meanings_of(build)
    print(f"{scene}: {summary}" if summary else scene)
    print("parameters, each with its default: change one by --set NAME=VALUE" if known else
          "it has no parameters")
    width = max((len(described(one)) for one in known.values()), default=0)
    for name, one in known.items():
        print(f"  {described(one):{width}}  {meanings.get(name, '')}".rstrip())


def meanings_of(build: Callable) -> dict[str, str]:
    """Meanings of the parameters of a function, by the section of its docstring (numpydoc)."""
    text = inspect.getdoc(build) or ""
    section = re.search(r"^Parameters\n-+\n(.*?)(?=^\S[^\n]*\n-+$|\Z)", text, re.M | re.S)
    meanings = {}
    for entry in re.findall(r"^(\w[^\n]*)\n((?:[ \n][^\n]*\n?)*)", section[1] if section else "",
                            re.M):
        names, meaning = entry[0].partition(":")[0], " ".join(entry[1].split())
        meanings |= {name.strip(): meaning for name in names.split(",")}
    return meanings


def _list_all() -> None:
    from sebody.catalogue import kernels, scenes
    from sebody.contract.names import ELEMENT

    print("scenes")
    for name, summary in scenes().items():
        print(f"  {name:24} {summary}")
    print("  parameters of a scene: sebody list SCENE; scenes of your own: sebody run FILE.py")
    listed = kernels()
    print("\nsuperelement kernels\n  layout         frame            inertia")
    for kernel in listed:
        if kernel.layout:
            print(f"  {kernel.layout:14} {kernel.frame:16} {kernel.inertia}")
    print("  frame 'node' is the converged_mean kernel with all weight on one node\n"
          "  inertia a: angular velocities in frame axes, b: in material axes,\n"
          "  c: whole displacement field, d: exact rigid-body part and deformation rates\n"
          "  layout any: used for all layouts that are not listed; for a faster or a damped "
          "kernel:\n"
          "  python -m sebody.derive LAYOUT")
    print("\njoints and loads")
    names = ", ".join(k.name.removeprefix(ELEMENT) for k in listed if not k.layout)
    print(textwrap.fill(names, 100, initial_indent="  ", subsequent_indent="  "))
