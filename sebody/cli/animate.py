"""``sebody animate``: an animation of a saved result."""

import argparse
from pathlib import Path

from sebody.cli.inputs import check_distinct


def add(commands: argparse._SubParsersAction) -> argparse.ArgumentParser:
    """The parser of the command."""
    parser = commands.add_parser("animate", help="make an animation of a saved result")
    parser.add_argument("result", metavar="RESULT.npz",
                        help="file written by 'sebody run SCENE --output FILE.npz'")
    parser.add_argument("quantities", nargs="*", metavar="QUANTITY",
                        help="what the page plots first, as for 'sebody plot'")
    parser.add_argument("--output", type=Path, metavar="FILE.html", required=True,
                        help="a page that needs nothing else; gif or mp4 for a film")
    parser.add_argument("--speed", type=float, metavar="S",
                        help="simulated time for each second of playing")
    parser.add_argument("--colour", metavar="QUANTITY",
                        help="what bodies are coloured by, in a page at first: displacement, "
                             "von_mises, or body, each in a colour of its own")
    parser.add_argument("--reference", metavar="NODE",
                        help="node that displacements are measured from, or 'frame', the floating "
                             "frame of each body; by default its support or its first joint")
    return parser


def run(options: argparse.Namespace) -> int:
    """Read the result and write the animation."""
    from sebody.results.animation import animate, check_animation
    from sebody.results.result import Result

    check_animation(options.output)
    check_distinct({"--output": options.output, "RESULT": Path(options.result)})
    animate(Result.load(options.result), options.output, *options.quantities,
            speed=options.speed, colour=options.colour, reference=options.reference)
    print(f"animation: {options.output}")
    return 0
