"""Addresses of the functions that the loop calls by address, see `sebody.engine.calls`."""

from collections.abc import Callable
from functools import cache

import numpy as np
from numba import typeof, types
from numpy.typing import NDArray

from sebody.compiler.choice import way
from sebody.engine.control import sample
from sebody.engine.matrix import refactorize
from sebody.engine.restart import restart
from sebody.engine.sharing import share

RETURNS = {refactorize: types.boolean, restart: types.int64, sample: types.int64,
           share: types.int64}
RESTARTED = types.float64, types.boolean        # what `restart` is given beside system and state
REFACTORIZED = types.int64, types.boolean
SHARED = types.int64, types.int64


def addresses(system, state) -> NDArray:
    """Addresses of `refactorize`, `restart`, `sample` and `share` for a system and a state, (4,).

    The functions are compiled if needed; `sample` for models with controllers or sensors alone,
    `share` for several threads.
    """
    kinds = typeof(system), typeof(state)
    return np.array([_address(refactorize, *kinds, *REFACTORIZED),
                     _address(restart, *kinds, *RESTARTED),
                     _address(sample, *kinds) if system.control.periods.size
                     or system.control.inputs.size else 0,
                     _address(share, *kinds, *SHARED) if system.shared.mail.size else 0])


def compile_routine(function: Callable, kinds: tuple[types.Type, ...]) -> None:
    """Compile one of these functions for some types of arguments."""
    _address(function, *kinds)


@cache
def _address(function: Callable, *kinds: types.Type) -> int:
    return way().address(function, RETURNS[function], kinds)
