"""What the first ensemble in lanes compiles, side by side in several processes."""

from collections.abc import Iterable
from dataclasses import fields
from pathlib import Path
from threading import Lock

import numpy as np
from numba import typeof, types

from sebody.compiler.choice import way
from sebody.compiler.first_run import Job, compile_apart
from sebody.compiler.workers import Task
from sebody.engine.lanes import loop
from sebody.engine.lanes.arrays import Columns, Scratch, empty, in_lanes
from sebody.engine.lanes.matrix import Alone
from sebody.engine.offsets import Offsets
from sebody.kernels.lanes.kernel import Own, address_in_lanes, is_compiled
from sebody.kernels.loader import find, load
from sebody.runs.first_run import SECONDS_A_LETTER, smallest
from sebody.runs.schemes import generalized_alpha

LOOP_SECONDS = 7.0              # of one processor

_lock = Lock()


def prepare(kernels: Iterable[tuple[str, Own]]) -> None:
    """Compile kernels and the loop for lanes where the cache lacks them; a line says so.

    Parameters
    ----------
    kernels : iterable of (str, parts)
        Names, and which constants are lanes.
    """
    with _lock:
        missing = [(name, own) for name, own in dict.fromkeys(kernels)
                   if not is_compiled(find(name), own)]
        jobs = [Job(Task(f"{name} in lanes", f"{__name__}:compile_kernel", (name, own)),
                    SECONDS_A_LETTER * find(name).stat().st_size) for name, own in missing]
        if not way().is_compiled(loop.advance):
            jobs.append(Job(Task("loop in lanes", f"{__name__}:compile_loop"), LOOP_SECONDS))
        compile_apart(jobs, "what makes eight runs at a time", Path(loop.__file__))


def compile_kernel(name: str, own: Own) -> None:
    """Compile a kernel for lanes here, or find it in the cache."""
    address_in_lanes(load(name), own)


def compile_loop() -> None:
    """The same of the loop, for the types of a small model's arrays: those of every model."""
    system, state = smallest()
    offsets = Offsets(system, state)
    buffer = empty(offsets.size)
    scratch = Scratch(**{one.name: empty(1) for one in fields(Scratch)})
    room, places = np.zeros((1, 1)), np.zeros(1, dtype=np.int64)
    alone = Alone(system, state, room[0], room, places, places, room)
    columns = Columns(places, empty(1, 1), places)
    given = (in_lanes(system, offsets, buffer), in_lanes(state, offsets, buffer), scratch, alone,
             columns, generalized_alpha())
    way().compile_for(loop.advance, (*map(typeof, given), types.int64, types.boolean))
