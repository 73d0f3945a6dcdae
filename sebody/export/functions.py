"""LLVM code of the functions that libraries consist of: compiled once for every processor."""

import sys
from collections.abc import Iterable
from pathlib import Path
from types import ModuleType

from numba import typeof

from sebody.basics.errors import InputError, SebodyError
from sebody.compiler import store, workers
from sebody.compiler.code import Code, Place
from sebody.compiler.decorators import function_code, kernel_code
from sebody.compiler.sources import function_hash, kernel_hash
from sebody.compiler.workers import Task
from sebody.engine import control, loop, matrix, restart, row_exchanges
from sebody.export.outputs import no_outputs
from sebody.export.platforms import environment, tag
from sebody.kernels.loader import load
from sebody.quantities import reading
from sebody.runs.first_run import examples

KIND = "code"
# functions of the engine, and the types of their arguments by the names of `first_run.examples`
FUNCTIONS = {
    "advance": (loop.advance, "system state record scheme whole whole flag"),
    "refactorize": (matrix.refactorize, "system state whole flag"),
    "restart": (restart.restart, "system state number flag"),
    "sample": (control.sample, "system state"),
    "set_input": (control.set_input, "system state whole number"),
    "evaluate": (reading.evaluate, "system state outputs"),
    "exchange": (row_exchanges.exchange, "system state exchanges whole"),
}


def codes(names: Iterable[str], processor: str) -> dict[str, Code]:
    """LLVM code of functions of the engine and of kernels, by name.

    What is not kept is compiled by processes of their own, in which Numba compiles for the
    processor; a line on standard error says so.

    Raises
    ------
    InputError
        No folder for compiled code can be written.
    SebodyError
        Something could not be compiled.
    """
    target = tag(processor)
    code_of = {name: place(name).kept(KIND, target) for name in names}
    missing = [name for name, one in code_of.items() if one is None]
    if missing:
        if not store.writable_folder(Path(loop.__file__)):
            raise InputError("code for the library cannot be kept: "
                             f"{store.not_writable(Path(loop.__file__))}")
        print(f"first export for {processor}: compiling {len(missing)} functions", file=sys.stderr,
              flush=True)
        tasks = [Task(name, f"{__name__}:compile_one", (name, processor)) for name in missing]
        workers.call_all(tasks, variables=environment(processor))
        code_of |= {name: place(name).kept(KIND, target) for name in missing}
    if lacking := [name for name, one in code_of.items() if one is None]:
        raise SebodyError(f"{', '.join(lacking)} could not be compiled for {processor}")
    return {name: _code(one) for name, one in code_of.items() if one is not None}


def _code(kept: bytes) -> Code:
    symbol, _, bitcode = kept.partition(b"\n")
    return Code(symbol.decode(), bitcode)


def kernel_module(name: str) -> ModuleType:
    """The module of a kernel that a model has."""
    module = load(name)
    assert module is not None        # assembly refuses a model without one of its kernels
    return module


def compile_one(name: str, processor: str) -> None:
    """Compile a function of the engine or a kernel for the processor that Numba compiles for."""
    if name in FUNCTIONS:
        function, arguments = FUNCTIONS[name]
        kinds = examples() | {"outputs": typeof(no_outputs()),
                              "exchanges": typeof(row_exchanges.Exchanges.of(0, 0))}
        made = function_code(function, tuple(kinds[one] for one in arguments.split()))
    else:
        made = kernel_code(kernel_module(name).kernel)
    place(name).keep(KIND, tag(processor), made.symbol.encode() + b"\n" + made.bitcode)


def place(name: str) -> Place:
    """The place where code of a function of the engine or of a kernel is kept."""
    if name in FUNCTIONS:
        function = FUNCTIONS[name][0].py_func
        return Place(Path(function.__code__.co_filename), name, function_hash(function))
    source = Path(str(kernel_module(name).__file__))
    return Place(source, name, kernel_hash(source))
