"""Arrays for members in lanes that go on alone for a while."""

from collections.abc import Mapping
from dataclasses import fields, replace

import numpy as np
from numba import typeof, types
from numpy.typing import NDArray

from sebody.compiler.choice import way
from sebody.contract.counts import MEMBERS
from sebody.engine import loop
from sebody.engine.aid import ADDRESS, CONTEXT
from sebody.engine.lanes.arrays import SHARED, Apart, empty
from sebody.engine.offsets import Offsets
from sebody.engine.scalars import numbers_of, record
from sebody.engine.state import Record, Scheme, State
from sebody.engine.system import System
from sebody.runs.aid import Aid

NEVER = 2**62       # grid steps between records of members that are alone
RECORDS = "control", "clock", "guard"


def new_apart(of: tuple[System, State], offsets: Offsets, slots: NDArray, lanes: NDArray,
              in_lanes: State, routine: int, of_matrices: Mapping[str, NDArray],
              ) -> tuple[Apart, Aid, list]:
    """Arrays of eight members, their aid, and what else their addresses lead to.

    Parameters
    ----------
    of : tuple
        System and state of the model as built.
    slots : (k,)
        Places of numbers in the buffer of all numbers that members take with them beside their
        state: those that parameters change.
    lanes : (size, members)
        This buffer in lanes.
    in_lanes : State
        The state in lanes.
    routine : int
        Address of the loop for numbers.
    of_matrices : mapping
        The places `taken`, `returned` and `carried` of `Apart`.
    """
    one = of[1]
    numbers, aids = np.zeros((MEMBERS, offsets.size)), np.zeros((MEMBERS, 2), dtype=np.int64)
    system = replace(offsets.packed(of[0], numbers[0]), aid=aids[0])
    state = offsets.packed(one, numbers[0])
    numbers[1:] = numbers[0]
    scalars = {name: np.tile(numbers_of(getattr(one, name)), (MEMBERS, 1)) for name in RECORDS}
    state = replace(state, **{name: record(getattr(one, name).dtype, rows[0])
                              for name, rows in scalars.items()})
    rows = [numbers, aids, *scalars.values()]
    words = [group.in_rows(rows) for group in (system, state)]
    aid = Aid([(system.at_row(of_system), state.at_row(of_state))
               for of_system, of_state in zip(*words, strict=True)], _nothing_to_read)
    aids[:, ADDRESS], aids[:, CONTEXT] = aid.address, range(MEMBERS)
    unwritten = Record.of(one, 0, NEVER)
    return Apart(
        places=_places(one, offsets, slots), **of_matrices, exchanged=empty(1), lanes=lanes,
        numbers=numbers, now=np.array([offsets.of(one.now).start]),
        changes=np.array([offsets.of(one.changes).start, offsets.of(one.fit).start]), **scalars,
        **{f"{name}_words": _words(getattr(in_lanes, name)) for name in RECORDS},
        **{f"{name}_in_lanes": memory_of(getattr(in_lanes, name), np.float64) for name in RECORDS},
        whole_in_lanes=memory_of(in_lanes.control, np.int64),
        addresses=np.array([[own[member].ctypes.data for own in words]
                            for member in range(MEMBERS)]),
        system=system, state=state, record=unwritten,
        routines=np.array([routine, 0])), aid, [*words, *rows]


def _nothing_to_read() -> None:
    """Read the sensors of members, which the loop reads itself."""


def _places(state: State, offsets: Offsets, slots: NDArray) -> NDArray:
    """Places of what a member takes with it: parameters, and its state without scratch memory."""
    left = SHARED | {"J", "condensed", "g", "changes", "kept", "work", "expansion",
                     "rotated_matrix", "column", "moved"}
    parts = [offsets.of(value) for one in fields(State) if one.name not in left
             and isinstance(value := getattr(state, one.name), np.ndarray)
             and value.dtype == np.float64 and value.size]
    return np.unique(np.concatenate([slots.astype(np.int64), *(
        np.arange(part.start, part.stop) for part in parts)]))


def _words(in_lanes: np.record) -> NDArray:
    """Places of the scalars of a record in lanes, and 1 where members have their own."""
    return np.array([(offset // 8, own.subdtype is not None)
                     for own, offset in in_lanes.dtype.fields.values()], dtype=np.int64)


def memory_of(in_lanes: np.record, kind: type) -> NDArray:
    """The memory of a record as numbers of one kind."""
    return in_lanes.base.view(np.ndarray).view(kind)


def address_of_loop(system: System, state: State, scheme: Scheme) -> int:
    """Address of the loop for numbers, which runs one by one have compiled."""
    kinds = (*map(typeof, (system, state, Record.of(state, 0), scheme)), types.int64, types.int64,
             types.boolean)
    return way().address(loop.advance, types.int64, kinds)
