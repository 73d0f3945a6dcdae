"""Multipliers of redundant constraints: of all that exert the same forces, those of least norm.

The norm is the root of the sum of the squares of all forces and of all moments over a
characteristic length of the model, which makes it the same in all units and all orientations.
Every equation of a joint gives a force or a moment of the size of its multiplier.
"""

import numpy as np
from numpy.typing import NDArray

from sebody.assembly.numbering import rotational
from sebody.basics.errors import InputError
from sebody.engine.least_norm import take_least_norm
from sebody.engine.state import State
from sebody.engine.system import System
from sebody.model.mechanism import Mechanism
from sebody.model.numbering import Numbering


def arm(model: Mechanism) -> float:
    """Length that moments are divided by: from the mean of all nodes to the furthest of them."""
    points = np.array([node.point for node in model.nodes.values()])
    largest = np.linalg.norm(points - points.mean(axis=0), axis=1).max()
    return float(largest) or 1.0        # of nodes at one place no force has a moment


def least_norm(model: Mechanism, numbering: Numbering, system: System, state: State,
               rows: NDArray) -> NDArray:
    """Recorded states with multipliers of least norm.

    Raises
    ------
    InputError
        A state that cannot be evaluated.
    """
    fitted = rows.copy()
    kept = [(array, array.copy()) for array in vars(state).values()
            if isinstance(array, np.ndarray)]
    status = take_least_norm(system, state, fitted, _norms(model, numbering),
                             not system.slot_unknowns.size)
    for array, values in kept:
        array[...] = values
    if status:
        raise InputError("the multipliers of a recorded state cannot be evaluated")
    return fitted


def _norms(model: Mechanism, numbering: Numbering) -> NDArray:
    """Squared norms of multipliers; of coordinates what makes constraints about equally strong."""
    square = arm(model)**2
    norms = np.where(rotational(model, numbering), square, 1.0)
    for equation in model.constraints:
        first = numbering.multipliers[equation]
        if all(place.kind == "rotation" for place in equation.attachments):
            norms[first:first + equation.multipliers] = 1.0 / square
    return norms[:numbering.free]
