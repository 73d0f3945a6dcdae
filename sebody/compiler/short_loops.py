"""Loops that LLVM is told are short.

Loops of kernels run over few nodes: LLVM prepares loops for thousands of passes, by vectors and in
rounds of eight, which makes kernels slower, general ones two to three times.
"""

from llvmlite import ir

_SHORT = (("llvm.loop.vectorize.enable", ir.Constant(ir.IntType(1), 0)),
          ("llvm.loop.unroll.runtime.disable",))      # with a number of rounds known at run time


def mark_short(module: ir.Module, jump: ir.Instruction) -> None:
    """Tell LLVM that the loop which a jump closes is short."""
    loop = module.add_metadata([f"loop {len(module.metadata)}", *_SHORT])
    loop.operands = loop, *loop.operands[1:]    # LLVM knows loops by nodes of themselves
    jump.set_metadata("llvm.loop", loop)
