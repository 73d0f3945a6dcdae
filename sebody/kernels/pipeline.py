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
from numba.core import types
from numba.core.ccallback import CFunc
from numba.core.compiler import CompilerBase
from numba.core.compiler_machinery import FunctionPass, PassManager, register_pass
from numba.core.ir import Jump
from numba.core.sigutils import normalize_signature
from numba.core.transforms import canonicalize_cfg
from numba.core.typed_passes import BaseNativeLowering, NoPythonBackend
from numba.core.untyped_passes import FixupArgs, TranslateByteCode

from sebody.kernels.cache import FunctionCache, is_kept
from sebody.kernels.callees import Function
from sebody.kernels.layout import ARGUMENTS
from sebody.kernels.lookups import Lowering, TypeInference
from sebody.kernels.sources import KERNELS, function_hash, in_room, kernel_hash

_POINTERS = {"int64": types.CPointer(types.int64), "float64": types.CPointer(types.float64)}
# of every kernel: task, count, stride and width, then pointers
SIGNATURE = types.int64(*[types.int64] * 4, *[_POINTERS[kind] for _, kind, _ in ARGUMENTS])

CONTRACT = {"contract"}     # a product and a sum in one rounding


_SHORT = (("llvm.loop.vectorize.enable", ir.Constant(ir.IntType(1), 0)),
          ("llvm.loop.unroll.runtime.disable",))      # with a number of rounds known at run time


def mark_short(module: ir.Module, jump: ir.Instruction) -> None:
    """Tell LLVM that the loop which a jump closes is short."""
    loop = module.add_metadata([f"loop {len(module.metadata)}", *_SHORT])
    loop.operands = loop, *loop.operands[1:]    # LLVM knows loops by nodes of themselves
    jump.set_metadata("llvm.loop", loop)


class _ShortLoops(Lowering):
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


@register_pass(mutates_CFG=True, analysis_only=False)
class _OneJumpBack(FunctionPass):
    """Gives every loop one jump back; nothing in a kernel has a lifetime that matters."""

    _name = "one_jump_back"

    def __init__(self):
        super().__init__()

    def run_pass(self, state):
        state.func_ir.blocks = canonicalize_cfg(state.func_ir.blocks)
        state.type_annotation = ""
        return True


class KernelPasses(CompilerBase):
    """Numba's pipeline for kernels: bytecode, types, machine code."""

    def define_pipelines(self) -> list[PassManager]:
        """The one pipeline."""
        manager = PassManager("kernel")
        for one in (TranslateByteCode, FixupArgs, _OneJumpBack, TypeInference, _Lowering,
                    NoPythonBackend):
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
    options = {"nopython": True, "error_model": "numpy", "fastmath": rounding} | options
    return Function(function, options, function_hash(function))


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
