"""``sebody import``: a body file from the files of an FE program."""

import argparse
import sys
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from sebody.basics.errors import InputError
from sebody.cli.number_arguments import real, whole

if TYPE_CHECKING:
    from sebody.reduction.accuracy import Accuracy


def add(commands: argparse._SubParsersAction) -> argparse.ArgumentParser:
    """The parser of the command."""
    parser = commands.add_parser("import", help="make a body file from files of an FE program")
    parser.add_argument("file", type=Path, metavar="FILE",
                        help="one of the files of the FE program; the others are found by name")
    parser.add_argument("--interface", action="append", default=[], metavar="NAME=WHAT",
                        dest="interfaces",
                        help="a boundary node, may be repeated. WHAT is the label of a node, two "
                             "labels 1/2 where rotations are stored at a second node, rbe2:SET or "
                             "rbe3:SET for a node set or surface, or "
                             "'cylinder:x,y,z;axis;radius' for a hole; of a foundation's file, "
                             "which names no place, X Y Z or NAME=@x,y,z")
    parser.parse_known_args = partial(_with_places, parser.parse_known_args)
    parser.add_argument("--path", action="append", default=[], metavar="NODESET", dest="paths",
                        help="a path that nodes of a model will slide along, may be repeated: "
                             "keeps the shapes at its nodes and adds static modes of unit loads "
                             "at 7 of them, in both directions across; NODESET:z in one direction "
                             "of the FE axes, NODESET:5 at 5 of its nodes, NODESET:z:5 both")
    parser.add_argument("--modes", type=whole, metavar="N",
                        help="number of internal modes (default 0)")
    parser.add_argument("--accuracy", type=real, metavar="E",
                        help="instead of --modes: choose the number of modes for this relative "
                             "error up to the frequency --up-to")
    parser.add_argument("--up-to", type=real, metavar="F",
                        help="highest frequency for --accuracy")
    parser.add_argument("--criterion", metavar="NAME",
                        help="error measured by --accuracy: stiffness (dynamic stiffness of the "
                             "interfaces, default), or frequencies (of free vibration only, with "
                             "far fewer modes; default with rubin)")
    parser.add_argument("--method", default="craig-bampton", metavar="NAME",
                        help="craig-bampton (default), guyan, macneal or rubin")
    parser.add_argument("--base", type=real, nargs=3, metavar=("X", "Y", "Z"),
                        help="of reduced matrices of a structure that is held to the ground: a "
                             "place of its base")
    parser.add_argument("--format", metavar="NAME", help="format of the files (default: detected)")
    parser.add_argument("--damping", metavar="D[,D...]",
                        help="damping ratio of the free vibration modes: one for all modes, or "
                             "one for each from the lowest up, the last also for higher modes")
    parser.add_argument("--units", default="", metavar="UNITS",
                        help="units of the numbers, such as 'mm t N s'")
    parser.add_argument("--unchecked", action="store_true",
                        help="write reduced matrices even if models would refuse them, so that "
                             "'sebody inspect' can be used")
    parser.add_argument("--lean", action="store_true",
                        help="omit shapes and mesh of the FE model, most of the file, "
                             "but for the shapes at the nodes of paths")
    parser.add_argument("--compare-free", action="store_true",
                        help="compare free frequencies with those of the FE model without rigid "
                             "faces, which stiffen it; takes another factorization")
    parser.add_argument("--output", type=Path, required=True, metavar="BODY.npz",
                        help="body file to write")
    return parser


def run(options: argparse.Namespace) -> int:
    """Read, reduce, write, and say what was found."""
    from sebody.basics.files import check_target
    from sebody.basics.units import parsed_units
    from sebody.io.body_file import TARGET, lean, write_body_file
    from sebody.io.importing import Wanted, imported
    from sebody.io.interfaces import parsed
    from sebody.io.paths import parsed_paths
    from sebody.io.registry import naming, read_source
    from sebody.reduction.watch import Terminal

    check_target(options.output, *TARGET)
    wanted = Wanted(parsed(options.interfaces), _modes(options), options.method, options.units,
                    _damping(options.damping), options.compare_free, options.base,
                    paths=parsed_paths(options.paths))
    parsed_units(options.units, "--units")
    watch = Terminal()
    try:
        watch.stage(f"reading {options.file}")
        reading = read_source(options.file, options.format)
        file = imported(reading, wanted, options.file, watch)
    finally:
        watch.close()
    with naming(options.file):
        body = None if options.unchecked else file.body()
    if options.lean:
        file = lean(file)
    write_body_file(file, options.output)
    series = getattr(reading.model, "series", None)
    loads = options.output.with_suffix(".csv")
    if series is not None:
        series.to_csv(loads)
    summary = body.summary() if body else ""
    for name, text in file.provenance.items():
        if f"{name}: {text}" not in summary:
            print(f"{name}: {text}")
    if body:
        print(summary)
    for text in file.cautions:
        if body is None or text not in body.cautions:
            print(f"caution: {text}")
    if series is not None:
        print(f"loads: {loads}, see sebody.io.LoadSeries.from_csv")
    print(f"body: {options.output}, see 'sebody inspect {options.output}'")
    return 0


def _with_places(parse: Callable, words: Sequence[str] | None = None, namespace: object = None
                 ) -> tuple[argparse.Namespace, list[str]]:
    """Parse arguments whose ``--interface X Y Z`` stand as ``--interface=interface=@X,Y,Z``."""
    words, made = list(sys.argv[1:] if words is None else words), []
    while words:
        word, *words = words
        if word == "--interface" and len(words) >= 3 and all(map(_is_number, words[:3])):
            word, words = f"--interface=interface=@{','.join(words[:3])}", words[3:]
        made.append(word)
    return parse(made, namespace)


def _is_number(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return True


def _modes(options: argparse.Namespace) -> "int | Accuracy":
    from sebody.reduction.accuracy import Accuracy

    if (options.accuracy is None) != (options.up_to is None):
        raise InputError("--accuracy and --up-to belong together: give --accuracy 1e-3 --up-to F")
    if options.accuracy is None:
        if options.criterion is not None:
            raise InputError("--criterion is that of --accuracy: give --accuracy 1e-3 --up-to F")
        return options.modes or 0
    if options.modes is not None:
        raise InputError("--accuracy chooses the number of modes: leave out --modes")
    return Accuracy(options.accuracy, options.up_to, options.criterion or "")


def _damping(text: str | None) -> float | list[float]:
    if text is None:
        return 0.0
    try:
        ratios = [float(word) for word in text.split(",")]
    except ValueError as error:
        raise InputError(f"--damping is {text!r}: give a ratio, or ratios with commas between, "
                         "such as 0.01 or 0.005,0.01,0.02") from error
    return ratios if len(ratios) > 1 else ratios[0]
