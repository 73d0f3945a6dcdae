"""Entry point of the command line."""

import argparse
import sys
from collections.abc import Sequence

from sebody.cli import atlas, bench, chart, check, listing, run, warm
from sebody.errors import InputError

COMMANDS = (run, listing, check, bench, chart, atlas, warm)     # in the order of the help


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command.

    Parameters
    ----------
    arguments : sequence of str, optional
        Those of the process by default.

    Returns
    -------
    int
        0, 1 when a run or a check fails, 2 when the input cannot be used.
    """
    options = _parser().parse_args(arguments)
    try:
        return options.command(options)
    except InputError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2


def _parser() -> argparse.ArgumentParser:
    """Every module of a command has `add`, which makes its parser, and `run`."""
    parser = argparse.ArgumentParser(
        prog="sebody", description="Flexible multibody dynamics with superelements.")
    commands = parser.add_subparsers(required=True, metavar="COMMAND")
    for command in COMMANDS:
        command.add(commands).set_defaults(command=command.run)
    return parser
