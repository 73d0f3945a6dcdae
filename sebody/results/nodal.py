"""Quantities of FE nodes inside superelements as symbols: motion, stresses, section forces.

Motion follows from that of the body's frame and from the amplitudes of its shapes, stresses from
amplitudes of shapes that strain it. Amplitudes are polynomials of second degree in the body's
motion, and in forces of its loads times the frame's rotation: their coefficients are differences of
what `sebody.results` computes of motions in which one number or two are one.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
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
        r = self._local(place, "places")
        if quantity == "position":
            return plus(own["origin"], times(R, r))
        rate, spin = self._local(place, "velocities"), own["spin"]
        if quantity == "velocity":
            return times(R, plus(own["velocity"], plus(rate, spun(spin, r))))
        twice = plus(scaled(2.0, rate), spun(spin, r))
        local = plus(self._local(place, "accelerations"), spun(spin, twice))
        return times(R, plus(own["acceleration"], plus(local, spun(own["spin_rate"], r))))

    def _local(self, place: int, what: str) -> list[Number]:
        """The place of a node in a frame that rests, or a rate of it."""
        before = sum(len(self.parts[name]) for name in self.parts if not name.startswith("y"))
        own = self.numbers[before:]

        def displaced(moved: NDArray) -> NDArray:
            field = self._field(np.hstack([np.zeros((len(moved), before)), moved]))
            return getattr(field, what)(np.arange(len(moved)), [place], axes="body")[:, 0]
        return [self._sum(terms, own).single() for terms in quadratic(displaced, len(own))]

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
        """What is linear in amplitudes; the stress of the worst of several fibres of a beam."""
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
        rows = quadratic(amplitudes, len(own))
        factors = [self._sum(terms, own).single() for terms in rows]
        made = self._field(np.zeros((1, 0))).stresses().of_unit_amplitudes()
        self._strains = made, factors
        return self._strains

    def _sum(self, polynomial: Polynomial, numbers: list) -> Sum:
        products: dict[tuple[int, ...], float] = {}
        for weight, factors in polynomial:
            product = tuple(sorted(numbers[i].place() for i in factors))
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


Polynomial = list[tuple[float, tuple[int, ...]]]


def quadratic(function: Callable[[NDArray], NDArray], size: int) -> list[Polynomial]:
    """Coefficients of polynomials of second degree.

    Parameters
    ----------
    function : callable
        Of (n, size) numbers; returns (n, m) values.
    size : int

    Returns
    -------
    list
        Of every value its coefficients, each with the numbers it belongs to.
    """
    unit = np.eye(size)
    pairs = list(combinations(range(size), 2))
    ends = [unit[i] + unit[j] for i, j in pairs]
    values = function(np.vstack([np.zeros((1, size)), unit, -unit, *([ends] if ends else [])]))
    zero, plus, minus, both = np.split(values, [1, 1 + size, 1 + 2 * size])
    linear, square = (plus - minus) / 2.0, (plus + minus) / 2.0 - zero
    of_size = ROUNDED * (np.abs(plus) + np.abs(minus) + np.abs(zero))
    linear[np.abs(linear) <= of_size] = 0.0
    square[np.abs(square) <= of_size] = 0.0
    polynomials: list[Polynomial] = [[(float(x), ())] * bool(x) for x in zero[0]]
    for i, m in zip(*np.nonzero(linear), strict=True):
        polynomials[m].append((float(linear[i, m]), (int(i),)))
    for i, m in zip(*np.nonzero(square), strict=True):
        polynomials[m].append((float(square[i, m]), (int(i), int(i))))
    if pairs:
        i, j = np.array(pairs).T
        mixed = both - plus[i] - plus[j] + zero
        mixed[np.abs(mixed) <= ROUNDED * (np.abs(both) + np.abs(plus[i]) + np.abs(plus[j])
                                          + np.abs(zero))] = 0.0
        for p, m in zip(*np.nonzero(mixed), strict=True):
            polynomials[m].append((float(mixed[p, m]), pairs[p]))
    return polynomials
