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

from functools import cache
from typing import NamedTuple

import sympy as sp

from sebody.contract.layout import Part
from sebody.derive.form.arrays import Place, constant
from sebody.derive.form.counts import agreed, first, n
from sebody.derive.form.functions import PATH_LOADS, PATH_PLACE
from sebody.derive.form.spaces import Space
from sebody.derive.form.steps import Solve, Stage, Step, call, search
from sebody.derive.formulas import arrays
from sebody.derive.formulas.elastic import conjugate_to
from sebody.derive.formulas.frames.frame import Frame, FrameOption
from sebody.derive.formulas.motion import rate_of
from sebody.derive.formulas.path_steps import (
    BENDS,
    BENDS_1,
    CHANGES,
    HEAD,
    HEAD_1,
    SHAPES,
    SHAPES_1,
    SLOPES,
    TABLE,
    Names,
    Steps,
    Timed,
    local,
    varied,
)
from sebody.derive.formulas.pulled_back import forces_on_unknowns
from sebody.derive.formulas.quantities import Quantities
from sebody.derive.symbolic.rotations import cross
from sebody.derive.symbolic.variation import along, check_same, differential

LOAD = Part("load", ("D",), "force of a load with the factor 1, in global axes [force]")


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


def _located(q: Quantities, frame: Frame, names: Names
             ) -> tuple[tuple[Step, ...], tuple[Stage, ...]]:
    """The gap from the unknowns; also the stages at its end."""
    r, x, g = (names.vector(name) for name in ("rp", "xq", "gap"))
    gap = (Stage("place on the path", "element",
                 sets=((x, q.x0.symbols + q.R0.symbols * r.symbols),)),
           Stage("gap from the path", "element",
                 sets=((g, names.vector("xp").symbols - x.symbols),)),
           Stage("weighted gap", "element", sets=((
               names.vector("phi"), names.scalar("share").symbols[0] * g.symbols),)))
    return local(q, frame, (
        search("place on the path in the frame", PATH_PLACE, TABLE,
               names.scalar("way").symbols[0], arrays.y, n, names.size, HEAD, SHAPES, SLOPES, BENDS,
               operations=0),
        Stage("arm of this place", "element", sets=((r, names.vector("rh").symbols),)),
        *gap)), gap


def _forces(q: Quantities, frame: Frame, names: Names) -> tuple[Stage | Solve, ...]:
    """From the multipliers to forces on the point, the way, the body."""
    w, ws = (names.scalar(name).symbols[0] for name in ("share", "share_s"))
    lam, gap, slope, arm, f = (names.vector(name).symbols
                               for name in ("lam", "gap", "rs", "rp", "fp"))
    on_body = cross(arm, f)
    _check_work(q, arm, f, on_body)
    return (
        Stage("force on the point", "element", sets=((names.vector("gp"), w * lam),)),
        # minus the derivative of the equations by the way
        Stage("tangent of the path", "element", sets=((
            names.vector("tangent"), w * (q.R0.symbols * slope) - ws * gap),)),
        Stage("force along the path", "element", sets=((
            names.scalar("gs"), sp.Matrix([-lam.dot(names.vector("tangent").symbols)])),)),
        Stage("force on the body in frame axes", "element",
              sets=((names.vector("fp"), -w * (q.R0.symbols.T * lam)),)),
        *names.on_coordinates(f),
        *forces_on_unknowns(q, frame, f, Stage(
            "moment of the force on the frame", "element", adds=((q.W, on_body),),
            continues=True)))


def _check_work(q: Quantities, arm: sp.Matrix, f: sp.Matrix, on_frame: sp.Matrix) -> None:
    """The moment on the frame is conjugate to its rotation in the motion of the point."""
    turned = f.dot(cross(q.dth0.symbols, arm))
    check_same("moment of the force on the frame", on_frame, conjugate_to(turned, q.dth0.symbols))


def _moved(q: Quantities, frame: Frame, names: Names, gap: tuple[Stage, ...],
           forces: tuple[Stage | Solve, ...]) -> tuple[tuple[Step, ...], tuple[Step, ...]]:
    """Differentials of the gap and of the forces, by the chain rule."""
    ds = q.space.d(names.scalar("way")).symbols[0]
    slope = names.vector("rs")
    dr, dslope = names.vector("drp"), names.vector("rsd_y")
    chain, steps, of_y = varied(q, frame, names)
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


def _rates(q: Quantities, frame: Frame, names: Names) -> tuple[tuple[Step, ...], tuple[Step, ...]]:
    """The gap's rate and second rate: differentials in the direction of time."""
    time = Timed(q, frame)
    clock, eta = time.clock, time.rates
    sd, sdd = (names.scalar(name).symbols[0] for name in ("wayd", "waydd"))
    slope, w, ws = names.vector("rs"), names.scalar("share"), names.scalar("share_s")
    by_y, turned, arm, V, along_y = (names.vector(name) for name in ("up", "rst", "rd", "V", "ut"))
    moving = (*names.summed(by_y, SHAPES, eta, "rate of the arm"),
              Stage("rate of the arm", "element",
                    sets=((arm, by_y.symbols + slope.symbols * sd),)))
    velocity = Stage("velocity of the place in frame axes", "element", sets=((V, (
        q.v0.symbols + cross(q.Om0.symbols, names.vector("rp").symbols) + arm.symbols)),))
    R0, gap, gap_rate = q.R0.symbols, names.vector("gap").symbols, names.vector("gd").symbols
    weighted = differential(w.symbols[0] * gap, along(w.symbols, ws.symbols * sd)
                            | along(names.vector("gap").symbols, gap_rate))
    rate = time.rate(
        *moving, velocity,
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
    return rate, time.second(
        names, turning_slope, *accelerated,
        Stage("second rate of the gap", "element", sets=((g2, names.vector("ap").symbols - R0 * (
            rate_of(q, V).symbols + cross(q.Om0.symbols, V.symbols))),)),
        Stage("second rate of the weighted gap", "element",
              sets=((names.vector("phidd"), again),)))


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
    residual = local(q, chosen, (
        Stage("way of the first load", "element", sets=((amplitude, sp.Matrix([way])),)),
        call("loads on the path in the frame", PATH_LOADS, TABLE, amplitude.symbols[0], arrays.y,
             n, names.size, HEAD, SHAPES, SLOPES, BENDS, HEAD_1, SHAPES_1, BENDS_1),
        Stage("sum of the arms", "element", sets=((arm, names.vector("rh").symbols),))))
    on_frame = cross(arm.symbols, f.symbols)
    _check_work(q, arm.symbols, f.symbols, on_frame)
    forces = (
        Stage("force in frame axes", "element", sets=((f, -(q.R0.symbols.T * load)),)),
        *names.on_coordinates(f.symbols),
        *forces_on_unknowns(q, chosen, share * f.symbols, Stage(
            "moment of the force on the frame", "element", adds=((q.W, on_frame),),
            continues=True)))
    chain, steps, of_y = varied(q, chosen, names)
    moved = names.vector("drp")
    steps += names.summed(moved, SHAPES, of_y, "motion of the arms")
    chain.rules |= along(arm.symbols, moved.symbols)
    for home in of_y:
        for shape, change in zip(*(names.rows(array, home) for array in (SHAPES, CHANGES)),
                                 strict=True):
            chain.rules |= along(shape, change)
    return LoadSteps(q, (*residual, *forces), (), (
        *steps, *(chain.step(step) for step in forces)))
