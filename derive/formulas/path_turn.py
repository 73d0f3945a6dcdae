"""A node in a plane that turns with the tangent of a path of a reduced body.

The tangent has an angle tau to the axes of the body's frame, by rows of rotations of the FE nodes,
splined in the way s as the path itself, with the followers eta of `formulas/path.py`,

    tau = A(s) + Psi_y(s) y + Psi_eta(s) eta,       t = R_0 (cos tau, sin tau)

and the normal ``n = (-sin, cos)`` of the angle ``theta + held``, which turns with the node,
stays normal to t. Weighted by what this body has of the path,

    phi = w(s) n . t = w sin(delta) = 0,            delta = theta_0 + tau - theta - held

The multiplier mu acts on the body at s with the moment ``w mu cos(delta)``, on the node with minus
this, and along the way with ``mu (w_s sin(delta) + w tau_s cos(delta))``: a moment pushes by itself
times the curvature of the deformed path.
"""

from functools import cache

import sympy as sp

from sebody.contract.layout import Part
from sebody.derive.form.arrays import constant
from sebody.derive.form.counts import n
from sebody.derive.form.functions import PATH_PLACE
from sebody.derive.form.spaces import Space
from sebody.derive.form.steps import Solve, Stage, Step, search
from sebody.derive.formulas import arrays
from sebody.derive.formulas.elastic import conjugate_to
from sebody.derive.formulas.frames.frame import Frame, FrameOption
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
from sebody.derive.symbolic.variation import along, check_same, differential, rotating

HELD = Part("held", (), "angle of the tangent to the node, which stays")
ANGLES = 1      # numbers of a row


@cache
def body_turn(frame: FrameOption) -> Steps:
    """Derive the steps in a frame."""
    q = Quantities(Space(True))
    chosen = frame.derive(q)
    names = Names(q, ANGLES)
    located, equation = _located(q, chosen, names)
    forces = _forces(q, chosen, names)
    rate, second = _rates(q, chosen, names)
    moved, turned = _moved(q, chosen, names, equation, forces)
    return Steps(q, located, forces, rate, second, moved, turned)


def _located(q: Quantities, frame: Frame, names: Names
             ) -> tuple[tuple[Step, ...], tuple[Stage, ...]]:
    """The equation from the unknowns; also the stages at its end."""
    tau, theta, w = (_one(names, name) for name in ("tau", "theta", "share"))
    held = q.space.quantity("angle", "scalar", "element", constant(HELD)).symbols[0]
    t, normal = names.vector("along"), names.vector("normal")
    (n_x, n_y), (t_x, t_y) = normal.symbols[:2], t.symbols[:2]
    equation = (
        Stage("tangent of the path", "element",
              sets=((t, q.R0.symbols * sp.Matrix([sp.cos(tau), sp.sin(tau), 0])),)),
        Stage("normal that turns with the node", "element", sets=((normal, sp.Matrix(
            [-sp.sin(theta + held), sp.cos(theta + held), 0])),)),
        Stage("sine and cosine of the angle between them", "element", sets=(
            (names.scalar("sine"), sp.Matrix([n_x * t_x + n_y * t_y])),
            (names.scalar("cosine"), sp.Matrix([n_y * t_x - n_x * t_y])))),
        Stage("weighted equation", "element", sets=((
            names.scalar("phi"), sp.Matrix([w * _one(names, "sine")])),)))
    return local(q, frame, (
        search("angle of the path in the frame", PATH_PLACE, TABLE, _one(names, "way"), arrays.y,
               n, ANGLES, HEAD, SHAPES, SLOPES, BENDS, operations=0),
        *equation)), equation


def _forces(q: Quantities, frame: Frame, names: Names) -> tuple[Stage | Solve, ...]:
    """From the multiplier to moments on node and body, and a force along the way."""
    w, w_s, tau_s, mu, sine, cosine, moment = (_one(names, name) for name in (
        "share", "share_s", "tau_s", "mu", "sine", "cosine", "moment"))
    on_frame = sp.Matrix([0, 0, moment])
    _check_work(q, names)
    return (
        Stage("moment on the body, and minus that on the node", "element", sets=(
            (names.scalar("moment"), sp.Matrix([w * mu * cosine])),
            (names.scalar("gp"), sp.Matrix([-w * mu * cosine])))),
        Stage("force along the path", "element", sets=((
            names.scalar("gs"), sp.Matrix([mu * (w_s * sine + w * tau_s * cosine)])),)),
        *names.on_coordinates(sp.Matrix([moment])),
        *forces_on_unknowns(q, frame, sp.zeros(3, 1), Stage(
            "moment on the frame", "element", adds=((q.W, on_frame),), continues=True)))


def _check_work(q: Quantities, names: Names) -> None:
    """The moment on the frame is conjugate to its rotation in the equation."""
    tau, normal = _one(names, "tau"), names.vector("normal").symbols
    t = sp.Matrix([sp.cos(tau), sp.sin(tau), 0])
    turned = normal.dot(differential(q.R0.symbols * t, rotating(q.R0.symbols, q.dth0.symbols)))
    t_x, t_y, _ = q.R0.symbols * t
    check_same("moment on the frame", conjugate_to(turned, q.dth0.symbols),
               sp.Matrix([0, 0, normal[1] * t_x - normal[0] * t_y]))


def _moved(q: Quantities, frame: Frame, names: Names, equation: tuple[Stage, ...],
           forces: tuple[Stage | Solve, ...]) -> tuple[tuple[Step, ...], tuple[Step, ...]]:
    """Differentials of the equation and of the forces, by the chain rule."""
    ds = q.space.d(names.scalar("way")).symbols
    chain, steps, of_y = varied(q, frame, names)
    by_y, bent = names.scalar("dtau_y"), names.scalar("dtau_sy")
    dtau, dtau_s = names.scalar("tau_d"), names.scalar("tau_sd")
    steps += [
        *names.summed(by_y, SHAPES, of_y, "turning of the tangent"),
        *names.summed(bent, SLOPES, of_y, "change of the curvature"),
        Stage("turning of the tangent, along the path included", "element", sets=(
            (dtau, by_y.symbols + names.scalar("tau_s").symbols * ds),
            (dtau_s, bent.symbols + names.scalar("tau_ss").symbols * ds)))]
    chain.rules |= along(names.scalar("tau").symbols, dtau.symbols)
    chain.rules |= along(names.scalar("tau_s").symbols, dtau_s.symbols)
    names.weigh(chain.rules, ds[0])
    for name in ("theta", "mu"):
        chain.move(names.scalar(name))
    names.bend(chain.rules, of_y, ds[0])
    steps += [chain.step(step) for step in equation]
    return tuple(steps), tuple(chain.step(step) for step in forces)


def _rates(q: Quantities, frame: Frame, names: Names) -> tuple[tuple[Step, ...], tuple[Step, ...]]:
    """The equation's rate and second rate: differentials in the direction of time."""
    time = Timed(q, frame)
    clock, eta = time.clock, time.rates
    sd, sdd, theta_d, theta_dd, w, w_s, w_ss, sine, cosine = (_one(names, name) for name in (
        "wayd", "waydd", "thetad", "thetadd", "share", "share_s", "share_ss", "sine", "cosine"))
    by_y, of_slope, slope_rate, delta = (names.scalar(name) for name in (
        "up", "ut", "rst", "delta_d"))
    relative = (*names.summed(by_y, SHAPES, eta, "rate of the angle"),
                Stage("rate of the angle between path and node", "element", sets=((delta, sp.Matrix(
                    [q.Om0.symbols[2] + by_y.symbols[0] + _one(names, "tau_s") * sd - theta_d])),)))
    weighted = sp.Matrix([w_s * sd * sine + w * cosine * delta.symbols[0]])
    rate = time.rate(*relative, Stage("rate of the weighted equation", "element",
                                    sets=((names.scalar("phid"), weighted),)))
    slopes = (*names.summed(of_slope, SLOPES, eta, "turning of the curvature"),
              Stage("rate of the curvature", "element", sets=((
                  slope_rate, of_slope.symbols + names.scalar("tau_ss").symbols * sd),)))
    clock.rules |= along(names.scalar("tau_s").symbols, slope_rate.symbols)
    clock.rules |= {sp.Symbol("wayd"): sdd, sp.Symbol("thetad"): theta_dd}
    names.bend(clock.rules, eta, sd)
    accelerated = tuple(clock.step(step) for step in relative)
    turned, again = delta.symbols[0], rate_of(q, delta).symbols[0]
    second = differential(weighted, {
        w_s: w_ss * sd, w: w_s * sd, sp.Symbol("wayd"): sdd, sine: cosine * turned,
        cosine: -sine * turned, turned: again})
    return rate, time.second(names, slopes, *accelerated, Stage(
        "second rate of the weighted equation", "element",
        sets=((names.scalar("phidd"), second),)))


def _one(names: Names, name: str) -> sp.Symbol:
    """A number of the element."""
    found: sp.Symbol = names.scalar(name).symbols[0]
    return found
