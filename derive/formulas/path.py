"""A point that stays on a path of a reduced body, at a way s that is an unknown of its own.

The path is where the recovery of the body's FE model has it, splined in s; with the frame ``x_0,
R_0``, local coordinates y and followers ``eta_b = y . Q_b y / 2``

    x = x_0 + R_0 r(s, y),      r = X(s) + Phi_y(s) y + Phi_eta(s) eta
    dr = Phi dy + r_s ds,       Phi = Phi_y + Phi_eta_b y^T Q_b

and the gap of the point p from the path vanishes, weighted by what this body has of the path,

    phi = w(s) (x_p - x) = 0

since paths go over several bodies, whose shares add up in the same equations. The multipliers lam
act on p by ``w lam``, on the body at r by ``-w lam``, and on s by

    lam . (w_s (x_p - x) - w R_0 r_s)

which is the whole law along the path: the force is normal to the deformed path by itself.
"""

from collections.abc import Iterable
from functools import cache
from typing import NamedTuple

import sympy as sp

from sebody.contract.layout import Part
from sebody.derive.form.arrays import Array, Place, constant
from sebody.derive.form.counts import agreed, first, i3, j3, k, n, row
from sebody.derive.form.functions import PATH_CHANGE, PATH_LOADS, PATH_PLACE
from sebody.derive.form.spaces import AXES, Quantity, Space
from sebody.derive.form.steps import Invert, Solve, Stage, Step, call, search
from sebody.derive.formulas import arrays
from sebody.derive.formulas.damping import rates
from sebody.derive.formulas.elastic import conjugate_to
from sebody.derive.formulas.frames.frame import Frame, FrameOption, origin_stage
from sebody.derive.formulas.kinematics import (
    elastic_rotation_variation,
    local_displacement,
    local_velocity,
    unknown_rules,
)
from sebody.derive.formulas.motion import rate_of, time_rules, turning
from sebody.derive.formulas.pulled_back import forces_on_unknowns
from sebody.derive.formulas.quantities import Quantities
from sebody.derive.passes.linearize import Linearizer, along_own
from sebody.derive.symbolic.rotations import cross
from sebody.derive.symbolic.variation import Rules, along, check_same, differential

PATH = Part("path", ("path",), "knots, rows of the recovery and followers, see kernels/paths.py")
TABLE = constant(PATH)
# what the runtime finds at a way; rows of scratch memory have room for 4 numbers, and n of them,
# or for n vectors
HEAD, SHAPES, SLOPES, BENDS, CHANGES, HEAD_1, SHAPES_1, BENDS_1 = (
    Array(name, (6, row)) for name in ("head", "shapes", "slopes", "bends", "changes", "head_1",
                                       "shapes_1", "bends_1"))
LOAD = Part("load", ("D",), "force of a load with the factor 1, in global axes [force]")
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


@cache
def body_path(planar: bool, frame: FrameOption) -> Steps:
    """Derive the steps in a frame."""
    q = Quantities(Space(planar))
    chosen = frame.derive(q)
    names = Names(q, 2 if planar else 3)
    located, gap = _located(q, chosen, names)
    forces = _forces(q, chosen, names)
    rate, second = _rates(q, chosen, names)
    moved, turned = _moved(q, chosen, names, gap, forces)
    return Steps(q, located, forces, rate, second, moved, turned)


def coordinates(q: Quantities) -> dict[str, Quantity]:
    """Local coordinates by what carries them."""
    return {"position": q.u, "rotation": q.psi, "mode": q.ym}


def _located(q: Quantities, frame: Frame, names: Names
             ) -> tuple[tuple[Step, ...], tuple[Stage, ...]]:
    """The gap from the unknowns; also the stages at its end."""
    size = 2 if q.space.planar else 3
    r, x, g = (names.vector(name) for name in ("rp", "xq", "gap"))
    gap = (Stage("place on the path", "element",
                 sets=((x, q.x0.symbols + q.R0.symbols * r.symbols),)),
           Stage("gap from the path", "element",
                 sets=((g, names.vector("xp").symbols - x.symbols),)),
           Stage("weighted gap", "element", sets=((
               names.vector("phi"), names.scalar("share").symbols[0] * g.symbols),)))
    inverses = tuple(Invert(step) for step in frame.velocity if isinstance(step, Solve))
    return (
        origin_stage(q, q.x0, q.x), *frame.locate, local_displacement(q),
        Stage("internal modes", "mode", sets=((q.ym, q.qm.symbols),)),
        search("place on the path in the frame", PATH_PLACE, TABLE,
               names.scalar("way").symbols[0], arrays.y, n, size, HEAD, SHAPES, SLOPES, BENDS,
               operations=0),
        Stage("arm of this place", "element", sets=((r, names.vector("rh").symbols),)),
        *gap, *inverses), gap


def _forces(q: Quantities, frame: Frame, names: Names) -> tuple[Stage | Solve, ...]:
    """From the multipliers to forces on the point, the way, the body."""
    w, ws = (names.scalar(name).symbols[0] for name in ("share", "share_s"))
    lam, gap, slope, arm, f = (names.vector(name).symbols
                               for name in ("lam", "gap", "rs", "rp", "fp"))
    on_body = cross(arm, f)
    _check_work(q, arm, f, on_body)
    conjugate = {"position": q.f, "rotation": q.m, "mode": q.fm}
    return (
        Stage("force on the point", "element", sets=((names.vector("gp"), w * lam),)),
        # minus the derivative of the equations by the way
        Stage("tangent of the path", "element", sets=((
            names.vector("tangent"), w * (q.R0.symbols * slope) - ws * gap),)),
        Stage("force along the path", "element", sets=((
            names.scalar("gs"), sp.Matrix([-lam.dot(names.vector("tangent").symbols)])),)),
        Stage("force on the body in frame axes", "element",
              sets=((names.vector("fp"), -w * (q.R0.symbols.T * lam)),)),
        *(Stage(f"forces conjugate to the local coordinates: {home}s", home,
                sets=((of, filled(of, [shape.dot(f) for shape in names.rows(SHAPES, home)])),))
          for home, of in conjugate.items()),
        *forces_on_unknowns(q, frame, f, Stage(
            "moment of the force on the frame", "element", adds=((q.W, on_body),),
            continues=True)))


def filled(of: Quantity, values: list[sp.Expr]) -> sp.Matrix:
    """Components where a quantity has some, zero elsewhere."""
    found = iter(values)
    return sp.Matrix([next(found) if isinstance(s, sp.Symbol) else 0 for s in of.symbols])


def _check_work(q: Quantities, arm: sp.Matrix, f: sp.Matrix, on_frame: sp.Matrix) -> None:
    """The moment on the frame is conjugate to its rotation in the motion of the point."""
    turned = f.dot(cross(q.dth0.symbols, arm))
    check_same("moment of the force on the frame", on_frame, conjugate_to(turned, q.dth0.symbols))


def _moved(q: Quantities, frame: Frame, names: Names, gap: tuple[Stage, ...],
           forces: tuple[Stage | Solve, ...]) -> tuple[tuple[Step, ...], tuple[Step, ...]]:
    """Differentials of the gap and of the forces, by the chain rule."""
    d = q.space.d
    chain = Linearizer(q.space, unknown_rules(q) | along_own(q.space, q.qm))
    ds = d(names.scalar("way")).symbols[0]
    slope = names.vector("rs")
    dr, dslope = names.vector("drp"), names.vector("rsd_y")
    steps, of_y = varied(q, frame, chain, names)
    arm, bent = names.vector("dry"), names.vector("drsy")
    steps += [
        *names.summed(arm, SHAPES, of_y, "motion of the arm"),
        *names.summed(bent, SLOPES, of_y, "turning of the path"),
        Stage("motion of the arm, along the path included", "element",
              sets=((dr, arm.symbols + slope.symbols * ds),
                    (dslope, bent.symbols + names.vector("rss").symbols * ds)))]
    chain.rules |= along(names.vector("rp").symbols, dr.symbols)
    chain.rules |= along(slope.symbols, dslope.symbols)
    names.weigh(chain.rules, ds)
    for name in ("xp", "lam"):
        chain.move(names.vector(name))
    names.bend(chain.rules, of_y, ds)
    steps += [chain.step(step) for step in gap]
    return tuple(steps), tuple(chain.step(step) for step in forces)


def varied(q: Quantities, frame: Frame, chain: Linearizer, names: Names
           ) -> tuple[list[Step], dict[str, Quantity]]:
    """Variations of the local coordinates and of the shapes through the followers."""
    d = q.space.d
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
    return steps, {home: d(one) for home, one in coordinates(q).items()}


def _rates(q: Quantities, frame: Frame, names: Names) -> tuple[tuple[Step, ...], tuple[Step, ...]]:
    """The gap's rate and second rate: differentials in the direction of time."""
    size = 2 if q.space.planar else 3
    clock = Linearizer(q.space, time_rules(q), lambda quantity: rate_of(q, quantity))
    of_y = tuple(step for step in rates(q) if step.sets)
    first, later = turning(q, frame, clock, of_y)
    sd, sdd = (names.scalar(name).symbols[0] for name in ("wayd", "waydd"))
    slope, w, ws = names.vector("rs"), names.scalar("share"), names.scalar("share_s")
    by_y, turned, arm, V, along_y = (names.vector(name) for name in ("up", "rst", "rd", "V", "ut"))
    eta = {"position": q.eu, "rotation": q.ep, "mode": q.em}
    moving = (*names.summed(by_y, SHAPES, eta, "rate of the arm"),
              Stage("rate of the arm", "element",
                    sets=((arm, by_y.symbols + slope.symbols * sd),)))
    velocity = Stage("velocity of the place in frame axes", "element", sets=((V, (
        q.v0.symbols + cross(q.Om0.symbols, names.vector("rp").symbols) + arm.symbols)),))
    R0, gap, gap_rate = q.R0.symbols, names.vector("gap").symbols, names.vector("gd").symbols
    weighted = differential(w.symbols[0] * gap, along(w.symbols, ws.symbols * sd)
                            | along(names.vector("gap").symbols, gap_rate))
    rate = (local_velocity(q), origin_stage(q, q.v0, q.vs), *first, *of_y, *moving, velocity,
            Stage("rate of the gap", "element", sets=((
                names.vector("gd"), names.vector("vp").symbols - R0 * V.symbols),)),
            Stage("rate of the weighted gap", "element", sets=((names.vector("phid"), weighted),)))
    turning_slope = (*names.summed(along_y, SLOPES, eta, "turning of the path"),
                     Stage("rate of the slope", "element", sets=((
                         turned, along_y.symbols + names.vector("rss").symbols * sd),)))
    clock.rules |= along(names.vector("rp").symbols, arm.symbols)
    clock.rules |= along(slope.symbols, turned.symbols)
    clock.rules |= {names.scalar("wayd").symbols[0]: sdd}
    names.bend(clock.rules, eta, sd)
    accelerated = tuple(clock.step(step) for step in (*moving, velocity))
    g2 = names.vector("gdd")
    again = differential(weighted, along(w.symbols, ws.symbols * sd)
                         | along(ws.symbols, names.scalar("share_ss").symbols * sd)
                         | along(names.vector("gap").symbols, gap_rate)
                         | along(names.vector("gd").symbols, g2.symbols) | {
                             names.scalar("wayd").symbols[0]: sdd})
    second = (origin_stage(q, q.a0, q.acc), *later, *turning_slope,
              call("changes of the shapes", PATH_CHANGE, TABLE, BENDS, arrays.eta, n, size,
                   CHANGES),
              *accelerated,
              Stage("second rate of the gap", "element", sets=((g2, names.vector(
                  "ap").symbols - R0 * (rate_of(q, V).symbols + cross(
                      q.Om0.symbols, V.symbols))),)),
              Stage("second rate of the weighted gap", "element",
                    sets=((names.vector("phidd"), again),)))
    return rate, second


class LoadSteps(NamedTuple):
    """Steps of forces that move along a path, likewise."""

    q: Quantities
    residual: tuple[Step, ...]
    prepared: tuple[Step, ...]
    tangent: tuple[Step, ...]


@cache
def path_load(planar: bool, frame: FrameOption) -> LoadSteps:
    """Derive the steps of given forces F c_k at given ways in a frame.

    With the shares c_k of this body their virtual work is that of one force F on what moves by the
    sums of c_k dx_k, so that a series of loads costs little more than one.
    """
    q = Quantities(Space(planar))
    chosen, names = frame.derive(q), Names(q, 2 if planar else 3)
    way = q.space.quantity("amplitude", "scalar", "element", arrays.loads, Place(
        3 * arrays.index[first + agreed("AT_PORT")])).symbols[0]
    load = q.space.quantity("load", "vector", "element", constant(LOAD)).symbols
    f, arm, share = names.vector("fp"), names.vector("rp"), names.scalar("share").symbols[0]
    amplitude = names.scalar("along")
    inverses = tuple(Invert(step) for step in chosen.velocity if isinstance(step, Solve))
    residual = (
        origin_stage(q, q.x0, q.x), *chosen.locate, local_displacement(q),
        Stage("internal modes", "mode", sets=((q.ym, q.qm.symbols),)),
        Stage("way of the first load", "element", sets=((amplitude, sp.Matrix([way])),)),
        call("loads on the path in the frame", PATH_LOADS, TABLE, amplitude.symbols[0], arrays.y,
             n, names.size, HEAD, SHAPES, SLOPES, BENDS, HEAD_1, SHAPES_1, BENDS_1),
        Stage("sum of the arms", "element", sets=((arm, names.vector("rh").symbols),)), *inverses)
    on_frame = cross(arm.symbols, f.symbols)
    _check_work(q, arm.symbols, f.symbols, on_frame)
    conjugate = {"position": q.f, "rotation": q.m, "mode": q.fm}
    forces = (
        Stage("force in frame axes", "element", sets=((f, -(q.R0.symbols.T * load)),)),
        *(Stage(f"forces conjugate to the local coordinates: {home}s", home,
                sets=((of, filled(of, [shape.dot(f.symbols)
                                        for shape in names.rows(SHAPES, home)])),))
          for home, of in conjugate.items()),
        *forces_on_unknowns(q, chosen, share * f.symbols, Stage(
            "moment of the force on the frame", "element", adds=((q.W, on_frame),),
            continues=True)))
    chain = Linearizer(q.space, unknown_rules(q) | along_own(q.space, q.qm))
    steps, of_y = varied(q, chosen, chain, names)
    moved = names.vector("drp")
    steps += names.summed(moved, SHAPES, of_y, "motion of the arms")
    chain.rules |= along(arm.symbols, moved.symbols)
    for home in of_y:
        for shape, change in zip(*(names.rows(array, home) for array in (SHAPES, CHANGES)),
                                 strict=True):
            chain.rules |= along(shape, change)
    return LoadSteps(q, (*residual, *forces), (), (
        *steps, *(chain.step(step) for step in forces)))
