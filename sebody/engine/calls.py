"""Calls of functions at their addresses, as kernels are called.

What a compiled function calls by name is compiled again as a part of it. Factorizations and
restarts are called seldom and are long: by address the loop is compiled without them, and beside
them. `sebody.engine.routines` has the addresses. The loop itself is called so for members that
leave their lanes.
"""

from numba import types
from numba.extending import intrinsic

from sebody.kernels.abi import called


@intrinsic
def call_advance(typingctx, address, system, state, record, scheme, last_grid, chunk, dense):
    """Call `sebody.engine.loop.advance` at its address."""
    return types.int64(types.int64, system, state, record, scheme, types.int64, types.int64,
                       types.boolean), called


@intrinsic
def call_advance_together(typingctx, address, system, state, scratch, together, apart, record,
                          scheme, last_grid, dense):
    """Call `sebody.engine.lanes.loop.advance` at its address."""
    return types.int64(types.int64, system, state, scratch, together, apart, record, scheme,
                       types.int64, types.boolean), called


@intrinsic
def call_aid(typingctx, address, context, what):
    """Call the aid of a loop at its address, see `sebody.engine.aid`."""
    return types.int64(types.int64, types.int64, types.int64), called


@intrinsic
def call_refactorize(typingctx, address, system, state, wanted, dense):
    """Call `sebody.engine.matrix.refactorize` at its address."""
    return types.boolean(types.int64, system, state, types.int64, types.boolean), called


@intrinsic
def call_refactorize_together(typingctx, address, system, state, together):
    """Call `sebody.engine.lanes.together.refactorize` at its address."""
    return types.int64(types.int64, system, state, together), called


@intrinsic
def call_restart(typingctx, address, system, state, lead, dense):
    """Call `sebody.engine.restart.restart` at its address."""
    return types.int64(types.int64, system, state, types.float64, types.boolean), called


@intrinsic
def call_sample(typingctx, address, system, state):
    """Call `sebody.engine.control.sample` at its address."""
    return types.int64(types.int64, system, state), called


@intrinsic
def call_samples(typingctx, address, system, state, scratch, apart, dense):
    """Call `sebody.engine.lanes.samples.sample` at its address."""
    return types.int64(types.int64, system, state, scratch, apart, types.boolean), called


@intrinsic
def call_share(typingctx, address, system, state, task, thread):
    """Call `sebody.engine.sharing.share` at its address."""
    return types.int64(types.int64, system, state, types.int64, types.int64), called
