"""Quantities of FE nodes inside superelements as symbols: motion, stresses, section forces.

Motion follows from that of the body's frame and, with coordinates that follow in second order,
from ``r = X + Phi y + y S y / 2`` in it, stresses from amplitudes of shapes that strain the body.
These amplitudes are polynomials of second degree in the body's motion, and in forces of its loads
times the frame's rotation: their coefficients are differences of what `Stresses` computes of
motions in which one number or two are one.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from itertools import combinations
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sebody.quantities.algebra import plus, scaled, spun, times
from sebody.quantities.expressions import Number, Sum, choice, root
from sebody.quantities.inside import number_of
from sebody.quantities.symbols import NoTape, Symbols
from sebody.results.field_states import FieldStates
from sebody.results.motion import BodyMotion
from sebody.results.postprocessing import Forces
from sebody.results.recording import Recording
from sebody.results.stresses import Stresses

MOTIONS = "position", "velocity", "acceleration"
STRESSES = "stress", "section_forces", "section_strains"
MISES = "von_mises"
ROUNDED = 1e-13         # of a coefficient, relative to the values it is a difference of
PIECE = 1024            # pairs of numbers that are one at a time
# von Mises's stress squared, of the components xx, yy, zz, yz, zx, xy
MISES_FORM = np.block([[1.5 * np.eye(3) - 0.5, np.zeros((3, 3))],
                       [np.zeros((3, 3)), 3.0 * np.eye(3)]])


class Inside:
    """Quantities of the FE nodes of a body.

    Parameters
    ----------
    of : States
        See `sebody.results.tapes`.
    body : str
    """

    def __init__(self, of: Any, body: str):
        self.of, self.body = of, body
        self.tape = of.tape
        self.parts = of.motion(body)
        self.numbers = [x for own in self.parts.values() for x in own]
        self._strains: tuple[Stresses, list[Sum]] | None = None

    # motion

    def motion(self, place: int, quantity: str) -> list[Number]:
        """Position, velocity or acceleration in global axes: in axes of the frame, then turned."""
        D, own = self.of.model.dimension, self.parts
        R = [own["rotation"][3 * i:3 * i + D] for i in range(D)]
        r, rate, second = self._local(place)
        if quantity == "position":
            return plus(own["origin"], times(R, r))
        spin = own["spin"]
        if quantity == "velocity":
            return times(R, plus(own["velocity"], plus(rate, spun(spin, r))))
        twice = plus(scaled(2.0, rate), spun(spin, r))
        local = plus(second, spun(spin, twice))
        return times(R, plus(own["acceleration"], plus(local, spun(own["spin_rate"], r))))

    def _local(self, place: int) -> list[list[Number]]:
        """Place of a node in a frame that rests, its rate and second rate."""
        y, rate, second = (self.parts[name] for name in ("y", "y_rate", "y_second"))
        field, reduced = self._field(np.zeros((1, 0))), self.of.model.bodies[self.body].reduced
        shapes = field.shapes_at(place)
        forms = np.zeros((shapes.shape[1], len(y), len(y)))
        if reduced.invariants is not None:
            forms = np.einsum("bc,bij->cij", shapes[len(y):], reduced.invariants.Q)
        forms[np.abs(forms) <= ROUNDED * np.abs(forms).max(initial=0.0)] = 0.0
        found: list[list[Number]] = [[], [], []]
        for point, Phi, S in zip(field.points[place], shapes[:len(y)].T, forms, strict=True):
            for own, terms in zip(found, (
                    [(point, ()), *_linear(Phi, y), *_form(0.5 * S, y, y)],
                    [*_linear(Phi, rate), *_form(S, y, rate)],
                    [*_linear(Phi, second), *_form(S, rate, rate), *_form(S, y, second)]),
                    strict=True):
                own.append(self._sum(terms).single())
        return found

    def _field(self, numbers: NDArray, elements: NDArray | None = None) -> FieldStates:
        """The body in states with some numbers of its motion, all others zero."""
        of, recording = self.of, self.of.recording
        D, state = of.model.dimension, recording.arrays_of_loop[1]
        whole = np.zeros((len(numbers), len(self.numbers)))
        whole[:, :numbers.shape[1]] = numbers
        ends = np.cumsum([0, *map(len, self.parts.values())])
        parts = {name: whole[:, first:end] for name, first, end in zip(
            self.parts, ends, ends[1:], strict=False)}
        parts["rotation"] = parts["rotation"].reshape(-1, 3, 3)[:, :D, :D]
        rows = np.repeat(recording.rows[:1], len(numbers), axis=0)
        made = Recording(of.model, of.numbering, recording.arrays_of_loop[0], state, rows, 0.0)
        if elements is None:
            elements = np.zeros((len(numbers), state.g.size))
        vars(made).update(unique_rows=rows, forces=Forces(elements, np.zeros((
            len(numbers), state.residual.size))))
        field = FieldStates(made, self.body)
        vars(field)["motion"] = BodyMotion(**parts)
        return field

    # stresses

    def stress(self, place: int, quantity: str) -> Any:
        """Quantity that is linear in amplitudes; of beams the stress of the worst fibre."""
        stresses, amplitudes = self._strained()
        if quantity != "stress":
            rows = stresses.sections_of_node(place, quantity)
            return self._combined(rows, amplitudes)
        fibres = stresses.fibres_of_node(place)
        if fibres.shape[1] > 1:
            own = [self._combined(fibres[:, k], amplitudes) for k in range(fibres.shape[1])]
            worst = [self._mises(stress) for stress in own]
            return [choice(worst, [stress[c] for stress in own]) for c in range(6)]
        return self._combined(stresses.of_node(place), amplitudes)

    def mises(self, place: int) -> Number:
        """Von Mises's stress, of a beam that of its worst fibre."""
        stresses, amplitudes = self._strained()
        fibres = stresses.fibres_of_node(place)
        if not fibres.shape[1]:
            return self._mises(self._combined(stresses.of_node(place), amplitudes))
        own = [self._mises(self._combined(fibres[:, k], amplitudes))
               for k in range(fibres.shape[1])]
        return choice(own, own)

    def _combined(self, rows: NDArray, amplitudes: list[Sum]) -> Any:
        """Sums of amplitudes, whose weights are the rows (amplitudes, ...)."""
        if rows.ndim > 1:
            return [self._combined(rows[:, k], amplitudes) for k in range(rows.shape[1])]
        return Sum(self.tape, {(amplitudes[i].place(),): float(rows[i])
                               for i in np.flatnonzero(rows)}).single()

    def _mises(self, stress: Sequence[Sum]) -> Number:
        square: Number = 0.0
        for i, j in zip(*np.nonzero(MISES_FORM), strict=True):
            square = float(MISES_FORM[i, j]) * (stress[i] * stress[j]) + square
        return root(square)

    def _strained(self) -> tuple[Stresses, list[Sum]]:
        """Stresses of unit amplitudes, and the amplitudes."""
        if self._strains is not None:
            return self._strains
        of, size = self.of, len(self.numbers)
        places = [of.numbering.forces_at[load] + i for load in of.model.loads
                  if load.body is of.model.bodies[self.body]
                  for i in range(np.size(load.constants["P"]))]

        def amplitudes(numbers: NDArray) -> NDArray:
            elements = np.zeros((len(numbers), of.recording.arrays_of_loop[1].g.size))
            elements[:, places] = numbers[:, size:]
            return self._field(numbers[:, :size], elements).stresses().amplitudes
        own = [*self.numbers, *map(of.force, places)]
        rates = range(size - 2 * len(self.parts["y"]), size)
        factors = [self._sum((weight, [own[i] for i in product]) for weight, product in terms
                             ).single() for terms in quadratic(amplitudes, len(own), rates)]
        made = self._field(np.zeros((1, 0))).stresses().of_unit_amplitudes()
        self._strains = made, factors
        return self._strains

    def _sum(self, terms: Iterable[Term]) -> Sum:
        products: dict[tuple[int, ...], float] = {}
        for weight, factors in terms:
            product = tuple(sorted(x.place() for x in factors))
            products[product] = products.get(product, 0.0) + weight
        return Sum(self.tape, products)


def inside(of: Symbols, name: str, quantity: str) -> Any:
    """A quantity of an FE node ``<body>.node<k>``.

    Raises
    ------
    NoTape
        It has no such form.
    """
    body, _, node = name.rpartition(".node")
    recovery = of.model.bodies[body].reduced.recovery
    place = None if recovery is None else number_of(recovery, int(node))
    if place is None or quantity not in (*MOTIONS, *STRESSES, MISES):
        raise NoTape(f"the {quantity} of FE nodes")
    key = f"inside {body}"
    if key not in of.made:
        of.made[key] = Inside(of, body)
    made: Inside = of.made[key]
    if quantity in MOTIONS:
        return made.motion(place, quantity)
    return made.mises(place) if quantity == MISES else made.stress(place, quantity)


Term = tuple[float, Sequence[Sum]]
Polynomial = list[tuple[float, tuple[int, ...]]]


def _linear(weights: NDArray, numbers: Sequence[Sum]) -> list[Term]:
    return [(float(weights[i]), (numbers[int(i)],)) for i in np.flatnonzero(weights)]


def _form(matrix: NDArray, left: Sequence[Sum], right: Sequence[Sum]) -> list[Term]:
    return [(float(matrix[i, j]), (left[int(i)], right[int(j)]))
            for i, j in zip(*np.nonzero(matrix), strict=True)]


def quadratic(function: Callable[[NDArray], NDArray], size: int, alone: Sequence[int] = ()
              ) -> list[Polynomial]:
    """Coefficients of polynomials of second degree.

    Parameters
    ----------
    function : callable
        Of (n, size) numbers; returns (n, m) values.
    size : int
    alone : sequence of int, optional
        Numbers that are in no product.

    Returns
    -------
    list
        Of every value its coefficients, each with the numbers it belongs to.
    """
    unit = np.eye(size)
    pairs = np.array(list(combinations([k for k in range(size) if k not in alone], 2)),
                     dtype=np.int64).reshape(-1, 2)
    values = function(np.vstack([np.zeros((1, size)), unit, -unit]))
    zero, plus, minus = np.split(values, [1, 1 + size])
    linear, square = (plus - minus) / 2.0, (plus + minus) / 2.0 - zero
    of_size = ROUNDED * (np.abs(plus) + np.abs(minus) + np.abs(zero))
    linear[np.abs(linear) <= of_size] = 0.0
    square[np.abs(square) <= of_size] = 0.0
    polynomials: list[Polynomial] = [[(float(x), ())] * bool(x) for x in zero[0]]
    for i, m in zip(*np.nonzero(linear), strict=True):
        polynomials[m].append((float(linear[i, m]), (int(i),)))
    for i, m in zip(*np.nonzero(square), strict=True):
        polynomials[m].append((float(square[i, m]), (int(i), int(i))))
    for first in range(0, len(pairs), PIECE):
        i, j = pairs[first:first + PIECE].T
        both = function(unit[i] + unit[j])
        mixed = both - plus[i] - plus[j] + zero
        mixed[np.abs(mixed) <= ROUNDED * (np.abs(both) + np.abs(plus[i]) + np.abs(plus[j])
                                          + np.abs(zero))] = 0.0
        for p, m in zip(*np.nonzero(mixed), strict=True):
            polynomials[m].append((float(mixed[p, m]), (int(i[p]), int(j[p]))))
    return polynomials
