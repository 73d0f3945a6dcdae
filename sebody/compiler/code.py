"""Code of compiled functions for other processors than this one, kept for exports.

Machine code of the JIT is of use to the process and the processor it was made for alone. Libraries
of models are made from LLVM code, which processes of their own compile for a named processor, once.
"""

import re
import sys
from pathlib import Path
from typing import NamedTuple

import numba
from llvmlite import binding

from sebody.compiler import store

# Numba's counting of references, in instructions of this machine's architecture
_COUNTING = re.compile(r"^define [^\n]*@(NRT_incref|NRT_decref)\(.*?^}", re.MULTILINE | re.DOTALL)


def bitcode(text: str) -> bytes:
    """LLVM code as bytes, for any architecture: references are counted by another library."""
    made = _COUNTING.sub(r"declare void @\1(ptr)", text)
    return binding.parse_assembly(made).as_bitcode()


class Code(NamedTuple):
    """LLVM code of a function and what it calls."""

    symbol: str         # of the function, with Numba's calling convention
    bitcode: bytes


class Place(NamedTuple):
    """The place where code of something is kept: beside what is compiled of a module."""

    source: Path
    name: str           # of what it is the code of
    made_from: str      # hash of all sources it depends on

    def keep(self, kind: str, target: str, content: bytes) -> None:
        """Keep code of a kind for a processor or platform."""
        store.write(self.source, self._file(kind, target), self._stamp, content)

    def kept(self, kind: str, target: str) -> bytes | None:
        """The code that was kept; None if there is none, or of other sources."""
        return next(store.read(self.source, self._file(kind, target), self._stamp), None)

    def _file(self, kind: str, target: str) -> str:
        cache = sys.implementation.cache_tag
        return f"{self.source.stem}.{self.name}.{kind}.{cache}.{target}.sebody"

    @property
    def _stamp(self) -> str:
        return f"{self.made_from}, Numba {numba.__version__}"
