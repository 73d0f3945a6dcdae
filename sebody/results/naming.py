"""The grammar of quantities, in one place: the meaning of ``tip.position.y`` everywhere.

=======================  =========================================================================
``tip.position``         a quantity, by the table of `sebody.quantities.table`
``tip.position.y``       a component: x, y, z of vectors, xx, xy, ... of rotation matrices and
                         stresses, 0, 1, ... of everything else
``tip.position.norm``    the length of a vector
``tip.rotation.z``       of a rotation matrix its rotation vector, followed through full turns
``energy``               a group of quantities of the model, see `GROUPS`
=======================  =========================================================================
"""

from collections.abc import Sequence
from itertools import product
from typing import NamedTuple, NoReturn

import numpy as np
from numpy.typing import NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.basics.spelling import alike
from sebody.quantities.table import OWNERS, find
from sebody.results import quantities, rotations
from sebody.results.recording import Recording

AXES, NORM = "xyz", "norm"
STRESS = "xx", "yy", "zz", "yz", "zx", "xy"
GROUPS = {"energy": ("energy.kinetic", "energy.strain", "energy.potential",
                     "energy.external_work"),
          "constraints": ("constraints.position", "constraints.velocity")}
NUMBERED = {name for owner in OWNERS for name, row in owner.quantities.items() if row.numbered}
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
    history = (np.column_stack([quantities.look_up(recording, one) for one in GROUPS[whole]])
               if whole in GROUPS else quantities.look_up(recording, whole))
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
    """Whether a name is that of a quantity, a component or a group."""
    try:
        look_up(recording, inputs.name(name, "name of a quantity"))
    except InputError:
        return False
    return True


def split(recording: Recording, name: str) -> tuple[str, list[str]]:
    """The quantity or group that a name begins with, and the components behind it.

    Raises
    ------
    InputError
        A name that nothing has; the message has names that are like it.
    """
    inputs.name(name, "name of a quantity")
    whole = name
    components: list[str] = []
    while whole not in GROUPS and find(recording, whole) is None:
        before, _, last = whole.rpartition(".")
        if not before or not (_may_be_component(last) or find(recording, before)):
            raise _unknown(recording, name, whole, components)
        whole, components = before, [last, *components]
    return whole, components


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


def labels_of(shape: tuple[int, ...], name: str) -> list[str]:
    """Components of a quantity of a shape in a state: of a matrix its rows, of a rotation all."""
    if shape == (3, 3):
        return [*map("".join, product(AXES, AXES))]
    return _labels(shape[0], name, len(shape) > 1)


def refuse_component(name: str, component: str, labels: Sequence[str] = ()) -> NoReturn:
    """Refuse a component that a quantity does not have."""
    if not labels:
        raise InputError(f"{name}.{component} is unknown: {name} is one number, it has no "
                         "components")
    known = [*(AXES if len(labels) == 9 and labels[0] == "xx" else ()), *labels, NORM]
    raise InputError(f"{name}.{component} is unknown: {name} has the components "
                     f"{', '.join(known)}")


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


def _unknown(recording: Recording, name: str, whole: str, components: list[str]) -> InputError:
    """The exception for a name that nothing has; `whole` is what there is before components."""
    if components and (near := alike(whole, quantities.names(recording))):
        meant = " or ".join(repr(".".join([one, *components])) for one in near)
        return InputError(f"{name!r} is unknown: did you mean {meant}?")
    return quantities.unknown_quantity(recording, name)


def _may_be_component(last: str) -> bool:
    return last in (*AXES, NORM, *STRESS, *map("".join, product(AXES, AXES))) or last.isdecimal()


def _is_rotation(history: NDArray) -> bool:
    return history.shape[1:] == (3, 3)


def _labels(size: int, name: str, has_inner: bool) -> list[str]:
    """Names of the columns of a quantity, of its rows where these have columns."""
    if name in GROUPS:
        return [one.partition(".")[2] for one in GROUPS[name]]
    quantity = name.rpartition(".")[2]
    if quantity == "stress" or (not name and size == len(STRESS)):
        return list(STRESS)
    directions = size in (2, 3) and quantity not in NUMBERED and not has_inner
    return list(AXES[:size]) if directions else [*map(str, range(size))]
