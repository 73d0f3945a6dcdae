"""Runs of an ensemble eight at a time: the arrays of a thread, and what becomes of their members."""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from sebody.contract.layout import MEMBERS
from sebody.engine.lanes import loop
from sebody.engine.lanes.arrays import Scratch, empty, fill, in_lanes, numbers
from sebody.engine.state import Record
from sebody.engine.system import System
from sebody.explore.ensembles.member import Copies, Course
from sebody.kernels.lanes.kernel import address_in_lanes
from sebody.kernels.loader import load

STRETCH = 64        # recorded states at a time: they stay in the processor's cache
ALONE = 1.0         # reason of a lane without a member


class Lanes:
    """The arrays of a thread for eight members.

    Parameters
    ----------
    copies : Copies
        Where members begin, one after the other.
    kernels : sequence of str
        Names of the model's kernels.
    """

    def __init__(self, copies: Copies, kernels: Sequence[str]):
        self.copies = copies
        image, one = copies.image, copies.image.template
        buffer = empty(image.offsets.size)
        self._numbers = numbers(buffer)
        self.system = _with_addresses(in_lanes(one.system, image.offsets, buffer), kernels)
        self.state = in_lanes(one.state, image.offsets, buffer)
        n = len(one.system.diagonal)
        self._scratch = Scratch(g=empty(one.state.g.size), frames=empty(one.state.frames.size),
                                dense=empty(n, n))
        self._places = self._own_places()
        rows = (STRETCH + 1, one.state.now.size)
        self._record = Record(empty(*rows), np.array([one.every]), copies.none.at)
        self._rows = np.empty(rows)

    def _own_places(self) -> NDArray:
        """Places in the buffer of what members begin with: parameters, and their state."""
        image, state = self.copies.image, self.copies.image.template.state
        begun = (image.offsets.of(part) for part in (
            state.now, state.aux, state.aux_change, state.q_start, state.loads, state.loads_old,
            state.acting, state.coefficients, state.frames_old, state.aux_old))
        return np.unique(np.concatenate([image.lines.slots.astype(np.int64),
                                         *(np.arange(part.start, part.stop) for part in begun)]))

    def take(self, member: int) -> None:
        """Give a lane the member that `copies` has begun."""
        loop.take_member(self.copies.floats, self._places, member, self._numbers)

    def run(self, courses: Sequence[Course], last: int, stop: Callable[[], bool]) -> NDArray | None:
        """Run members that were taken to a grid step, and take in their outputs.

        Returns
        -------
        ndarray or None
            Which of them gave up, (members,): they are to be run alone. None if it was stopped.
        """
        state, first, count = self.state, self.copies.state, len(courses)
        for name in ("control", "clock", "guard"):
            fill(getattr(state, name), getattr(first, name))
        for member in range(count, MEMBERS):        # lanes without a member: another one's numbers
            self.take(member)
        state.control["reason"] = np.where(np.arange(MEMBERS) < count, 0.0, ALONE)
        every, reached = int(self._record.every[0]), 0
        while reached < last:
            reached = min(last, (reached // every + STRETCH) * every)
            state.control["recorded"] = 0
            loop.advance(self.system, state, self._scratch, self._record, self.copies.scheme,
                         reached)
            rows = self._rows[:state.control["recorded"]]
            for member in np.flatnonzero(state.control["reason"][:count] == 0.0):
                loop.rows_of(numbers(self._record.rows), member, rows)
                courses[member].take(rows)
            if stop():
                return None
        return state.control["reason"][:count] != 0.0

    @property
    def time(self) -> float:
        """Time reached."""
        return float(self.state.clock["time"])


def _with_addresses(system: System, kernels: Sequence[str]) -> System:
    """A system that calls kernels for lanes."""
    modules = [load(name) for name in kernels]
    addresses = {module.kernel.address: address_in_lanes(module) for module in modules}
    members = {name: getattr(system, name) for name in System.__annotations__}
    members["address"] = np.array([addresses[a] for a in system.address.tolist()])
    return System(**members)
