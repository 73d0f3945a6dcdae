"""The floating-point rate of this machine on the products that dominate superelements."""

import time

import numpy as np

from sebody.compiler.decorators import compiled
from sebody.contract.layout import padded_columns
from sebody.kernels.abi import pointer_to
from sebody.kernels.dense import columns_times

SIZE = 16


@compiled
def _repeat(times, A, x, out, n):
    for _ in range(times):
        columns_times(pointer_to(A), pointer_to(x), pointer_to(out), n, n)
        x[0] = 1e-9 * out[0]


def flops_per_second(times: int = 100_000) -> float:
    """Best of seven measurements of products with a matrix that stays in the cache."""
    A = padded_columns(np.eye(SIZE) + 0.01)
    x, out = np.ones(SIZE), np.zeros(SIZE)
    _repeat(1, A, x, out, SIZE)
    seconds = []
    for _ in range(7):
        began = time.perf_counter()
        _repeat(times, A, x, out, SIZE)
        seconds.append(time.perf_counter() - began)
    return 2.0 * SIZE * SIZE * times / min(seconds)
