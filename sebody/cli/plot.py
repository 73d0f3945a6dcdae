"""``sebody plot``: histories, phase plots and spectra of saved results."""

import argparse
from pathlib import Path

from sebody.cli.scene_arguments import (
    check_distinct,
    check_picture,
    default_output,
    labelled_results,
)


def add(commands: argparse._SubParsersAction) -> argparse.ArgumentParser:
    """The parser of the command."""
    parser = commands.add_parser(
        "plot", help="plot quantities of one saved result, or compare several results")
    parser.add_argument("result", metavar="RESULT.npz",
                        help="file written by 'sebody run SCENE --output FILE.npz'; its quantities "
                             "are listed by 'sebody list FILE.npz'")
    parser.add_argument("words", nargs="*", metavar="QUANTITY",
                        help="tip.position, tip.position.x, tip.velocity.norm, energy, or "
                             "tip.position.x:y for y over x; further files RESULT.npz are "
                             "compared (default: an overview)")
    parser.add_argument("--spectrum", action="store_true", help="plot power spectral densities")
    parser.add_argument("--output", type=Path, metavar="FILE.png",
                        help="png, svg or pdf (default: RESULT.png)")
    return parser


def run(options: argparse.Namespace) -> int:
    """Read the results and draw."""
    output = options.output or default_output(options.result, ".png")
    check_picture(output)
    from sebody.pictures.drawing import plot
    from sebody.results.saving import OUTPUT

    others = [word for word in options.words if word.endswith(OUTPUT[1])]
    check_distinct({"--output": output, "RESULT": Path(options.result)})
    plot(labelled_results([options.result, *others]),
         *(word for word in options.words if word not in others),
         output=output, spectrum=options.spectrum)
    print(f"picture: {output}")
    return 0
