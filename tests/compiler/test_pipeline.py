"""How functions are compiled: their rounding is their own, not that of whoever calls them first."""

import re

from numba import njit, types

from sebody.compiler.decorators import compiled
from sebody.compiler.inside.names import CFunc, normalize_signature
from sebody.compiler.inside.pipeline import KernelPasses, PartPasses
from sebody.engine.elimination import eliminate
from sebody.kernels.frame_search import converged_mean


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


def twice(count, x, y):
    for i in range(count):
        y[i] = 2.0 * x[i]
    for i in range(count):
        x[i] = 0.5 * y[i]


def test_loops_of_kernels_are_short():
    """LLVM makes vectors of such loops, unless it is told; each loop has a node of its own."""
    numbers = types.CPointer(types.float64)
    signature = types.void(types.int64, numbers, numbers)
    plain, text = ("".join(njit(signature, **options)(twice).inspect_llvm().values())
                   for options in ({}, {"pipeline_class": KernelPasses}))
    assert "vector.body" in plain and "vector.body" not in text
    assert text.count('"llvm.loop.unroll.runtime.disable"') == 1
    assert len(set(re.findall(r"!llvm.loop !(\d+)", text))) == 2


def test_a_kernel_is_a_c_function():
    """Not what a C function calls with its arguments copied; exports take in both."""
    numbers = types.CPointer(types.float64)
    signature = types.int64(types.int64, numbers, numbers)

    def defined(passes):
        made = CFunc(negated, normalize_signature(signature), {}, {}, passes)
        made.compile()
        names = re.findall(r"^define .*@([^(]*)\(", made.inspect_llvm(), re.MULTILINE)
        return ["cfunc." in name for name in names if "negated" in name]
    assert defined(KernelPasses) == [True]
    assert sorted(defined(PartPasses)) == [False, True]


def negated(count, x, y):
    for i in range(count):
        y[i] = -x[i]
    return count


@compiled(forceinline=True)
def scaled(count, x, y):
    for i in range(count):
        y[i] = 2.0 * x[i]


@compiled(forceinline=True, apart=True)
def scaled_apart(count, x, y):
    for i in range(count):
        y[i] = 2.0 * x[i]


def test_arrays_that_are_apart():
    """LLVM is told, inside callers, too; otherwise it compares ends of arrays, if they are few."""
    numbers = types.CPointer(types.float64)
    signature = types.int64, numbers, numbers

    @njit(signature)
    def caller(count, x, y):
        scaled(count, x, y)

    @njit(signature)
    def caller_apart(count, x, y):
        scaled_apart(count, x, y)
    plain, told = ("".join(one.inspect_llvm().values()) for one in (caller, caller_apart))
    compared = "LVerDomain"     # of loops that LLVM doubles, to compare the ends; older ones alone
    assert "vector.body" in plain and ("alias.scope" not in plain or compared in plain)
    assert "vector.body" in told and "alias.scope" in told and compared not in told
