"""Coordinates that follow the others: ``eta_b = y^T Q_b y / 2``, of second order.

Rates and virtual displacements are those of the chain rule; forces on eta come back to y through
the transpose of ``delta eta_b = (Q_b y) . delta y``.
"""

import sympy as sp

from sebody.derive.symbolic.steps import Call
from sebody.derive.symbolic.variation import along, check_same, differential

_BY_Y = ("free", "slaved", "hn")    # products of the vectors Q_b y with vectors like y


def stacked(vector: str, out: str) -> Call:
    """``Q_b x`` of all b, one after the other."""
    return Call(f"Q_b {vector}, all b", "packed_times",
                ("followers", vector, out, "slaved*hn"), ("followers", vector, out))


def slaving() -> tuple[Call, ...]:
    """Values and rates behind the coordinates y and theirs."""
    _prove()
    return (
        stacked("z", "Zq"), stacked("zd", "Zd"),
        Call("eta_b = y . Q_b y / 2, their rates and second rates", "follow",
             ("Zq", "Zd", "z", "zd", "zdd", *_BY_Y), ("Zq", "Zd", "z", "zd", "zdd")))


def varied() -> tuple[Call, ...]:
    """Differentials of the values; of y first."""
    return (Call("differential: eta_b", "rows_times", ("Zq", "dz", "at(dz, free)", *_BY_Y),
                 ("Zq", "dz")),)


def rates_varied() -> tuple[Call, ...]:
    """Differentials of the rates."""
    rows = "Zq", "Zd", "Za", "dz", "dzd", "dzdd"
    return (Call("differential: rates of eta, accelerations of eta", "follow_changes",
                 (*rows, *_BY_Y), rows),)


def pulled_back(force: str) -> Call:
    """Forces on eta, added to those on y in the same row."""
    return Call("forces on eta, pulled back", "add_block_times",
                ("Zq", f"at({force}, free)", force, "free", "slaved", "hn"), ("Zq", force))


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
