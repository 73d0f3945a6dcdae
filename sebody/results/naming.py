"""Histories of quantities by the names of `sebody.quantities.names`."""

from itertools import product
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.quantities.names import (
    AXES,
    GROUPS,
    NORM,
    labels_of,
    refuse_component,
    split,
    unknown_quantity,
)
from sebody.quantities.table import NODE, find
from sebody.results import rotations
from sebody.results.histories import histories
from sebody.results.recording import Recording

SMALL_ANGLE = 1e-6      # rad: below, the axis of a rotation is that of the state before


class Values(NamedTuple):
    """Components of a history."""

    name: str
    labels: tuple[str, ...]     # of the components; one that is empty for a number
    numbers: NDArray            # (n, components)


def look_up(recording: Recording, name: str) -> NDArray:
    """History of a quantity, (n, ...), of a group, (n, members), or of a component, (n,).

    Raises
    ------
    InputError
        A name that nothing has, or a component that a quantity does not have.
    """
    whole, components = split(recording, name)
    history = (np.column_stack([_whole(recording, one) for one in GROUPS[whole]])
               if whole in GROUPS else _whole(recording, whole))
    for component in components:
        history = component_of(whole, history, component)
        whole = f"{whole}.{component}"
    return history


def values(recording: Recording, name: str) -> Values:
    """Columns of a quantity, of a component or of a group, with labels; rotations as vectors.

    Raises
    ------
    InputError
        As of `look_up`.
    """
    columns = look_up(recording, name)
    if _is_rotation(columns):
        columns = rotation_vectors(columns)
    labels = [label.replace("_", " ") for label in component_names(columns, name)]
    return Values(name, tuple(labels), columns.reshape(len(columns), -1))


def is_known(recording: Recording, name: object) -> bool:
    """Tell whether a name is that of a quantity, a component or a group."""
    try:
        look_up(recording, inputs.name(name, "name of a quantity"))
    except InputError:
        return False
    return True


def component_of(name: str, history: NDArray, component: str) -> NDArray:
    """A component of a history (n, ...) of this name.

    Raises
    ------
    InputError
        There is none of this name.
    """
    if history.ndim == 1:
        refuse_component(name, component)
    if _is_rotation(history) and component in (*AXES, NORM):
        return component_of(name, rotation_vectors(history), component)
    if component == NORM:
        return np.sqrt((history**2).reshape(len(history), -1).sum(axis=1))
    labels = labels_of(history.shape[1:], name)
    if component not in labels:
        refuse_component(name, component, labels)
    if _is_rotation(history):
        history = history.reshape(len(history), -1)
    return history[:, labels.index(component)]


def component_names(history: NDArray, name: str = "") -> list[str]:
    """Names of all numbers in a state of a history (n, ...), in their order; one that is empty."""
    if history.ndim == 1:
        return [""]
    if _is_rotation(history):
        return [*map("".join, product(AXES, AXES))]
    _, *inner = history.shape[1:]
    labels = [labels_of(history.shape[1:], name), *(map(str, range(size)) for size in inner)]
    return [*map(".".join, product(*labels))]


def rotation_vectors(matrices: NDArray) -> NDArray:
    """Rotation vectors (n, 3) of matrices (n, 3, 3), continued through full turns."""
    vectors = rotations.vectors(matrices)
    angles = np.linalg.norm(vectors, axis=1)
    known = angles > SMALL_ANGLE
    if not known.any():
        return vectors
    # the axis of a small rotation is that of the last larger one, of the first ones the first's
    last = np.maximum.accumulate(np.where(known, np.arange(len(angles)), -1))
    last[last < 0] = np.flatnonzero(known)[0]
    axes = (vectors / np.maximum(angles, SMALL_ANGLE)[:, None])[last]
    rotated = np.einsum("ni,ni->n", axes[1:], axes[:-1]) < 0
    signs = np.concatenate([[1.0], np.cumprod(np.where(rotated, -1.0, 1.0))])
    return np.unwrap(signs * angles)[:, None] * signs[:, None] * axes


def _is_rotation(history: NDArray) -> bool:
    return history.shape[1:] == (3, 3)


def saved(recording: Recording) -> list[str]:
    """Names of the histories an output file holds."""
    names = ["t"]
    for name in recording.model.nodes:
        names += [f"{name}.{quantity}" for quantity, row in NODE.items()
                  if row.saved and row.has(recording, name)]
    return [*names, "energy.kinetic", "energy.strain", "energy.potential", "energy.external_work",
            "momentum", "angular_momentum"]


def _whole(recording: Recording, name: str) -> NDArray:
    """History of a whole quantity by its full name."""
    found = find(recording, name)
    if found is None:
        raise unknown_quantity(recording, name)
    quantity, owner = found
    numbers = histories(recording)
    return numbers.whole(quantity.formula(numbers, owner))
