"""``sebody reduce``: a body file from the model of a scene."""

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from sebody.basics.errors import InputError
from sebody.cli.number_arguments import real, whole
from sebody.cli.scene_arguments import build_scene

if TYPE_CHECKING:
    from sebody.reduction.accuracy import Accuracy


def add(commands: argparse._SubParsersAction) -> argparse.ArgumentParser:
    """The parser of the command."""
    parser = commands.add_parser("reduce", help="make a body file from the model of a scene, "
                                                "with its joints and springs, at rest")
    parser.add_argument("scene", metavar="SCENE", help="name of a scene or a file, FILE.py")
    parser.add_argument("--set", action="append", default=[], metavar="NAME=VALUE",
                        dest="changes", help="change a parameter of the scene; may be repeated")
    parser.add_argument("--interfaces", nargs="+", required=True, metavar="NODE",
                        help="nodes of the model that the body is on; NODE:translation or "
                             "NODE:rotation keeps that alone")
    parser.add_argument("--modes", type=whole, metavar="N",
                        help="number of internal modes (default: all)")
    parser.add_argument("--accuracy", type=real, metavar="E",
                        help="instead of --modes: choose the number of modes for this relative "
                             "error of the dynamic stiffness up to the frequency --up-to")
    parser.add_argument("--up-to", type=real, metavar="F",
                        help="highest frequency for --accuracy")
    parser.add_argument("--as-built", action="store_true",
                        help="reduce the model as built, not its equilibrium")
    parser.add_argument("--lean", action="store_true",
                        help="omit shapes and meshes of the bodies inside, most of the file")
    parser.add_argument("--output", type=Path, required=True, metavar="BODY.npz",
                        help="body file to write")
    return parser


def run(options: argparse.Namespace) -> int:
    """Reduce, write, and say what was made."""
    from sebody.basics.files import check_target
    from sebody.explore.assemblies.reducing import reduce_model
    from sebody.io.body_file import TARGET, save_body

    check_target(options.output, *TARGET)
    interfaces = _interfaces(options.interfaces)
    modes = _modes(options)
    scene = build_scene(options.scene, options.changes)
    body = reduce_model(scene.model, interfaces, modes, preload=not options.as_built)
    provenance = {"scene": " ".join([options.scene, *options.changes]), "reduced by": "sebody "
                  "reduce"} | {f"interface {name}": f"node {name}" for name in interfaces}
    save_body(body, options.output, tuple(interfaces), provenance=provenance,
              recovery=not options.lean)
    print(body.summary())
    print(f"body: {options.output}, see 'sebody inspect {options.output}'")
    return 0


def _interfaces(words: list[str]) -> dict[str, str | None]:
    """Nodes by name, and what each is to keep."""
    found: dict[str, str | None] = {}
    for word in words:
        name, colon, keep = word.rpartition(":")
        name, keep = (name, keep) if colon and keep in ("full", "translation", "rotation") else (
            word, "")
        if name in found:
            raise InputError(f"--interfaces names {name} twice: leave one out")
        found[name] = keep or None
    return found


def _modes(options: argparse.Namespace) -> "int | Accuracy | None":
    from sebody.reduction.accuracy import Accuracy

    if (options.accuracy is None) != (options.up_to is None):
        raise InputError("--accuracy and --up-to belong together: give --accuracy 1e-3 --up-to F")
    if options.accuracy is None:
        return options.modes
    if options.modes is not None:
        raise InputError("--accuracy chooses the number of modes: leave out --modes")
    return Accuracy(options.accuracy, options.up_to)
