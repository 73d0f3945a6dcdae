"""Steps that all equations of points and nodes on paths of reduced bodies share.

Rows of the recovery, or of rotations, are splined in the way s, with the followers of
`formulas/path.py`. They change with the way, through the followers and in time.
"""

from collections.abc import Iterable
from typing import NamedTuple

import sympy as sp

from sebody.contract.layout import Part
from sebody.derive.form.arrays import Array, Place, constant
from sebody.derive.form.counts import i3, j3, k, n, row
from sebody.derive.form.functions import PATH_CHANGE
from sebody.derive.form.spaces import AXES, Quantity
from sebody.derive.form.steps import Invert, Solve, Stage, Step, call
from sebody.derive.formulas import arrays
from sebody.derive.formulas.damping import rates
from sebody.derive.formulas.frames.frame import Frame, origin_stage
from sebody.derive.formulas.kinematics import (
    elastic_rotation_variation,
    local_displacement,
    local_velocity,
    unknown_rules,
)
from sebody.derive.formulas.motion import rate_of, time_rules, turning
from sebody.derive.formulas.pulled_back import forces_on_coordinates
from sebody.derive.formulas.quantities import Quantities
from sebody.derive.passes.linearize import Linearizer, along_own
from sebody.derive.symbolic.variation import Rules, along

PATH = Part("path", ("path",), "knots, rows of the recovery and followers, see kernels/paths.py")
TABLE = constant(PATH)
# what the runtime finds at a way; rows of scratch memory have room for 4 numbers, and n of them,
# or for n vectors
HEAD, SHAPES, SLOPES, BENDS, CHANGES, HEAD_1, SHAPES_1, BENDS_1 = (
    Array(name, (6, row)) for name in ("head", "shapes", "slopes", "bends", "changes", "head_1",
                                       "shapes_1", "bends_1"))
# in `HEAD`: the arm or the angle and its derivatives by the way, the weight and its derivatives
PLACES = {"rh": 0, "rs": 3, "rss": 6, "share": 9, "share_s": 10, "share_ss": 11,
          "tau": 0, "tau_s": 3, "tau_ss": 6}


class Steps(NamedTuple):
    """At node level, the same for every layout; unknowns behind the body's are in components."""

    q: Quantities
    located: tuple[Step, ...]       # place on the path, and the gap
    forces: tuple[Step, ...]        # those of the multipliers on all unknowns
    rate: tuple[Step, ...]          # rate of the gap
    second: tuple[Step, ...]        # second rate, once the first is known
    moved: tuple[Step, ...]         # of a column: the gap
    turned: tuple[Step, ...]        # and the forces


class Names:
    """Quantities of a path by name, with so many numbers in a row; one of an angle."""

    def __init__(self, q: Quantities, size: int):
        self._q, self.size = q, size
        self.space = q.space

    def vector(self, name: str) -> Quantity:
        """A vector of the element; of `PLACES` one in memory."""
        return self._of(name, "vector")

    def scalar(self, name: str) -> Quantity:
        """A number of the element, likewise."""
        return self._of(name, "scalar")

    def _of(self, name: str, kind: str) -> Quantity:
        if name in PLACES:
            return self.space.quantity(name, kind, "element", HEAD, Place(PLACES[name]))
        return self.space.quantity(name, kind, "element")

    def rows(self, array: Array, home: str) -> list[sp.Matrix]:
        """Vectors by each coordinate of a position, of a rotation or by a mode."""
        axes = {"position": AXES[:2] if self.space.planar else AXES,
                "rotation": AXES[2:] if self.space.planar else AXES, "mode": ("",)}[home]
        first = {"position": i3, "rotation": j3, "mode": k}[home]
        kind = "scalar" if self.size == 1 else "vector"
        return [self.space.quantity(f"{array.name}_{home}{axis}", kind, home, array,
                                    Place(self.size * (first + c))).symbols
                for c, axis in enumerate(axes)]

    def summed(self, result: Quantity, array: Array, of: dict[str, Quantity], what: str
               ) -> tuple[Stage, ...]:
        """Sum over positions, rotations and modes of rows times coordinates."""
        return tuple(Stage(f"{what} by {home}s", home, adds=((result, sum(
            (shape * one for shape, one in zip(self.rows(array, home), quantity.kept,
                                               strict=True)), sp.zeros(*result.symbols.shape))),),
            continues=home != "position") for home, quantity in of.items())

    def on_coordinates(self, f: sp.Matrix) -> tuple[Stage, ...]:
        """Forces conjugate to the local coordinates, of what acts on the place or the angle."""
        return forces_on_coordinates(self._q, lambda home: self.rows(SHAPES, home), f)

    def weigh(self, rules: Rules, ds: sp.Expr) -> None:
        """Let the weight and its slope change with the way."""
        w, ws, wss = (self.scalar(name).symbols for name in ("share", "share_s", "share_ss"))
        rules |= along(w, ws * ds)
        rules |= along(ws, wss * ds)

    def bend(self, rules: Rules, homes: Iterable[str], ds: sp.Expr) -> None:
        """Let the shapes change through the followers and with the way."""
        for home in homes:
            for shape, change, turn in zip(*(self.rows(array, home) for array in (
                    SHAPES, CHANGES, SLOPES)), strict=True):
                rules |= along(shape, change + turn * ds)


def _coordinates(q: Quantities) -> dict[str, Quantity]:
    """Local coordinates by what carries them."""
    return {"position": q.u, "rotation": q.psi, "mode": q.ym}


def local(q: Quantities, frame: Frame, steps: Iterable[Step]) -> tuple[Step, ...]:
    """Steps that read local coordinates: after those, and before the inverses of the frame."""
    return (origin_stage(q, q.x0, q.x), *frame.locate, local_displacement(q),
            Stage("internal modes", "mode", sets=((q.ym, q.qm.symbols),)), *steps,
            *(Invert(step) for step in frame.velocity if isinstance(step, Solve)))


def varied(q: Quantities, frame: Frame, names: Names
           ) -> tuple[Linearizer, list[Step], dict[str, Quantity]]:
    """Variations of the local coordinates and of the shapes through the followers.

    Also the linearizer by the chain rule, and the variations by what carries them.
    """
    d, chain = q.space.d, Linearizer(q.space, unknown_rules(q) | along_own(q.space, q.qm))
    steps: list[Step] = [
        Stage("directions of positions in frame axes", "position",
              sets=((q.dx, q.R0.symbols.T * q.dx.symbols),)),
        origin_stage(q, q.dx0, q.dx), *frame.variation, chain.stage(local_displacement(q)),
        Stage("variation of the elastic rotations, (17)", "rotation",
              sets=((d(q.psi), elastic_rotation_variation(q)),)),
        Stage("differential: internal modes", "mode", sets=((d(q.ym), d(q.qm).symbols),)),
        *frame.differentials,
        call("changes of the shapes", PATH_CHANGE, TABLE, BENDS, arrays.y.d, n, names.size,
             CHANGES)]
    for quantity in (q.psi, q.ym, q.beta, q.beta0):
        chain.move(quantity)
    return chain, steps, {home: d(one) for home, one in _coordinates(q).items()}


class Timed:
    """Steps of rates and second rates, and the direction of time."""

    def __init__(self, q: Quantities, frame: Frame):
        self._q = q
        self.clock = Linearizer(q.space, time_rules(q), lambda quantity: rate_of(q, quantity))
        self._of_y = tuple(step for step in rates(q) if step.sets)
        self._first, self._later = turning(q, frame, self.clock, self._of_y)
        self.rates = {"position": q.eu, "rotation": q.ep, "mode": q.em}     # local, by carrier

    def rate(self, *steps: Step) -> tuple[Step, ...]:
        """Steps of a rate, behind those of the frame and of local coordinates."""
        q = self._q
        return (local_velocity(q), origin_stage(q, q.v0, q.vs), *self._first, *self._of_y, *steps)

    def second(self, names: Names, turned: Iterable[Step], *steps: Step) -> tuple[Step, ...]:
        """Steps of a second rate, behind the changes of slopes and shapes."""
        q = self._q
        return (origin_stage(q, q.a0, q.acc), *self._later, *turned,
                call("changes of the shapes", PATH_CHANGE, TABLE, BENDS, arrays.eta, n, names.size,
                     CHANGES), *steps)
