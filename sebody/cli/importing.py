"""``sebody import``: a body file from the files of an FE program."""

import argparse
from pathlib import Path


def add(commands: argparse._SubParsersAction) -> argparse.ArgumentParser:
    """The parser of the command."""
    parser = commands.add_parser("import", help="make a body file from files of an FE program")
    parser.add_argument("file", type=Path, metavar="FILE",
                        help="one of the program's files; those beside it are found by its name")
    parser.add_argument("--interface", action="append", default=[], metavar="NAME=WHAT",
                        dest="interfaces",
                        help="a boundary node, may be repeated: a node's label, two of them 1/2 "
                             "where rotations have a node of their own, rbe2:SET or rbe3:SET")
    parser.add_argument("--modes", type=int, default=0, metavar="N",
                        help="number of internal modes (default 0)")
    parser.add_argument("--format", metavar="NAME", help="kind of the files, guessed by default")
    parser.add_argument("--units", default="", metavar="TEXT", help="units, to be kept in the file")
    parser.add_argument("--output", type=Path, required=True, metavar="BODY.npz",
                        help="body file to write")
    return parser


def run(options: argparse.Namespace) -> int:
    """Read, reduce, write, and say what was found."""
    from sebody.files import check_target
    from sebody.io.body_file import TARGET, write_body_file
    from sebody.io.importing import imported
    from sebody.io.interfaces import parsed
    from sebody.io.registry import read_source

    check_target(options.output, *TARGET)
    interfaces = parsed(options.interfaces)
    file = imported(read_source(options.file, options.format), interfaces, options.modes,
                    units=options.units, path=options.file)
    file.body()
    write_body_file(file, options.output)
    for name, text in file.provenance.items():
        print(f"{name:20} {text}")
    print(f"{'body':20} {options.output}")
    return 0
