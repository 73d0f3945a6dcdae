"""The way functions are compiled: the fast one, or the plain one where it is asked for or needed.

The fast way uses Numba beyond its public interface, which a release of Numba may change. It is
tried once with every version of Numba that sebody was not tested with.
"""

import os
import subprocess
import sys
from functools import cache
from pathlib import Path
from types import ModuleType

import numba

from sebody.basics.errors import InputError
from sebody.compiler import store
from sebody.compiler.sources import COMPILER, folder_hash

VARIABLE = "SEBODY_PLAIN"
TESTED = (0, 60), (0, 69)       # versions of Numba: from the first, below the second
TRIAL = "sebody.compiler.inside.trial"
_GOOD = b"good"


@cache
def way() -> ModuleType:
    """The module that compiles: `sebody.compiler.inside.entry` or `sebody.compiler.plain`.

    Raises
    ------
    InputError
        ``SEBODY_PLAIN`` is neither 0 nor 1.
    """
    from sebody.compiler import plain

    asked = os.environ.get(VARIABLE) or "0"
    if asked not in ("0", "1"):
        raise InputError(f"the environment variable {VARIABLE} is {asked!r}: set it to 1 to "
                         "compile with Numba's public interface alone, or unset it")
    if asked == "1":
        return plain
    try:
        from sebody.compiler.inside import entry
        reason = _untested_fails()
    except (ImportError, AttributeError, TypeError) as error:
        reason = str(error)
    if not reason:
        return entry
    print(f"sebody compiles with the public interface of Numba {numba.__version__} alone, which "
          f"takes longer and gives the same numbers: {reason}", file=sys.stderr, flush=True)
    os.environ[VARIABLE] = "1"      # processes that this one starts need not find out again
    return plain


def _untested_fails() -> str:
    """The reason why the fast way fails with an untested version of Numba; empty if it does not.

    It is tried in a process of its own, which may crash, and the outcome is kept.
    """
    first, end = TESTED
    if first <= tuple(int(part) for part in numba.__version__.split(".")[:2]) < end:
        return ""
    here, made_from = Path(__file__), f"{folder_hash(COMPILER)}, Numba {numba.__version__}"
    name = f"trial.{sys.implementation.cache_tag}.sebody"
    for outcome in store.read(here, name, made_from):
        return "" if outcome == _GOOD else outcome.decode()
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    done = subprocess.run([sys.executable, "-m", TRIAL], env=environment, text=True,
                          capture_output=True)
    said = (done.stderr.strip().splitlines() or [f"status {done.returncode}"])[-1]
    outcome = "" if done.returncode == 0 else f"a trial of sebody's own compilation failed ({said})"
    store.write(here, name, made_from, outcome.encode() or _GOOD)
    return outcome


def why_no_lanes() -> str:
    """The reason why kernels cannot be compiled for eight numbers at a time; empty where they can.

    LLVM makes of eight numbers as many vectors as the processor needs for them.
    """
    return "the plain way to compile" if way().__name__ == "sebody.compiler.plain" else ""
