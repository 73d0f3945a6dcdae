"""Entry point of the command line."""

import argparse
import os
import re
import signal
import sys
import warnings
from collections.abc import Sequence
from typing import Any, TextIO

from sebody.basics.errors import InputError, SebodyError
from sebody.cli import (
    advise,
    animate,
    atlas,
    bench,
    blade,
    chart,
    check,
    export,
    importing,
    inspect,
    interrupts,
    listing,
    new,
    plot,
    reducing,
    report,
    run,
    sweep,
    verify,
    warm,
)

# in the order of the help
COMMANDS = (run, sweep, advise, listing, new, plot, animate, report, importing, reducing, blade,
            export, inspect, check, bench, chart, atlas, verify, warm)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command.

    Parameters
    ----------
    arguments : sequence of str, optional
        Those of the process by default.

    Returns
    -------
    int
        0, 1 when a run or a check fails or a file cannot be written, 2 when the input cannot be
        used; 130, 143 and 141 as of a command that Ctrl-C, SIGTERM or a closed pipe has ended.
    """
    _open_streams()
    try:
        try:
            with interrupts.watched(), warnings.catch_warnings():
                warnings.showwarning = _warn
                return _run(arguments)
        finally:
            sys.stdout.flush()          # a closed pipe or full disk may show only here
    except BrokenPipeError:             # of `| head`: there is nobody to tell
        _discard(sys.stdout)            # whether a part of what was printed is lost already or not
        return _mute(interrupts.ENDED_BY + signal.SIGPIPE)
    except OSError as error:
        what = error.filename or "the output cannot be written"
        print(f"error: {what}: {error.strerror}", file=sys.stderr)
        return _mute(1)


def _open_streams() -> None:
    """Let what a closed standard stream would get go nowhere: Python has None in its place."""
    for name in ("stdout", "stderr"):
        if getattr(sys, name) is None:
            setattr(sys, name, open(os.devnull, "w"))


def _run(arguments: Sequence[str] | None) -> int:
    options, others = _parser().parse_known_args(arguments)
    if others:
        options.parser.error(_unrecognized(options.parser, others))
    try:
        return options.command(options)
    except SebodyError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2 if isinstance(error, InputError) else 1
    except MemoryError as error:
        print(f"error: memory ran out{f': {error}' if str(error) else ''}; take a smaller model or "
              "mesh, keep fewer states (--every), or allow more memory", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        return interrupts.exit_code() or interrupts.ENDED_BY + signal.SIGINT


def _warn(message: Warning | str, *where: object) -> None:
    """Show a warning as a line, without the place in the program it comes from."""
    print(f"warning: {message}", file=sys.stderr)


def _mute(code: int) -> int:
    """Let go of what could not be printed; otherwise Python tries again at its end."""
    for stream in (sys.stdout, sys.stderr):
        try:
            stream.flush()
        except OSError:
            _discard(stream)
    return code


def _discard(stream: TextIO) -> None:
    """Let all that is printed from now on go nowhere."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())


class _Version(argparse.Action):
    """Print the version; unlike argparse's own action, look it up only when it is asked for."""

    def __init__(self, *arguments: Any, **options: Any):
        super().__init__(*arguments, nargs=0, **options)

    def __call__(self, parser: argparse.ArgumentParser, *parsed: Any) -> None:
        from sebody import __version__

        print(f"sebody {__version__}")
        parser.exit()


class _Completion(argparse.Action):
    """Print what makes a shell complete commands and options."""

    def __call__(self, parser: argparse.ArgumentParser, namespace: argparse.Namespace,
                 values: Any, option_string: str | None = None) -> None:
        try:
            import shtab
        except ImportError:
            parser.error('completion needs shtab: pip install "sebody[completion]"')
        print(shtab.complete(parser, shell=values))
        parser.exit()


class _Parser(argparse.ArgumentParser):
    """The parser of all commands, which says what was perhaps meant by a word that is none."""

    def error(self, message: str) -> Any:
        chosen = re.match(r"argument COMMAND: invalid choice: '(.*?)'", message)
        if chosen:
            from sebody.basics.spelling import unknown

            known = [name for action in self._actions if isinstance(action.choices, dict)
                     for name in action.choices]
            message = str(unknown("command", chosen[1], known))
        super().error(message)


def _parser() -> argparse.ArgumentParser:
    """Every module of a command has `add`, which makes its parser, and `run`."""
    parser = _Parser(
        prog="sebody", description="Flexible multibody dynamics with superelements.")
    parser.add_argument("--version", action=_Version, help="show the version and exit")
    parser.add_argument("--print-completion", action=_Completion, metavar="SHELL",
                        choices=("bash", "zsh", "tcsh"),
                        help="print what completes commands in bash, zsh or tcsh, and exit")
    commands = parser.add_subparsers(required=True, metavar="COMMAND",
                                     parser_class=argparse.ArgumentParser)
    for command in COMMANDS:
        own = command.add(commands)
        own.set_defaults(command=command.run, parser=own)
    return parser


def _unrecognized(parser: argparse.ArgumentParser, others: list[str]) -> str:
    """The message about arguments that a command does not have."""
    from difflib import get_close_matches

    known = [word for action in parser._actions for word in action.option_strings]
    near = [word for one in others for word in get_close_matches(one.partition("=")[0], known, 1)]
    message = f"unrecognized arguments: {' '.join(others)}"
    if near:
        message += f"; did you mean {' or '.join(dict.fromkeys(near))}?"
    elif "--set" in known and others[0].startswith("--"):
        message += "; parameters of a scene are given by --set NAME=VALUE"
    return message
