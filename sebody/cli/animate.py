"""``sebody animate``: an animation of a saved result."""

import argparse
from pathlib import Path

from sebody.cli.number_arguments import real
from sebody.cli.scene_arguments import check_distinct, default_output


def add(commands: argparse._SubParsersAction) -> argparse.ArgumentParser:
    """The parser of the command."""
    parser = commands.add_parser("animate", help="make an animation of a saved result")
    parser.add_argument("result", metavar="RESULT.npz",
                        help="file written by 'sebody run SCENE --output FILE.npz'")
    parser.add_argument("quantities", nargs="*", metavar="QUANTITY",
                        help="plotted first in the page, written as for 'sebody plot'")
    parser.add_argument("--output", type=Path, metavar="FILE.html",
                        help="a self-contained page; with the ending gif or mp4 a film "
                             "(default: RESULT.html)")
    parser.add_argument("--speed", type=real, metavar="S",
                        help="simulated time per second of playback")
    parser.add_argument("--colour", metavar="QUANTITY",
                        help="initial colours: displacement, von_mises, or body (one colour for "
                             "each body); a page can change it")
    parser.add_argument("--reference", metavar="NODE",
                        help="node from which displacements are measured, or 'frame' for the "
                             "floating frame of each body; default: support or first joint of the "
                             "body")
    return parser


def run(options: argparse.Namespace) -> int:
    """Read the result and write the animation."""
    from sebody.pictures.animation import animate, check_animation
    from sebody.results.result import Result

    output = options.output or default_output(options.result, ".html")
    check_animation(output)
    check_distinct({"--output": output, "RESULT": Path(options.result)})
    animate(Result.load(options.result), output, *options.quantities,
            speed=options.speed, colour=options.colour, reference=options.reference)
    print(f"animation: {output}")
    return 0
