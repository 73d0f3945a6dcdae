"""The typed form of kernels: whole numbers, arrays, calls, and the passes over statements."""

import importlib
import inspect

import pytest
import sympy as sp

from sebody.contract.counts import axes_of, packed_size, superelement_counts, whole_vectors
from sebody.contract.layout import SUPERELEMENT_CONSTANTS, Part
from sebody.derive.form import counts, functions
from sebody.derive.form.arrays import Entry, Place, constant, pointed, scratch
from sebody.derive.form.functions import Function
from sebody.derive.form.statements import (
    Change,
    For,
    If,
    Let,
    Point,
    Set,
    Update,
    compared,
    invoked,
)
from sebody.derive.form.steps import call
from sebody.derive.form.whole import Agreed, Applied, Number, Quotient, largest, replaced, whole
from sebody.derive.kernels.memory import size_of
from sebody.derive.passes.fold import folded
from sebody.derive.passes.operations import operations
from sebody.derive.passes.uses import uses
from sebody.derive.printing.numba.expressions import whole_code

n, i, j, N = counts.n, counts.i, counts.j, counts.N
TABLE = [value for value in vars(functions).values() if isinstance(value, Function)]


@pytest.mark.parametrize("number, text", [
    (n + 0, "n"), (0 + n, "n"), (n * 1, "n"), (n * 0, "0"), (3 * (2 * n), "6*n"), (n * 2, "2*n"),
    (N + 3 + 1, "N + 4"), (N + (3 - 3), "N"), (n - 6, "n - 6"), (n - 6 + 6, "n"),
    ((N + 1) * n, "(N + 1)*n"), (n + (i - j), "n + i - j"), (n - (i - j), "n - i + j"),
    (Quotient(i - j, whole(3)), "(i - j)//3"), (largest(n + 1, 9), "max(n + 1, 9)"),
    (counts.padded(n), "padded(n)"), (5 + (-2) * n, "5 + -2*n"), (whole(0) - n, "-n")])
def test_whole_numbers_are_written_as_built(number, text):
    assert whole_code(whole(number)) == text


@pytest.mark.parametrize("number, value", [
    (n * n - 3, 22), (Quotient(n + 3, whole(3)), 2), (largest(n, 9), 9), ((N + 2) * n, 45)])
def test_what_becomes_known_is_computed(number, value):
    assert replaced(number, {n: 5, N: 7}) == Number(value)
    assert replaced(number, {counts.deep: 1}) == number


def test_other_numbers_are_refused():
    with pytest.raises(TypeError, match="2.5 is no whole number: give a count or an int"):
        n + 2.5
    with pytest.raises(TypeError, match="inverse_3 is no function of 1 whole numbers"):
        Applied(functions.INVERSE_3, (n,))


def test_places_of_components():
    assert [whole_code(Place().of(k)) for k in (0, 2)] == ["0", "2"]
    assert [whole_code(Place(N, first=3).of(k)) for k in (0, 2)] == ["N + 3", "N + 5"]
    assert [whole_code(Place(i, counts.hN, 1).of(k)) for k in (0, 2)] == ["hN + i", "3*hN + i"]
    assert whole_code(Place(i, counts.hN).of(0)) == "i"


def test_entries_are_atoms_of_expressions():
    """Equal where array and place are, differentiated as symbols, and found again."""
    y = scratch("y")
    assert y[i + 1] == scratch("y")[i + 1] != y[i] and hash(y[i]) == hash(scratch("y")[i])
    value = 3 * y[i]**2 + y[i] * y[i + 1]
    assert value.diff(y[i]) == 6 * y[i] + y[i + 1]
    assert value.atoms(Entry) == {y[i], y[i + 1]} == value.free_symbols
    assert y.at(0) is y and y.at(n).at(2) == y.at(n + 2)
    assert y.d == scratch("dy")


def test_a_call_has_the_operands_of_its_function():
    y, s, S = scratch("y"), scratch("s"), constant(SUPERELEMENT_CONSTANTS[4])
    made = call("product", functions.BLOCK_TIMES, S, y, s.at(3), n, 4, counts.padded(n))
    assert made.operands == (S, y, s.at(3), n, Number(4), counts.padded(n))
    with pytest.raises(TypeError, match=r"block_times takes 6 operands \(A, x, out, rows, columns, "
                                        r"height\), not 2"):
        call("product", functions.BLOCK_TIMES, S, y)
    with pytest.raises(TypeError, match="operand x of block_times is READ, not Count"):
        call("product", functions.BLOCK_TIMES, S, n, s, n, n, n)
    with pytest.raises(TypeError, match="operand rows of block_times is WHOLE, not Array"):
        call("product", functions.BLOCK_TIMES, S, y, s, y, n, n)
    with pytest.raises(TypeError, match="relative_rotations gives STATUS, not 0 outputs"):
        invoked(functions.RELATIVE_ROTATIONS, (n, y, y, y, y))


@pytest.mark.parametrize("function", TABLE, ids=lambda f: f.name)
def test_functions_are_those_of_the_runtime(function):
    """Their modules, names and operands; numbers, where they take no arrays, are what they give."""
    found = getattr(importlib.import_module(f"sebody.kernels.{function.module}"), function.name)
    plain = getattr(found, "py_func", getattr(found, "_defn", found))
    names = [name for name in inspect.signature(plain).parameters if name != "typingctx"]
    assert names == [name for name, _ in function.operands]


@pytest.mark.parametrize("planar", [False, True])
def test_sizes_of_constants(planar):
    """The kernel computes places from counts, the packer from numbers."""
    known = axes_of(planar) | superelement_counts(3, 2, planar, 17) | {"damped": 2}
    scope = {"padded": whole_vectors, "packed_room": packed_size}
    for part in (*SUPERELEMENT_CONSTANTS, Part("C", ("n", "damped"), columns=True), Part("one"),
                 Part("z", ("damped", "n", "n"), packed=True), Part("K", ("pairs", 2, "n"))):
        assert eval(whole_code(size_of(part, planar)), scope, known) == part.size(known)


def sample():
    """Statements of all kinds that hold others."""
    y, table, work = scratch("y"), pointed("table", whole=True), pointed("work")
    x, t = sp.symbols("x t")
    body = (Set((x,), (y[i],)), Update(t, Change.ADD, x**2 * sp.sin(y[n + i])),
            invoked(functions.INVERSE_TANGENT, (x * t,), (t, y[i]), operations=30))
    return (Let((N,), (n + 2,)), Point(y, work.at(N * counts.padded(n))),
            For(i, Number(0), N, body, "position"),
            If(compared(table[N], "<", n, "<", Agreed("HEADER", 5)), (Set((t,), (sp.sqrt(x),)),),
               (invoked(functions.CLEAR, (y.at(n), 3 * N)),)))


def test_uses_are_found_in_the_order_of_use():
    found = uses(sample())
    assert [array.name for array in found.arrays] == ["work", "y", "table"]
    assert [f.name for f in found.functions] == ["padded", "inverse_tangent_coefficients", "clear"]
    assert [number.name for number in found.agreed] == ["HEADER"]
    assert found.counts == (n, N, i)
    assert found.mathematics == ("sin", "sqrt") and len(found.views) == 2


def test_operations_are_counted_where_the_values_are():
    """A square, a product, a sine, and 30 of the function; outside a root, which counts twice."""
    found = operations(sample())
    assert (found.element, found.position, found.rotation) == (2, 3 + 30, 0)


def test_known_counts_are_folded_into_everything():
    found = folded(sample(), {n: 5, N: 7})
    assert found[0] == Point(scratch("y"), pointed("work").at(7 * counts.padded(5)))
    loop, branch = found[1:]
    assert (loop.first, loop.end) == (Number(0), Number(7))
    assert loop.body[1].value.atoms(Entry) == {scratch("y")[5 + i]}
    assert branch.holds.numbers[1] == Number(5)
    assert branch.otherwise[0].operands == (scratch("y").at(5), Number(21))
    assert folded(found, {n: 5, N: 7}) == found
    assert n not in uses(found).counts and N not in uses(found).counts
