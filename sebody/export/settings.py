"""Parameters of an exported model: which numbers in its arrays follow from them, and how.

Each of these numbers is an offset and a sum of slopes times values, so that parameters may be set
in any order, and a value that a number is itself is that to the last digit.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from sebody.assembly.allocation import allocate
from sebody.assembly.build import build
from sebody.assembly.equal_bodies import evaluate_alone
from sebody.basics.errors import InputError
from sebody.engine.arrays import Arrays
from sebody.engine.offsets import arrays_of, patterns
from sebody.engine.state import State
from sebody.engine.system import System
from sebody.model.numbering import Numbering
from sebody.parameters.changes import Handle
from sebody.parameters.lines import lines
from sebody.parameters.table import by_parameter, parameter, varied
from sebody.quantities.reading import Reading
from sebody.runs.simulation import Simulation

Outputs = Callable[[Numbering, System, State], Reading]


@dataclass(frozen=True, eq=False)
class Values(Arrays):
    """Values that the parameters of an instance have."""

    values: NDArray     # (p,)


@dataclass(frozen=True, eq=False)
class Settings:
    """Numbers that parameters of a model set.

    Attributes
    ----------
    names : list of str
    values : Values
        As built.
    least, most : (p,)
        Bounds of what can be set.
    places : list of (ndarray, int)
        Arrays and their items that follow.
    offsets : (k,)
        Of these numbers.
    slopes : (k, p)
        By the values.
    """

    names: list[str]
    values: Values
    least: NDArray
    most: NDArray
    places: list[tuple[NDArray, int]]
    offsets: NDArray
    slopes: csr_array

    @property
    def arrays(self) -> list[NDArray]:
        """Arrays that change when a parameter is set."""
        return list({id(array): array for array, _ in self.places}.values())


def settings(run: Simulation, reading: Reading, names: list[str], outputs: Outputs) -> Settings:
    """Numbers that follow from some parameters of a run's model: of system, gravity and outputs.

    Parameters
    ----------
    reading : Reading
        Outputs of the model as built.
    outputs : function
        Outputs of the model as it is when it is called.

    Raises
    ------
    InputError
        Numbers that follow from a parameter in another way than linearly.
    """
    found = {name: parameter(run.model, name) for name in names}
    handles = varied(found)
    order = [name for owner in handles for name in by_parameter(found)[owner]]
    own = [*_floats(run.system), run.state.coefficients, *_floats(reading)]
    kinds = [*patterns(run.system), *patterns(reading)]

    def numbers(with_outputs: bool = True) -> NDArray | None:
        made, numbering = build(run.model, grid=run.grid)
        evaluate_alone(run.model, made)
        for name in ("aid", "routines", "regularized", "massless"):
            getattr(made, name)[:] = getattr(run.system, name)
        state = allocate(run.model, made, numbering, run.h, run.dense)
        read = outputs(numbering, made, state) if with_outputs else reading
        arrays = [*_floats(made), state.coefficients, *_floats(read)]
        if [one.shape for one in arrays] != [one.shape for one in own] or not all(
                np.array_equal(*pair) for pair in zip([*patterns(made), *patterns(read)], kinds,
                                                      strict=True)):
            return None
        return np.concatenate([np.where(np.isinf(one), 0.0, one).ravel() for one in arrays])
    base = np.concatenate([handle.base.ravel() for handle in handles.values()] or [np.zeros(0)])
    if not names:
        return Settings([], Values(base), base, base, [], base, csr_array((0, 0)))
    of = lines(handles, numbers, run.grid)
    if of is None:
        for name, handle in handles.items():
            if lines({name: handle}, lambda: numbers(False), run.grid) is None:
                raise InputError(f"input {name!r}: numbers of the model do not follow from it "
                                 "linearly, so a library cannot set it: leave it out, or export "
                                 "a model for each value")
        raise InputError(f"inputs {', '.join(map(repr, names))}: outputs or numbers of the model "
                         "do not follow from their values linearly, as stresses do not from "
                         "gravity: leave one of these or of the outputs out")
    starts = np.cumsum([0, *(one.size for one in own)])
    arrays = np.searchsorted(starts, of.slots, side="right") - 1
    places = [(own[a], int(slot - starts[a])) for a, slot in zip(arrays, of.slots, strict=True)]
    offsets = np.array([array.ravel()[at] for array, at in places]) - of.slopes @ base
    least, most = (np.concatenate([np.full(handle.base.size, bound) for handle, bound in zip(
        handles.values(), bounds, strict=True)]) for bounds in zip(
            *(_bounds(handle) for handle in handles.values()), strict=True))
    return Settings(order, Values(base), least, most, places, offsets, of.slopes)


def _floats(group: Arrays) -> list[NDArray]:
    return [array for array in arrays_of(group) if array.dtype == np.float64]


def _bounds(handle: Handle) -> tuple[float, float]:
    """Least and largest value that a parameter can be set to."""
    least = -np.inf if handle.least is None else handle.least
    if handle.above is not None:
        least = np.nextafter(handle.above, np.inf)
    return least, np.inf if handle.most is None else handle.most
