"""Compilation: functions by all of Numba's passes, kernels by the passes they need.

With these kernels compile in two thirds of the time. Kernels are arithmetic on floats through
pointers: Numba's rewriting and inlining passes have nothing to do, every variable has one type, so
single static assignment is left to LLVM, and types of operations on floats are looked up only once.
Their loops run over few nodes: LLVM prepares loops for thousands of passes, by vectors and in
rounds of eight, which makes kernels slower, general ones two to three times.
"""

from collections.abc import Callable
from functools import partial
from pathlib import Path

from llvmlite import ir
from numba import njit
from numba.core import types
from numba.core.ccallback import CFunc
from numba.core.compiler import CompilerBase
from numba.core.compiler_machinery import PassManager, register_pass
from numba.core.ir import Jump
from numba.core.lowering import Lower
from numba.core.sigutils import normalize_signature
from numba.core.typed_passes import (
    AnnotateTypes,
    BaseNativeLowering,
    IRLegalization,
    NoPythonBackend,
    NopythonTypeInference,
)
from numba.core.untyped_passes import FixupArgs, IRProcessing, TranslateByteCode

from sebody.kernels.cache import FunctionCache, is_kept
from sebody.kernels.layout import ARGUMENTS
from sebody.kernels.sources import KERNELS, function_hash, in_room, kernel_hash

_POINTERS = {"int64": types.CPointer(types.int64), "float64": types.CPointer(types.float64)}
# of every kernel: task, count, stride and width, then pointers
SIGNATURE = types.int64(*[types.int64] * 4, *[_POINTERS[kind] for _, kind, _ in ARGUMENTS])

CONTRACT = {"contract"}     # a product and a sum in one rounding


class _Remembering:
    """A typing context that resolves a function of given number types only once."""

    def __init__(self, context):
        self._context, self._found = context, {}

    def __getattr__(self, name):
        return getattr(self._context, name)

    def resolve_function_type(self, function, arguments, keywords):
        key = function, arguments
        if keywords or not all(isinstance(a, types.Number) for a in arguments):
            return self._context.resolve_function_type(function, arguments, keywords)
        if key not in self._found:
            self._found[key] = self._context.resolve_function_type(function, arguments, keywords)
        return self._found[key]


@register_pass(mutates_CFG=True, analysis_only=False)
class _TypeInference(NopythonTypeInference):
    def run_pass(self, state):
        context = state.typingctx
        state.typingctx = _Remembering(context)
        try:
            return super().run_pass(state)
        finally:
            state.typingctx = context


_SHORT = (("llvm.loop.vectorize.enable", ir.Constant(ir.IntType(1), 0)),
          ("llvm.loop.unroll.runtime.disable",))      # with a number of rounds known at run time


def mark_short(module: ir.Module, jump: ir.Instruction) -> None:
    """Tell LLVM that the loop which a jump closes is short."""
    loop = module.add_metadata([f"loop {len(module.metadata)}", *_SHORT])
    loop.operands = loop, *loop.operands[1:]    # LLVM knows loops by nodes of themselves
    jump.set_metadata("llvm.loop", loop)


class _ShortLoops(Lower):
    """Tells LLVM of every loop that it is short."""

    def lower_inst(self, inst):
        super().lower_inst(inst)
        if isinstance(inst, Jump) and self.blkmap[inst.target].is_terminated:     # a jump back
            mark_short(self.module, self.builder.block.terminator)


@register_pass(mutates_CFG=True, analysis_only=False)
class _Lowering(BaseNativeLowering):
    _name = "kernel_lowering"

    @property
    def lowering_class(self):
        return _ShortLoops


class KernelPasses(CompilerBase):
    """Numba's pipeline for kernels: bytecode, types, machine code."""

    def define_pipelines(self) -> list[PassManager]:
        """The one pipeline."""
        manager = PassManager("kernel")
        for one in (TranslateByteCode, FixupArgs, IRProcessing, _TypeInference, IRLegalization,
                    AnnotateTypes, _Lowering, NoPythonBackend):
            manager.add_pass(one, one.__name__)
        manager.finalize()
        return [manager]


def compiled(function: Callable | None = None, **options) -> Callable:
    """Compile a function of the runtime, and keep the compiled code.

    Functions of ``kernels/`` contract products and sums as the kernels that call them do, others
    do not. The choice is explicit because otherwise Numba takes it from the first caller that is
    compiled, and results would depend on what was run before.
    """
    if function is None:
        return partial(compiled, **options)
    rounding = CONTRACT if in_room(function, KERNELS) else False
    dispatcher = njit(**{"error_model": "numpy", "fastmath": rounding} | options)(function)
    dispatcher._cache = FunctionCache(function, function_hash(function))
    return dispatcher


def kernel_function(function: Callable) -> CFunc:
    """Compile a kernel, a function of the `SIGNATURE`, and keep the compiled code.

    The attribute `address` of the result is the address of the machine code.
    """
    kernel = CFunc(function, normalize_signature(SIGNATURE), {},
                   {"error_model": "numpy", "fastmath": CONTRACT}, KernelPasses)
    kernel._cache = FunctionCache(function, kernel_hash(Path(function.__code__.co_filename)))
    kernel.compile()
    return kernel


def is_compiled(path: Path) -> bool:
    """Whether the kernel in a file was compiled; the file is not imported."""
    return is_kept(path, "kernel", kernel_hash(path))
