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
        _dots("eta_b = y . Q_b y / 2", "Zq", "z", "z"),
        Call("half of it", "scale", ("at(z, free)", "0.5", "slaved"), ("z",)),
        _dots("their rates, Q_b y . ydot", "Zq", "zd", "zd"),
        _dots("their accelerations, Q_b y . yddot", "Zq", "zdd", "zdd"),
        _dots("and ydot . Q_b ydot", "Zd", "zd", "zdd", "add_"))


def varied() -> tuple[Call, ...]:
    """Differentials of the values; of y first."""
    return (_dots("differential: eta_b", "Zq", "dz", "dz"),)


def rates_varied() -> tuple[Call, ...]:
    """Differentials of the rates."""
    return (_dots("differential: rates of eta", "Zq", "dzd", "dzd"),
            _dots("of Q_b y", "Zd", "dz", "dzd", "add_"),
            _dots("differential: accelerations of eta", "Zq", "dzdd", "dzdd"),
            _dots("of ydot, twice", "Zd", "dzd", "dzdd", "add_"),
            _dots("again", "Zd", "dzd", "dzdd", "add_"),
            _dots("of Q_b y", "Za", "dz", "dzdd", "add_"))


def pulled_back(force: str) -> Call:
    """Forces on eta, added to those on y in the same row."""
    return Call("forces on eta, pulled back", "add_block_times",
                ("Zq", f"at({force}, free)", force, "free", "slaved", "hn"), ("Zq", force))


def _dots(title: str, vectors: str, vector: str, out: str, add: str = "") -> Call:
    return Call(title, f"{add}rows_times", (vectors, vector, f"at({out}, free)", *_BY_Y),
                (vectors, vector, out))


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
