"""Numbers of a state as symbols: sums of products of numbers, of which a `Tape` is made.

A formula of `sebody.quantities` gives the history of a quantity where it is given histories, and
a tape where it is given symbols: compiled code evaluates and differentiates the tape.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import accumulate, chain
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from sebody.contract.read_numbers import (
    ANGLE,
    CHOICE,
    COSINE,
    FACTORS,
    INVERSE,
    POSITIVE,
    ROOT,
    SINE,
    SUM,
)

Product: TypeAlias = tuple[int, ...]


class Step(NamedTuple):
    """A number of a tape that follows from those before it."""

    function: int
    place: int          # of the number
    products: tuple[tuple[Product, float], ...]


class Arrays(NamedTuple):
    """Steps of a tape as `sebody.kernels.tapes` reads them."""

    steps: NDArray      # (1 + 4 s,)
    factors: NDArray    # (FACTORS m,)
    weights: NDArray    # (m,)


class Tape:
    """Numbers that follow from one another: the first is one, others are read or computed.

    Attributes
    ----------
    inputs : dict
        Places of numbers that are read, by their kind and place in a state.
    steps : list of Step
    outputs : list of int
        Places of the numbers that are asked for.
    """

    def __init__(self) -> None:
        self.size = 1
        self.inputs: dict[tuple[int, int], int] = {}
        self.steps: list[Step] = []
        self.outputs: list[int] = []
        self._known: dict[tuple, int] = {}

    def read(self, kind: int, place: int) -> Sum:
        """A number of a state."""
        if (kind, place) not in self.inputs:
            self.inputs[kind, place] = self._new()
        return Sum(self, {(self.inputs[kind, place],): 1.0})

    def enter(self, function: int, products: Iterable[tuple[Product, float]]) -> Sum:
        """A number that follows from others, entered once."""
        own = tuple(products)
        key = function, own
        if key not in self._known:
            self._known[key] = self._new()
            self.steps.append(Step(function, self._known[key], own))
        return Sum(self, {(self._known[key],): 1.0})

    def put(self, value: Number) -> None:
        """Let a number be the next output."""
        if not isinstance(value, Sum):
            value = self.enter(SUM, [((), float(value))])
        self.outputs.append(value.place())

    def arrays(self) -> Arrays:
        """The steps for compiled code."""
        used = self._used()
        taken = [step for step in self.steps if step.place in used]
        products = [product for step in taken for product in step.products]
        ends = list(accumulate((len(step.products) for step in taken), initial=0))
        steps = [(step.function, step.place, ends[k], ends[k + 1]) for k, step in enumerate(taken)]
        return Arrays(
            np.array([len(steps), *chain.from_iterable(steps)], dtype=np.int64),
            np.array([place for own, _ in products
                      for place in (*own, *(0,) * (FACTORS - len(own)))], dtype=np.int64),
            np.array([weight for _, weight in products], dtype=float))

    @property
    def angles(self) -> list[int]:
        """Places of angles, which continue from what they were."""
        used = self._used()
        return [step.place for step in self.steps
                if step.function == ANGLE and step.place in used]

    def read_for(self, first: int = 0) -> list[tuple[tuple[int, int], int]]:
        """Keys and places of numbers that the outputs from one on follow from."""
        used = self._used(first)
        return [(key, place) for key, place in self.inputs.items() if place in used]

    def _used(self, first: int = 0) -> set[int]:
        """Places of numbers that the outputs from one on follow from, these included."""
        used = set(self.outputs[first:])
        for step in reversed(self.steps):
            if step.place in used:
                used |= {place for product, _ in step.products for place in product}
        return used

    def _new(self) -> int:
        self.size += 1
        return self.size - 1


class Sum:
    """A sum of products of numbers of a tape."""

    __slots__ = "tape", "products"
    __array_ufunc__ = None      # numbers of NumPy leave arithmetic to this class

    def __init__(self, tape: Tape, products: dict[Product, float]):
        self.tape, self.products = tape, products

    def __add__(self, other: Number) -> Sum:
        found = dict(self.products)
        for product, weight in _products(other):
            found[product] = found.get(product, 0.0) + weight
        return Sum(self.tape, {product: weight for product, weight in found.items() if weight})

    def __neg__(self) -> Sum:
        return Sum(self.tape, {product: -weight for product, weight in self.products.items()})

    def __sub__(self, other: Number) -> Sum:
        return self + (-other)

    def __mul__(self, other: Number) -> Sum:
        if not isinstance(other, Sum):
            factor = float(other)
            return Sum(self.tape, {product: weight * factor for product, weight in
                                   self.products.items()} if factor else {})
        one, two = self, other
        if len(one.products) > 1 and len(two.products) > 1:
            one, two = one.single(), two.single()
        if one._longest() + two._longest() > FACTORS:
            one, two = one.single(), two.single()
        found = Sum(self.tape, {})
        for a, x in one.products.items():
            found = found + Sum(self.tape, {tuple(sorted(a + b)): x * y
                                            for b, y in two.products.items()})
        return found

    def __rsub__(self, other: Number) -> Sum:
        return other + (-self)

    __radd__, __rmul__ = __add__, __mul__

    def place(self) -> int:
        """The place of the number on the tape, which it is entered into if it is not there."""
        (product, weight), *others = [*self.products.items(), ((), 0.0)]
        if weight == 1.0 and len(product) == 1 and len(others) == 1:
            return product[0]
        own = self.tape.enter(SUM, self.products.items())
        return next(iter(own.products))[0]

    def of(self, function: int) -> Sum:
        """A function of this number."""
        return self.tape.enter(function, self.products.items())

    def single(self) -> Sum:
        """This number by its own place on the tape."""
        return Sum(self.tape, {(self.place(),): 1.0})

    def _longest(self) -> int:
        return max(map(len, self.products), default=0)


Number: TypeAlias = Any         # a history (n,), a Sum, or a constant
Vector: TypeAlias = Sequence[Number]
Matrix: TypeAlias = Sequence[Vector]


def root(x: Number) -> Number:
    """Square root; of what rounding has made negative it is zero."""
    return x.of(ROOT) if isinstance(x, Sum) else np.sqrt(np.maximum(x, 0.0))


def inverse(x: Number) -> Number:
    """One over a number."""
    return x.of(INVERSE) if isinstance(x, Sum) else 1.0 / x


def cosine(x: Number) -> Number:
    """Cosine of an angle."""
    return x.of(COSINE) if isinstance(x, Sum) else np.cos(x)


def sine(x: Number) -> Number:
    """Sine of an angle."""
    return x.of(SINE) if isinstance(x, Sum) else np.sin(x)


def positive(x: Number) -> Number:
    """One where a number is above zero, and zero elsewhere."""
    return x.of(POSITIVE) if isinstance(x, Sum) else np.where(np.asarray(x) > 0.0, 1.0, 0.0)


def angle(across: Number, along: Number) -> Number:
    """Angle of a vector; turns count from state to state."""
    if isinstance(across, Sum) and isinstance(along, Sum):
        return across.tape.enter(ANGLE, [((across.place(),), 1.0), ((along.place(),), 1.0)])
    return np.unwrap(np.arctan2(across, along))


def choice(compared: Sequence[Number], values: Sequence[Number]) -> Number:
    """The value whose comparison is the largest, the first such."""
    tape = next((x.tape for x in compared if isinstance(x, Sum)), None)
    if tape is None:
        stacked = np.broadcast_arrays(*values)
        return np.choose(np.argmax(np.broadcast_arrays(*compared), axis=0), stacked)
    return tape.enter(CHOICE, [((_place(tape, a), _place(tape, b)), 1.0)
                               for a, b in zip(compared, values, strict=True)])


def _place(tape: Tape, x: Number) -> int:
    return (x if isinstance(x, Sum) else tape.enter(SUM, [((), float(x))])).place()


def _products(x: Number) -> Iterable[tuple[Product, float]]:
    if isinstance(x, Sum):
        return x.products.items()
    return [((), float(x))] if x else []
