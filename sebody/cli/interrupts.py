"""Ctrl-C and SIGTERM: they end a command at once, but not while it has results to keep.

Python raises `KeyboardInterrupt` wherever it is, perhaps between a run and the saving of its
results. In `held` the signal is only noted: the run asks for it between two steps (`look`), and
what follows, saving, is not disturbed.
"""

import signal
from collections.abc import Iterator
from contextlib import contextmanager

SIGNALS = (signal.SIGINT, signal.SIGTERM)
ENDED_BY = 128          # a shell's exit code of a command that a signal ended, less its number

_arrived: list[int] = []
_holding: list[bool] = []


@contextmanager
def watched() -> Iterator[None]:
    """Signals are treated as above; those that the process was started to ignore are ignored."""
    _arrived.clear()
    before = {number: signal.getsignal(number) for number in SIGNALS}
    for number, handler in before.items():
        if handler is not signal.SIG_IGN:
            signal.signal(number, _note)
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


@contextmanager
def held() -> Iterator[None]:
    """Signals raise no exception but in `look`."""
    _holding.append(True)
    try:
        yield
    finally:
        _holding.pop()


def look() -> None:
    """Raise `KeyboardInterrupt` if a signal has arrived."""
    if _arrived:
        raise KeyboardInterrupt


def exit_code() -> int:
    """The exit code of a command that a signal has ended; 0 if none has arrived."""
    return ENDED_BY + _arrived[0] if _arrived else 0


def _note(number: int, frame: object) -> None:
    _arrived.append(number)
    if not _holding:
        raise KeyboardInterrupt
