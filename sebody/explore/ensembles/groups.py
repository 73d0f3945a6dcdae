"""Groups of eight runs from their starts to their outputs, compiled: see `Lanes.make`."""

from dataclasses import dataclass

import numpy as np
from numba import typeof, types
from numpy.typing import NDArray

from sebody.compiler.choice import way
from sebody.compiler.decorators import compiled
from sebody.compiler.inside.lanes import number_of, spread, with_number
from sebody.contract.counts import MEMBERS
from sebody.engine.arrays import Arrays
from sebody.engine.calls import call_advance_together
from sebody.engine.lanes import loop
from sebody.engine.lanes.apart import GAVE_UP, RUNS
from sebody.engine.lanes.arrays import Apart, Columns, Scratch, numbers
from sebody.engine.lanes.together import Together
from sebody.engine.state import DONE, Scheme, State
from sebody.engine.system import System
from sebody.explore.ensembles.apart import RECORDS, memory_of
from sebody.explore.ensembles.beginning import Beginning, begin_together
from sebody.runs.folds import Folds, fold_all, forget, write_all


@dataclass(frozen=True, eq=False)
class Groups(Arrays):
    """Arrays that the groups of a thread are made with, one after the other.

    ==================  ============================================================================
    routine             (1,) address of `engine.lanes.loop.advance`
    system to record    its arguments
    single_system,      the single run of the thread, by which members begin
    single_state
    given               what they begin with, in its arrays
    places              of what members begin with in the buffer of all numbers
    begun               scalars and counters of a member that has begun, the same for all
    control, clock,     (k,) the memory of those in lanes
    guard
    table               (states, numbers, members) the memory of `record`
    folds               outputs
    ==================  ============================================================================
    """

    routine: NDArray
    system: System
    state: State
    scratch: Scratch
    together: Together
    apart: Apart
    record: Columns
    single_system: System
    single_state: State
    given: Beginning
    places: NDArray
    begun: NDArray
    control: NDArray
    clock: NDArray
    guard: NDArray
    table: NDArray
    folds: Folds


def address_of_loop(given_to_loop: tuple, scheme: Scheme) -> int:
    """Address of the loop in lanes for its arguments up to `record`; it is compiled if needed."""
    kinds = (*map(typeof, (*given_to_loop, scheme)), types.int64, types.boolean)
    return way().address(loop.advance, types.int64, kinds)


def new_groups(routine: int, given_to_loop: tuple, single: tuple[System, State, Beginning],
               places: NDArray, folds: Folds) -> Groups:
    """Arrays that groups are made with.

    Parameters
    ----------
    routine, given_to_loop
        The loop in lanes, and its arguments up to `record`.
    """
    _, state, *_, record = given_to_loop
    scalars = [memory_of(getattr(state, name), np.int64) for name in RECORDS]
    return Groups(np.array([routine]), *given_to_loop, *single, places, np.concatenate(scalars),
                  *scalars, numbers(record.rows), folds)


@compiled(nogil=True)
def make(groups, changes, scheme, lead, dense, last, values, made):
    """Make runs in groups of eight, those that need Python apart.

    Parameters
    ----------
    changes : (runs, components)
        As of `beginning.begin`.
    lead : float
        As of `engine.restart`.
    last : int
        Last step of the grid.
    values : (runs, values)
        Get the outputs of the runs that are made.
    made : (runs,)
        Becomes true of these.
    """
    control = groups.state.control
    for first in range(0, changes.shape[0], MEMBERS):
        end = min(first + MEMBERS, changes.shape[0])
        codes = begin_together(groups.single_system, groups.single_state, groups.given,
                               changes[first:end], lead, dense, groups.places, groups.apart.lanes)
        count = 0
        for code in codes:
            count += 1 if code == DONE else 0
        if count == 0:
            continue
        reached = 0
        while reached < last:
            reached = run_on(groups, count, scheme, dense, reached, last)
        member = 0
        for k in range(codes.size):
            if codes[k] == DONE:
                if number_of(control.reason, member) != GAVE_UP:
                    write_all(groups.folds, member, values[first + k])
                    made[first + k] = True
                member += 1


@compiled(nogil=True)
def run_on(groups, count, scheme, dense, reached, last):
    """Run a group for as many steps as there is room for, take in outputs; the step reached.

    Parameters
    ----------
    count : int
        Members that have begun, which are the first ones.
    """
    record, control = groups.record, groups.state.control
    every = record.every[0]
    if reached == 0:
        _begin_members(groups, count)
    reached = min(last, (reached // every + record.rows.shape[0] - 1) * every)
    control.recorded = 0
    call_advance_together(groups.routine[0], groups.system, groups.state, groups.scratch,
                          groups.together, groups.apart, record, scheme, reached,
                          dense)
    fold_all(groups.folds, control.recorded, groups.table)
    return reached


@compiled
def _begin_members(groups, count):
    """Set the scalars of a group; lanes without a member get the numbers of another one."""
    lanes, k = groups.apart.lanes, 0
    groups.apart.exchanged[0] = spread(0.0)
    for place in groups.places:
        for member in range(count, MEMBERS):
            lanes[place, member] = lanes[place, 0]
    for own in (groups.control, groups.clock, groups.guard):
        for i in range(own.size):
            own[i] = groups.begun[k]
            k += 1
    control = groups.state.control
    for member in range(MEMBERS):
        control.reason = with_number(control.reason, member, RUNS if member < count else GAVE_UP)
    forget(groups.folds)
