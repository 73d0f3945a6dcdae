"""``sebody blade``: body files of a blade from the files of OpenFAST's module BeamDyn."""

import argparse
from pathlib import Path

from sebody.basics.errors import InputError
from sebody.cli.number_arguments import whole

FINE = 8        # elements of a body where none are given, and twice the modes at least


def add(commands: argparse._SubParsersAction) -> argparse.ArgumentParser:
    """The parser of the command."""
    parser = commands.add_parser("blade", help="make body files of a blade from BeamDyn's files")
    parser.add_argument("file", type=Path, metavar="FILE",
                        help="the primary input file of BeamDyn, beside the blade file it names")
    parser.add_argument("--bodies", type=whole, default=1, metavar="N",
                        help="superelements from root to tip (default 1)")
    parser.add_argument("--modes", type=whole, default=6, metavar="N",
                        help="internal modes of each (default 6)")
    parser.add_argument("--elements", type=whole, metavar="N",
                        help="finite elements of the whole blade, a multiple of the bodies "
                             "(default: eight a body or more)")
    parser.add_argument("--divide", default="rotation", metavar="HOW",
                        help="rotation: bodies turn equally under a load at the tip (default); "
                             "length: they are equally long")
    parser.add_argument("--output", type=Path, nargs="+", required=True, metavar="BODY.npz",
                        help="body files to write from root to tip, one for each body; of one name "
                             "for several bodies BODY-1.npz, BODY-2.npz and so on")
    return parser


def run(options: argparse.Namespace) -> int:
    """Read, divide, reduce, write, and say what was found."""
    from sebody import Model
    from sebody.basics.files import check_target
    from sebody.io import read_beamdyn, save_body
    from sebody.io.body_file import TARGET

    targets = _targets(options.output, options.bodies)
    for target in targets:
        check_target(target, *TARGET)
    blade = read_beamdyn(options.file)
    model = Model(units=blade.units)
    root, tip = (model.node(name, blade.axis.position(place))
                 for name, place in (("root", 0.0), ("tip", 1.0)))
    elements = options.elements or options.bodies * max(FINE, 2 * options.modes)
    model.beam("blade", (root, tip), blade.section, elements, options.bodies, options.modes,
               axis=blade.axis, divide=options.divide)
    beam = model.beams[-1]
    print(f"blade: {blade.source}, {len(blade.section.places)} stations, "
          f"{blade.axis.length:.6g} m, {blade.mass:.6g} kg")
    for caution in blade.cautions:
        print(f"caution: {caution}")
    for k, (part, target) in enumerate(zip(beam.parts, targets, strict=True)):
        first, last = beam.places[k], beam.places[k + 1]
        provenance = {"source": blade.source, "method":
                      f"{elements // options.bodies} elements by exact flexibility, "
                      f"{options.modes} modes",
                      "part": f"{first:.6g} to {last:.6g} of the length"}
        save_body(part.reduced, target, ("root", "tip") if options.bodies == 1 else
                  (f"end {k}", f"end {k + 1}"), units=blade.units, provenance=provenance)
        print(f"body: {target}, {first:.4g} to {last:.4g} of the length, mass "
              f"{part.reduced.total_mass:.6g} kg, see 'sebody inspect {target}'")
    return 0


def _targets(given: list[Path], bodies: int) -> list[Path]:
    """One file for each body."""
    if len(given) == 1 and bodies > 1:
        return [given[0].with_name(f"{given[0].stem}-{k + 1}{given[0].suffix}")
                for k in range(bodies)]
    if len(given) != bodies or len(set(given)) != bodies:
        raise InputError(f"--output names {len(given)} files and there are {bodies} bodies: give "
                         "one name, which is numbered, or a different one for each body")
    return given
