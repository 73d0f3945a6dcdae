"""Whole numbers of a kernel: counts, indices and places, as expressions with the order of writing.

They are no SymPy expressions: a place is read as it was built, ``9*nodes[j] + 3*r + k``.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from sebody.derive.form.functions import Function, Gives, Use


class Whole:
    """A whole number; sums and products with others and with numbers of Python are one, too."""

    def __add__(self, other: "Whole | int") -> "Whole":
        return _total((1, self), (1, whole(other)))

    def __radd__(self, other: int) -> "Whole":
        return whole(other) + self

    def __sub__(self, other: "Whole | int") -> "Whole":
        return _total((1, self), (-1, whole(other)))

    def __mul__(self, other: "Whole | int") -> "Whole":
        return _product(self, whole(other))

    def __rmul__(self, other: int) -> "Whole":
        return whole(other) * self

    def parts(self) -> tuple:
        """The parts it is made of: other whole numbers, and whatever it reads."""
        return ()

    def rebuilt(self, change: "Change") -> "Whole":
        """The same of changed parts."""
        return self


Change = Callable[[Any], Any]


@dataclass(frozen=True)
class Number(Whole):
    """A number."""

    value: int


@dataclass(frozen=True)
class Count(Whole):
    """A count, an index or a place with a name: known beforehand, read, or of a loop."""

    name: str


@dataclass(frozen=True)
class Agreed(Whole):
    """A number that kernels and runtime agree on: a name in `sebody.contract.layout`."""

    name: str
    value: int


@dataclass(frozen=True)
class Total(Whole):
    """Sums and differences: numbers with the signs they are taken with."""

    terms: tuple[tuple[int, Whole], ...]

    def parts(self) -> tuple:
        return tuple(term for _, term in self.terms)

    def rebuilt(self, change: Change) -> Whole:
        return _total(*((sign, change(term)) for sign, term in self.terms))


@dataclass(frozen=True)
class Times(Whole):
    """A product."""

    factors: tuple[Whole, ...]

    def parts(self) -> tuple:
        return self.factors

    def rebuilt(self, change: Change) -> Whole:
        result: Whole = Number(1)
        for factor in self.factors:
            result = result * change(factor)
        return result


@dataclass(frozen=True)
class Quotient(Whole):
    """A quotient without the rest; the dividend is not negative."""

    dividend: Whole
    divisor: Whole

    def parts(self) -> tuple:
        return self.dividend, self.divisor

    def rebuilt(self, change: Change) -> Whole:
        top, below = map(change, self.parts())
        if isinstance(top, Number) and isinstance(below, Number):
            return Number(top.value // below.value)
        return Quotient(top, below)


@dataclass(frozen=True)
class Largest(Whole):
    """The larger one of two."""

    one: Whole
    other: Whole

    def parts(self) -> tuple:
        return self.one, self.other

    def rebuilt(self, change: Change) -> Whole:
        one, other = map(change, self.parts())
        if isinstance(one, Number) and isinstance(other, Number):
            return Number(max(one.value, other.value))
        return Largest(one, other)


@dataclass(frozen=True)
class Applied(Whole):
    """A function of the runtime of whole numbers."""

    function: Function
    arguments: tuple[Whole, ...]

    def __post_init__(self):
        wanted = [use for _, use in self.function.operands]
        if self.function.gives is not Gives.WHOLE or wanted != [Use.WHOLE] * len(self.arguments):
            raise TypeError(f"{self.function.name} is no function of {len(self.arguments)} whole "
                            "numbers with a whole number as value")

    def parts(self) -> tuple:
        return self.arguments

    def rebuilt(self, change: Change) -> Whole:
        return Applied(self.function, tuple(map(change, self.arguments)))


@dataclass(frozen=True)
class Stored(Whole):
    """An entry of an array of whole numbers."""

    array: Any              # Array
    place: Whole

    def parts(self) -> tuple:
        return self.array, self.place

    def rebuilt(self, change: Change) -> Whole:
        return Stored(self.array, change(self.place))


@dataclass(frozen=True)
class Truncated(Whole):
    """A whole number that is stored among real ones."""

    entry: Any              # Entry

    def parts(self) -> tuple:
        return (self.entry,)

    def rebuilt(self, change: Change) -> Whole:
        return Truncated(change(self.entry))


def whole(value: Whole | int) -> Whole:
    """A number of Python as one of a kernel."""
    if isinstance(value, Whole):
        return value
    if isinstance(value, int):
        return Number(value)
    raise TypeError(f"{value!r} is no whole number: give a count or an int")


def largest(one: Whole | int, other: Whole | int) -> Whole:
    """The larger one of two."""
    return Largest(whole(one), whole(other)).rebuilt(lambda part: part)


def replaced(value: Whole, known: Mapping[Whole, Whole | int]) -> Whole:
    """The number with others in place of some; what becomes known is computed."""
    def change(part):
        if not isinstance(part, Whole):
            return part
        return whole(known[part]) if part in known else part.rebuilt(change)
    return change(value)


def _total(*terms: tuple[int, Whole]) -> Whole:
    """A sum without zeros, sums in it written out, and numbers that follow each other added."""
    flat: list[tuple[int, Whole]] = []
    for sign, term in terms:
        inner = term.terms if isinstance(term, Total) else ((1, term),)
        for own, part in inner:
            _append(flat, sign * own, part)
    flat = flat or [(1, Number(0))]
    return flat[0][1] if len(flat) == 1 and flat[0][0] == 1 else Total(tuple(flat))


def _append(flat: list[tuple[int, Whole]], sign: int, part: Whole) -> None:
    if isinstance(part, Number):
        value = sign * part.value
        if flat and isinstance(flat[-1][1], Number):
            last_sign, last = flat.pop()
            value += last_sign * last.value
        if value:
            positive = value > 0 or not flat
            flat.append((1, Number(value)) if positive else (-1, Number(-value)))
    else:
        flat.append((sign, part))


def _product(one: Whole, other: Whole) -> Whole:
    """A product, products in it written out, with one number at its head if any."""
    factors, number = [], 1
    for factor in (one, other):
        for part in factor.factors if isinstance(factor, Times) else (factor,):
            if isinstance(part, Number):
                number *= part.value
            else:
                factors.append(part)
    if number == 0 or not factors:
        return Number(number)
    if number != 1:
        factors.insert(0, Number(number))
    return factors[0] if len(factors) == 1 else Times(tuple(factors))
