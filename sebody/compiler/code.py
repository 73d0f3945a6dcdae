"""LLVM code of compiled functions for other processors than this one, kept for exports.

Machine code is of use to the process and the processor it was made for alone. Libraries of models
are made from LLVM code, which processes of their own compile for a named processor, once.
"""

import sys
from pathlib import Path
from typing import NamedTuple

import numba

from sebody.compiler import store


class Code(NamedTuple):
    """LLVM code of a function and what it calls."""

    symbol: str         # of the function, with Numba's calling convention
    bitcode: bytes


def keep(source: Path, name: str, made_from: str, processor: str, code: Code) -> None:
    """Keep the code of a function beside what is compiled of its module."""
    store.write(source, _file(source, name, processor), _stamp(made_from),
                code.symbol.encode() + b"\n" + code.bitcode)


def kept(source: Path, name: str, made_from: str, processor: str) -> Code | None:
    """The code that was kept; None if there is none, or of other sources."""
    for content in store.read(source, _file(source, name, processor), _stamp(made_from)):
        symbol, _, bitcode = content.partition(b"\n")
        return Code(symbol.decode(), bitcode)
    return None


def _file(source: Path, name: str, processor: str) -> str:
    return f"{source.stem}.{name}.code.{sys.implementation.cache_tag}.{processor}.sebody"


def _stamp(made_from: str) -> str:
    return f"{made_from}, Numba {numba.__version__}"
