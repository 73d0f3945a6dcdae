"""Compiled functions kept from run to run, in place of Numba's own cache.

Numba compares the file of a function only, so editing a function does not recompile the functions
that call it. Here compiled code is kept with a hash of all sources it may call. Numba's cache also
raises an error if no folder can be written or a file is damaged; this one compiles instead.
Processors have files of their own, so that the first line of a file tells whether it is of use.
"""

import pickle
import sys
import zlib
from collections.abc import Callable
from functools import cache
from pathlib import Path

import numba

from sebody.compiler import store
from sebody.compiler.inside.names import CompileResult, NullCache, cpu_target, dumps


class FunctionCache(NullCache):
    """Compiled code of a function: a file for each processor, an entry for each signature.

    Parameters
    ----------
    function : callable
        A function of a module.
    made_from : str
        Hash of all sources the machine code depends on.
    """

    kind = ""       # of what is kept of a function, in the names of files

    def __init__(self, function: Callable, made_from: str):
        assert function.__closure__ is None, f"{function.__name__}: the hash sees no closures"
        self._source = Path(function.__code__.co_filename)
        self._function = function.__qualname__
        self._made_from = _stamp(made_from)

    @property
    def _name(self) -> str:
        return _file_name(self._source, self._function, self.kind)

    def holds_any(self) -> bool:
        """Whether the function was compiled, for whatever signature."""
        return store.holds(self._source, self._name, self._made_from)

    def load_overload(self, sig, target_context) -> CompileResult | None:
        """Compiled code for a signature, or None."""
        target_context.refresh()
        for content in store.read(self._source, self._name, self._made_from):
            kept = pickle.loads(content).get(sig)
            if kept is not None:
                return self._rebuilt(target_context, *pickle.loads(kept))
        return None

    _rebuilt = staticmethod(CompileResult._rebuild)

    def save_overload(self, sig, data: CompileResult) -> None:
        """Keep the compiled code for a signature."""
        assert not data.library.has_dynamic_globals, f"{self._name} holds addresses"
        entries = {}
        for content in store.read(self._source, self._name, self._made_from):
            entries = pickle.loads(content) | entries
        entries[sig] = dumps(data._reduce())
        if not store.write(self._source, self._name, self._made_from, dumps(entries)):
            store.say_not_kept(self._source)


def is_kept(source: Path, function: str, made_from: str, kind: str = "") -> bool:
    """Whether a function of a file that need not be imported was compiled."""
    return store.holds(source, _file_name(source, function, kind), _stamp(made_from))


def _file_name(source: Path, function: str, kind: str = "") -> str:
    name = ".".join(filter(None, (source.stem, function, kind))).replace("<", "").replace(">", "")
    return f"{name}.{sys.implementation.cache_tag}.{_processor()}.sebody"


@cache
def _processor() -> str:
    """Short name of the processor that is compiled for."""
    described = repr(cpu_target.target_context.codegen().magic_tuple())
    return f"{zlib.crc32(described.encode()):08x}"


def _stamp(made_from: str) -> str:
    return f"{made_from}, Numba {numba.__version__}"
