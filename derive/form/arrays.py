"""Arrays of a kernel: rows of numbers with extents in counts, and views of them."""

from dataclasses import dataclass, replace
from enum import Enum, auto

import sympy as sp

from sebody.contract.layout import Part
from sebody.derive.form import counts
from sebody.derive.form.whole import Count, Number, Stored, Whole, whole


class Held(Enum):
    """Kinds of memory that hold an array."""

    SCRATCH = auto()        # memory that the kernel asks for
    CONSTANTS = auto()      # the row of constants of an element
    POINTED = auto()        # an argument of the kernel, or a place in one


@dataclass(frozen=True)
class Array:
    """Numbers under a name.

    Parameters
    ----------
    name : str
    shape : tuple of Whole or int
        Rows and their length in memory; of scratch memory a row is `counts.row` numbers long.
    held : Held
    whole : bool
        Whole numbers; else real ones.
    """

    name: str
    shape: tuple[Whole | int, ...] = (counts.row,)
    held: Held = Held.SCRATCH
    whole: bool = False

    def __getitem__(self, place: Whole | int) -> "Entry | Stored":
        return Stored(self, whole(place)) if self.whole else Entry(self, whole(place))

    def at(self, first: Whole | int) -> "Array | View":
        """The array that begins at a place."""
        return View(self, whole(first)) if whole(first) != Number(0) else self

    def renamed(self, name: str) -> "Array":
        """Another array of the same extent, in scratch memory."""
        return replace(self, name=name, held=Held.SCRATCH)

    @property
    def d(self) -> "Array":
        """The array of its differential."""
        return self.renamed("d" + self.name)


@dataclass(frozen=True)
class View:
    """An array from a place on."""

    array: Array
    first: Whole

    def at(self, first: Whole | int) -> "Array | View":
        """The array that begins at a place of it."""
        return self.array.at(self.first + first)


@dataclass(frozen=True)
class Place:
    """The places of a quantity's components: the k-th at ``start + (first + k) stride``."""

    start: Whole | int = 0
    stride: Whole | int = 1
    first: int = 0

    def of(self, k: int) -> Whole:
        """The place of one component."""
        steps = (self.first + k) * whole(self.stride)
        return steps + self.start if self.stride != 1 else whole(self.start) + steps


class Entry(sp.AtomicExpr):
    """A real number of an array, as an atom of expressions."""

    is_commutative = True
    is_number = False
    _diff_wrt = True        # SymPy may differentiate by it

    def __new__(cls, array: Array, place: Whole | int) -> "Entry":
        made = super().__new__(cls)
        made.array, made.place = array, whole(place)
        return made

    def _hashable_content(self) -> tuple:
        return self.array.name, repr(self.place)

    def __getnewargs__(self) -> tuple:
        return self.array, self.place

    @property
    def free_symbols(self) -> set:
        return {self}

    def sort_key(self, order=None) -> tuple:
        """By the name of the array, then by place."""
        one = sp.S.One
        return self.class_key(), (1, self._hashable_content()), one.sort_key(), one

    def _sympystr(self, printer) -> str:
        return f"{self.array.name}[{self.place}]"


def array_of(view: Array | View) -> Array:
    """The array of a view, or itself."""
    return view.array if isinstance(view, View) else view


def scratch(name: str, rows: Whole | int = 1) -> Array:
    """Scratch memory: some rows of local coordinates."""
    return Array(name, (counts.row,) if rows == 1 else (rows, counts.row))


def constant(part: Part) -> Array:
    """A part of the row of constants."""
    sizes = tuple(Count(size) if isinstance(size, str) else size for size in part.shape)
    if part.columns:
        sizes = sizes[1], counts.padded(sizes[0])
    return Array(part.name, sizes or (1,), Held.CONSTANTS)


def pointed(name: str, *shape: Whole | int, whole: bool = False) -> Array:
    """An argument, or a place in one."""
    return Array(name, shape, Held.POINTED, whole)
