"""Scalars and pointers that nothing reads: programs that combine several parts leave some."""

from collections.abc import Iterable, Iterator
from typing import Any

import sympy as sp

from sebody.derive.form.arrays import Array
from sebody.derive.form.statements import For, If, Invoke, Point, Set, Statement, Update, Zero
from sebody.derive.passes.uses import uses


def without_unused(statements: Iterable[Statement]) -> tuple[Statement, ...]:
    """The same statements without scalars that are set, and pointers, that are never read."""
    remaining = tuple(statements)
    while True:
        kept = tuple(_kept(remaining, {*_read(remaining), *uses(remaining).arrays}))
        if kept == remaining:
            return remaining
        remaining = kept


def _kept(statements: Iterable[Statement], read: set[sp.Symbol | Array]) -> Iterator[Statement]:
    def is_kept(target: Any) -> bool:
        return not isinstance(target, sp.Symbol) or target in read
    for one in statements:
        match one:
            case Set(targets, values):
                pairs = [pair for pair in zip(targets, values, strict=True) if is_kept(pair[0])]
                if pairs:
                    yield Set(*map(tuple, zip(*pairs, strict=True)))
            case Zero(symbols):
                if kept := tuple(filter(is_kept, symbols)):
                    yield Zero(kept)
            case Update():
                if is_kept(one.target):
                    yield one
            case Point(array) if array not in read:
                continue
            case For(body=body):
                if own := tuple(_kept(body, read)):
                    yield one._replace(body=own)
            case If(body=body, otherwise=otherwise):
                yield one._replace(body=tuple(_kept(body, read)),
                                   otherwise=tuple(_kept(otherwise, read)))
            case _:
                yield one


def _read(statements: Iterable[Statement]) -> Iterator[sp.Symbol]:
    for one in statements:
        match one:
            case Set(targets, values):
                yield from _in(*values, *(t for t in targets if not isinstance(t, sp.Symbol)))
            case Update():      # what is only added to is not read
                yield from _in(one.value)
            case For(body=body):
                yield from _read(body)
            case If(body=body, otherwise=otherwise):
                yield from _read((*body, *otherwise))
            case Invoke(operands=operands):
                yield from _in(*operands)


def _in(*values: Any) -> Iterator[sp.Symbol]:
    for value in values:
        if isinstance(value, sp.Basic):
            yield from (s for s in value.free_symbols if isinstance(s, sp.Symbol))
