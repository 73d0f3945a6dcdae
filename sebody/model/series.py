"""Series of loads on a model: on coordinates of superelements, and along beams by station."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from itertools import pairwise
from typing import Unpack

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.basics.spelling import unknown
from sebody.contract.names import body_load_kind
from sebody.fem.loads import line_load
from sebody.fem.model import FEModel
from sebody.io.load_series import LoadSeries
from sebody.model.acting import Acting
from sebody.model.arguments import chosen_name, vector
from sebody.model.beams import course_of, part_models
from sebody.model.frames import FRAMES
from sebody.model.histories import time_function
from sebody.model.mechanism import Mechanism
from sebody.model.parts import Beam, Element, Superelement
from sebody.model.time_functions import TimeFunction
from sebody.reduction.body import ReducedBody

AXES = "xyz"


def body_series(model: Mechanism, body: str, series: LoadSeries,
                amplitude: ArrayLike | Callable[[float], float] | TimeFunction | None = None,
                columns: Mapping[str, str] | None = None, name: str | None = None,
                **acting: Unpack[Acting]) -> Element:
    """A series of loads on the coordinates of a superelement: one element for all columns.

    What a column acts on is its name: a position ``NODE.x``, a rotation ``NODE.rx`` (a moment), an
    internal mode ``mode 0``, or a load that was reduced with the body. Where the body has one node
    beside its base, as a foundation, ``x`` to ``rz`` will do. As `body_load` it turns with the
    frame of the body; the frame of a foundation stands still.

    Parameters
    ----------
    body : str
        Name of a superelement.
    series : LoadSeries
        Of all its columns.
    amplitude : float, table, function or profile, optional
        Time function that the series is multiplied by.
    columns : mapping of str to str, optional
        What columns act on, by their names, where these do not say it.
    **acting
        `until`, `from_`, `breaks_at`, `release_when`: see `sebody.model.acting.Acting`.

    Raises
    ------
    InputError
        A superelement there is not, no series, or a column that acts on nothing.
    """
    placed = _placed(model, body)
    inputs.instance(series, f"series on {body!r}", LoadSeries,
                    "give a LoadSeries, as LoadSeries.from_csv or read_extptfm make it")
    others = inputs.mapping({} if columns is None else columns, "columns", "give a dict of texts")
    for one in others:
        if one not in series.names:
            raise unknown("column", one, series.names, "the series has", "it has none")
    targets = [others.get(one, one) for one in series.names]
    vectors = _targets(placed)
    for one in targets:
        if one not in vectors:
            raise InputError(f"superelement {body!r} has nothing that column {one!r} acts on: "
                             f"columns are called {_example(placed)}, or give columns={{...}}")
    matrix = np.column_stack([vectors[one] for one in targets])
    return _add(model, placed, series, matrix, time_function(amplitude),
                chosen_name(model, name, f"series on {body}"))


def beam_series(model: Mechanism, beam: str, series: LoadSeries, stations: ArrayLike,
                direction: ArrayLike,
                amplitude: ArrayLike | Callable[[float], float] | TimeFunction | None = None,
                name: str | None = None, **acting: Unpack[Acting]) -> list[Element]:
    """A force by length along a beam, whose values at some stations are a series.

    Between stations the force by length is linear, beyond the first and last one it is none; within
    a finite element it is linear between its ends. It turns with the frame of each superelement of
    the beam. All share one table.

    Parameters
    ----------
    beam : str
        Name of a beam that `beam` made.
    series : LoadSeries
        A column for each station: force by length [force/length].
    stations : (columns,)
        Distance of each from the first end of the beam, ascending [length].
    direction : (3,), planar (2,)
        Direction of the force at the start, in global axes.
    amplitude
        As of `body_series`.
    **acting
        `until`, `from_`, `breaks_at`, `release_when`: see `sebody.model.acting.Acting`.

    Returns
    -------
    list of Element
        One for each superelement that the force acts on, numbered as these.

    Raises
    ------
    InputError
        No such beam, stations that do not ascend along it or are not as many as columns.
    """
    named = {one.name: one for one in model.beams}
    if not isinstance(beam, str) or beam not in named:
        raise unknown("beam", beam, named, "the model has", "the model has none")
    made = named[beam]
    inputs.instance(series, f"series on beam {beam!r}", LoadSeries,
                    "give a LoadSeries, as LoadSeries.from_csv makes it")
    direction = vector(model, direction, f"direction of the series on beam {beam!r}")
    length = course_of(model, made, made.section).length
    remedy = (f"give {len(series.names)} numbers, one for each column, ascending from 0 to "
              f"{length:.6g}")
    places = inputs.vector(stations, "stations", len(series.names), remedy=remedy)
    near = 1e-9 * length
    if (np.diff(places) <= 0).any() or places[0] < -near or places[-1] > length + near:
        raise InputError(f"stations are {places}: {remedy}")
    course = time_function(amplitude)
    name = chosen_name(model, name, f"series on {beam}")
    found = [(part, matrix) for part, matrix in _beam_columns(
        model, made, places, direction, near) if matrix.any()]
    return [_add(model, part, series, matrix, course,
                 name if len(found) == 1 else f"{name} {k}")
            for k, (part, matrix) in enumerate(found, 1)]


def coordinate_vectors(body: ReducedBody, nodes: list[str]) -> dict[str, NDArray]:
    """Unit vectors of the reduced coordinates by the names that columns of a series have."""
    dimension, rows = body.coordinates.shape[1], iter(np.eye(len(body.mass)))
    names = [f"{nodes[k]}.{axis}" for k in body.position_nodes for axis in AXES[:dimension]]
    names += [f"{nodes[k]}.r{axis}" for k in body.rotation_nodes
              for axis in (AXES if dimension == 3 else "z")]
    return dict(zip([*names, *(f"mode {k}" for k in range(body.modes))], rows, strict=True))


def _targets(placed: Superelement) -> dict[str, NDArray]:
    """Targets of columns, by name."""
    body, nodes = placed.reduced, [node.name for node in placed.nodes]
    vectors = coordinate_vectors(body, nodes)
    others = [name for k, name in enumerate(nodes) if k != body.base]
    if len(others) == 1:
        first = f"{others[0]}."
        vectors |= {name.removeprefix(first): row for name, row in vectors.items()
                    if name.startswith(first)}
    return vectors | dict(body.loads)


def _example(placed: Superelement) -> str:
    names = list(coordinate_vectors(placed.reduced, [node.name for node in placed.nodes]))
    last = f", {names[-1]!r}" if placed.reduced.modes else ""
    loads = "".join(f", {name!r}" for name in placed.reduced.loads)
    return f"{names[0]!r}, {names[len(placed.positions) * 3 % len(names)]!r}{last}{loads}"


def _beam_columns(model: Mechanism, beam: Beam, places: NDArray, direction: NDArray, near: float
                  ) -> Iterator[tuple[Superelement, NDArray]]:
    """Superelements of a beam and their reduced loads of each station alone, (n, stations)."""
    length = course_of(model, beam, beam.section).length
    for part, body, (fe, turn), span in zip(beam.parts, beam.bodies, part_models(model, beam),
                                            pairwise(beam.places), strict=True):
        along = length * np.linspace(*span, len(fe.coordinates))
        for end in (places[0], places[-1]):     # nodes at the ends, but for rounding
            along[np.abs(along - end) < near] = end
        local = turn.T @ direction
        by_station = [np.interp(along, places, one, left=0.0, right=0.0)
                      for one in np.eye(len(places))]
        loads = np.column_stack([line_load(fe, np.outer(values, local)) for values in by_station])
        yield part, _reduced(body, fe, loads)


def _reduced(body: ReducedBody, fe: FEModel, loads: NDArray) -> NDArray:
    """``Phi^T p`` of loads on the FE DOFs of a beam along its own axes."""
    recovery = body.recovery
    assert recovery is not None
    shapes = recovery.shapes[:, :len(body.mass)]
    of_body = shapes.T @ loads[fe.rows.ravel()]
    return of_body if recovery.by is None else recovery.by @ of_body


def _placed(model: Mechanism, name: str) -> Superelement:
    if not isinstance(name, str) or name not in model.bodies:
        raise unknown("superelement", name, model.bodies, "the model has", "the model has none")
    return model.bodies[name]


def _add(model: Mechanism, placed: Superelement, series: LoadSeries, matrix: NDArray,
         course: TimeFunction, name: str) -> Element:
    kind = body_load_kind(FRAMES[placed.frame].kernel, model.planar)
    load = Element(name, kind, placed.attachments,
                   {"P": np.zeros(len(matrix)), "columns": matrix}, time_function=course,
                   body=placed, series=series)
    model.loads.append(load)
    return load
