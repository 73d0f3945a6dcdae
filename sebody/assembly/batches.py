"""Bodies and elements in batches that share a kernel: their index rows and constants."""

from collections.abc import Iterable, Mapping
from itertools import accumulate
from types import ModuleType
from typing import NamedTuple
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sebody.assembly.body_constants import frame_constants, full_rows, superelement_constants
from sebody.assembly.contracts import (
    check_element,
    check_superelement,
    constants_row,
    counts_of,
    index_row,
    positions_of,
)
from sebody.assembly.controller_rows import ActuatorRow, law_constants, law_counts, law_row
from sebody.assembly.equal_bodies import (
    behind_row,
    constants_key,
    kernel_together,
    lanes_exist,
    many_alike,
    turn_row,
)
from sebody.assembly.memory_map import frame_numbers
from sebody.contract.counts import CACHE_LINE, Counts, axes_of, superelement_counts
from sebody.contract.equal_row import NOT_TURNED
from sebody.contract.layout import AT_POSITIONS, AT_ROTATIONS
from sebody.engine.offsets import at_cache_lines
from sebody.kernels.loader import element_kernel, load
from sebody.model.body_points import point_constants
from sebody.model.mechanism import Mechanism
from sebody.model.numbering import Numbering, coordinates
from sebody.model.parts import Element, Node, PathPiece, Superelement
from sebody.model.path_tables import path_numbers
from sebody.reduction.body import ReducedBody

# rows of constants of every body that is still in use: the next run of its model needs them again
_rows: WeakKeyDictionary[ReducedBody, dict[tuple, NDArray]] = WeakKeyDictionary()


class Shape(NamedTuple):
    """Key of the index arrays of a batch."""

    width: int
    stride: int                             # length of an index row
    frames: tuple[int, ...]                 # these as in `Batch`
    unknowns: tuple[tuple[int, ...], ...]
    full: tuple[int, ...]


class Batch(NamedTuple):
    """Elements that share a kernel, numbers of positions and rotations, and of unknowns.

    Equal bodies of large models are batches of their own.
    """

    kernel: ModuleType
    width: int
    frames: list[int]               # number of the frame of each element, -1 for global axes
    rows: list[list[int]]           # index rows
    unknowns: list[list[int]]       # unknowns of each element
    owners: list[int]               # id of the body, constraint or load of each element
    full: list[int]                 # leading unknowns of each beyond which its matrix is diagonal

    @property
    def shape(self) -> Shape:
        """Keys of index arrays."""
        return Shape(self.width, len(self.rows[0]), tuple(self.frames),
                     tuple(map(tuple, self.unknowns)), tuple(self.full))


class Batches(NamedTuple):
    """All of a model: superelements, then elements without a power port, then those with one."""

    all: list[Batch]
    first_joint: int        # first batch that is not of superelements
    first_power: int        # first batch of elements with a power port
    constants: NDArray


class _Constants:
    """Rows of constants, one after the other, each from a whole cache line on."""

    def __init__(self) -> None:
        self._rows: list[tuple[int, NDArray]] = []
        self._size = 0

    def add(self, row: NDArray) -> int:
        """Append a row; returns where it begins."""
        first = self._size
        self._rows.append((first, row))
        self._size += -(-len(row) // CACHE_LINE) * CACHE_LINE
        return first

    def numbers(self) -> NDArray:
        """All of them."""
        whole = at_cache_lines(self._size)
        for first, row in self._rows:
            whole[first:first + len(row)] = row
        return whole


def make_batches(model: Mechanism, numbering: Numbering) -> Batches:
    """Batches of a model, every element verified against its kernel.

    Raises
    ------
    InputError
        An element that does not fit its kernel.
    """
    constants = _Constants()
    bodies = _body_batches(model, numbering, constants)
    elements = [*model.rigid_bodies.values(), *model.constraints, *model.loads]
    idle = [e for e in elements if not element_kernel(e.kind).POWER]
    working = [e for e in elements if element_kernel(e.kind).POWER]
    frames = frame_numbers(model)
    joints = _element_batches(numbering, constants, idle, frames)
    loads = _element_batches(numbering, constants, [e for e in working if e.law is None], frames)
    # these set amplitudes of the loads behind them
    laws = _law_batches(model, numbering, constants, [e for e in working if e.law is not None],
                        loads)
    return Batches(bodies + joints + laws + loads, len(bodies), len(bodies) + len(joints),
                   constants.numbers())


def _body_batches(model: Mechanism, numbering: Numbering, constants: _Constants) -> list[Batch]:
    batches: dict[tuple, Batch] = {}
    known: dict[tuple, tuple[int, int]] = {}
    turns: dict[int, int] = {}      # by places of constants
    many, eight = many_alike(model), lanes_exist()
    for frame, body in enumerate(model.bodies.values()):
        kernel = load(body.kernel)
        check_superelement(body, kernel)
        at_constants, full = _constants_of(body, known, constants)
        unknowns = [c for t in (*body.positions, *body.rotations)
                    for c in coordinates(numbering, t)]
        first = numbering.modes[body.name]
        unknowns += range(first, first + body.reduced.modes)
        row = index_row(body.name, kernel, unknowns, constants=at_constants, frame=frame,
                        port=numbering.ports.get(body, 0), positions=len(body.positions),
                        nodes=[numbering.rotations.get(t, 0) for t in body.rotations])
        common, turn = at_constants, NOT_TURNED
        if body.name in many and many[body.name].turned:
            common, _ = _constants_of(many[body.name].model, known, constants)
            if at_constants not in turns:
                turns[at_constants] = constants.add(turn_row(body))
            turn = turns[at_constants]
        if body.name in many and eight:
            _append(batches, kernel_together(), frame, row + behind_row(body, common, turn),
                    unknowns, body, full, common)
        else:
            _append(batches, kernel, frame, row, unknowns, body, full)
    return list(batches.values())


def _constants_of(body: Superelement, known: dict[tuple, tuple[int, int]],
                  constants: _Constants) -> tuple[int, int]:
    """The start of a superelement's constants, and the row beyond which a matrix is diagonal."""
    key = constants_key(body)
    if key not in known:
        kernel, how = load(body.kernel), key[1:]
        rows = _rows.setdefault(body.reduced, {})
        if how not in rows:
            rows[how] = constants_row(body.name, kernel, counts_of(body),
                                      superelement_constants(body))
        known[key] = constants.add(rows[how]), full_rows(body, kernel)
    return known[key]


def _element_batches(numbering: Numbering, constants: _Constants, elements: Iterable[Element],
                     frames: Mapping[Superelement | Element, int]) -> list[Batch]:
    """Batches of elements; those on bodies use the frame of their body."""
    batches: dict[tuple, Batch] = {}
    for element in elements:
        kernel, unknowns = element_kernel(element.kind), element_unknowns(numbering, element)
        check_element(element, kernel, len(unknowns), numbering)
        frame = -1 if element.body is None else frames[element.body]
        row = index_row(element.name, kernel, unknowns,
                        frame=_kept_at(numbering, element, max(frame, 0)),
                        constants=constants.add(_element_constants(element, kernel)),
                        port=numbering.ports.get(element, 0), positions=positions_of(element),
                        nodes=_matrices(numbering, element))
        behind = [] if element.function is None else [element.function.address]
        if element.point is not None:
            behind = [frames[element.point.body]]
        if element.path is not None:
            carrier = element.path.here.carrier
            behind = [frames[element if isinstance(carrier, Node) else carrier]]
        if element.seen is not None:
            assert element.pressed_by is not None
            behind = [numbering.memories[element.pressed_by.constraints[element.seen]][0]]
        if element.body is not None:
            columns = 0 if element.series is None else len(element.series.names)
            behind = [numbering.series.get(element, 0), columns]
        modes = 0 if element.body is None else element.body.reduced.modes
        _append(batches, kernel, frame, row + behind, unknowns, element,
                len(unknowns) - modes)
    return list(batches.values())


def _law_batches(model: Mechanism, numbering: Numbering, constants: _Constants,
                 laws: Iterable[Element], loads: Iterable[Batch]) -> list[Batch]:
    """Batches of continuous controllers, which call the kernels of their actuators."""
    batches: dict[tuple, Batch] = {}
    rows = {owner: ActuatorRow(batch.kernel.kernel.address, unknowns, row)
            for batch in loads for owner, unknowns, row in zip(
                batch.owners, batch.unknowns, batch.rows, strict=True)}
    for element in laws:
        kernel, unknowns = element_kernel(element.kind), element_unknowns(numbering, element)
        check_element(element, kernel, len(unknowns), numbering)
        values = law_constants(model, numbering, element)
        own = constants_row(element.name, kernel, law_counts(values), values)
        row = index_row(element.name, kernel, unknowns, constants=constants.add(own),
                        frame=_kept_at(numbering, element, 0), port=numbering.ports[element],
                        positions=positions_of(element), nodes=_matrices(numbering, element))
        row = row + law_row(model, numbering, element, unknowns, rows)
        _append(batches, kernel, -1, row, unknowns, element, len(unknowns))
    return list(batches.values())


def _element_constants(element: Element, kernel: ModuleType) -> NDArray:
    """The row of constants; with what places the frame of a body, and a point in it."""
    if element.path is not None:
        return _path_constants(element, kernel)
    body = element.body if element.point is None else element.point.body
    if body is None:
        return constants_row(element.name, kernel, {}, element.constants)
    if element.point is not None:
        more: dict[str, ArrayLike] = point_constants(element.point)
    else:
        more = {"columns": np.zeros((len(body.reduced.mass), 0))}
    values = frame_constants(body) | more | dict(element.constants)
    series = np.shape(values["columns"])[1] if element.point is None else 0
    return constants_row(element.name, kernel, counts_of(body) | {"series": series}, values)


def _path_constants(element: Element, kernel: ModuleType) -> NDArray:
    """The row of constants on a path: what places the frame, forces that move, and the path."""
    assert element.path is not None
    own, on = dict(element.constants), element.path
    path = path_numbers(on.path, on.piece, "axles" in own, on.turns)
    if on.section is not None:
        path = np.concatenate([path, on.section.ravel()])
    if "axles" in own:
        axles = np.asarray(own.pop("axles"))
        path = np.concatenate([path, [len(axles)], axles.ravel()])
    counts, values = carrier_constants(element.path.here)
    return constants_row(element.name, kernel, {**counts, "path": len(path)},
                         values | own | {"path": path})


def carrier_constants(piece: PathPiece) -> tuple[Counts, dict[str, ArrayLike]]:
    """Counts and constants of what a piece of a path is on: before those of the path."""
    carrier = piece.carrier
    if not isinstance(carrier, Node):
        return counts_of(carrier), frame_constants(carrier)
    planar = len(carrier.point) == 2
    counts = {**axes_of(planar), **superelement_counts(1, 1, planar, piece.carrier_width)}
    return counts, {"alphas": [1.0], "fits": [1.0], "alpha_rs": [1.0],
                    "X": np.zeros((1, len(carrier.point)))}


def _matrices(numbering: Numbering, element: Element) -> list[int]:
    """Numbers of the rotation matrices; on planar bodies angles are counted by zeros."""
    if element.body is not None or any(element.carried):
        blocks = element.dof_blocks
        if element.path is not None and element.path.section is None:  # an angle is an unknown
            blocks = blocks[:element.carried[0]]
        return [numbering.rotations.get(t, 0) for t in blocks if t.rotational]
    return [numbering.rotations[t] for t in element.dof_blocks if t in numbering.rotations]


def _append(batches: dict[tuple, Batch], kernel: ModuleType, frame: int, row: list[int],
            unknowns: list[int], owner: int, full: int, like: int = -1) -> None:
    key = kernel.__name__, row[AT_POSITIONS], row[AT_ROTATIONS], len(unknowns), len(row), like
    batch = batches.setdefault(key, Batch(kernel, len(unknowns), [], [], [], [], []))
    batch.frames.append(frame)
    batch.rows.append(row)
    batch.unknowns.append(unknowns)
    batch.owners.append(owner)
    batch.full.append(full)


def element_unknowns(numbering: Numbering, element: Element) -> list[int]:
    """Coordinates of an element, then its multipliers."""
    unknowns = [c for t in element.dof_blocks for c in coordinates(numbering, t)]
    places, modes = element.carried
    if modes:       # internal modes come behind the nodes of the body
        at = sum(t.start.size for t in element.dof_blocks[:places])
        first = numbering.modes[_carrier(element)]
        unknowns[at:at] = range(first, first + modes)
    if element.body is not None:
        first = numbering.modes[element.body.name]
        unknowns += range(first, first + element.body.reduced.modes)
    if element.law is not None:
        unknowns += [numbering.modes[body] + mode for body, mode in element.law.modes]
    if element.mode is not None:
        unknowns.append(numbering.modes[element.mode[0]] + element.mode[1])
    if element.equations.multipliers:
        first = numbering.multipliers[element]
        unknowns += range(first, first + element.equations.multipliers)
    return unknowns + numbering.reads.get(element, [])


def _carrier(element: Element) -> str:
    """Name of the body whose coordinates come first."""
    if element.path is not None:
        return element.path.here.carrier.name
    assert element.point is not None
    return element.point.body.name


def _kept_at(numbering: Numbering, element: Element, otherwise: int) -> int:
    """The start of the numbers that an element keeps from step to step."""
    own = numbering.memories.get(element)
    return otherwise if own is None else own[0]


def starts(sizes: Iterable[int]) -> NDArray:
    """First index of every piece when pieces of these sizes follow one another, and the end."""
    return np.array([0, *accumulate(sizes)], dtype=np.int64)
