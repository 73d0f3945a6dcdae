"""How functions are compiled: their rounding is their own, not that of whoever calls them first."""

from numba import njit

from sebody.engine.elimination import eliminate
from sebody.kernels.frame_search import converged_mean
from sebody.kernels.pipeline import compiled


@compiled
def remainder(a, b, c):
    return a * b - c


@njit(fastmath={"contract"})
def called_like_from_a_kernel(a, b, c):
    return remainder(a, b, c)


def test_rounding_does_not_depend_on_the_first_caller():
    """One rounding of ``a b - c`` instead of two would leave what the product lost."""
    a = 1.0 + 2.0**-30
    assert called_like_from_a_kernel(a, a, a * a) == 0.0
    assert remainder(a, a, a * a) == 0.0


def test_functions_of_kernels_round_like_kernels():
    assert converged_mean.targetoptions["fastmath"] == {"contract"}
    assert eliminate.targetoptions["fastmath"] is False
