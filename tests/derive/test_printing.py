"""The target for Numba: expressions, lines, imports, tables of constants and of traits."""

import ast

import numpy as np
import pytest
import sympy as sp

from sebody.contract.layout import Part
from sebody.contract.traits import FrameTraits, InertiaTraits
from sebody.derive.form import counts
from sebody.derive.form.arrays import pointed, scratch
from sebody.derive.form.functions import CLEAR, INVERSE_3, PACKED_TIMES
from sebody.derive.form.kernel import Kernel, Operations
from sebody.derive.form.spaces import Space
from sebody.derive.form.statements import (
    Change,
    For,
    If,
    Let,
    Point,
    Remark,
    Return,
    Set,
    Update,
    Zero,
    compared,
    invoked,
)
from sebody.derive.formulas.frames.frame import Condition
from sebody.derive.formulas.quantities import Quantities
from sebody.derive.printing.numba import options, parts
from sebody.derive.printing.numba.expressions import code
from sebody.derive.printing.numba.imports import import_lines
from sebody.derive.printing.numba.statements import lines
from sebody.derive.symbolic.rotations import skew

x, y, z = sp.symbols("x y z")


@pytest.mark.parametrize("expression, text", [
    (x + y, "x + y"), (x**2, "x*x"), ((x + y)**3, "(x + y)*(x + y)*(x + y)"), (x**4, "x*x*x*x"),
    (x**5, "x**5"), (x / 2, "(0.5)*x"), (sp.Rational(1, 3), repr(1 / 3)), (sp.sqrt(x), "sqrt(x)"),
    (1 / x, "1/x"), (y / x**2, "y/(x*x)"), (y / (x**2 * z**3), "y/(x*x*z*z*z)"),
    ((x + y) / z**2, "(x + y)/(z*z)"), (1 / sp.sqrt(x), "1/sqrt(x)"),
    (sp.atan2(y, x), "atan2(y, x)"), (-x, "-x")])
def test_code(expression, text):
    assert code(expression) == text


@pytest.mark.parametrize("expression", [
    (x - y)**2 / (z - x)**3, x * y**2 / (z**2 * (x + y)), sp.Rational(3, 7) * x**3 / y**2,
    (x**2 + y**2) / (2 * z**2)])
def test_code_means_the_expression(expression):
    point = {x: 1.7, y: -0.3, z: 2.9}
    value = eval(code(expression), {str(s): v for s, v in point.items()})
    assert value == pytest.approx(float(expression.subs(point)), rel=1e-14)


def test_statements_as_lines():
    table, work, row = pointed("table", whole=True), pointed("work"), scratch("row")
    i, n = counts.i, counts.n
    found = lines((
        Let((counts.N, counts.hN), (n + 1, counts.padded(n + 1))), Point(row, work.at(2 * n)),
        Point(scratch("same"), work), Remark("what follows"), Zero((x, y)),
        For(i, counts.FIRST_MODE, n, (
            Set((x, y), (row[i], row[n + i])), Update(row[table[i]], Change.SUBTRACT, x * y))),
        If(compared(counts.task, "==", counts.agreed("TANGENT")), (
            invoked(CLEAR, (row.at(n), n)),), (Set((x,), (sp.S.Zero,)),)),
        Return(counts.agreed("OK"))), 1)
    assert found == [
        "    N, hN = n + 1, padded(n + 1)", "    row = at(work, 2*n)", "    same = work",
        "    # what follows", "    x = y = 0.0", "    for i in range(MODES, n):",
        "        x, y = row[i], row[n + i]", "        row[table[i]] -= x*y",
        "    if task == TANGENT:", "        clear(at(row, n), n)", "    else:", "        x = 0.0",
        "    return OK"]


def test_long_assignments_are_broken_and_mean_the_same():
    """In parentheses, after an operator, at most 100 columns; a sum goes on with `+=`."""
    total = sum(sp.Symbol(f"variable_{k}") * sp.Symbol(f"other_{k}") for k in range(12))
    for statement in (Set((x,), (total,)), Update(x, Change.ADD, total)):
        found = lines([statement], 2)
        operator = "+=" if isinstance(statement, Update) else "="
        assert len(found) > 2 and max(map(len, found)) <= 100
        assert found[0].startswith(f"        x {operator} (other_0*variable_0 + ")
        assert all(line.startswith("            ") for line in found[1:])
        whole = ast.parse(f"x {operator} {code(total)}")
        assert ast.dump(ast.parse("\n".join(found).strip())) == ast.dump(whole)


def test_long_calls_are_broken_between_operands():
    names = [f"value_{k}" for k in range(9)]
    symbols = [sp.Symbol(name) for name in names]
    call = lines([invoked(INVERSE_3, tuple(symbols), tuple(symbols))])
    assert max(map(len, call)) <= 100 and len(call) > 1
    assert ast.unparse(ast.parse("\n".join(call))) == (
        f"{', '.join(names)} = inverse_3({', '.join(names)})")
    long = [scratch(f"a_rather_long_name_of_an_array_{k}") for k in range(3)]
    first, *others = lines([invoked(PACKED_TIMES, (*long, counts.n))], 1)
    assert first.startswith("    packed_times(a_rather")
    assert others and all(line.startswith(" " * len("    packed_times(")) for line in others)


def kernel(*body):
    nothing = Operations(0, 0, 0, 0)
    return Kernel("k", body, {}, 0, 0, nothing, nothing)


def test_imports_are_what_is_used_sorted_and_wrapped():
    row = pointed("row")
    used = kernel(invoked(INVERSE_3, (x,) * 9, (x, y)), Point(row, row.at(counts.padded(3))),
                  Set((x,), (sp.sin(y) + sp.sqrt(x),)))
    assert import_lines(used) == (
        "from math import sin, sqrt\n\nfrom sebody.compiler.decorators import kernel_function\n"
        "from sebody.kernels.abi import at, padded\nfrom sebody.kernels.dense import inverse_3")
    many = ("AT_CONSTANTS", "ACCELERATION", "VELOCITY", "C_STIFFNESS", "C_CONSTRAINT", "HEADER")
    wide = kernel(*(Return(counts.agreed(name)) for name in many))
    assert import_lines(wide, ("SUPERELEMENT_CONSTANTS",), ("Part",)).split("\n")[1:] == [
        "from sebody.contract.layout import (", "    ACCELERATION,", "    AT_CONSTANTS,",
        "    C_CONSTRAINT,", "    C_STIFFNESS,", "    HEADER,", "    SUPERELEMENT_CONSTANTS,",
        "    VELOCITY,", "    Part,", ")"]


def test_constants_are_printed_as_they_are_declared():
    declared = (Part("k"), Part("e", (3,), "axis"), Part("C", ("n", "n"), columns=True),
                Part("long", ("n", 2), "a meaning that is so long that it needs another line",
                     packed=True))
    assert eval(parts.table(declared), {"Part": Part}) == declared
    assert max(map(len, parts.table(declared, 2).split("\n"))) <= 100
    assert parts.table(()) == "()"


def test_traits_are_printed_as_they_are_declared():
    frames = {"f": FrameTraits("a frame", planar=False, constants=(Part("w", ("N_POSITIONS",)),))}
    inertia = {"i": InertiaTraits("an option", "i", rank=0, cost=1.0, softening=0.5, material=True)}
    scope = {}
    exec(options.options_text(frames, inertia, {}), scope)
    assert scope["FRAMES"] == frames and scope["INERTIA_OPTIONS"] == inertia
    assert scope["CONDITIONS"] == {}


@pytest.mark.parametrize("planar", [False, True])
def test_conditions_are_printed_as_functions_of_the_constants(planar):
    """A vector condition of displacements, and a scalar one of rotations."""
    q = Quantities(Space(planar))
    found = {("fit", planar): Condition(q.u, 2 * q.fit.symbols[0] * skew(q.X.symbols),
                                        (q.fit, q.X)),
             ("mean", planar): Condition(q.psi, q.alpha_r.symbols[0] * sp.eye(3), (q.alpha_r,))}
    scope, X = {}, np.array([0.3, -0.7, 1.1])[:2 if planar else 3]
    exec(options.options_text({}, {}, found), scope)
    fit, mean = (scope["CONDITIONS"][name, planar] for name in ("fit", "mean"))
    assert (fit.of, fit.constants) == ("position", ("fits", "X"))
    assert (mean.of, mean.constants) == ("rotation", ("alpha_rs",))
    u, moment = np.arange(1.0, 4.0)[:len(X)], [0, 0, 0]
    moment[3 - (1 if planar else 3):] = np.atleast_1d(
        X[0] * u[1] - X[1] * u[0] if planar else np.cross(X, u))
    assert np.array(fit.coefficients(0.25, X)) @ u == pytest.approx(
        0.5 * np.array(moment[2:] if planar else moment))
    assert np.array_equal(mean.coefficients(0.5), 0.5 * np.eye(1 if planar else 3))
