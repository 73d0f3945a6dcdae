"""Kinetic energy of the displacement field in the floating frame, and its forces.

The velocity of a mass point of the body is, in axes of the frame,

    v* = v0* + Omega_0 x (X + A z) + A zdot

with constant shapes A. The kinetic energy of all points is a form in v0*, Omega_0 and zdot whose
coefficients are integrals of X and A: first moments c, moments of inertia J and couplings B, linear
or quadratic in z. Each force is the rate of a momentum, less a derivative; what varies is known of
every integral by its gradient. The integrals are additive, so what holds for one point with two
shapes holds for all bodies (`prove`).
"""

from functools import cache
from typing import NamedTuple

import sympy as sp

from sebody.derive.form.spaces import PAIRS
from sebody.derive.formulas.elastic import conjugate_to
from sebody.derive.symbolic.rotations import cross
from sebody.derive.symbolic.variation import along, check_same, differential


class Motion(NamedTuple):
    """The frame: vectors in its own axes."""

    mass: sp.Expr
    velocity: sp.Matrix         # v0* = R0^T xdot_0
    felt: sp.Matrix             # R0^T (xddot_0 - g)
    spin: sp.Matrix             # Omega_0
    turning: sp.Matrix          # its rate


class Sums(NamedTuple):
    """Integrals over the body, contracted with coordinates z and their rates."""

    c: sp.Matrix            # c0 + S1 z
    cd: sp.Matrix           # S1 zdot
    cdd: sp.Matrix          # S1 zddot
    J: sp.Matrix            # J0_kl + (h_kl + h_lk) z + z J2_kl z, symmetric
    Jd: sp.Matrix           # its rate
    spun: sp.Matrix         # B zdot,   B_k = g_k + z K_k
    accelerated: sp.Matrix  # B zddot
    coupled: sp.Matrix      # Bdot zdot


class Row(NamedTuple):
    """The constants of one coordinate z_i, and their contractions."""

    S1: sp.Matrix           # first moment of its shape
    g: sp.Matrix            # g_k,i
    h: sp.Matrix            # h_kl,i + h_lk,i, symmetric
    j: sp.Matrix            # (J2_kl z)_i, symmetric
    u: sp.Matrix            # (K_k^T z)_i
    v: sp.Matrix            # (K_k^T zdot)_i
    w: sp.Matrix            # (K_k zdot)_i
    jd: sp.Matrix           # (J2_kl zdot)_i
    ua: sp.Matrix           # (K_k^T zddot)_i
    wa: sp.Matrix           # (K_k zddot)_i


def kinetic_energy(m: Motion, s: Sums, squared: sp.Expr) -> sp.Expr:
    """T of the body; `squared` is ``zdot . Mbar zdot``."""
    v, w = m.velocity, m.spin
    return (m.mass * v.dot(v) / 2 + v.dot(cross(w, s.c) + s.cd) + w.dot(s.J * w) / 2
            + w.dot(s.spun) + squared / 2)


def momenta(m: Motion, s: Sums) -> tuple[sp.Matrix, sp.Matrix]:
    """Momentum and its moment about the origin of the frame, ``dT/dv0*`` and ``dT/dOmega_0``."""
    v, w = m.velocity, m.spin
    return m.mass * v + cross(w, s.c) + s.cd, cross(s.c, v) + s.J * w + s.spun


def on_origin(m: Motion, s: Sums) -> sp.Matrix:
    """Force conjugate to ``R0^T delta x_0``: rate of the momentum, and weight."""
    w = m.spin
    return (m.mass * m.felt + cross(m.turning, s.c) + cross(w, cross(w, s.c)) + 2 * cross(w, s.cd)
            + s.cdd)


def on_frame(m: Motion, s: Sums) -> sp.Matrix:
    """Moment conjugate to ``delta Theta_0``."""
    w = m.spin
    return (cross(s.c, m.felt) + s.J * m.turning + cross(w, s.J * w) + s.Jd * w + s.coupled
            + s.accelerated + cross(w, s.spun))


def on_coordinate(m: Motion, r: Row) -> sp.Expr:
    """Force conjugate to ``delta z_i``, without ``(Mbar zddot)_i``."""
    w = m.spin
    return (r.S1.dot(m.felt) + (r.g + r.u).dot(m.turning) + w.dot(r.v - r.w)
            - w.dot((r.h + 2 * r.j) * w) / 2)


def gradients(r: Row) -> tuple[Sums, Sums, Sums]:
    """Derivatives of the sums by z_i, by zdot_i and by zddot_i."""
    none, still = sp.zeros(3, 1), sp.zeros(3, 3)
    inertia, coupling = r.h + 2 * r.j, r.g + r.u
    return (Sums(r.S1, none, none, inertia, 2 * r.jd, r.w, r.wa, none),
            Sums(none, r.S1, none, still, inertia, coupling, none, r.v + r.w),
            Sums(none, none, r.S1, still, still, none, coupling, none))


def by_sums(force: sp.Matrix, s: Sums, change: Sums) -> sp.Matrix:
    """Change of a force by that of the sums."""
    rules = {}
    for value, moved in zip(s, change, strict=True):
        rules |= along(value, moved)
    return differential(force, rules)


def _vector(name: str) -> sp.Matrix:
    return sp.Matrix(sp.symbols(f"{name}_:3"))


def _inertia(name: str) -> sp.Matrix:
    products = {}
    for r, c in PAIRS:
        products[r, c] = products[c, r] = sp.Symbol(f"{name}_{r}{c}")
    return sp.Matrix(3, 3, lambda r, c: products[r, c])


def _symmetric(name: str) -> sp.Matrix:
    a, b, c = sp.symbols(f"{name}_:3")
    return sp.Matrix([[a, b], [b, c]])


class _Body:
    """A body of two coordinates with any constants, and its sums and rows."""

    def __init__(self):
        self.z, self.zd, self.zdd = (sp.Matrix(sp.symbols(f"{n}_:2")) for n in ("z", "zd", "zdd"))
        self.S1 = sp.Matrix(3, 2, sp.symbols("S_:6"))
        self.g = sp.Matrix(3, 2, sp.symbols("g_:6"))
        self.K = [sp.Matrix(2, 2, sp.symbols(f"K{k}_:4")) for k in range(3)]
        self.h = [_inertia(f"h{i}") for i in range(2)]
        self.J2 = {}
        for r, c in PAIRS:
            self.J2[r, c] = self.J2[c, r] = _symmetric(f"J2_{r}{c}")
        self.M = _symmetric("M")
        self.c0, self.J0 = _vector("c0"), _inertia("J0")
        self.in_time = along(self.z, self.zd) | along(self.zd, self.zdd)

    def sums(self) -> Sums:
        z, zd, zdd = self.z, self.zd, self.zdd
        B = sp.Matrix(3, 2, lambda k, i: self.g[k, i] + (z.T * self.K[k])[i])
        J = (self.J0 + self.h[0] * z[0] + self.h[1] * z[1]
             + sp.Matrix(3, 3, lambda r, c: z.dot(self.J2[r, c] * z)))
        return Sums(self.c0 + self.S1 * z, self.S1 * zd, self.S1 * zdd, J,
                    differential(J, self.in_time), B * zd, B * zdd,
                    differential(B, self.in_time) * zd)

    def row(self, i: int) -> Row:
        z, zd, zdd = self.z, self.zd, self.zdd

        def coupled(x, transposed):
            return sp.Matrix([((K.T if transposed else K) * x)[i] for K in self.K])

        def squares(x):
            return sp.Matrix(3, 3, lambda r, c: (self.J2[r, c] * x)[i])
        return Row(self.S1[:, i], self.g[:, i], self.h[i], squares(z), coupled(z, True),
                   coupled(zd, True), coupled(zd, False), squares(zd), coupled(zdd, True),
                   coupled(zdd, False))


@cache
def prove() -> None:
    """Energy of a mass point, forces by Hamilton's principle, gradients of the sums.

    The formulas are bilinear in constants and coordinates: two coordinates have every product that
    more of them have.
    """
    _prove_energy()
    body = _Body()
    sums, rows = body.sums(), [body.row(i) for i in range(2)]
    motion = Motion(sp.Symbol("m"), *map(_vector, ("v", "b", "Om", "Omd")))
    _prove_forces(body, sums, rows, motion)
    for k, name in enumerate(("z", "zd", "zdd")):
        for i in range(2):
            for total, change in zip(sums, gradients(rows[i])[k], strict=True):
                check_same(f"gradient of a sum by {name}", change.reshape(len(change), 1),
                           total.diff(getattr(body, name)[i]).reshape(len(change), 1))


def _prove_energy() -> None:
    """T of one point from its velocity."""
    body, X, A = _Body(), _vector("X"), sp.Matrix(3, 2, sp.symbols("A_:6"))
    m = sp.Symbol("m")
    motion = Motion(m, _vector("v"), sp.zeros(3, 1), _vector("Om"), sp.zeros(3, 1))
    e = [sp.eye(3)[:, k] for k in range(3)]
    shapes = [A[:, i] for i in range(2)]
    values = along(body.S1, m * A) | along(body.c0, m * X) | along(body.M, m * A.T * A)
    values |= along(body.g, sp.Matrix(3, 2, lambda k, i: m * cross(e[k], X).dot(shapes[i])))
    for k in range(3):
        values |= along(body.K[k], sp.Matrix(2, 2, lambda i, j, k=k:
                                             m * cross(e[k], shapes[i]).dot(shapes[j])))
    for r, c in PAIRS:
        values[body.J0[r, c]] = m * cross(e[r], X).dot(cross(e[c], X))
        for i in range(2):
            values[body.h[i][r, c]] = m * (cross(e[r], X).dot(cross(e[c], shapes[i]))
                                           + cross(e[c], X).dot(cross(e[r], shapes[i])))
            for j in range(i, 2):
                values[body.J2[r, c][i, j]] = m * (
                    cross(e[r], shapes[i]).dot(cross(e[c], shapes[j]))
                    + cross(e[c], shapes[i]).dot(cross(e[r], shapes[j]))) / 2
    T = kinetic_energy(motion, body.sums(), body.zd.dot(body.M * body.zd)).xreplace(values)
    v = motion.velocity + cross(motion.spin, X + A * body.z) + A * body.zd
    check_same("kinetic energy of a mass point", sp.Matrix([T]), sp.Matrix([m * v.dot(v) / 2]))


def _prove_forces(body: _Body, s: Sums, rows: list[Row], m: Motion) -> None:
    """Hamilton's principle: momenta at the rates of variations, the rest at the variations.

    ``delta v0* = (delta x*)' + Omega_0 x delta x* + v0* x delta Theta_0`` with ``delta x* = R0^T
    delta x_0``, and ``delta Omega_0 = (delta Theta_0)' + Omega_0 x delta Theta_0``.
    """
    T = kinetic_energy(m, s, body.zd.dot(body.M * body.zd))
    pushed, turned = momenta(m, s)
    for name, p, of in (("momentum", pushed, m.velocity), ("moment of it", turned, m.spin)):
        check_same(f"{name} of the body", p, conjugate_to(T, of))
    # R0^T xddot_0 = v0*' + Omega_0 x v0*
    in_time = (body.in_time | along(m.velocity, m.felt - cross(m.spin, m.velocity))
               | along(m.spin, m.turning))
    dx, dth = _vector("dx"), _vector("dth")
    form = (pushed.dot(cross(m.spin, dx) + cross(m.velocity, dth))
            + turned.dot(cross(m.spin, dth)))
    for name, short, p, along_ in (("origin", on_origin(m, s), pushed, dx),
                                   ("frame", on_frame(m, s), turned, dth)):
        check_same(f"inertia on the {name}", short,
                   differential(p, in_time) - conjugate_to(form, along_))
    for i in range(2):
        short = on_coordinate(m, rows[i]) + (body.M * body.zdd)[i]
        chain = differential(T.diff(body.zd[i]), in_time) - T.diff(body.z[i])
        check_same("inertia on a coordinate", sp.Matrix([short]), sp.Matrix([chain]))
