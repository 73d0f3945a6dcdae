"""Quantities of option C: where its sums, rows and factors are kept in a kernel.

The frame's motion is seen in axes of the body, constant in the frame, in which its constants have
the most zeros.
"""

import sympy as sp

from sebody.contract.counts import axes_of
from sebody.derive.form.arrays import Array, Place
from sebody.derive.form.counts import N, hN, i
from sebody.derive.form.spaces import Quantity
from sebody.derive.form.steps import Stage
from sebody.derive.formulas.inertia import floating_arrays as at, floating_field as field
from sebody.derive.formulas.inertia.resultants import resultants
from sebody.derive.formulas.quantities import Quantities

PLACE, RATE, SECOND = at.Lz, at.Lv, at.La       # local tangents by z, zd and zdd
BESIDE = Place(N)       # behind the coordinates: motion of the frame, forces on it
GEOMETRY = sp.Symbol("c_geo")


class FloatingQuantities:
    """Quantities of the sums and rows, and the formulas in them."""

    def __init__(self, q: Quantities):
        self.q, self.stress = q, resultants(q.space)
        counts = axes_of(q.space.planar)
        self.D, self.turns, self.pairs = counts["D"], counts["turns"], counts["pairs"]
        self.lines, self.force_rows = counts["lines"], N + counts["motions"]
        self.made = counts["coupled"] + self.turns      # with products that others are made from
        behind = Place(N, first=self.D)
        self.turn = self.of_element("turn", "rotation", at.turn).symbols
        self.felt = self.of_element("felt", "vector", at.zdd, BESIDE)
        self.turning = self.of_element("turning", "axial", at.zdd, behind)
        self.spin = self.of_element("spin", "axial", at.zd, BESIDE)
        self.on_origin = self.of_element("Rt", "vector", at.local, BESIDE)
        self.on_frame = self.of_element("Rr", "axial", at.local, behind)
        self.sums, self.integrals = self.make_sums()
        self.quantities, self.groups = self.make_row()
        self.row = field.Row(*(quantity.symbols for quantity in self.quantities))
        back = self.turn.T
        self.motion = field.Motion(q.mass.symbols[0], back * q.v0.symbols, self.felt.symbols,
                                   self.spin.symbols, self.turning.symbols)
        self.force = field.on_coordinate(self.motion, self.row)
        self.moving = Stage(
            "motion of the frame in axes of the body, a factor of local tangents", "element",
            sets=((self.felt, back * (q.a0.symbols - q.gamma.symbols)),
                  (self.turning, back * q.Om0d.symbols), (self.spin, back * q.Om0.symbols)))

    def of_element(self, name: str, kind: str, array: Array | None = None,
                   place: Place | None = None) -> Quantity:
        """A quantity of the element."""
        return self.q.space.quantity(name, kind, "element", array, place)

    def make_sums(self) -> tuple[field.Sums, Stage]:
        """The integrals, from their parts at rest, linear and quadratic."""
        after_turns, D = self.D + self.turns, self.D

        def part(name, kind, array, first=0):
            return self.of_element(name, kind, array, Place(first)).symbols
        at_rest = part("c0", "vector", at.c0), part("J0", "inertia", at.J0)
        linear = [(part(f"S1z{t}", "vector", array), part(f"gz{t}", "axial", array, D),
                   part(f"hz{t}", "inertia", array, after_turns))
                  for t, array in enumerate(at.lines)]
        of_z, of_zd, of_zdd = at.quadratic
        jz = part("jz", "inertia", of_z)
        jzd = part("jzd", "inertia", of_zd)
        uzd = part("uzd", "axial", of_zd, self.pairs)
        vzd = part("vzd", "axial", of_zd, self.pairs + self.turns)
        uzdd = part("uzdd", "axial", of_zdd)
        values = field.Sums(
            at_rest[0] + linear[0][0], linear[1][0], linear[2][0], at_rest[1] + linear[0][2] + jz,
            linear[1][2] + 2 * jzd, linear[1][1] + uzd, linear[2][1] + uzdd, vzd)
        kinds = {"J": "inertia", "Jd": "inertia", "spun": "axial", "accelerated": "axial",
                 "coupled": "axial"}
        kept = [self.of_element(f"sum_{name}", kinds.get(name, "vector"))
                for name in field.Sums._fields]
        return field.Sums(*(k.symbols for k in kept)), Stage(
            "integrals over the body", "element", sets=tuple(zip(kept, values, strict=True)))

    def make_row(self) -> tuple[field.Row, dict[Array, list[Quantity]]]:
        """Quantities that belong to a coordinate: columns of constants and of products."""
        kinds = {"S1": "vector", "h": "inertia", "j": "inertia", "jd": "inertia"}
        columns = {at.moment_columns: ("S1", "g", "h"), at.products: ("j", "u", "v", "w"),
                   at.more: ("jd", None, "ua", "wa")}     # v again, where nothing is named
        size = {"vector": self.D, "axial": self.turns, "inertia": self.pairs}
        quantities, groups = {}, {}
        for array, names in columns.items():
            first, groups[array] = 0, []
            for name in names:
                kind = kinds.get(name, "axial")
                if name is not None:
                    quantities[name] = self.q.space.quantity(f"row_{name}", kind, "shape", array,
                                                             Place(i, hN, first))
                    groups[array].append(quantities[name])
                first += size[kind]
        return field.Row(**quantities), groups

    def factors(self, out: Array, rows: list[Quantity], moved: int = 0) -> tuple:
        """Coefficients of some rows in the force on a coordinate, one after the other.

        The first `moved` of them are those of a change of place.
        """
        pairs, first = [], 0
        for k, quantity in enumerate(rows):
            scale = GEOMETRY if k < moved else sp.S.One
            factor = self.of_element(f"{out.name}_{quantity.name}", quantity.kind, out,
                                     Place(first))
            derivative = quantity.symbols.applyfunc(
                lambda s: self.force.diff(s) if isinstance(s, sp.Symbol) else sp.S.Zero)
            pairs.append((factor, scale * derivative))
            first += len(quantity.kept)
        return tuple(pairs)
