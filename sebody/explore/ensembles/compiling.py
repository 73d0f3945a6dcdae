"""Compilation for the first ensemble in lanes, side by side in several processes."""

from collections.abc import Iterable
from pathlib import Path
from threading import Lock

import numpy as np
from numba import typeof, types

from sebody.compiler.choice import way
from sebody.compiler.first_run import Job, compile_apart
from sebody.compiler.workers import Task
from sebody.engine.lanes import loop
from sebody.engine.lanes.arrays import Columns, Scratch, empty, in_lanes, numbers
from sebody.engine.lanes.together import refactorize
from sebody.engine.offsets import Offsets
from sebody.engine.scalars import numbers_of
from sebody.explore.ensembles.apart import RECORDS, new_apart
from sebody.explore.ensembles.beginning import Beginning
from sebody.explore.ensembles.groups import make, new_groups, run_on
from sebody.explore.ensembles.matrices import address_together, new_together
from sebody.kernels.lanes.kernel import Own, address_in_lanes, is_compiled, module_in_lanes
from sebody.quantities.expressions import Tape
from sebody.quantities.reading import reading
from sebody.runs.first_run import SECONDS_A_LETTER, smallest
from sebody.runs.outputs import folds_of
from sebody.runs.schemes import generalized_alpha

LOOP_SECONDS, GROUPS_SECONDS, MATRICES_SECONDS = 7.0, 3.0, 3.0      # of one processor

_lock = Lock()


def prepare(kernels: Iterable[tuple[str, Own, bool]]) -> None:
    """Compile kernels and the loop for lanes where the cache lacks them; a line says so.

    Parameters
    ----------
    kernels : iterable of (str, parts, bool)
        Names, which constants are lanes, and whether matrices are made in lanes, too.
    """
    with _lock:
        asked = {(Path(module_in_lanes(name).__file__), *how): name for name, *how in kernels}
        jobs = [Job(Task(f"{name} in lanes", f"{__name__}:compile_kernel", (name, *how)),
                    SECONDS_A_LETTER * path.stat().st_size)
                for (path, *how), name in asked.items() if not is_compiled(path, *how)]
        if not way().is_compiled(loop.advance):
            jobs.append(Job(Task("loop in lanes", f"{__name__}:compile_loop"), LOOP_SECONDS))
        if not way().is_compiled(make):
            jobs.append(Job(Task("groups in lanes", f"{__name__}:compile_groups"), GROUPS_SECONDS))
        if any(matrices for *_, matrices in asked) and not way().is_compiled(refactorize):
            jobs.append(Job(Task("matrices in lanes", f"{__name__}:compile_matrices"),
                            MATRICES_SECONDS))
        compile_apart(jobs, "what makes eight runs at a time", Path(loop.__file__))


def compile_kernel(name: str, own: Own, matrices: bool) -> None:
    """Compile a kernel for lanes here, or find it in the cache."""
    address_in_lanes(module_in_lanes(name), own, matrices)


def compile_loop() -> None:
    """The same of the loop, for the types of a small model's arrays: those of every model."""
    kinds = (*map(typeof, (*_given_to_loop(), generalized_alpha())), types.int64, types.boolean)
    way().compile_for(loop.advance, kinds)


def compile_groups() -> None:
    """The same of what makes groups from start to end."""
    given_to_loop, one = _given_to_loop(), smallest()[1]
    floats, places, pairs = np.zeros(1), np.zeros(1, dtype=np.int64), np.zeros((1, 2), np.int64)
    scalars = {name: numbers_of(getattr(one, name)) for name in RECORDS}
    given = Beginning(model=floats, floats=floats, copied=pairs, restart=places, slots=places,
                      ends=places, components=places, slopes=floats, kept=places, **scalars,
                      **{f"{name}_built": own for name, own in scalars.items()})
    groups = new_groups(0, given_to_loop, (*smallest(), given), places, folds_of(
        (), (), (), (), reading(Tape()), pairs[:0], 1))
    kinds = tuple(map(typeof, (groups, 0, generalized_alpha(), False, 0, 0)))
    way().compile_for(run_on, kinds)
    way().compile_for(make, (*map(typeof, (groups, pairs + 0.0, generalized_alpha(), 0.0, False, 0,
                                           pairs + 0.0, np.zeros(1, dtype=bool))),))


def _given_to_loop() -> tuple:
    """Arguments of the loop in lanes up to `record`, of a small model."""
    system, state = smallest()
    offsets = Offsets(system, state)
    buffer = empty(offsets.size)
    places = np.zeros(1, dtype=np.int64)
    scratch = Scratch(*(empty(1) for _ in range(3)), places, places)
    columns = Columns(places, empty(1, 1), places, np.zeros((0, 2), dtype=np.int64),
                      np.zeros((0, 3), dtype=np.int64), places, places, empty(1))
    members = in_lanes(system, offsets, buffer), in_lanes(state, offsets, buffer)
    apart, *_ = new_apart((system, state), offsets, places[:0], numbers(buffer), members[1], 0,
                          dict.fromkeys(("taken", "returned", "carried"), places))
    return (*members, scratch, new_together(members[1], empty(1)), apart, columns)


def compile_matrices() -> None:
    """The same of what makes the matrices of eight members at once."""
    system, state = smallest()
    offsets = Offsets(system, state)
    buffer = empty(offsets.size)
    system, state = in_lanes(system, offsets, buffer), in_lanes(state, offsets, buffer)
    address_together(system, state, new_together(state, empty(1)))
