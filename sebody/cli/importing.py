"""``sebody import``: a body file from the files of an FE program."""

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from sebody.errors import InputError

if TYPE_CHECKING:
    from sebody.reduction import Accuracy


def add(commands: argparse._SubParsersAction) -> argparse.ArgumentParser:
    """The parser of the command."""
    parser = commands.add_parser("import", help="make a body file from files of an FE program")
    parser.add_argument("file", type=Path, metavar="FILE",
                        help="one of the program's files; those beside it are found by its name")
    parser.add_argument("--interface", action="append", default=[], metavar="NAME=WHAT",
                        dest="interfaces",
                        help="a boundary node, may be repeated: a node's label, two of them 1/2 "
                             "where rotations have a node of their own, rbe2:SET or rbe3:SET")
    parser.add_argument("--modes", type=int, metavar="N",
                        help="number of internal modes (default 0)")
    parser.add_argument("--accuracy", type=float, metavar="E",
                        help="in place of --modes: as many as this relative error of the dynamic "
                             "stiffness of the interfaces needs, up to the frequency --up-to")
    parser.add_argument("--up-to", type=float, metavar="F", help="end of the band of --accuracy")
    parser.add_argument("--method", default="craig-bampton", metavar="NAME",
                        help="craig-bampton (default), guyan, macneal or rubin")
    parser.add_argument("--format", metavar="NAME", help="kind of the files, guessed by default")
    parser.add_argument("--units", default="", metavar="TEXT", help="units, to be kept in the file")
    parser.add_argument("--unchecked", action="store_true",
                        help="write also reduced matrices that no model would take, for inspect")
    parser.add_argument("--lean", action="store_true",
                        help="leave out shapes and mesh of the FE model, most of the file's size")
    parser.add_argument("--output", type=Path, required=True, metavar="BODY.npz",
                        help="body file to write")
    return parser


def run(options: argparse.Namespace) -> int:
    """Read, reduce, write, and say what was found."""
    from sebody.files import check_target
    from sebody.io.body_file import TARGET, write_body_file
    from sebody.io.importing import imported
    from sebody.io.interfaces import parsed
    from sebody.io.registry import naming, read_source

    check_target(options.output, *TARGET)
    modes = _modes(options)
    interfaces = parsed(options.interfaces)
    file = imported(read_source(options.file, options.format), interfaces, modes, options.method,
                    options.units, options.file)
    with naming(options.file):
        body = None if options.unchecked else file.body()
    if options.lean:
        file.parts["recovery"] = None
    write_body_file(file, options.output)
    for name, text in file.provenance.items():
        print(f"{name}: {text}")
    if body:
        print(body.summary())
    print(f"body: {options.output}, see 'sebody inspect {options.output}'")
    return 0


def _modes(options: argparse.Namespace) -> "int | Accuracy":
    from sebody.reduction import Accuracy

    if (options.accuracy is None) != (options.up_to is None):
        raise InputError("--accuracy and --up-to belong together: give --accuracy 1e-3 --up-to F")
    if options.accuracy is None:
        return options.modes or 0
    if options.modes is not None:
        raise InputError("--accuracy chooses the number of modes: leave out --modes")
    return Accuracy(options.accuracy, options.up_to)
