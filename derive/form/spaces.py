"""Named quantities in space or in a plane."""

from dataclasses import dataclass, field
from typing import NamedTuple

import sympy as sp

from sebody.derive.form.arrays import Array, Place
from sebody.derive.symbolic.variation import check_same

AXES = "xyz"
PAIRS = (0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)     # entries of a symmetric matrix


class Quantity(NamedTuple):
    """Something with a name, components and a place in the kernel."""

    name: str
    kind: str           # vector | axial | scalar | rotation (a 3x3 matrix) | inertia (symmetric)
    home: str           # what carries one value each, see `loops`
    array: Array | None     # that holds it; None for local variables of the element
    symbols: sp.Matrix  # components in space; zeros where motion in a plane has none
    place: Place | None = None      # of its components, if not where its home has them

    @property
    def kept(self) -> list[sp.Symbol]:
        """The components that are stored: the symbols, without the zeros of a plane."""
        if self.kind == "inertia":
            return [self.symbols[p] for p in PAIRS if isinstance(self.symbols[p], sp.Symbol)]
        return list(dict.fromkeys(s for s in self.symbols if isinstance(s, sp.Symbol)))


@dataclass(frozen=True)
class Space:
    """Three-dimensional motion, or motion in the x-y plane with rotations about z."""

    planar: bool
    known: dict[str, Quantity] = field(default_factory=dict, hash=False, compare=False)

    def quantity(self, name: str, kind: str, home: str, array: Array | None = None,
                 place: Place | None = None) -> Quantity:
        """Declare a quantity (or return the one of that name)."""
        if name not in self.known:
            symbols = getattr(self, "_" + kind)(name)
            self.known[name] = Quantity(name, kind, home, array, symbols, place)
        return self.known[name]

    def d(self, quantity: Quantity) -> Quantity:
        """The differential of a quantity, as a quantity of its own."""
        array = quantity.array and quantity.array.d
        kind = "axial" if quantity.kind == "rotation" else quantity.kind
        return self.quantity("d" + quantity.name, kind, quantity.home, array, quantity.place)

    def components(self, kind: str, value: sp.Matrix) -> list[sp.Expr]:
        """Kept components of an expression; those a plane drops must vanish identically."""
        value = sp.Matrix(value)
        if kind == "inertia" and not self.planar:
            return [value[r, c] for r, c in PAIRS]
        if not self.planar or kind == "scalar":
            return list(value)
        if kind == "rotation":
            return [value[0], value[3]]
        if kind == "inertia":
            return [value[8]]
        keep = [2] if kind == "axial" else [0, 1]
        for k in set(range(3)) - set(keep):
            check_same("out-of-plane component", sp.Matrix([value[k]]), sp.zeros(1, 1))
        return [value[k] for k in keep]

    def _vector(self, name):
        axes = AXES[:2] if self.planar else AXES
        return sp.Matrix([sp.Symbol(f"{name}_{a}") if a in axes else 0 for a in AXES])

    def _axial(self, name):
        axes = AXES[2:] if self.planar else AXES
        return sp.Matrix([sp.Symbol(f"{name}_{a}") if a in axes else 0 for a in AXES])

    def _inertia(self, name):
        entries = {}
        for r, c in PAIRS:
            kept = not self.planar or (r, c) == (2, 2)
            entries[r, c] = entries[c, r] = sp.Symbol(f"{name}_{AXES[r]}{AXES[c]}") if kept else 0
        return sp.Matrix(3, 3, lambda r, c: entries[r, c])

    def _scalar(self, name):
        return sp.Matrix([sp.Symbol(name)])

    def _rotation(self, name):
        if not self.planar:
            return sp.Matrix(3, 3, lambda i, j: sp.Symbol(f"{name}_{AXES[i]}{AXES[j]}"))
        c, s = sp.symbols(f"{name}_cos {name}_sin")
        return sp.Matrix([[c, -s, 0], [s, c, 0], [0, 0, 1]])
