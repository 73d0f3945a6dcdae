"""Coordinates that follow the others: ``eta_b = y^T Q_b y / 2``, of second order.

Rates and virtual displacements are those of the chain rule; forces on eta come back to y through
the transpose of ``delta eta_b = (Q_b y) . delta y``.
"""

import sympy as sp

from sebody.derive.form.arrays import Array
from sebody.derive.form.counts import free, hn, slaved
from sebody.derive.form.functions import (
    ADD_BLOCK_TIMES,
    FOLLOW,
    FOLLOW_CHANGES,
    PACKED_TIMES,
    PACKED_TIMES_BOTH,
    ROWS_TIMES,
)
from sebody.derive.form.steps import Call, call
from sebody.derive.formulas.inertia import floating_arrays as at
from sebody.derive.symbolic.variation import along, check_same, differential

_BY_Y = free, slaved, hn    # products of the vectors Q_b y with vectors like y


def slaving() -> tuple[Call, ...]:
    """Values and rates behind the coordinates y and theirs."""
    _prove()
    return (
        call("Q_b z and Q_b zd, all b", PACKED_TIMES_BOTH, at.followers, at.z, at.zd, at.Zq, at.Zd,
             slaved * hn),
        call("eta_b = y . Q_b y / 2, their rates and second rates", FOLLOW,
             at.Zq, at.Zd, at.z, at.zd, at.zdd, *_BY_Y))


def accelerated() -> Call:
    """The further step for differentials of the accelerations."""
    return call("Q_b zdd, all b", PACKED_TIMES, at.followers, at.zdd, at.Za, slaved * hn)


def varied() -> tuple[Call, ...]:
    """Differentials of the values; of y first."""
    return (call("differential: eta_b", ROWS_TIMES, at.Zq, at.z.d, at.z.d.at(free), *_BY_Y),)


def rates_varied() -> tuple[Call, ...]:
    """Differentials of the rates."""
    return (call("differential: rates of eta, accelerations of eta", FOLLOW_CHANGES,
                 at.Zq, at.Zd, at.Za, at.z.d, at.zd.d, at.zdd.d, *_BY_Y),)


def pulled_back(force: Array) -> Call:
    """Forces on eta, added to those on y in the same row."""
    return call("forces on eta, pulled back", ADD_BLOCK_TIMES, at.Zq, force.at(free), force, *_BY_Y)


def _prove() -> None:
    """One eta of two y, with its differentials."""
    y, yd, ydd, dy, dyd, dydd = (sp.Matrix(sp.symbols(f"{n}_:2"))
                                 for n in ("y", "yd", "ydd", "dy", "dyd", "dydd"))
    a, b, c = sp.symbols("a b c")
    Q = sp.Matrix([[a, b], [b, c]])
    value = y.dot(Q * y) / 2
    in_time = along(y, yd) | along(yd, ydd)
    varied = along(y, dy) | along(yd, dyd) | along(ydd, dydd)
    Zq, Zd, Za = Q * y, Q * yd, Q * ydd
    rate, second = Zq.dot(yd), Zq.dot(ydd) + Zd.dot(yd)
    for name, short, chain in (
            ("rate", rate, differential(value, in_time)),
            ("acceleration", second, differential(rate, in_time)),
            ("variation", Zq.dot(dy), differential(value, varied)),
            ("variation of the rate", Zq.dot(dyd) + Zd.dot(dy), differential(rate, varied)),
            ("variation of the acceleration", Zq.dot(dydd) + 2 * Zd.dot(dyd) + Za.dot(dy),
             differential(second, varied))):
        check_same(f"{name} of a slaved coordinate", sp.Matrix([short]), sp.Matrix([chain]))
