"""The passes of Numba that kernels need, and no others.

With these kernels compile in two thirds of the time. Kernels are arithmetic on floats through
pointers: Numba's rewriting and inlining passes have nothing to do, every variable has one type, so
single static assignment is left to LLVM, and types of operations on floats are looked up only once.
"""

from llvmlite import ir

from sebody.compiler.inside.lookups import Lowering, TypeInference
from sebody.compiler.inside.names import (
    BaseNativeLowering,
    CompilerBase,
    FixupArgs,
    FunctionPass,
    Jump,
    NoPythonBackend,
    PassManager,
    TranslateByteCode,
    canonicalize_cfg,
    register_pass,
)
from sebody.compiler.short_loops import mark_short


class _ShortLoops(Lowering):
    """Tells LLVM of every loop that it is short, and of products which it may take in."""

    def lower_normal_function(self, fndesc):
        super().lower_normal_function(fndesc)
        if getattr(self.func_ir.func_id.func, "sizes_known", False):
            for function in self.module.functions:
                function.attributes.discard("noinline")

    def lower_inst(self, inst):
        super().lower_inst(inst)
        if isinstance(inst, Jump) and self.blkmap[inst.target].is_terminated:     # a jump back
            mark_short(self.module, self.builder.block.terminator)


class _CFunctions(_ShortLoops):
    """The same, where a kernel is called through its address alone."""

    def create_cfunc_wrapper(self):
        """Make the kernel a C function, which Numba would let call it.

        That copies the arguments, in vectors of those that were just written one by one: a copy
        waits for them longer than some kernels take. Kernels raise no exceptions.
        """
        context, names = self.context, self.fndesc
        convention = context.call_conv
        module = self.library.create_ir_module("c_function")
        body = ir.Function(module, convention.get_function_type(names.restype, names.argtypes),
                           names.llvm_func_name)
        kinds = [context.get_value_type(kind) for kind in (names.restype, *names.argtypes)]
        function = ir.Function(module, ir.FunctionType(kinds[0], kinds[1:]),
                               names.llvm_cfunc_wrapper_name)
        builder = ir.IRBuilder(function.append_basic_block())
        _, result = convention.call_function(builder, body, names.restype, names.argtypes,
                                             function.args, attrs=("alwaysinline",))
        builder.ret(result)
        self.library.add_ir_module(module)
        self.library._final_module.get_function(names.llvm_func_name).linkage = "linkonce_odr"


@register_pass(mutates_CFG=True, analysis_only=False)
class _Lowering(BaseNativeLowering):
    _name = "kernel_lowering"

    @property
    def lowering_class(self):
        return _ShortLoops


@register_pass(mutates_CFG=True, analysis_only=False)
class _LoweringToC(_Lowering):
    _name = "kernel_lowering_to_c"

    @property
    def lowering_class(self):
        return _CFunctions


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


class PartPasses(CompilerBase):
    """Numba's pipeline for kernels that other LLVM code takes in: bytecode, types, LLVM code."""

    lowering = _Lowering

    def define_pipelines(self) -> list[PassManager]:
        """The one pipeline."""
        manager = PassManager("kernel")
        for one in (TranslateByteCode, FixupArgs, _OneJumpBack, TypeInference, self.lowering,
                    NoPythonBackend):
            manager.add_pass(one, one.__name__)
        manager.finalize()
        return [manager]


class KernelPasses(PartPasses):
    """The same for kernels that are called through their address."""

    lowering = _LoweringToC
