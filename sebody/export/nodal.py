"""Quantities of FE nodes inside superelements: motion, stresses, section forces.

Motion follows from that of the body's frame and from the amplitudes of its shapes, stresses from
amplitudes of shapes that strain it. Amplitudes are polynomials of second degree in the body's
motion, and in forces of its loads times the frame's rotation: their coefficients are differences of
what `sebody.results` computes of motions in which one number or two are one.
"""

from collections.abc import Callable
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from sebody.assembly.numbering import Numbering
from sebody.export.program import Program, Term
from sebody.export.quantities import FORCE, MOVED, VALUE
from sebody.model.mechanism import Mechanism
from sebody.results import naming
from sebody.results.field_quantities import number_of
from sebody.results.field_states import FieldStates
from sebody.results.motion import BodyMotion
from sebody.results.postprocessing import Forces
from sebody.results.recording import Recording
from sebody.results.stresses import Stresses

MOTIONS, STRESSES = ("position", "velocity", "acceleration"), ("stress", "section_forces")
MISES = "von_mises"
ROUNDED = 1e-13         # of a coefficient, relative to the values it is a difference of
# von Mises's stress squared, of the components xx, yy, zz, yz, zx, xy
MISES_FORM = np.block([[1.5 * np.eye(3) - 0.5, np.zeros((3, 3))],
                       [np.zeros((3, 3)), 3.0 * np.eye(3)]])

Factor = tuple[int, int]


class Nodal:
    """Quantities of FE nodes of a model, entered into a program.

    Parameters
    ----------
    recording : Recording
        One state.
    """

    def __init__(self, model: Mechanism, numbering: Numbering, recording: Recording,
                 program: Program):
        self.model, self.numbering, self.recording = model, numbering, recording
        self.program = program
        self._strains: dict[str, tuple[Stresses, list[Factor]]] = {}

    def put(self, k: int, owner: str, quantity: str, component: str) -> bool:
        """Enter a quantity as output k; False if it has no such form."""
        body, _, node = owner.rpartition(".node")
        recovery = self.model.bodies[body].reduced.recovery
        place = None if recovery is None else number_of(recovery, int(node))
        if place is None:
            return False
        if quantity in MOTIONS:
            self.program.put(k, self._motion(body, place, quantity, "xyz".index(component)))
            return True
        if quantity in STRESSES:
            return self._put_stress(k, body, place, f"{owner}.{quantity}", quantity, component)
        return quantity == MISES and self._put_mises(k, body, place)

    # motion

    def _motion(self, body: str, place: int, quantity: str, axis: int) -> list[Term]:
        """A component in global axes, of terms in axes of the frame times its rotation."""
        at, _ = self.program.motion(self.model, self.numbering, body)
        D = self.model.dimension
        r = self._local(body, place, "places")
        spin, turn = at["spin"].start, at["spin_rate"].start
        if quantity == "position":
            local = [[Term(1.0, (own,))] for own in r]
        else:
            rate = self._local(body, place, "velocities")
            local = [[Term(1.0, (own,))] for own in rate]
            _add_cross(local, spin, [[Term(1.0, (own,))] for own in r])
        if quantity == "acceleration":
            twice = [[Term(2.0, (own,))] for own in rate]
            _add_cross(twice, spin, [[Term(1.0, (own,))] for own in r])
            local = [[Term(1.0, (own,))] for own in self._local(body, place, "accelerations")]
            _add_cross(local, spin, twice)
            _add_cross(local, turn, [[Term(1.0, (own,))] for own in r])
        terms = []
        if quantity == "position":
            terms.append(Term(1.0, ((MOVED, at["origin"].start + axis),)))
        else:
            for j in range(D):
                local[j].append(Term(1.0, ((MOVED, at[quantity].start + j),)))
        for j in range(D):
            terms += [term.times((MOVED, at["rotation"].start + 3 * axis + j))
                      for term in local[j]]
        return terms

    def _local(self, body: str, place: int, what: str) -> list[Factor]:
        """Outputs: the place of a node in a frame that rests, or a rate of it."""
        at, _ = self.program.motion(self.model, self.numbering, body)
        first, end = at["y"].start, at["y_second"].stop

        def displaced(moved: NDArray) -> NDArray:
            field = self._field(body, moved, first)
            return getattr(field, what)(np.arange(len(moved)), [place], axes="body")[:, 0]
        rows = quadratic(displaced, end - first)
        return [(VALUE, self.program.add(placed(terms, lambda i: (MOVED, first + i))))
                for terms in rows]

    def _field(self, body: str, moved: NDArray, first: int, elements: NDArray | None = None
               ) -> FieldStates:
        """A body in states with some numbers of its motion, from `first` on, all others zero."""
        at, group = self.program.motion(self.model, self.numbering, body)
        begin = at["origin"].start
        whole = np.zeros((len(moved), group.size))
        whole[:, first - begin:first - begin + moved.shape[1]] = moved
        parts = {name: whole[:, own.start - begin:own.stop - begin] for name, own in at.items()}
        D, state = self.model.dimension, self.recording.arrays_of_loop[1]
        parts["rotation"] = parts["rotation"].reshape(-1, 3, 3)[:, :D, :D]
        rows = np.repeat(self.recording.rows[:1], len(moved), axis=0)
        made = Recording(self.model, self.numbering, self.recording.arrays_of_loop[0], state, rows,
                         0.0)
        if elements is None:
            elements = np.zeros((len(moved), state.g.size))
        vars(made).update(unique_rows=rows, forces=Forces(elements, np.zeros((
            len(moved), state.residual.size))))
        field = FieldStates(made, body)
        vars(field)["motion"] = BodyMotion(**parts)
        return field

    # stresses

    def _put_stress(self, k: int, body: str, place: int, whole: str, quantity: str,
                    component: str) -> bool:
        """A component of what is linear in amplitudes: not of the worst of several fibres."""
        stresses, amplitudes = self._strained(body)
        if quantity == "section_forces":
            rows = stresses.section_forces_of_node(place)
        elif (fibres := stresses.fibres_of_node(place)).shape[1] > 1:
            return self._put_worst(k, fibres, amplitudes, component)
        else:
            rows = stresses.of_node(place)
        labels = naming.component_names(rows, whole)
        weights = rows.reshape(len(rows), -1)[:, labels.index(component)]
        self.program.put(k, combined(weights, amplitudes))
        return True

    def _put_mises(self, k: int, body: str, place: int) -> bool:
        stresses, amplitudes = self._strained(body)
        fibres = stresses.fibres_of_node(place)
        if not fibres.shape[1]:
            return bool(self._mises(stresses.of_node(place), amplitudes, k))
        for number in range(fibres.shape[1]):
            own, _ = self._mises(fibres[:, number], amplitudes)
            self.program.choices.append((k, own, own))
        return True

    def _put_worst(self, k: int, fibres: NDArray, amplitudes: list[Factor], component: str
                   ) -> bool:
        """A component of the stress of the fibre with the largest of von Mises's stresses."""
        for number in range(fibres.shape[1]):
            own, stress = self._mises(fibres[:, number], amplitudes)
            at = stress[naming.STRESS.index(component)]
            self.program.choices.append((k, own, at))
        return True

    def _mises(self, rows: NDArray, amplitudes: list[Factor], k: int | None = None
               ) -> tuple[int, list[int]]:
        """Outputs: von Mises's stress, perhaps as output k, and the components of the stress."""
        stress = [self.program.add(combined(rows[:, c], amplitudes)) for c in range(6)]
        if k is None:
            k = self.program.add(())
        self.program.put_root(k, [
            Term(float(MISES_FORM[i, j]), ((VALUE, stress[i]), (VALUE, stress[j])))
            for i, j in zip(*np.nonzero(MISES_FORM), strict=True)])
        return k, stress

    def _strained(self, body: str) -> tuple[Stresses, list[Factor]]:
        """Stresses of unit amplitudes, and outputs: the amplitudes."""
        if body in self._strains:
            return self._strains[body]
        at, group = self.program.motion(self.model, self.numbering, body)
        begin, size = at["origin"].start, group.size
        own = [(FORCE, self.numbering.forces_at[load] + i) for load in self.model.loads
               if load.body is self.model.bodies[body]
               for i in range(np.size(load.constants["P"]))]
        places = [place for _, place in own]

        def amplitudes(numbers: NDArray) -> NDArray:
            elements = np.zeros((len(numbers), self.recording.arrays_of_loop[1].g.size))
            elements[:, places] = numbers[:, size:]
            field = self._field(body, numbers[:, :size], begin, elements)
            return field.stresses().amplitudes
        rows = quadratic(amplitudes, size + len(own))
        factors = [(VALUE, self.program.add(placed(
            terms, lambda i: (MOVED, begin + i) if i < size else own[i - size]))) for terms in rows]
        made = self._field(body, np.zeros((1, 0)), begin).stresses().of_unit_amplitudes()
        self._strains[body] = made, factors
        return self._strains[body]


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


def placed(polynomial: Polynomial, factor: Callable[[int], Factor]) -> list[Term]:
    """Terms of a polynomial of some numbers."""
    return [Term(weight, tuple(factor(i) for i in numbers)) for weight, numbers in polynomial]


def combined(weights: NDArray, factors: list[Factor]) -> list[Term]:
    """A sum of numbers with weights."""
    return [Term(float(weights[i]), (factors[i],)) for i in np.flatnonzero(weights)]


def _add_cross(to: list[list[Term]], spin: int, vector: list[list[Term]]) -> None:
    """Add the product of an angular velocity and a vector, in a plane about its normal."""
    if len(to) == 2:
        to[0] += [term.times((MOVED, spin), weight=-1.0) for term in vector[1]]
        to[1] += [term.times((MOVED, spin)) for term in vector[0]]
        return
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        to[i] += [term.times((MOVED, spin + j)) for term in vector[k]]
        to[i] += [term.times((MOVED, spin + k), weight=-1.0) for term in vector[j]]
