"""A point in space that a path of a reduced body holds in one direction.

With the place x of `formulas/path.py` and a direction E(s) in axes of the body's frame, splined in
the way as the path itself,

    phi = w(s) E(s) . g = 0,        g = R_0^T (x_p - x) = R_0^T (x_p - x_0) - r

Two of these equations, one of them along the path, hold the point on the path and leave it free
across; the gap g is not small then, so the force acts on the frame where the point is, at r + g.
The multiplier mu acts with ``w mu R_0 E`` on the point, with ``-w mu E`` on the body, and along the
way with

    mu (w_s E . g + w E_s . g - w E . r_s)
"""

from functools import cache

import sympy as sp

from sebody.derive.form.counts import n
from sebody.derive.form.functions import PATH_DIRECTION
from sebody.derive.form.spaces import Space
from sebody.derive.form.steps import Role, Solve, Stage, Step, search
from sebody.derive.formulas import arrays
from sebody.derive.formulas.elastic import conjugate_to
from sebody.derive.formulas.frames.frame import Frame, FrameOption
from sebody.derive.formulas.motion import rate_of
from sebody.derive.formulas.path_direction import SECTION, VECTOR, along_way, edges
from sebody.derive.formulas.path_steps import (
    BENDS,
    HEAD,
    SHAPES,
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
from sebody.derive.symbolic.variation import along, check_same, differential, rotating


@cache
def body_across(frame: FrameOption) -> Steps:
    """Derive the steps in a frame."""
    q = Quantities(Space(False))
    chosen, names = frame.derive(q), Names(q, VECTOR)
    located, equation = _located(q, chosen, names)
    forces = _forces(q, chosen, names)
    rate, second = _rates(q, chosen, names)
    return Steps(q, located, forces, rate, second, *_moved(q, chosen, names, equation, forces))


def _located(q: Quantities, frame: Frame, names: Names
             ) -> tuple[tuple[Step, ...], tuple[Stage, ...]]:
    """The equation from the unknowns; also the stages at its end."""
    r, arm, g, c = names.vector("rh"), names.vector("rp"), names.vector("gap"), names.scalar("off")
    E = edges(q)[0].symbols
    equation = (
        Stage("the point in axes of the frame", "element", sets=((arm, q.R0.symbols.T * (
            names.vector("xp").symbols - q.x0.symbols)),)),
        Stage("gap from the path", "element", sets=((g, arm.symbols - r.symbols),)),
        Stage("its part in the direction", "element", sets=((c, sp.Matrix([E.dot(g.symbols)])),)),
        Stage("weighted equation", "element", sets=((names.scalar("phi"), sp.Matrix([
            names.scalar("share").symbols[0] * c.symbols[0]])),)))
    return local(q, frame, (
        search("place on the path in the frame, and direction", PATH_DIRECTION, TABLE,
               names.scalar("way").symbols[0], arrays.y, n, HEAD, SHAPES, SLOPES, BENDS, SECTION,
               operations=0),
        *equation)), equation


def _forces(q: Quantities, frame: Frame, names: Names) -> tuple[Stage | Solve, ...]:
    """From the multiplier to forces on the point, the way, the body."""
    w, ws, mu, c = (names.scalar(name).symbols[0] for name in ("share", "share_s", "mu", "off"))
    E, E_s, _ = (one.symbols for one in edges(q))
    slope, g, arm, f = (names.vector(name).symbols for name in ("rs", "gap", "rp", "fp"))
    on_frame = cross(arm, f)
    _check_work(q, names)
    return (
        Stage("force on the body in frame axes", "element",
              sets=((names.vector("fp"), -w * mu * E),)),
        Stage("force on the point", "element", sets=((names.vector("gp"), -(q.R0.symbols * f)),)),
        Stage("tangent of the path, for results alone", "element", sets=((
            names.vector("tangent"), q.R0.symbols * (w * slope - ws * g)),), role=Role.BY_RULE),
        Stage("force along the path", "element", sets=((names.scalar("gs"), sp.Matrix(
            [mu * (ws * c + w * (E_s.dot(g) - E.dot(slope)))])),)),
        *names.on_coordinates(f),
        *forces_on_unknowns(q, frame, f, Stage(
            "moment of the force on the frame", "element", adds=((q.W, on_frame),),
            continues=True)))


def _check_work(q: Quantities, names: Names) -> None:
    """The moment on the frame is conjugate to its rotation in the equation."""
    R0, p, x0, E = q.R0.symbols, names.vector("xp").symbols, q.x0.symbols, edges(q)[0].symbols
    work = differential(E.dot(R0.T * (p - x0)), rotating(R0, q.dth0.symbols))
    check_same("moment of a force across a path", cross(R0.T * (p - x0), -E),
               conjugate_to(work, q.dth0.symbols), (R0,))


def _moved(q: Quantities, frame: Frame, names: Names, equation: tuple[Stage, ...],
           forces: tuple[Stage | Solve, ...]) -> tuple[tuple[Step, ...], tuple[Step, ...]]:
    """Differentials of the equation and of the forces, by the chain rule."""
    ds = q.space.d(names.scalar("way")).symbols[0]
    chain, steps, of_y = varied(q, frame, names)
    by_y, bent = names.vector("dry"), names.vector("drsy")
    dr, dslope = names.vector("drh_y"), names.vector("rsd_y")
    steps += [
        *names.summed(by_y, SHAPES, of_y, "motion of the place"),
        *names.summed(bent, SLOPES, of_y, "turning of the path"),
        Stage("motion of the place, along the path included", "element", sets=(
            (dr, by_y.symbols + names.vector("rs").symbols * ds),
            (dslope, bent.symbols + names.vector("rss").symbols * ds)))]
    chain.rules |= along(names.vector("rh").symbols, dr.symbols)
    chain.rules |= along(names.vector("rs").symbols, dslope.symbols)
    chain.rules |= along_way(q, ds)
    names.weigh(chain.rules, ds)
    chain.move(names.vector("xp"))
    chain.move(names.scalar("mu"))
    names.bend(chain.rules, of_y, ds)
    steps += [chain.step(step) for step in equation]
    return tuple(steps), tuple(chain.step(step) for step in forces
                               if isinstance(step, Solve) or step.role is not Role.BY_RULE)


def _rates(q: Quantities, frame: Frame, names: Names) -> tuple[tuple[Step, ...], tuple[Step, ...]]:
    """The equation's rate and second rate: differentials in the direction of time."""
    time = Timed(q, frame)
    clock, eta = time.clock, time.rates
    sd, sdd, w, ws, wss, c = (names.scalar(name).symbols[0] for name in (
        "wayd", "waydd", "share", "share_s", "share_ss", "off"))
    by_y, r_d, g_d, by_slope, slope_d = (names.vector(name) for name in (
        "up", "rd", "gd", "ut", "rst"))
    c_d, (E, E_s, _) = names.scalar("off_d"), edges(q)
    R0, slope, arm, g = (q.R0.symbols, *(names.vector(name).symbols for name in (
        "rs", "rp", "gap")))
    moving = (
        *names.summed(by_y, SHAPES, eta, "rate of the place"),
        Stage("rate of the place in the frame", "element",
              sets=((r_d, by_y.symbols + slope * sd),)),
        Stage("rate of the gap in axes of the frame", "element", sets=((g_d, (
            R0.T * names.vector("vp").symbols - q.v0.symbols - cross(q.Om0.symbols, arm)
            - r_d.symbols)),)),
        Stage("rate of its part in the direction", "element", sets=((c_d, sp.Matrix(
            [sd * E_s.symbols.dot(g) + E.symbols.dot(g_d.symbols)])),)))
    weighted = sp.Matrix([ws * sd * c + w * c_d.symbols[0]])
    rate = time.rate(*moving, Stage("rate of the weighted equation", "element",
                                    sets=((names.scalar("phid"), weighted),)))
    bending = (*names.summed(by_slope, SLOPES, eta, "turning of the path"),
               Stage("rate of the slope", "element", sets=((
                   slope_d, by_slope.symbols + names.vector("rss").symbols * sd),)))
    clock.rules |= along(slope, slope_d.symbols) | along_way(q, sd) | {sd: sdd}
    clock.rules |= along(g, g_d.symbols) | along(arm, g_d.symbols + r_d.symbols)
    clock.rules |= rotating(R0, q.Om0.symbols)
    clock.rules |= along(names.vector("vp").symbols, names.vector("ap").symbols)
    names.bend(clock.rules, eta, sd)
    accelerated = tuple(clock.step(step) for step in moving)
    second = differential(weighted, {
        ws: wss * sd, w: ws * sd, sd: sdd, c: c_d.symbols[0],
        c_d.symbols[0]: rate_of(q, c_d).symbols[0]})
    return rate, time.second(names, bending, *accelerated, Stage(
        "second rate of the weighted equation", "element",
        sets=((names.scalar("phidd"), second),)))
