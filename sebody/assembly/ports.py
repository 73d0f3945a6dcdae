"""Power ports of a model: where loads, drives and dampers supply or take energy."""

from collections.abc import Iterable, Mapping
from itertools import accumulate, pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.contract.layout import INPUT
from sebody.engine.load_amplitudes import AMPLITUDE, PIECE, POLYNOMIAL, SERIES
from sebody.kernels.loader import element_kernel
from sebody.model.histories import Pieces
from sebody.model.mechanism import Mechanism
from sebody.model.numbering import Numbering
from sebody.model.parts import DofBlock, Element, Superelement
from sebody.model.time_functions import TimeFunction, same_waves


class Ports(NamedTuple):
    """Power ports: of loads, springs and drives, of damped bodies, of prescribed motions."""

    of: dict[Element | Superelement, int]   # constraint, load, spring or body -> port
    names: list[str]
    time_functions: list[TimeFunction]
    prescribed: list[tuple[int, int, int, float]]   # coordinate, port, 1 for a rotation, factor
    jumps: list[list[float]]        # times at which accelerations jump with the port
    forced: list[bool]              # ports of loads, which are no motions
    gravity: list[tuple[int, NDArray]]      # ports of gravity that changes with time, their fields


def number_ports(model: Mechanism, at: Mapping[DofBlock, int]) -> Ports:
    """Power ports of a model; `at` is the first coordinate of each DOF block, by id."""
    ports = Ports({}, [], [], [], [], [], [])

    def add(name: str, time_function: TimeFunction | None, jumps: list[float],
            forced: bool = False) -> int:
        ports.names.append(name)
        ports.time_functions.append(time_function or TimeFunction())
        ports.jumps.append(jumps)
        ports.forced.append(forced)
        return len(ports.names) - 1

    for element in (*model.constraints, *model.loads):
        if element_kernel(element.kind).POWER:
            ports.of[element] = add(element.name, element.time_function, _jumps(element),
                                    not element.multipliers)
    for body in model.bodies.values():
        if body.reduced.damping is not None:
            ports.of[body] = add(f"damping of {body.name}", None, [])
    for dof_block in model.dof_blocks():
        rotational = int(dof_block.rotational and not model.planar)
        for motion in dof_block.motions:
            port = add(motion.name, motion.time_function, motion.time_function.abrupt(2))
            ports.prescribed.extend((at[dof_block] + k, port, rotational, d)
                                    for k, d in enumerate(motion.direction) if d != 0.0)
    for one in model.gravity_courses:
        port = add(one.name, one.time_function, one.time_function.abrupt(0), True)
        ports.gravity.append((port, one.direction))
    return ports


def series_of(model: Mechanism, ports: int) -> dict[Element, int]:
    """Loads that have a series, and the place of its first amplitude, behind those of all ports."""
    loads = [load for load in model.loads if load.series is not None]
    places = accumulate((len(load.series.names) for load in loads), initial=3 * ports)
    return dict(zip(loads, places, strict=False))


def series_arrays(series: Mapping[Element, int], ports: Mapping[Element | Superelement, int],
                  pieces_of: Mapping[Element, Pieces]) -> dict[str, NDArray]:
    """The members of `System` for series of loads; `series` has the places of their amplitudes.

    Loads that have one series share its table.
    """
    rows, known = [], {}
    times, values = [np.zeros(0)], [np.zeros(0)]
    for load, at in series.items():
        pieces = pieces_of[load]
        if load.series not in known:
            known[load.series] = sum(map(len, times)), sum(map(len, values))
            times.append(pieces.times)
            values.append(pieces.coefficients.ravel())
        first, place = known[load.series]
        count, terms, columns = pieces.coefficients.shape
        rows.append((ports[load], first, count, columns, terms, place, at))
    return {"series": np.array(rows, dtype=np.int64).reshape(-1, SERIES),
            "series_times": np.concatenate(times), "series_values": np.concatenate(values)}


def _jumps(element: Element) -> list[float]:
    """Times at which an element makes accelerations jump."""
    if element.time_function is None:
        return []
    if element.series is not None:
        return element.time_function.abrupt(0)      # and those of the series, see `port_arrays`
    if element.function is not None:        # of its corners: what it does there is not known
        return list(element.time_function.corners)
    return element.time_function.abrupt(2 if element.multipliers else 0)


def port_arrays(time_functions: list[TimeFunction], numbering: Numbering, jumps: list[list[float]],
                series: Iterable[Pieces]) -> dict[str, NDArray]:
    """The members of `System` for time functions of ports and for prescribed coordinates.

    `time_functions`, `jumps` and `series` are as steps are given them.
    """
    prescribed, inputs = numbering.prescribed, numbering.memory.inputs
    fields = np.zeros((len(numbering.gravity), 3))
    for row, (_, field) in zip(fields, numbering.gravity, strict=True):
        row[:field.size] = field
    series = list(series)
    jumping = {t for times in (*jumps, *(one.jumps.tolist() for one in series)) for t in times}
    corners = sorted(jumping.union(*(_corners(h) for h in time_functions),
                                   *(one.corners.tolist() for one in series)))
    return {"table_at": np.array([0, *accumulate(len(h.times) for h in time_functions)],
                                 dtype=np.int64),
            "table_times": np.array([t for h in time_functions for t in h.times], dtype=float),
            "table_pieces": _pieces(time_functions),
            "corners": np.array(corners, dtype=float),
            "jumps": np.array([int(t in jumping) for t in corners], dtype=np.int64),
            "functions": np.array([
                (INPUT, inputs[port], 0) if port in inputs else h.addresses
                for port, h in enumerate(time_functions)], dtype=np.int64).reshape(-1, 3),
            "prescribed": np.array([row[:3] for row in prescribed], dtype=np.int64).reshape(-1, 3),
            "prescribed_factor": np.array([row[3] for row in prescribed], dtype=float),
            "gravity_ports": np.array([port for port, _ in numbering.gravity], dtype=np.int64),
            "gravity_fields": fields}


def _corners(one: TimeFunction) -> list[float]:
    """Times at which variable steps end.

    Between two corners of a function that is not known, such as the ends of a short pulse, steps
    also end at three times, so that none steps over what happens there.
    """
    corners = list(one.corners)
    if one.functions or one.is_time:
        corners += [(1.0 - s) * a + s * b for a, b in pairwise(one.corners)
                    for s in (0.25, 0.5, 0.75)]
    return corners


def _pieces(time_functions: list[TimeFunction]) -> NDArray:
    """Polynomials and harmonics of all pieces of all time functions, (pieces, PIECE)."""
    rows = np.zeros((sum(len(h.pieces) for h in time_functions), PIECE))
    if time_functions:
        rows[:, :POLYNOMIAL] = np.concatenate([h.polynomials() for h in time_functions])
    if waves := same_waves(time_functions):
        rows[:, AMPLITUDE:] = waves
    return rows
