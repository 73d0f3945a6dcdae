"""The loop as Python runs it, and its aid: factors with row exchanges, readings of sensors."""

import weakref
from collections.abc import Callable
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
    system : System
        Gets the address: its `aid` is of this run alone.
    state : State
    read : callable
        Sets the readings of sensors.
    """

    def __init__(self, system: System, state: State, read: Callable[[], None]):
        self.system, self.state, self._read = system, state, read
        self._exchanges: Exchanges | None = None
        self._raised: BaseException | None = None
        own = weakref.ref(self)             # no circle: runs are large

        def serve(context: int, what: int) -> int:
            aid = own()
            return 1 if aid is None else aid._serve(what)
        self._function = _AID(serve)
        system.aid[ADDRESS] = cast(self._function, c_void_p).value

    def forget(self) -> None:
        """Forget factors: another state was put in place of the one they are of."""
        self._exchanges = None

    def check(self) -> None:
        """Raise what was raised in the loop."""
        if self._raised is not None:
            raised, self._raised = self._raised, None
            raise raised

    def _serve(self, what: int) -> int:
        while True:
            try:
                if what == READINGS:
                    self._read()
                else:
                    self._exchange(what)
                return 0
            except KeyboardInterrupt as interrupt:
                self._raised = interrupt
            except BaseException as error:      # ctypes would print it and go on
                self._raised = error
                return 1

    def _exchange(self, what: int) -> None:
        own = self._exchanges or self._room(0)
        while exchange(self.system, self.state, own, what) == ROOM:
            own = self._room(int(own.kind[1]))
        self._exchanges = own

    def _room(self, entries: int) -> Exchanges:
        return Exchanges.of(self.system.diagonal.size, self.system.rows.size, entries)


class Run(Protocol):
    """What the loop is given of a run."""

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
