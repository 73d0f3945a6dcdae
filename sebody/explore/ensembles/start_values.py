"""The numbers a run begins with, as functions of its parameters.

Many parameters change some of the numbers in a model's arrays, and each of these linearly. Runs
then begin with a copy of all numbers and additions to a few. Parameters of another kind have the
model built anew for each of their runs.
"""

from collections.abc import Callable, Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.assembly.allocation import allocate
from sebody.assembly.build import build
from sebody.assembly.equal_bodies import evaluate_alone
from sebody.engine.offsets import Offsets, arrays_of, patterns
from sebody.engine.state import State
from sebody.engine.system import System
from sebody.parameters.changes import BODIES, MOTION, Handle
from sebody.parameters.lines import lines
from sebody.parameters.table import PLACES
from sebody.runs.simulation import Simulation

# what the stiffness of bristles, or that they hold something at the start, may follow from
OF_BRISTLES = ".bristle", ".radius", ".level", ".size", ".ratio"
OF_MASSES = ".mass", *PLACES        # and what masses and constraints follow from


class Fact(NamedTuple):
    """Something that holds of some models, and what is said of it."""

    reason: str
    holds: Callable[[Simulation], bool]


# starts that solve for more than accelerations, and are made anew for each run
OWN_STARTS = (
    Fact("friction that holds something at the start", lambda one: one.held),
    Fact("gears whose teeth are as stiff as the step allows",
         lambda one: any("teeth" in load.tuned for load in one.model.loads)),
)


class Image:
    """All numbers of the run of a model as built, and those that parameters change.

    Parameters
    ----------
    template : Simulation
        Of the model as built, before its first step.
    handles : mapping
        The parameters that vary.

    Attributes
    ----------
    linear : bool
        Whether runs can begin with a copy.
    """

    def __init__(self, template: Simulation, handles: Mapping[str, Handle]):
        self.template, self.handles = template, handles
        self.lines = None
        if not handles:         # a single run of the model as it is
            return
        self.offsets = Offsets(template.system, template.state)
        self.floats = np.zeros(self.offsets.size)
        self.offsets.packed(template.system, self.floats)
        self.offsets.packed(template.state, self.floats)
        if template.sampling.unsampled is not None:     # runs make their first samples themselves
            state = template.state
            for array, before in zip((state.frames, state.memory), template.sampling.unsampled,
                                     strict=True):
                self.floats[self.offsets.of(array)] = before
        self.lines = (lines(handles, self._numbers, template.grid) if self._can_copy(handles)
                      else None)

    @property
    def linear(self) -> bool:
        """Tell whether runs can begin with a copy."""
        return self.lines is not None

    @property
    def factored(self) -> bool:
        """Tell whether runs begin with the factors of masses and constraints of the model as built.

        Its inverse is that of its start, which is not written where the start needs another way.
        Runs have other masses where parameters change them: accelerations would be as good as the
        criterion of convergence, 1e-10, where new factors leave rounding. Starts of index 2 look
        ahead by a single correction, which is as good as its factors.
        """
        if any(name.endswith(OF_MASSES) for name in self.handles):
            return False
        one = self.template
        return (one.dense and not one.scheme.stabilized and not one.begun
                and one.state.spare.size == 0 and one.system.massless[0] == 0
                and one.state.control.regularized == 0 and bool(one.state.inverse.any()))

    def _can_copy(self, handles: Mapping[str, Handle]) -> bool:
        """Tell whether the start needs accelerations alone: no fitted velocities."""
        one = self.template
        constrained = bool(one.numbering.multipliers) or bool(one.system.prescribed.size)
        touched = {handle.touches for handle in handles.values()}
        tuned = any(load.tuned for load in one.model.loads)
        return not (any(handle.whole for handle in handles.values())
                    or any(fact.holds(one) for fact in OWN_STARTS)
                    or (tuned and (touched & {BODIES, MOTION}
                                   or any(name.endswith(OF_BRISTLES) for name in handles)))
                    or (one.system.regularized[0] and one.system.massless_axes.any())
                    or ((constrained or one.begun) and MOTION in touched)
                    or (one.start.changed and touched & {BODIES, MOTION}))

    def _numbers(self) -> NDArray | None:
        """All numbers of the model as it is now, before its start; None if its pattern differs.

        Infinite ones, which are limits that are not there, are zeros.
        """
        one = self.template
        system, numbering = build(one.model, grid=one.grid)
        if not np.array_equal(system.address, one.system.address):
            evaluate_alone(one.model, system)       # as the template does, see `Ensemble`
        for name in ("aid", "routines", "regularized", "massless"):
            getattr(system, name)[:] = getattr(one.system, name)
        state = allocate(one.model, system, numbering, one.h, one.dense)
        if not (_alike(system, one.system) and _alike(state, one.state, sizes_only=True)):
            return None
        found = np.zeros(self.offsets.size)
        same = Offsets(system, state)
        same.packed(system, found)
        same.packed(state, found)
        found[np.isinf(found)] = 0.0
        return found


def _alike(group: System | State, other: System | State, sizes_only: bool = False) -> bool:
    """Tell whether two groups have the same integers, and floats of the same sizes."""
    if group._facts != other._facts or any(
            a.shape != b.shape for a, b in zip(arrays_of(group), arrays_of(other), strict=True)):
        return False
    return sizes_only or all(np.array_equal(a, b) for a, b in
                             zip(patterns(group), patterns(other), strict=True))
