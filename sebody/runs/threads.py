"""Threads that help the loop with the steps of a large model, see `sebody.engine.sharing`."""

import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from ctypes import CFUNCTYPE, c_int64, c_void_p

from sebody.assembly.independent_parts import FEWEST
from sebody.basics import inputs
from sebody.engine.mailbox import CALL
from sebody.engine.state import HELP, State
from sebody.engine.system import System

MOST = 64               # threads
TOO_SMALL = ("threads = {} is not used: threads share the steps of models with "
             f"{FEWEST} unknowns or more, this one has {{}}")
IN_ORDER = ("threads = {} is not used: friction along a path reads the tangent that the path has "
            "just found, so elements are evaluated one after another")
WORTH_IT = 10_000       # unknowns times steps of a short piece of a run, which takes 2 ms or more
REST = 1e-4             # seconds after which a helper that found no work looks again
_SHARE = CFUNCTYPE(c_int64, c_void_p, c_void_p, c_int64, c_int64)   # releases Python's lock


def checked_threads(threads: int) -> int:
    """The number of threads that is asked for."""
    return inputs.integer(threads, "threads", least=1, most=MOST,
                          remedy=f"give a whole number from 1 to {MOST}, of the cores that may "
                                 "share a step")


@contextmanager
def helping(system: System, state: State) -> Iterator[None]:
    """Threads that help whatever calls the loop meanwhile; they end with it, however it ends.

    Calls with helpers are numbered, and helpers take nothing of another one: where a second Ctrl-C
    keeps this call from ending its helpers, they leave when the next one with helpers begins.
    """
    mail = system.shared.mail
    if not mail.size:
        yield
        return
    mail[CALL] += 1
    call = int(mail[CALL])
    threads = [threading.Thread(target=_help, args=(system, state, k, call), daemon=True)
               for k in range(1, len(system.shared.work))]
    try:
        for thread in threads:
            try:
                thread.start()
            except RuntimeError:        # the system gives no more: the loop does what is left
                break
        yield
    finally:
        mail[CALL] += 1
        for thread in threads:
            if thread.ident is not None:
                thread.join()


def worth_help(system: System, steps: int) -> bool:
    """Tell whether so many steps take longer than helpers do to begin and end."""
    return bool(system.shared.mail.size) and steps * system.diagonal.size >= WORTH_IT


def _help(system: System, state: State, thread: int, call: int) -> None:
    """Do pieces of the loop's work until its call ends; sleep while there are none."""
    share = _SHARE(int(system.routines[3]))
    groups = (vars(system)["_address"], vars(state)["_address"])    # as compiled code gets them
    while not share(*groups, HELP + call, thread):
        time.sleep(REST)
