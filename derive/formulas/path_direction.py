"""A node in space that keeps a direction across one of a path of a reduced body.

The sections of the path turn with the FE nodes, by rows of their rotations that are splined in the
way s as the path itself, with the followers eta of `formulas/path.py`. A direction E(s) of the
undeformed section, splined likewise, becomes

    e = R_0 exp(psi) E(s),      psi = Psi_y(s) y + Psi_eta(s) eta

exp and not ``1 + skew(psi)``, so that directions of a section stay across each other and are those
of a boundary node where the path comes by one. The direction p of the node, which turns with it,
stays across e, weighted by what this body has of the path:

    phi = w(s) (R_p p) . e = 0

Three of these equations keep the orientation, two let the node turn about one axis. In axes of the
frame, with ``N = R_0^T R_p p`` and ``e = exp(psi) E``, the multiplier mu acts with ``w mu e x N``
on the frame, with ``w mu T^T(psi) (E x exp(-psi) N)`` on psi, with ``w mu p x R_p^T R_0 e`` on the
node, and along the way, since

    e_s = exp(psi) (E_s + T(psi) psi_s x E)

with ``mu (w_s N . e + w N . e_s)``: a moment pushes by itself times the curvature of the path.
"""

from functools import cache

import sympy as sp

from sebody.contract.layout import Part
from sebody.derive.form.arrays import Place, constant, scratch
from sebody.derive.form.counts import n
from sebody.derive.form.functions import PATH_DIRECTION, STUMPFF_1_TO_7
from sebody.derive.form.spaces import Quantity, Space
from sebody.derive.form.steps import Solve, Stage, Step, Values, search
from sebody.derive.formulas import arrays
from sebody.derive.formulas.elastic import conjugate_to
from sebody.derive.formulas.frames.frame import Frame, FrameOption
from sebody.derive.formulas.inertia.rigid_part import along_tangent, turned
from sebody.derive.formulas.motion import rate_of
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
from sebody.derive.passes.lower import Names as Known
from sebody.derive.symbolic.rotations import cross, exp, stumpff
from sebody.derive.symbolic.variation import Rules, along, check_same, differential, rotating

DIRECTION = Part("held", ("D",), "direction that turns with the node, in its axes")
SECTION = scratch("section")        # the direction of the path, and its derivatives by the way
VECTOR = 3


class _Parts:
    """Quantities of the element by short names."""

    def __init__(self, q: Quantities, names: Names):
        self.names, space = names, q.space
        self.psi, self.psi_s, self.psi_ss = (names.vector(x) for x in ("rh", "rs", "rss"))
        self.E, self.E_s, _ = edges(q)
        self.p = space.quantity("across", "vector", "element", constant(DIRECTION))
        self.Rp = space.quantity("Rp", "rotation", "element")
        self.spin, self.turning = (names.vector(name) for name in ("Omp", "Ap"))
        self.turned = names.vector("dthp")
        self.bent, self.bent_E, self.e, self.e_s, self.N, self.N_in = (
            names.vector(name) for name in ("bent", "bent_edge", "aim", "aim_s", "side", "sidein"))
        self.c, self.c_s = names.scalar("cosine"), names.scalar("cosine_s")

    def number(self, name: str) -> sp.Symbol:
        """A number of the element."""
        found: sp.Symbol = self.names.scalar(name).symbols[0]
        return found


def edges(q: Quantities) -> list[Quantity]:
    """The direction of the path, and its two derivatives by the way."""
    return [q.space.quantity(name, "vector", "element", SECTION, Place(VECTOR * k))
            for k, name in enumerate(("edge", "edge_s", "edge_ss"))]


def along_way(q: Quantities, ds: sp.Expr) -> Rules:
    """Rules of this direction as the way changes."""
    E, E_s, E_ss = (one.symbols for one in edges(q))
    return along(E, E_s * ds) | along(E_s, E_ss * ds)


@cache
def body_direction(frame: FrameOption) -> Steps:
    """Derive the steps in a frame."""
    q = Quantities(Space(False))
    chosen = frame.derive(q)
    parts = _Parts(q, Names(q, VECTOR))
    located, equation = _located(q, chosen, parts)
    forces = _forces(q, chosen, parts)
    rate, second = _rates(q, chosen, parts)
    return Steps(q, located, forces, rate, second,
                 *_moved(q, chosen, parts, equation, forces))


def section_names(q: Quantities) -> Known:
    """Coefficients of exp(psi) and T(psi), and the symbols that hold their values."""
    psi = Names(q, VECTOR).vector("rh").symbols
    return {stumpff(k, psi.dot(psi)): getattr(q, f"r{k}").symbols[0] for k in range(1, 8)}


def _located(q: Quantities, frame: Frame, of: _Parts
             ) -> tuple[tuple[Step, ...], tuple[Stage, ...]]:
    """The equation from the unknowns; also the stages at its end."""
    psi, E, w = of.psi.symbols, of.E.symbols, of.number("share")
    N, e = of.N.symbols, of.e.symbols
    equation = (
        Stage("curvature by the deformation, in axes of the section", "element",
              sets=((of.bent, along_tangent(psi, of.psi_s.symbols)),)),
        Stage("direction of the path, and its derivative by the way", "element", sets=(
            (of.e, turned(psi, E)),
            (of.bent_E, of.E_s.symbols + cross(of.bent.symbols, E)))),
        Stage("this derivative in axes of the frame", "element",
              sets=((of.e_s, turned(psi, of.bent_E.symbols)),)),
        Stage("direction of the node in axes of the frame", "element", sets=((
            of.N, q.R0.symbols.T * (of.Rp.symbols * of.p.symbols)),)),
        Stage("cosine of the angle between them, and its derivative by the way", "element", sets=(
            (of.c, sp.Matrix([N.dot(e)])), (of.c_s, sp.Matrix([N.dot(of.e_s.symbols)])))),
        Stage("weighted equation", "element", sets=((
            of.names.scalar("phi"), sp.Matrix([w * of.c.symbols[0]])),)))
    _check_slope(of)
    return local(q, frame, (
        search("section of the path in the frame", PATH_DIRECTION, TABLE, of.number("way"),
               arrays.y, n, HEAD, SHAPES, SLOPES, BENDS, SECTION, operations=0),
        Values("coefficients of exp and T, and for their derivatives",
               tuple(getattr(q, f"r{k}") for k in range(1, 8)), STUMPFF_1_TO_7, of.psi, 60),
        *equation)), equation


def _check_slope(of: _Parts) -> None:
    """The derivative of the direction by the way is that of the chain rule."""
    psi, E = of.psi.symbols, of.E.symbols
    chain = differential(exp(psi) * E, along(psi, of.psi_s.symbols) | along(E, of.E_s.symbols))
    check_same("direction of a path by the way", turned(psi, of.E_s.symbols + cross(
        along_tangent(psi, of.psi_s.symbols), E)), chain)


def _forces(q: Quantities, frame: Frame, of: _Parts) -> tuple[Stage | Solve, ...]:
    """From the multiplier to moments on node and body, and a force along the way."""
    w, w_s, mu = (of.number(name) for name in ("share", "share_s", "mu"))
    pull = of.names.scalar("pull")
    N, e, E, psi = of.N.symbols, of.e.symbols, of.E.symbols, of.psi.symbols
    on_node, on_section, on_frame = (of.names.vector(name) for name in ("gp", "onpsi", "onframe"))
    in_section = along_tangent(psi, cross(E, of.N_in.symbols), -1)
    _check_work(q, of, in_section)
    return (
        Stage("direction of the node in axes of the section", "element",
              sets=((of.N_in, turned(psi, N, -1)),)),
        Stage("weighted multiplier", "element", sets=((pull, sp.Matrix([w * mu])),)),
        Stage("moment on the node, material", "element", sets=((on_node, pull.symbols[0] * cross(
            of.p.symbols, of.Rp.symbols.T * (q.R0.symbols * e))),)),
        Stage("moments on the section and on the frame", "element", sets=(
            (on_section, pull.symbols[0] * in_section),
            (on_frame, pull.symbols[0] * cross(e, N)))),
        Stage("force along the path", "element", sets=((of.names.scalar("gs"), sp.Matrix(
            [mu * (w_s * of.c.symbols[0] + w * of.c_s.symbols[0])])),)),
        *of.names.on_coordinates(on_section.symbols),
        *forces_on_unknowns(q, frame, sp.zeros(3, 1), Stage(
            "moment on the frame", "element", adds=((q.W, on_frame.symbols),), continues=True)))


def _check_work(q: Quantities, of: _Parts, in_section: sp.Matrix) -> None:
    """Moments are conjugate to rotations of frame, node and section in the equation."""
    psi, E, p, R0, Rp = (one.symbols for one in (of.psi, of.E, of.p, q.R0, of.Rp))
    meaning = dict(zip([*of.N.symbols, *of.N_in.symbols, *of.e.symbols], [
        *(R0.T * Rp * p), *(exp(psi).T * R0.T * Rp * p), *(exp(psi) * E)], strict=True))
    of_psi = sp.Matrix(sp.symbols("v_x v_y v_z"))
    for name, rules, by, short in (
            ("frame", rotating(R0, q.dth0.symbols), q.dth0.symbols,
             cross(of.e.symbols, of.N.symbols)),
            ("node", rotating(Rp, of.turned.symbols), of.turned.symbols,
             cross(p, Rp.T * (R0 * of.e.symbols))),
            ("section", along(psi, of_psi), of_psi, in_section)):
        work = differential((Rp * p).dot(R0 * exp(psi) * E), rules)
        check_same(f"moment on the {name}", short.xreplace(meaning), conjugate_to(work, by),
                   (R0, Rp))


def _moved(q: Quantities, frame: Frame, of: _Parts, equation: tuple[Stage, ...],
           forces: tuple[Stage | Solve, ...]) -> tuple[tuple[Step, ...], tuple[Step, ...]]:
    """Differentials of the equation and of the forces, by the chain rule."""
    ds = q.space.d(of.names.scalar("way")).symbols[0]
    chain, steps, of_y = varied(q, frame, of.names)
    by_y, bent = of.names.vector("dry"), of.names.vector("drsy")
    dpsi, dpsi_s = of.names.vector("drp"), of.names.vector("rsd_y")
    steps += [
        *of.names.summed(by_y, SHAPES, of_y, "turning of the section"),
        *of.names.summed(bent, SLOPES, of_y, "change of the curvature"),
        Stage("turning of the section, along the path included", "element", sets=(
            (dpsi, by_y.symbols + of.psi_s.symbols * ds),
            (dpsi_s, bent.symbols + of.psi_ss.symbols * ds)))]
    chain.rules |= along(of.psi.symbols, dpsi.symbols) | along(of.psi_s.symbols, dpsi_s.symbols)
    chain.rules |= along_way(q, ds) | rotating(of.Rp.symbols, of.turned.symbols)
    of.names.weigh(chain.rules, ds)
    chain.move(of.names.scalar("mu"))
    of.names.bend(chain.rules, of_y, ds)
    steps += [chain.step(step) for step in equation]
    return tuple(steps), tuple(chain.step(step) for step in forces)


def _rates(q: Quantities, frame: Frame, of: _Parts) -> tuple[tuple[Step, ...], tuple[Step, ...]]:
    """The equation's rate and second rate: differentials in the direction of time."""
    time = Timed(q, frame)
    clock, eta = time.clock, time.rates
    sd, sdd, w, w_s, w_ss = (of.number(name) for name in (
        "wayd", "waydd", "share", "share_s", "share_ss"))
    by_y, psi_d, by_slope, psi_sd, spin, E_d, e_d, relative, N_d = (
        of.names.vector(name) for name in (
            "up", "rd", "ut", "rst", "spin", "edge_d", "aim_d", "rel", "side_d"))
    c, c_d = of.c, of.names.scalar("cosine_d")
    psi, E, N, e, R0 = (one.symbols for one in (of.psi, of.E, of.N, of.e, q.R0))
    moving = (
        *of.names.summed(by_y, SHAPES, eta, "rate of the section's rotation"),
        Stage("rate of the section's rotation, along the path included", "element",
              sets=((psi_d, by_y.symbols + of.psi_s.symbols * sd),)),
        Stage("angular velocity of the section in the frame, in its axes", "element",
              sets=((spin, along_tangent(psi, psi_d.symbols)),)),
        Stage("rate of the direction in axes of the section", "element",
              sets=((E_d, of.E_s.symbols * sd + cross(spin.symbols, E)),)),
        Stage("rate of the direction in axes of the frame; the node's against it", "element", sets=(
            (e_d, turned(psi, E_d.symbols)),
            (relative, R0.T * (of.Rp.symbols * of.spin.symbols) - q.Om0.symbols))),
        Stage("rate of the node's direction in axes of the frame", "element",
              sets=((N_d, cross(relative.symbols, N)),)),
        Stage("rate of the cosine", "element", sets=((c_d, sp.Matrix(
            [N_d.symbols.dot(e) + N.dot(e_d.symbols)])),)))
    weighted = sp.Matrix([w_s * sd * c.symbols[0] + w * c_d.symbols[0]])
    rate = time.rate(*moving, Stage("rate of the weighted equation", "element",
                                    sets=((of.names.scalar("phid"), weighted),)))
    curving = (*of.names.summed(by_slope, SLOPES, eta, "turning of the curvature"),
               Stage("rate of the curvature", "element", sets=((
                   psi_sd, by_slope.symbols + of.psi_ss.symbols * sd),)))
    clock.rules |= along(psi, psi_d.symbols) | along(of.psi_s.symbols, psi_sd.symbols)
    clock.rules |= along_way(q, sd) | along(e, e_d.symbols) | along(N, N_d.symbols)
    clock.rules |= rotating(R0, q.Om0.symbols) | rotating(of.Rp.symbols, of.spin.symbols)
    clock.rules |= along(of.spin.symbols, of.turning.symbols) | {sd: sdd}
    of.names.bend(clock.rules, eta, sd)
    accelerated = tuple(clock.step(step) for step in moving)
    second = differential(weighted, {
        w_s: w_ss * sd, w: w_s * sd, sd: sdd, c.symbols[0]: c_d.symbols[0],
        c_d.symbols[0]: rate_of(q, c_d).symbols[0]})
    return rate, time.second(of.names, curving, *accelerated, Stage(
        "second rate of the weighted equation", "element",
        sets=((of.names.scalar("phidd"), second),)))
