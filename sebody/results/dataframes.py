"""Histories as tables of pandas and data sets of xarray (extra ``tables``)."""

from collections.abc import Iterable, Iterator
from importlib.util import find_spec
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.basics.units import parsed_units
from sebody.quantities.names import STRESS
from sebody.results.naming import component_names, look_up, saved
from sebody.results.recording import Recording
from sebody.results.units import unit

if TYPE_CHECKING:
    from pandas import DataFrame
    from xarray import Dataset


def to_pandas(recording: Recording, names: Iterable[str] | None) -> "DataFrame":
    """A column for each component, as in ``tip.position.x``; the index is the time.

    Raises
    ------
    InputError
        pandas is missing, or a name that nothing has.
    """
    check_installed("pandas")
    from pandas import DataFrame, Index

    columns = {}
    for name, values in _histories(recording, names):
        labels = component_names(values, name)
        for label, column in zip(labels, values.reshape(len(values), -1).T, strict=True):
            columns[f"{name}.{label}" if label else name] = column
    return DataFrame(columns, index=Index(recording.recorded("t")[:, 0], name="t"))


def to_xarray(recording: Recording, names: Iterable[str] | None) -> "Dataset":
    """A variable for each quantity, with its unit in words; dimensions are t and components.

    Raises
    ------
    InputError
        xarray is missing, or a name that nothing has.
    """
    check_installed("xarray")
    from xarray import Dataset

    units = parsed_units(recording.model.units)
    variables = {}
    coordinates: dict[str, NDArray | list[str]] = {"t": recording.recorded("t")[:, 0]}
    for name, values in _histories(recording, names):
        sizes = values.shape[1:]
        dimensions = _dimensions(values, name, recording.model.dimension)
        for dimension, size in zip(dimensions, sizes, strict=True):
            if labels := {"axis": "xyz", "row": "xyz", "column": "xyz",
                          "component": STRESS}.get(dimension):
                coordinates[dimension] = list(labels[:size])
        variables[name] = (("t", *dimensions), values, {"units": unit(name, units)})
    return Dataset(variables, coordinates)


def _dimensions(values: NDArray, name: str, dimension: int) -> list[str]:
    sizes = values.shape[1:]
    if sizes == (3, 3):
        return ["row", "column"]
    labels = tuple(component_names(values, name))
    if labels == STRESS:
        return ["component"]
    if labels == tuple("xyz"[:dimension]):
        return ["axis"]
    return [f"number_{size}" for size in sizes]


def _histories(recording: Recording, names: Iterable[str] | None
               ) -> Iterator[tuple[str, NDArray]]:
    wanted = saved(recording) if names is None else inputs.items(
        names, "names", "give a list of names of quantities")
    if not wanted:
        raise inputs.refusal("names", names, "name a quantity, or leave it out")
    for name in wanted:
        inputs.name(name, "name of a quantity")
        if name != "t":
            yield name, np.asarray(look_up(recording, name))


def check_installed(package: str) -> None:
    """Refuse tables without their package.

    Raises
    ------
    InputError
        It is missing.
    """
    if find_spec(package) is None:
        raise InputError(f'tables need {package}: pip install "sebody[tables]"')
