"""Compiled functions kept from run to run, in place of Numba's own cache.

Numba compares the file of a function only, so editing a function does not recompile the functions
that call it. Here compiled code is kept with a hash of all sources it may call. Numba's cache also
raises an error if no folder can be written or a file is damaged; this one compiles instead.
"""

import pickle
import sys
from collections.abc import Callable
from pathlib import Path

import numba
from numba.core.caching import NullCache
from numba.core.compiler import CompileResult
from numba.core.serialize import dumps

from sebody.kernels import store


class FunctionCache(NullCache):
    """Compiled code of a function: one file, an entry for each signature and processor.

    Parameters
    ----------
    function : callable
        A function of a module.
    made_from : str
        Hash of all sources the machine code depends on.
    """

    def __init__(self, function: Callable, made_from: str):
        assert function.__closure__ is None, f"{function.__name__}: the hash sees no closures"
        self._source = Path(function.__code__.co_filename)
        name = f"{self._source.stem}.{function.__qualname__}".replace("<", "").replace(">", "")
        self._name = f"{name}.{sys.implementation.cache_tag}.sebody"
        self._made_from = f"{made_from}, Numba {numba.__version__}"

    def load_overload(self, sig, target_context) -> CompileResult | None:
        """Compiled code for a signature, or None."""
        target_context.refresh()
        key = sig, target_context.codegen().magic_tuple()
        for content in store.read(self._source, self._name, self._made_from):
            kept = pickle.loads(content).get(key)
            if kept is not None:
                return CompileResult._rebuild(target_context, *pickle.loads(kept))
        return None

    def save_overload(self, sig, data: CompileResult) -> None:
        """Keep the compiled code for a signature."""
        assert not data.library.has_dynamic_globals, f"{self._name} holds addresses"
        entries = {}
        for content in store.read(self._source, self._name, self._made_from):
            entries = pickle.loads(content) | entries
        entries[sig, data.codegen.magic_tuple()] = dumps(data._reduce())
        if not store.write(self._source, self._name, self._made_from, dumps(entries)):
            tried = ", ".join(map(str, store.folders(self._source)))
            store.say_once("writing", "compiled code cannot be kept, every start compiles it "
                           f"again: no folder of {tried} can be written; set NUMBA_CACHE_DIR to "
                           "one that can")
