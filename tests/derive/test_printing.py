"""The printer: expressions, lines, loops, linear equations, imports and tables of constants."""

import ast

import pytest
import sympy as sp

from sebody.derive.formulas.quantities import Quantities
from sebody.derive.kernels.layouts import Layout
from sebody.derive.printing import options, parts
from sebody.derive.printing.expressions import code, indented, offset
from sebody.derive.printing.imports import import_lines
from sebody.derive.printing.step_printer import StepPrinter
from sebody.derive.symbolic.spaces import Space
from sebody.derive.symbolic.steps import (
    Product,
    Scaling,
    Search,
    Shift,
    Solve,
    Stage,
    Tail,
    Values,
    cross,
)
from sebody.kernels.layout import FrameTraits, InertiaTraits, Part

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


def test_offset():
    assert [offset("i3", k) for k in range(3)] == ["i3", "i3 + 1", "i3 + 2"]


def test_long_assignments_are_broken_and_mean_the_same():
    """In parentheses, after an operator, at most 100 columns; a sum goes on with `+=`."""
    tail = " + ".join(f"variable_{k}*other_{k}" for k in range(12))
    for operator in ("=", "+="):
        text = indented([f"total {operator} {tail}"], 2)
        lines = text.split("\n")
        assert len(lines) > 2 and max(map(len, lines)) <= 100
        assert lines[0].startswith(f"        total {operator} (variable_0*other_0 + ")
        assert all(line.startswith("            ") for line in lines[1:])
        whole = ast.parse(f"total {operator} {tail}")
        assert ast.dump(ast.parse(text.strip())) == ast.dump(whole)


@pytest.mark.parametrize("line", ["# " + "word " * 30, "call(" + "argument, " * 12 + ")"])
def test_other_long_lines_are_left_alone(line):
    assert indented([line], 0) == line


def printer(layout="f2"):
    layout = Layout.parse(layout)
    q = Quantities(Space(layout.planar))
    return q, StepPrinter(q.space, layout, {q.e0.symbols[0]: q.e0.symbols[0]})


def test_stage_over_positions():
    """Loads, the formula, a sum from zero: a product for each component and node."""
    q, p = printer()
    stage = Stage("scaled", "position", adds=((q.F, q.alpha.symbols[0] * q.x.symbols),))
    assert p.lines([stage]) == [
        "# scaled", "F_x = F_y = F_z = 0.0", "for i in range(N_POSITIONS):", "    i3 = 3*i",
        "    alpha = alphas[i]", "    x_x, x_y, x_z = qe[i3], qe[i3 + 1], qe[i3 + 2]",
        "    F_x += alpha*x_x", "    F_y += alpha*x_y", "    F_z += alpha*x_z"]
    assert p.operations == {"position": 3}
    assert p.lines([stage._replace(continues=True)])[1] == "for i in range(N_POSITIONS):"


def test_planar_stage_has_the_components_of_a_plane():
    q, p = printer("planar-f2")
    turned = Stage("turned", "rotation", sets=((q.w, 2 * q.Om.symbols),))
    assert p.lines([turned]) == [
        "# turned", "for j in range(N_ROTATIONS):", "    j3 = ROTATIONS + j", "    Om_z = ve[j3]",
        "    yd[j3] = 2*Om_z"]
    arm = Stage("arm", "position", adds=((q.W, cross(q.X.symbols, q.f.symbols)),))
    assert p.lines([arm])[-1] == "    W_z += X_x*f_y - X_y*f_x"


def test_stages_of_modes_and_of_the_element():
    q, p = printer()
    modes = Stage("modes", "mode", sets=((q.ym, q.qm.symbols),))
    assert p.lines([modes]) == ["# modes", "for k in range(MODES, n):", "    qm = qe[k]",
                                "    y[k] = qm"]
    local = Stage("local", "element", sets=((q.v0, 2 * q.dx0.symbols),))
    assert p.lines([local])[1:] == ["v0_x = 2*dx0_x", "v0_y = 2*dx0_y", "v0_z = 2*dx0_z"]


def test_what_adds_nothing_is_not_printed():
    q, p = printer()
    nothing = Stage("nothing", "position", adds=((q.F, sp.zeros(3, 1)),), continues=True)
    assert p.lines([nothing]) == []


def test_common_subexpressions_are_numbered_through():
    """Names are used once in a kernel."""
    q, p = printer()
    product = q.x.symbols.dot(q.X.symbols)
    stage = Stage("s", "position", sets=((q.u, product**2 * sp.Matrix([1, 1, 1])),))
    first, second = (set(line.split(" =")[0].strip() for line in p.lines([stage])
                         if line.strip().startswith("t")) for _ in range(2))
    assert first and second and not first & second


def equation(q, weight, matrix):
    """``sum weight (matrix rate - Om) = 0``."""
    return Solve("mean", q.Om0, "rotation",
                 q.alpha_r.symbols[0] * (matrix * q.Om0.symbols - q.Om.symbols), sp.zeros(3, 1),
                 "B", invert=True, weight=weight)


def test_solve_with_a_sum_that_is_known():
    """Weights add up to one: nothing is summed for the matrix, nothing inverted."""
    q, p = printer()
    lines = p.lines([equation(q, q.alpha_r.symbols[0], 2 * sp.eye(3))])
    assert lines[1] == "rhs_x = rhs_y = rhs_z = 0.0"
    assert lines[-3:] == ["Om0_x = (0.5)*rhs_x", "Om0_y = (0.5)*rhs_y", "Om0_z = (0.5)*rhs_z"]
    assert not any("B_" in line or "inverse_3" in line for line in lines)


def test_solve_with_a_matrix_to_be_inverted():
    q, p = printer()
    known = equation(q, None, sp.eye(3))
    lines = p.lines([known])
    assert lines[1] == "B_00 = B_01 = B_02 = B_10 = B_11 = B_12 = B_20 = B_21 = B_22 = 0.0"
    assert "    B_00 += alpha_r" in lines
    names = "Bxx, Bxy, Bxz, Byx, Byy, Byz, Bzx, Bzy, Bzz"
    assert any(line.startswith(f"{names} = inverse_3(B_00, B_01, ") for line in lines)
    assert lines[-3] == "Om0_x = Bxx*rhs_x + Bxy*rhs_y + Bxz*rhs_z"
    back = p.lines([known._replace(invert=False, transposed=True)])
    assert back[-3] == "Om0_x = Bxx*rhs_x + Byx*rhs_y + Bzx*rhs_z"
    assert not any("inverse_3" in line for line in back)


def test_solve_in_a_plane_is_a_division():
    q, p = printer("planar-f2")
    lines = p.lines([equation(q, None, sp.eye(3))])
    assert lines[1:3] == ["B_00 = 0.0", "rhs_z = 0.0"]
    assert lines[-2:] == ["Bzz = 1.0/B_00", "Om0_z = Bzz*rhs_z"]


def test_searches_values_and_rows():
    q, p = printer()
    search = Search("find", "fit", ("N_ROTATIONS", "R", Tail("y", "ROTATIONS")), 7, q.R0)
    assert p.lines([search]) == [
        "# find", "status = fit(N_ROTATIONS, R, at(y, ROTATIONS))", "if status != 0:",
        "    return status", "R0_xx, R0_xy, R0_xz = frame[0], frame[1], frame[2]",
        "R0_yx, R0_yy, R0_yz = frame[3], frame[4], frame[5]",
        "R0_zx, R0_zy, R0_zz = frame[6], frame[7], frame[8]"]
    assert p.operations == {"element": 7}
    values = Values("coefficients", (q.e0, q.e1), "series", q.psi, 5)
    square = "y[j3] * y[j3] + y[j3 + 1] * y[j3 + 1] + y[j3 + 2] * y[j3 + 2]"
    assert p.lines([values])[-1] == f"    e0s[j], e1s[j] = series({square})"
    assert p.operations == {"element": 7, "rotation": 5}
    assert p.lines([Shift("off", "s", "weight", "-")])[1:] == ["for i in range(n):",
                                                             "    s[i] -= weight[i]"]
    assert p.lines([Scaling("held", ("dy",), (q.dth0,), "c")])[1:] == [
        "for i in range(n):", "    dy[i] *= c", "dth0_x *= c", "dth0_y *= c", "dth0_z *= c"]
    assert p.lines([Product("p", "M", "yd", "p")])[1:] == ["arrow_times(M, yd, p, n, filled)"]
    assert p.products == 1


def test_frame_in_a_plane():
    q, p = printer("planar-f2")
    assert p.lines([Search("find", "mean", (), 1, q.R0)])[-1] == (
        "R0_cos, R0_sin = frame[0], frame[3]")


def test_steps_report_what_they_use():
    q, _ = printer()
    names = {}
    stage = Stage("s", "position", sets=((q.h, q.alpha.symbols[0] * q.f.symbols),))
    assert stage.uses(q.space, names) == (("alphas", "s", "h"), ())
    product = Product("p", "M", "yd", "p").differential()
    assert product.uses(q.space, names) == (("M", "dyd", "dp"), ("arrow_times",))
    inverted, known = equation(q, None, sp.eye(3)), equation(q, q.alpha_r.symbols[0], sp.eye(3))
    assert inverted.uses(q.space, names).calls == ("inverse_3",)
    assert known.uses(q.space, names) == (("alpha_rs", "ve"), ())


def test_imports_are_sorted_and_wrapped():
    assert import_lines({"at", "padded", "inverse_3"}) == (
        "from sebody.kernels.abi import at, padded\nfrom sebody.kernels.dense import inverse_3")
    wide = import_lines({"Part", "AT_CONSTANTS", "SUPERELEMENT_CONSTANTS", "DAMPING_CONSTANTS",
                         "ACCELERATION", "VELOCITY"})
    assert wide.split("\n") == [
        "from sebody.kernels.layout import (", "    ACCELERATION,", "    AT_CONSTANTS,",
        "    DAMPING_CONSTANTS,", "    SUPERELEMENT_CONSTANTS,", "    VELOCITY,", "    Part,", ")"]
    with pytest.raises(KeyError, match="no_such_function"):
        import_lines({"no_such_function"})


def test_constants_are_printed_as_they_are_declared():
    declared = (Part("k"), Part("e", (3,), "axis"), Part("C", ("n", "n"), columns=True))
    assert eval(parts.table(declared), {"Part": Part}) == declared
    assert parts.table(()) == "()"
    assert parts.chain((*declared[1:], Part("D", ("D",))), planar=True) == [
        "e = at(constants, index[first + AT_CONSTANTS])", "C = at(e, 3)",
        "D = at(C, n*padded(n))"]


def test_traits_are_printed_as_they_are_declared():
    frames = {"f": FrameTraits("a frame", planar=False, constants=(Part("w", ("N_POSITIONS",)),))}
    inertia = {"i": InertiaTraits("an option", material=True)}
    scope = {}
    exec(options.options_text(frames, inertia), scope)
    assert scope["FRAMES"] == frames and scope["INERTIA_OPTIONS"] == inertia
