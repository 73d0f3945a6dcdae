"""Systems and states whose numbers are lanes: the same groups, with arrays of another kind.

Times, the grid and all whole numbers are the same for all members. Of the records of scalars, what
depends on the motion is lanes; counters of theirs are floats in lanes.
"""

from collections.abc import Iterator
from dataclasses import dataclass, fields
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from sebody.compiler.inside.lanes import NUMPY_KIND
from sebody.contract.counts import MEMBERS
from sebody.engine.arrays import Arrays
from sebody.engine.offsets import Offsets
from sebody.engine.state import Record, State
from sebody.engine.system import System

# floats that are the same for all members: times, and what branches are taken by
SHARED = {"is_multiplier", "table_times", "corners", "prescribed_factor", "memory",
          "series_times", "series_values"}
OWN_GROUPS = {"control"}        # of a system: read by single runs of the members alone
SAMPLED = {"periods", "offsets"}        # and what of it is the same for all
# scalars of all members together; the other ones of the records are lanes
TIMES = {"time", "step", "current_step", "aux_step", "chosen", "end", "beside",
         "allowed", "origin", "begun", "rate", "rate_before", "natural"}
WHOLE = {"grid", "unit", "level", "recorded", "pivoted", "adaptive", "corner",
         "meets", "split", "inside", "restart", "due", "held", "piece", "regularized", "cuts",
         "rejected"}
_ALIGNED = 64       # bytes of a vector

Group = TypeVar("Group", bound=Arrays)


@dataclass(frozen=True, eq=False)
class Scratch(Arrays):
    """Memory of an iteration for members that need not be evaluated again.

    ==================  ============================================================================
    frames              frames before an evaluation
    T                   tangent operators before accelerations are solved for
    unmoved             forces of the elements that have not moved
    table               of elements that are evaluated member by member: see `member_row`
    kept                (B,) numbers that an element of each batch keeps, if it is one of them
    ==================  ============================================================================
    """

    frames: NDArray
    T: NDArray
    unmoved: NDArray
    table: NDArray
    kept: NDArray


@dataclass(frozen=True, eq=False)
class Apart(Arrays):
    """Arrays of members that are alone for a matrix or a while, see `engine.lanes.apart`.

    =======================  =======================================================================
    places                   numbers that members take with them, in the buffer of all numbers
    taken, returned          likewise: of what matrices depend on, of what is made with them
    carried                  likewise: element matrices of bodies, where members have them in lanes
    exchanged                (1,) one where a member's factors have row exchanges, else zero
    lanes                    (size, members) that buffer in lanes
    numbers                  (members, size) the same of every member alone
    now                      (1,) where `State.now` begins in it
    changes                  (2,) the same of `State.changes` and `State.fit`
    control, clock, guard    (members, scalars) the records of every member
    ..._words                (scalars, 2) place of each in the record in lanes; 1 if each member has
                             its own there, else 0
    ..._in_lanes             the records in lanes as floats, and `control` as whole numbers, too
    addresses                (members, 2) of system and state of every member
    system, state            those of the first; their types are those of all
    record                   which nothing is written to
    routines                 (2,) addresses of `engine.loop.advance` and `lanes.samples.sample`
    =======================  =======================================================================
    """

    places: NDArray
    taken: NDArray
    returned: NDArray
    carried: NDArray
    exchanged: NDArray
    lanes: NDArray
    numbers: NDArray
    now: NDArray
    changes: NDArray
    control: NDArray
    clock: NDArray
    guard: NDArray
    control_words: NDArray
    clock_words: NDArray
    guard_words: NDArray
    control_in_lanes: NDArray
    whole_in_lanes: NDArray
    clock_in_lanes: NDArray
    guard_in_lanes: NDArray
    addresses: NDArray
    system: System
    state: State
    record: Record
    routines: NDArray


@dataclass(frozen=True, eq=False)
class Columns(Arrays):
    """Recorded numbers of some steps.

    ==================  ============================================================================
    places              (c,) which numbers of `State.now`, ascending
    rows                (records, c + e) their values, and those of what is evaluated
    every               (1,) grid steps between records
    evaluated           (e, 2) further numbers: kind as of `contract.read_numbers`, and place
    batches             (b, 3) batches whose forces are evaluated: number, first element, elements
    needs               (kinds,) one for each kind of numbers that is evaluated
    shown               places of `State.now` that are needed of members that are alone
    loads               loads before an evaluation
    ==================  ============================================================================
    """

    places: NDArray
    rows: NDArray
    every: NDArray
    evaluated: NDArray
    batches: NDArray
    needs: NDArray
    shown: NDArray
    loads: NDArray


def empty(*shape: int) -> NDArray:
    """An array of lanes, zeros, aligned as vectors are."""
    size = int(np.prod(shape))
    room = np.zeros(size * MEMBERS + MEMBERS)
    first = -room.ctypes.data % _ALIGNED // room.itemsize
    return room[first:first + size * MEMBERS].view(NUMPY_KIND).reshape(shape)


def numbers(array: NDArray) -> NDArray:
    """The numbers of an array of lanes, those of the members along the last axis."""
    return array["members"]


def shared_places(system: System, state: State, offsets: Offsets) -> Iterator[slice]:
    """Parts of the buffer of all numbers that members cannot have of their own."""
    for group in (system, state):
        for one in fields(group):
            value = getattr(group, one.name)
            if isinstance(value, Arrays):
                if one.name in OWN_GROUPS:
                    yield from (offsets.of(getattr(value, name)) for name in SAMPLED)
            elif one.name in SHARED:
                yield offsets.of(value)


def in_lanes(group: Group, offsets: Offsets, buffer: NDArray) -> Group:
    """The same group with its floats in a buffer of lanes, which get their numbers."""
    made = {}
    for one in fields(group):
        value = getattr(group, one.name)
        if isinstance(value, Arrays):
            made[one.name] = value if one.name in OWN_GROUPS else in_lanes(value, offsets, buffer)
        elif isinstance(value, np.record):
            made[one.name] = _record(value)
        elif one.name == "memory":      # which holds the time of the next sample
            made[one.name] = value.copy()
        elif value.dtype != np.float64 or one.name in SHARED:
            made[one.name] = value
        else:
            view = buffer[offsets.of(value)].reshape(value.shape)
            numbers(view)[...] = value[..., np.newaxis]
            made[one.name] = view
    return type(group)(**made)


def _record(scalars: np.record) -> np.record:
    """A record of the same names, whose scalars are lanes but for those of all members."""
    kind = np.dtype([(name, own) if name in TIMES | WHOLE else (name, np.float64, (MEMBERS,))
                     for name, (own, _) in scalars.dtype.fields.items()])
    made = np.zeros(1, kind).view(np.recarray)[0]
    fill(made, scalars)
    return made


def fill(record: np.record, scalars: np.record) -> None:
    """Set the scalars of a record of lanes, the same for all members."""
    for name in scalars.dtype.names:
        record[name] = scalars[name]
