"""Scalars that some statements leave and later ones read: kept in memory between two calls."""

from collections.abc import Iterable, Iterator
from typing import Any

import sympy as sp

from sebody.derive.form.arrays import Array
from sebody.derive.form.statements import For, If, Invoke, Set, Statement, Update, Zero


def carried(before: Iterable[Statement], parts: Iterable[Iterable[Statement]], kept: Array
            ) -> tuple[tuple[Set, ...], list[tuple[Set, ...]], int]:
    """Statements that keep scalars behind some others, and that find them before each of others.

    Returns
    -------
    keep : tuple of Set
    found : list of tuple of Set
        One for each of `parts`.
    room : int
        Numbers in `kept`.
    """
    left = {symbol for symbol, is_read in _scalars(before) if not is_read}
    needed = []
    for part in parts:
        own: set[sp.Symbol] = set()
        needed.append({symbol: None for symbol, is_read in _scalars(part)
                       if symbol in left and not _is_own(symbol, is_read, own)})
    places = {symbol: k for k, symbol in enumerate(sorted(
        {s for part in needed for s in part}, key=str))}
    return (tuple(Set((kept[k],), (symbol,)) for symbol, k in places.items()),
            [tuple(Set((s,), (kept[k],)) for s, k in places.items() if s in part)
             for part in needed], len(places))


def _is_own(symbol: sp.Symbol, is_read: bool, own: set[sp.Symbol]) -> bool:
    """Tell if a scalar was set by the same statements before."""
    if not is_read:
        own.add(symbol)
    return symbol in own


def _scalars(statements: Iterable[Statement]) -> Iterator[tuple[sp.Symbol, bool]]:
    """Scalars in the order of use, and whether they are read: not where they are set."""
    for one in statements:
        match one:
            case Set(targets, values):
                yield from _read(*values)
                yield from ((t, False) for t in targets if isinstance(t, sp.Symbol))
            case Zero(symbols):
                yield from ((s, False) for s in symbols)
            case Update(target, _, value):
                yield from _read(value, target)
            case For(body=body):
                yield from _scalars(body)
            case If(body=body, otherwise=otherwise):
                yield from _scalars((*body, *otherwise))
            case Invoke(operands=operands, outputs=outputs):
                yield from _read(*operands)
                yield from ((o, False) for o in outputs if isinstance(o, sp.Symbol))


def _read(*values: Any) -> Iterator[tuple[sp.Symbol, bool]]:
    for value in values:
        if isinstance(value, sp.Basic):
            yield from ((s, True) for s in sorted(value.free_symbols, key=str)
                        if isinstance(s, sp.Symbol))
