"""Addresses of the functions that the loop calls by address, see `sebody.engine.calls`."""

from functools import cache

import numpy as np
from numba import typeof, types
from numpy.typing import NDArray

from sebody.engine.matrix import refactorize
from sebody.engine.restart import restart
from sebody.kernels.callees import Function

RESTARTED = types.float64, types.boolean        # what `restart` is given beside system and state
REFACTORIZED = types.int64, types.boolean


def addresses(system, state) -> NDArray:
    """Addresses of `refactorize` and `restart` for a system and a state of these types, (2,).

    The functions are compiled if needed.
    """
    kinds = typeof(system), typeof(state)
    return np.array([_address(refactorize, *kinds, *REFACTORIZED),
                     _address(restart, *kinds, *RESTARTED)])


@cache
def _address(function: Function, *kinds: types.Type) -> int:
    function.compile(kinds)
    compiled = function.overloads[kinds]
    return compiled.library.get_pointer_to_function(compiled.fndesc.llvm_cfunc_wrapper_name)
