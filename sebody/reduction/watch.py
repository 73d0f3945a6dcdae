"""Remarks of a long reduction on its own progress."""

import sys
from collections.abc import Callable
from time import monotonic
from typing import Any

from sebody.basics import inputs


class Watch:
    """Stages of the work, and remarks that are to stay; both are lost by default."""

    def stage(self, text: str) -> None:
        """Tell the stage that begins now."""

    def remark(self, text: str) -> None:
        """Tell a user something before the reduction is done."""

    def close(self) -> None:
        """There are no further messages."""


SILENT = Watch()
_QUIET = 10.0       # seconds without a line in a file


class Terminal(Watch):
    """Remarks on standard error, and stages: on a terminal on one line that changes.

    In a file a stage has a line of its own if none was written for ten seconds.
    """

    def __init__(self) -> None:
        self._shows = sys.stderr.isatty()
        self._width = 0
        self._written = monotonic()

    def stage(self, text: str) -> None:
        """Replace the line, or write another one."""
        if self._shows:
            print("\r" + text.ljust(self._width), end="", file=sys.stderr, flush=True)
            self._width = len(text)
        elif monotonic() - self._written > _QUIET:
            self.remark(text)

    def remark(self, text: str) -> None:
        """A line of its own."""
        self.close()
        print(text, file=sys.stderr, flush=True)
        self._written = monotonic()

    def close(self) -> None:
        """Take the line of stages away."""
        if self._width:
            print("\r" + " " * self._width + "\r", end="", file=sys.stderr, flush=True)
            self._width = 0


class _Calls(Watch):
    """Stages and remarks as calls of a function."""

    def __init__(self, function: Callable[[str], Any]) -> None:
        self.stage = self.remark = function


def watching(progress: Callable[[str], Any] | bool | Watch | None) -> Watch:
    """Watch of a reduction: a function of a text, the terminal for True, nothing for None.

    Raises
    ------
    InputError
        Anything else.
    """
    if isinstance(progress, Watch):
        return progress
    if progress is None or progress is False:
        return SILENT
    if progress is True:
        return Terminal()
    return _Calls(inputs.function(progress, "progress",
                                  "give a function of a text, or True for lines"))
