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
from sebody.compiler.inside.names import (
    CompileResult,
    CPUCodegen,
    JITCodeLibrary,
    NullCache,
    cpu_target,
    dumps,
    runtime,
)


class _Kept(JITCodeLibrary):
    """Machine code that was kept. No other library takes it in: it comes without LLVM code."""

    _functions: tuple[str, ...]     # that can be asked for by name

    @classmethod
    def of(cls, codegen: CPUCodegen, name: str, machine_code: bytes,
           functions: tuple[str, ...]) -> "_Kept":
        """Load machine code, in which some functions are called from outside."""
        library = cls(codegen, name)
        library._functions = functions
        library.enable_object_caching()
        library._set_compiled_object(machine_code)
        library._finalize_final_module()
        return library

    def get_pointer_to_function(self, name: str) -> int:
        """Address of a function, 0 if there is none of this name."""
        return self._codegen._engine.get_function_address(name) if name in self._functions else 0


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
        """Tell if the function was compiled, for whatever signature."""
        return store.holds(self._source, self._name, self._made_from)

    def load_overload(self, sig, target_context) -> CompileResult | None:
        """Compiled code for a signature, or None."""
        # refreshing the context imports all that compiling needs; code that is read needs memory
        runtime.initialize(target_context)
        for content in store.read(self._source, self._name, self._made_from):
            kept = pickle.loads(content).get(sig)
            if kept is not None:
                return self._rebuilt(target_context, *pickle.loads(kept))
        return None

    @staticmethod
    def _rebuilt(context, code, fndesc, env, signature, objectmode, lifted, typeann, reload_init,
                 envs) -> CompileResult:
        for initialize in reload_init:
            initialize()
        library = _Kept.of(context.codegen(), *code)
        for one in envs:
            library.codegen.set_env(one.env_name, one)
        return CompileResult(
            target_context=context, typing_context=context.typing_context, library=library,
            environment=env, entry_point=context.get_executable(library, fndesc, env),
            fndesc=fndesc, type_annotation=typeann, signature=signature, objectmode=objectmode,
            lifted=lifted, typing_error=None, call_helper=None, metadata=None,
            reload_init=reload_init, referenced_envs=envs)

    @staticmethod
    def _reduced(data: CompileResult) -> tuple:
        """The arguments of `_rebuilt`; LLVM code, which callers take in, is kept by itself."""
        library, names = data.library, data.fndesc
        functions = tuple(name for name in (
            names.llvm_func_name, names.llvm_cpython_wrapper_name,
            names.llvm_cfunc_wrapper_name) if library.get_pointer_to_function(name))
        *described, environments = data._reduce()[1:]
        # those without constants are asked for nothing, and their modules take long to import
        environments = tuple(one for one in environments if one.consts)
        return (library.name, library._get_compiled_object(), functions), *described, environments

    def save_overload(self, sig, data: CompileResult) -> None:
        """Keep the compiled code for a signature."""
        assert not data.library.has_dynamic_globals, f"{self._name} holds addresses"
        entries = {}
        for content in store.read(self._source, self._name, self._made_from):
            entries = pickle.loads(content) | entries
        entries[sig] = dumps(self._reduced(data))
        if not store.write(self._source, self._name, self._made_from, dumps(entries)):
            store.say_not_kept(self._source)


def is_kept(source: Path, function: str, made_from: str, kind: str = "") -> bool:
    """Tell if a function of a file that need not be imported was compiled."""
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
