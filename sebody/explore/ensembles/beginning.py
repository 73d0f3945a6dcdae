"""The start of a run from a copy of all numbers, compiled: other threads go on meanwhile."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sebody.compiler.decorators import compiled
from sebody.engine.arrays import Arrays
from sebody.engine.calls import call_restart
from sebody.engine.evaluate import move_prescribed, set_loads
from sebody.engine.kept_factors import VALID
from sebody.engine.links import place_dependent
from sebody.engine.state import DONE
from sebody.engine.vectors import copy


@dataclass(frozen=True, eq=False)
class Beginning(Arrays):
    """Beginning of a run, beside the arrays of a thread that get it.

    ==================  ============================================================================
    model, floats       numbers of the model as built, and those of the thread
    copied              (k, 2) first and last places of those that runs change
    restart             (1,) how the accelerations are asked for
    slots               (k,) places of the numbers that depend on parameters
    ends                (k + 1,) where the slopes of each begin and end
    components, slopes  by which component of the parameters, and how much
    kept                places of what elements keep, as of the last accepted state
    control, clock,     scalars and flags of the thread, and below those of the model as built
    guard
    ==================  ============================================================================
    """

    model: NDArray
    floats: NDArray
    copied: NDArray
    restart: NDArray
    slots: NDArray
    ends: NDArray
    components: NDArray
    slopes: NDArray
    kept: NDArray
    control: NDArray
    clock: NDArray
    guard: NDArray
    control_built: NDArray
    clock_built: NDArray
    guard_built: NDArray


@compiled(nogil=True)
def begin(system, state, given, change):
    """Numbers for changed parameters, loads and positions; accelerations are asked for.

    Parameters
    ----------
    change : (components,)
        Values of the parameters less those of the model as built.
    """
    for part in range(given.copied.shape[0]):
        for k in range(given.copied[part, 0], given.copied[part, 1]):
            given.floats[k] = given.model[k]
    for i in range(given.slots.size):
        total = 0.0
        for k in range(given.ends[i], given.ends[i + 1]):
            total += given.slopes[k] * change[given.components[k]]
        given.floats[given.slots[i]] = given.model[given.slots[i]] + total
    for i in range(given.control.size):
        given.control[i] = given.control_built[i]
    copy(given.clock_built, given.clock)
    copy(given.guard_built, given.guard)
    if state.spare.size > 0:
        state.spare[VALID] = 0.0        # these factors are of the model as built
    set_loads(system, state.frames, state.loads, 0.0)
    copy(state.loads, state.loads_old)
    move_prescribed(system, state)
    place_dependent(system.links, state.q, state.v, state.a, state.R, state.turns)
    state.control.restart = given.restart[0]


@compiled(nogil=True)
def end(state, given):
    """Nothing is counted of the start, and the first step begins from it."""
    for i in range(given.control.size):
        given.control[i] = given.control_built[i]
    copy(state.frames, state.frames_old)
    for k in given.kept:        # the first step is the first that changes these
        given.floats[k] = given.model[k]
    copy(state.aux, state.aux_old)


@compiled(nogil=True)
def begin_together(system, state, given, changes, lead, dense, places, lanes):
    """Begin runs one after the other; those that have begun are members of lanes.

    Parameters
    ----------
    changes : (runs, components)
        As of `begin`.
    lead : float
        As of `engine.restart`.
    places : (k,)
        What members begin with in the buffer of all numbers.
    lanes : (size, members)
        Gets it.

    Returns
    -------
    (runs,) codes of `engine.restart`
    """
    member, codes = 0, np.empty(changes.shape[0], np.int64)
    for run in range(changes.shape[0]):
        begin(system, state, given, changes[run])
        codes[run] = call_restart(system.routines[1], system, state, lead, dense)
        if codes[run] == DONE:
            end(state, given)
            for k in range(places.size):
                lanes[places[k], member] = given.floats[places[k]]
            member += 1
    return codes
