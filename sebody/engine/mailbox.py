"""Tasks that threads share piece by piece: posted by the loop, done by whichever thread is free.

One word holds the number of the task and how many of its pieces were taken. A thread takes the next
piece by an atomic exchange of this word, which fails if another thread was faster or the task is
over. So nothing waits for a thread that is not running: the others take its pieces.
"""

import ctypes
import os
from dataclasses import dataclass
from functools import cache

import numpy as np
from llvmlite import binding, ir
from numba import types
from numba.extending import intrinsic
from numpy.typing import NDArray

from sebody.compiler.decorators import compiled
from sebody.contract.counts import CACHE_LINE
from sebody.engine.arrays import Arrays
from sebody.engine.offsets import at_cache_lines
from sebody.kernels.abi import at

# words of the mailbox; what threads write to often is in lines of its own. CALL is the number of
# the call of the loop that helpers belong to; it changes when the call ends, too
OPEN, DONE, FAILED, CALL, TASK, COUNT, OWNER, YIELD = 0, 16, 32, 48, 64, 65, 66, 67
WORDS = 80
_TAKEN = 32             # bits of OPEN that count the pieces taken, below the number of the task
_NONE = (1 << _TAKEN) - 1           # where no task is open
NO_FAILURE = (1 << 62)
STATUS = 8              # bits of a status in FAILED, below the piece it is of
TRIES = 4000            # looks at a word before other threads of the machine get their turn


@dataclass(frozen=True, eq=False)
class Shared(Arrays):
    """Memory that threads of one run have beside its state; empty where there is one thread.

    ==================  ============================================================================
    mail                (WORDS,) the mailbox
    work                (threads, numbers) scratch memory of kernels
    columns             (threads, numbers) of the elimination
    rotated             (threads, numbers) of one element matrix
    ==================  ============================================================================
    """

    mail: NDArray
    work: NDArray
    columns: NDArray
    rotated: NDArray

    @classmethod
    def of(cls, threads: int, work: int = 0, columns: int = 0, rotated: int = 0) -> "Shared":
        """Mail and scratch memory of some threads, of so many numbers each."""
        if threads < 2:
            return cls(np.zeros(0, dtype=np.int64), *(np.zeros((0, 0)) for _ in range(3)))
        mail = np.zeros(WORDS, dtype=np.int64)
        mail[OPEN], mail[YIELD] = _NONE, _yield_address()
        sizes = (-(-size // CACHE_LINE) * CACHE_LINE for size in (work, columns, rotated))
        return cls(mail, *(at_cache_lines(threads * size).reshape(threads, size)
                           for size in sizes))


@cache
def _yield_address() -> int:
    """Address of the function of the system that lets other threads run."""
    library = ctypes.windll.kernel32 if os.name == "nt" else ctypes.CDLL(None)  # type: ignore
    function = library.SwitchToThread if os.name == "nt" else library.sched_yield
    return ctypes.cast(function, ctypes.c_void_p).value or 0


@intrinsic
def load(typingctx, word):
    """A word that other threads write; what they wrote before it is seen, too."""
    def codegen(context, builder, sig, args):
        return builder.load_atomic(args[0], "acquire", 8)
    return types.int64(word), codegen


@intrinsic
def store(typingctx, word, value):
    """Write a word, after everything that was written before it."""
    def codegen(context, builder, sig, args):
        builder.store_atomic(args[1], args[0], "release", 8)
        return context.get_dummy_value()
    return types.none(word, types.int64), codegen


@intrinsic
def _add(typingctx, word, value):
    def codegen(context, builder, sig, args):
        return builder.atomic_rmw("add", args[0], args[1], "acq_rel")
    return types.int64(word, types.int64), codegen


@intrinsic
def _lower(typingctx, word, value):
    """Write the smaller of a word and a value."""
    def codegen(context, builder, sig, args):
        return builder.atomic_rmw("min", args[0], args[1], "acq_rel")
    return types.int64(word, types.int64), codegen


@intrinsic
def _exchange(typingctx, word, expected, value):
    """Write a value where a word is as expected; whether it was."""
    def codegen(context, builder, sig, args):
        both = builder.cmpxchg(*args, "acq_rel", "acquire")
        return builder.extract_value(both, 1)
    return types.boolean(word, types.int64, types.int64), codegen


@intrinsic
def pause(typingctx):
    """Tell the processor that a loop waits, where it has an instruction for that."""
    def codegen(context, builder, sig, args):
        if binding.get_process_triple().startswith(("x86_64", "i686")):
            name = "llvm.x86.sse2.pause"
            kind = ir.FunctionType(ir.VoidType(), [])
            known = builder.module.globals.get(name)
            builder.call(known or ir.Function(builder.module, kind, name), [])
        return context.get_dummy_value()
    return types.none(), codegen


@intrinsic
def _call(typingctx, address):
    def codegen(context, builder, sig, args):
        function = ir.FunctionType(ir.IntType(32), [])
        builder.call(builder.inttoptr(args[0], function.as_pointer()), [])
        return context.get_dummy_value()
    return types.none(types.int64), codegen


@compiled
def wait_a_little(mail, tries):
    """Wait; after many tries let other threads of the machine run."""
    pause()
    if tries > TRIES:
        _call(mail[YIELD])


@intrinsic
def address_of(typingctx, pointer):
    """A pointer as a number."""
    def codegen(context, builder, sig, args):
        return builder.ptrtoint(args[0], ir.IntType(64))
    return types.int64(pointer), codegen


@compiled
def post(mail, owner, task, count):
    """Open a task of so many pieces, on the arrays of an owner, once the last task is over."""
    number = load(at(mail, OPEN)) >> _TAKEN
    # No piece is taken while the words below are written: what has this number has no pieces. A
    # thread that sees the new owner or count sees this, too, because each of them is a `store`.
    store(at(mail, OPEN), ((number + 1) << _TAKEN) + _NONE)
    mail[TASK], mail[FAILED] = task, NO_FAILURE
    store(at(mail, OWNER), owner)
    store(at(mail, COUNT), count)
    store(at(mail, DONE), 0)
    store(at(mail, OPEN), (number + 2) << _TAKEN)


@compiled
def take(mail, owner, call):
    """Take the next piece of the open task, if it is on the arrays of this owner; or -1.

    Nor is a piece taken by what belongs to a call of the loop that is over: CALL is read after
    OPEN, which changes with every task, so the task is of the call that is compared.
    """
    while True:
        word = load(at(mail, OPEN))
        piece = word & _NONE
        if (load(at(mail, CALL)) != call or piece >= load(at(mail, COUNT))
                or load(at(mail, OWNER)) != owner):
            return -1
        if _exchange(at(mail, OPEN), word, word + 1):
            return piece


@compiled
def finish(mail, piece, status):
    """Tell that a piece is done, and its status."""
    if status != 0:
        _lower(at(mail, FAILED), (piece << STATUS) + status)
    _add(at(mail, DONE), 1)


@compiled
def wait_for_all(mail):
    """Wait until all pieces are done; the status of the first one that failed, or zero."""
    tries = 0
    while load(at(mail, DONE)) < load(at(mail, COUNT)):
        wait_a_little(mail, tries)
        tries += 1
    failed = load(at(mail, FAILED))
    return 0 if failed == NO_FAILURE else failed & ((1 << STATUS) - 1)
