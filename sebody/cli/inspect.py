"""``sebody inspect``: what is in a body file, what is wrong with it, and what to do."""

import argparse
import sys
from pathlib import Path

from sebody.basics.errors import InputError
from sebody.cli.scene_arguments import check_distinct, check_picture


def add(commands: argparse._SubParsersAction) -> argparse.ArgumentParser:
    """The parser of the command."""
    parser = commands.add_parser("inspect", help="check a body file: defects and remedies")
    parser.add_argument("body", type=Path, metavar="BODY.npz", help="a body file")
    parser.add_argument("--output", type=Path, metavar="FILE.png",
                        help="draw surface, interfaces and free vibration modes")
    parser.add_argument("--json", action="store_true", help="print JSON instead of text")
    parser.add_argument("--repair", choices=["rigid-modes"],
                        help="project the stiffness so that rigid-body motion causes no force")
    parser.add_argument("--save", type=Path, metavar="FILE.npz",
                        help="file for the repaired body")
    return parser


def run(options: argparse.Namespace) -> int:
    """Inspect, perhaps repair; 1 if the body has a defect."""
    from sebody.basics.files import check_target
    from sebody.explore import inspection
    from sebody.io.body_file import TARGET, read_body_file, write_body_file

    check_picture(options.output)
    if bool(options.repair) != bool(options.save):
        raise InputError("--repair and --save belong together: give --repair rigid-modes --save "
                         "FILE.npz")
    if options.save:
        check_target(options.save, *TARGET)
    check_distinct({"--output": options.output, "--save": options.save})
    file = read_body_file(options.body)
    said = []
    if options.repair:
        file, said = inspection.free_rigid_motion(file)
    found = inspection.inspect(file)
    if options.save:
        write_body_file(file, options.save)
        said.append(f"repaired body: {options.save}")
    if options.output:
        from sebody.explore.inspection.draw import draw

        draw(file, found.body, found.numbers["centre"], options.output)
        said.append(f"picture: {options.output}")
    print(inspection.to_json(found) if options.json else inspection.report(found))
    for line in said:
        print(line, file=sys.stderr if options.json else sys.stdout)
    return 0 if found.usable else 1
