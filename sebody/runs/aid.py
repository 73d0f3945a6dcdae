"""The loop as Python runs it, and its aid: factors with row exchanges, readings of sensors."""

import weakref
from collections.abc import Callable, Sequence
from ctypes import CFUNCTYPE, c_int64, c_void_p, cast
from typing import Protocol

from sebody.engine import loop
from sebody.engine.aid import ADDRESS
from sebody.engine.row_exchanges import Exchanges, exchange
from sebody.engine.sparse_lu import ROOM
from sebody.engine.state import READINGS, Record, Scheme, State
from sebody.engine.system import System

_AID = CFUNCTYPE(c_int64, c_int64, c_int64)     # takes Python's lock


class Aid:
    """Gives a loop what it asks for.

    What is raised meanwhile is raised again by `check`, once the loop has returned. A Ctrl-C is
    noted, and the loop gets what it asked for nevertheless: it returns soon.

    Parameters
    ----------
    runs : sequence of (System, State)
        Their number is the context that they ask in.
    read : callable
        Sets the readings of sensors.
    """

    def __init__(self, runs: Sequence[tuple[System, State]], read: Callable[[], None]):
        self._runs, self._read = runs, read
        self._exchanges: dict[int, Exchanges] = {}
        self._raised: BaseException | None = None
        own = weakref.ref(self)             # no circle: runs are large

        def serve(context: int, what: int) -> int:
            aid = own()
            return 1 if aid is None else aid._serve(context, what)
        self._function = _AID(serve)

    @classmethod
    def of(cls, system: System, state: State, read: Callable[[], None]) -> "Aid":
        """The aid of a single run, whose system gets the address: its `aid` is its own."""
        aid = cls([(system, state)], read)
        system.aid[ADDRESS] = aid.address
        return aid

    @property
    def address(self) -> int:
        """Address of the function that the loop calls."""
        return cast(self._function, c_void_p).value or 0

    def forget(self) -> None:
        """Forget factors: another state was put in place of the one they are of."""
        self._exchanges.clear()

    def check(self) -> None:
        """Raise what was raised in the loop."""
        if self._raised is not None:
            raised, self._raised = self._raised, None
            raise raised

    def _serve(self, run: int, what: int) -> int:
        while True:
            try:
                if what == READINGS:
                    self._read()
                else:
                    self._exchange(run, what)
                return 0
            except KeyboardInterrupt as interrupt:
                self._raised = interrupt
            except BaseException as error:      # ctypes would print it and go on
                self._raised = error
                return 1

    def _exchange(self, run: int, what: int) -> None:
        system, state = self._runs[run]
        own = self._exchanges.get(run) or _room(system, 0)
        while exchange(system, state, own, what) == ROOM:
            own = _room(system, int(own.kind[1]))
        self._exchanges[run] = own


def _room(system: System, entries: int) -> Exchanges:
    return Exchanges.of(system.diagonal.size, system.rows.size, entries)


class Run(Protocol):
    """The parts of a run that the loop is given."""

    system: System
    state: State
    scheme: Scheme
    dense: bool
    aid: Aid


def advance(run: Run, record: Record, last: int, steps: int) -> int:
    """Run to a step of the grid, or so many steps: the code of `sebody.engine.loop.advance`.

    What is raised in the aid is raised again.
    """
    code = loop.advance(run.system, run.state, record, run.scheme, last, steps, run.dense)
    run.aid.check()
    return code
