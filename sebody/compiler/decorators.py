"""Decorators of compiled functions and kernels, and what first runs ask of them."""

from collections.abc import Callable
from functools import partial
from pathlib import Path

from numba import types

from sebody.compiler.choice import way
from sebody.compiler.code import Code
from sebody.compiler.sources import KERNELS, function_hash, in_folder, kernel_hash
from sebody.contract.layout import ARGUMENTS

_POINTERS = {"int64": types.CPointer(types.int64), "float64": types.CPointer(types.float64)}
# of every kernel: task, count, stride and width, then pointers
SIGNATURE = types.int64(*[types.int64] * 4, *[_POINTERS[kind] for _, kind, _ in ARGUMENTS])

CONTRACT = {"contract"}     # a product and a sum in one rounding
ANY_ORDER = {"reassoc"}     # sums in any order: loops may be compiled to vector instructions
OF_KERNELS = {"error_model": "numpy", "fastmath": CONTRACT}


def compiled(function: Callable | None = None, **options) -> Callable:
    """Compile a function of the runtime, and keep the compiled code.

    Functions of ``kernels/`` contract products and sums as the kernels that call them do, others
    do not. The choice is explicit because otherwise Numba takes it from the first caller that is
    compiled, and results would depend on what was run before.

    With `apart`, pointers among the arguments lead to memory of their own, so that a loop over them
    may be compiled to vector instructions; of the fast way alone.
    """
    if function is None:
        return partial(compiled, **options)
    function.apart = options.pop("apart", False)
    rounding = CONTRACT if in_folder(function, KERNELS) else False
    options = {"error_model": "numpy", "fastmath": rounding} | options
    return way().function(function, options, function_hash(function))


def in_lanes_of(function: Callable) -> Callable:
    """Decorator of a compiled function that is called in place of another one with lanes.

    Of the fast way alone: functions that choose by their numbers need it, all others are compiled
    for lanes as they are.
    """
    def put(own: Callable) -> Callable:
        function.in_lanes = compiled(own)
        return function.in_lanes
    return put


def kernel_function(function: Callable | None = None, sizes_known: bool = False) -> Callable:
    """Compile a kernel, a function of the `SIGNATURE`, and keep the compiled code.

    The attribute `address` of the result is the address of the machine code.

    With `sizes_known` the sizes of its products are constants, so that the compiler may write small
    products where they are called; of the fast way alone. Kernels that read the sizes at run time
    become slower by this.
    """
    if function is None:
        return partial(kernel_function, sizes_known=sizes_known)
    function.sizes_known = sizes_known
    return way().kernel(function, SIGNATURE, OF_KERNELS,
                        kernel_hash(Path(function.__code__.co_filename)))


def function_code(function: Callable, kinds: tuple[types.Type, ...]) -> Code:
    """LLVM code of a `compiled` function for some types of arguments, compiled anew."""
    return way().function_code(function, kinds)


def kernel_code(kernel: Callable) -> Code:
    """LLVM code of what `kernel_function` made, compiled anew."""
    return way().kernel_code(kernel.__wrapped__, SIGNATURE, OF_KERNELS)


def is_compiled(path: Path) -> bool:
    """Tell if the kernel in a file was compiled; the file is not imported."""
    return way().is_kept(path, "kernel", kernel_hash(path))
