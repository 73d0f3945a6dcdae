"""The plain way to compile: through Numba's public interface alone.

Every function here has a counterpart in `sebody.compiler.inside.entry`, which compiles faster.
Numba keeps the compiled code in its own cache. That cache compares the file of a function only, not
what the function calls, so everything compiled from other sources has a folder of its own.
"""

import math
import re
import sys
import zlib
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

import numba
import numpy as np
from llvmlite import binding
from numba import cfunc, config, from_dtype, njit, types
from numba.extending import intrinsic, overload_attribute

from sebody.compiler import store
from sebody.compiler.code import Code, bitcode

SLOWER = 2.5        # compilation, compared with the fast way


class _Made(NamedTuple):
    """The way a function was compiled."""

    options: dict
    made_from: str


_made: dict[Callable, _Made] = {}                   # by the function in Python
_shown: set[tuple[type[types.Type], str]] = set()   # members that compiled code can read


def function(function: Callable, options: dict, made_from: str) -> Callable:
    """A function to be called from Python and from other compiled functions.

    Parameters
    ----------
    options : dict
        Of `numba.njit`.
    made_from : str
        Hash of all sources the machine code depends on.
    """
    _made[function] = _Made(options, made_from)
    with _folder(function, made_from) as kept:
        return njit(cache=kept, **options)(function)


def kernel(function: Callable, signature, options: dict, made_from: str) -> Callable:
    """A function to be called through its attribute `address`, compiled at once."""
    with _folder(function, made_from) as kept:
        made = cfunc(signature, cache=kept, **options)(function)
    _mark(function, made_from, kept)
    return made


def compile_for(function: Callable, kinds: tuple[types.Type, ...]) -> None:
    """Compile a function for some types of arguments, or find it in the cache."""
    options, made_from = _made[function.py_func]
    with _folder(function.py_func, made_from) as kept:
        njit(kinds, cache=kept, **options)(function.py_func)
    _mark(function.py_func, made_from, kept)


def is_compiled(function: Callable) -> bool:
    """Tell if a function was compiled, for whatever types of arguments."""
    code = function.py_func.__code__
    return is_kept(Path(code.co_filename), function.py_func.__qualname__,
                   _made[function.py_func].made_from)


def is_kept(source: Path, name: str, made_from: str) -> bool:
    """Tell if a function of a file that need not be imported was compiled."""
    return store.holds(source, _mark_name(source, name), _stamp(made_from))


def part_of_callers(function: Callable) -> None:
    """Nothing is compiled of a function for its callers before they are compiled."""


def address(function: Callable, returns: types.Type, kinds: tuple[types.Type, ...]) -> int:
    """Address of a function as a C function of some types of arguments."""
    made = kernel(function.py_func, returns(*kinds), *_made[function.py_func])
    _addressed.append(made)         # its code lives as long as it does
    return made.address


_addressed: list[Callable] = []


def function_code(function: Callable, kinds: tuple[types.Type, ...]) -> Code:
    """LLVM code of a function for some types of arguments, compiled anew."""
    made = njit(kinds, **_made[function.py_func].options)(function.py_func)
    text, own = made.inspect_llvm(kinds), function.py_func.__name__
    wrapped = re.findall(r'^define .*@"?cfunc\.([^"(]+)', text, re.MULTILINE)
    return Code(next(name for name in wrapped if own in name), bitcode(text))


def kernel_code(function: Callable, signature, options: dict) -> Code:
    """LLVM code of a function to be called through its address, compiled anew."""
    return code_of(cfunc(signature, **options)(function))


def code_of(made: Callable) -> Code:
    """LLVM code of a `numba.cfunc` that this process compiled."""
    return Code(made.native_name.removeprefix("cfunc."), bitcode(made.inspect_llvm()))


def type_of(kind: np.dtype) -> types.Type:
    """The compiled type of the numbers of an array, or of a record of scalars."""
    return from_dtype(kind)


def processor() -> tuple[str, str]:
    """Name and features of the processor that is compiled for, as LLVM knows them."""
    name, features = config.CPU_NAME, config.CPU_FEATURES       # none of them is a choice, too
    return (binding.get_host_cpu_name() if name is None else name,
            binding.get_host_cpu_features().flatten() if features is None else features)


def guarded(function: Callable) -> Callable:
    """A compiled function that gives whether another one raises, and what it returns otherwise.

    It gets the arguments as a tuple. Of a function that returns nothing it gives zero.
    """
    signature, = function.nopython_signatures
    if signature.return_type == types.none:
        @njit
        def returned(arguments):
            try:
                function(*arguments)
            except Exception:
                return True, 0.0
            return False, 0.0
    else:
        @njit
        def returned(arguments):
            try:
                value = function(*arguments)
            except Exception:
                return True, math.nan
            return False, value
    return returned


def show_members(kind: type[types.Type], names: Iterable[str], resolve: Callable,
                 lower: Callable) -> None:
    """Let compiled code read members of values by name.

    Parameters
    ----------
    kind : type
        Of the types of the values.
    names : iterable of str
        Members of values of some such type.
    resolve : callable
        ``resolve(type, name)``: type of a member; None if there is none.
    lower : callable
        ``lower(context, builder, type, value, name)``: instructions that read a member.
    """
    for name in names:
        if (kind, name) not in _shown:
            _shown.add((kind, name))
            _show(kind, name, resolve, lower)


def _show(kind: type[types.Type], name: str, resolve: Callable, lower: Callable) -> None:
    @intrinsic
    def member(typingctx, group):
        def codegen(context, builder, sig, args):
            return lower(context, builder, sig.args[0], args[0], name)
        return resolve(group, name)(group), codegen

    @overload_attribute(kind, name)
    def read(group):
        if resolve(group, name) is not None:
            return lambda group: member(group)


@contextmanager
def _folder(function: Callable, made_from: str) -> Iterator[bool]:
    """Let Numba keep code in a folder for these sources; gives whether there is one."""
    source = Path(function.__code__.co_filename)
    folder = store.writable_folder(source)
    if folder is None:
        store.say_not_kept(source)
        yield False
        return
    given = config.CACHE_DIR
    config.CACHE_DIR = str(folder / f"plain-{zlib.crc32(made_from.encode()):08x}")
    try:
        yield True
    finally:
        config.CACHE_DIR = given


def _mark(function: Callable, made_from: str, kept: bool) -> None:
    """Remember that Numba keeps a function: its cache cannot be asked without an import."""
    source = Path(function.__code__.co_filename)
    if kept and not is_kept(source, function.__qualname__, made_from):
        store.write(source, _mark_name(source, function.__qualname__), _stamp(made_from), b"")


def _mark_name(source: Path, name: str) -> str:
    own = f"{zlib.crc32(repr(processor()).encode()):08x}"
    return f"{source.stem}.{name}.plain.{sys.implementation.cache_tag}.{own}.sebody"


def _stamp(made_from: str) -> str:
    return f"{made_from}, Numba {numba.__version__}"
