"""From steps to statements, read as lines of Python: loops, loads, sums, linear equations."""

import pytest
import sympy as sp

from sebody.derive.form import counts
from sebody.derive.form.arrays import scratch
from sebody.derive.form.functions import INVERSE_TANGENT, RELATIVE_ROTATIONS
from sebody.derive.form.spaces import Space
from sebody.derive.form.steps import (
    Product,
    Repeat,
    Scaling,
    Shift,
    Solve,
    Stage,
    Sum,
    Values,
    search,
)
from sebody.derive.form.whole import Number
from sebody.derive.formulas import arrays
from sebody.derive.formulas.quantities import Quantities
from sebody.derive.passes.lower import Lowering
from sebody.derive.passes.operations import operations
from sebody.derive.passes.uses import uses
from sebody.derive.printing.numba.statements import lines
from sebody.derive.symbolic.rotations import cross


def printer(planar=False, arrows=True):
    q = Quantities(Space(planar))
    lowering = Lowering(q.space, {q.e0.symbols[0]: q.e0.symbols[0]}, arrows)
    return q, lambda *steps: lines(lowering.statements(steps)), lowering


def test_stage_over_positions():
    """Loads, the formula, a sum from zero: a product for each component and node."""
    q, text, lowering = printer()
    stage = Stage("scaled", "position", adds=((q.F, q.alpha.symbols[0] * q.x.symbols),))
    assert text(stage) == [
        "# scaled", "F_x = F_y = F_z = 0.0", "for i in range(N_POSITIONS):", "    i3 = 3*i",
        "    alpha = alphas[i]", "    x_x, x_y, x_z = qe[i3], qe[i3 + 1], qe[i3 + 2]",
        "    F_x += alpha*x_x", "    F_y += alpha*x_y", "    F_z += alpha*x_z"]
    assert operations(lowering.statements([stage])) == (0, 3, 0, 0)
    assert text(stage._replace(continues=True))[1] == "for i in range(N_POSITIONS):"


def test_planar_stage_has_the_components_of_a_plane():
    q, text, _ = printer(planar=True)
    turned = Stage("turned", "rotation", sets=((q.w, 2 * q.Om.symbols),))
    assert text(turned) == ["# turned", "for j in range(N_ROTATIONS):", "    j3 = ROTATIONS + j",
                            "    Om_z = ve[j3]", "    yd[j3] = 2*Om_z"]
    arm = Stage("arm", "position", adds=((q.W, cross(q.X.symbols, q.f.symbols)),))
    assert text(arm)[-1] == "    W_z += X_x*f_y - X_y*f_x"


def test_stages_of_modes_and_of_the_element():
    q, text, _ = printer()
    modes = Stage("modes", "mode", sets=((q.ym, q.qm.symbols),))
    assert text(modes)[1:] == ["for k in range(MODES, n):", "    qm = qe[k]", "    y[k] = qm"]
    local = Stage("local", "element", sets=((q.v0, 2 * q.dx0.symbols),))
    assert text(local)[1:] == ["v0_x = 2*dx0_x", "v0_y = 2*dx0_y", "v0_z = 2*dx0_z"]


def test_what_adds_nothing_is_left_out():
    q, text, _ = printer()
    assert text(Stage("nothing", "position", adds=((q.F, sp.zeros(3, 1)),), continues=True)) == []


def test_common_subexpressions_are_numbered_through():
    """Names are used once in a kernel."""
    q, text, _ = printer()
    product = q.x.symbols.dot(q.X.symbols)
    stage = Stage("s", "position", sets=((q.u, product**2 * sp.Matrix([1, 1, 1])),))
    first, second = (set(line.split(" =")[0].strip() for line in text(stage)
                         if line.strip().startswith("t")) for _ in range(2))
    assert first and second and not first & second


def equation(q, weight, matrix):
    """``sum weight (matrix rate - Om) = 0``."""
    summand = q.alpha_r.symbols[0] * (matrix * q.Om0.symbols - q.Om.symbols)
    return Solve("mean", q.Om0, (Sum("rotation", summand),), sp.zeros(3, 1), "B", invert=True,
                 weight=weight)


def test_solve_with_a_sum_that_is_known():
    """Weights add up to one: nothing is summed for the matrix, nothing inverted."""
    q, text, _ = printer()
    found = text(equation(q, q.alpha_r.symbols[0], 2 * sp.eye(3)))
    assert found[1] == "rhs_x = rhs_y = rhs_z = 0.0"
    assert found[-3:] == ["Om0_x = (0.5)*rhs_x", "Om0_y = (0.5)*rhs_y", "Om0_z = (0.5)*rhs_z"]
    assert not any("B_" in line or "inverse_3" in line for line in found)


def test_solve_with_sums_over_several_carriers():
    """Each in a loop of its own, into one matrix and one right-hand side."""
    q, text, _ = printer()
    modal = q.vm.symbols[0] * q.R0.symbols[:, 0]
    sums = *equation(q, None, sp.eye(3)).sums, Sum("mode", modal)
    found = text(equation(q, None, sp.eye(3))._replace(sums=sums))
    loops = [line for line in found if line.startswith("for ")]
    assert loops == ["for j in range(N_ROTATIONS):", "for k in range(MODES, n):"]
    assert found.count("rhs_x = rhs_y = rhs_z = 0.0") == 1
    assert found[-3] == "Om0_x = Bxx*rhs_x + Bxy*rhs_y + Bxz*rhs_z"
    assert "    rhs_x += -R0_xx*vm" in found[found.index(loops[1]):]


def test_solve_with_a_matrix_to_be_inverted():
    q, text, lowering = printer()
    known = equation(q, None, sp.eye(3))
    found = text(known)
    assert found[1] == "B_00 = B_01 = B_02 = B_10 = B_11 = B_12 = B_20 = B_21 = B_22 = 0.0"
    assert "    B_00 += alpha_r" in found
    names = "Bxx, Bxy, Bxz, Byx, Byy, Byz, Bzx, Bzy, Bzz"
    assert any(line.startswith(f"{names} = inverse_3(B_00, B_01, ") for line in found)
    assert found[-3] == "Om0_x = Bxx*rhs_x + Bxy*rhs_y + Bxz*rhs_z"
    back = text(known._replace(invert=False, transposed=True))
    assert back[-3] == "Om0_x = Bxx*rhs_x + Byx*rhs_y + Bzx*rhs_z"
    assert not any("inverse_3" in line for line in back)
    assert [f.name for f in uses(lowering.statements([known])).functions] == ["inverse_3"]


def test_solve_in_a_plane_is_a_division():
    q, text, _ = printer(planar=True)
    found = text(equation(q, None, sp.eye(3)))
    assert found[1:3] == ["B_00 = 0.0", "rhs_z = 0.0"]
    assert found[-2:] == ["Bzz = 1.0/B_00", "Om0_z = Bzz*rhs_z"]


def test_searches_values_and_rows():
    q, text, lowering = printer()
    found = search("find", RELATIVE_ROTATIONS, counts.ROTATIONS, arrays.nodes, arrays.R,
                   arrays.frame, arrays.y.at(counts.FIRST_ROTATION), operations=7, finds=q.R0)
    assert text(found) == [
        "# find", "status = relative_rotations(N_ROTATIONS, nodes, R, frame, at(y, ROTATIONS))",
        "if status != 0:", "    return status",
        "R0_xx, R0_xy, R0_xz = frame[0], frame[1], frame[2]",
        "R0_yx, R0_yy, R0_yz = frame[3], frame[4], frame[5]",
        "R0_zx, R0_zy, R0_zz = frame[6], frame[7], frame[8]"]
    assert operations(lowering.statements([found])).element == 7
    values = Values("coefficients", (q.e0, q.e1), INVERSE_TANGENT, q.psi, 5)
    assert text(values)[-2:] == [
        "    psi_x, psi_y, psi_z = y[j3], y[j3 + 1], y[j3 + 2]",
        "    e0s[j], e1s[j] = inverse_tangent_coefficients(psi_x*psi_x + psi_y*psi_y + "
        "psi_z*psi_z)"]
    assert operations(lowering.statements([values])).rotation == 5
    assert text(Shift("off", arrays.s, arrays.weight, adds=False))[1:] == [
        "for i in range(n):", "    s[i] -= weight[i]"]
    assert text(Scaling("held", (arrays.y.d,), (q.dth0,), sp.Symbol("c")))[1:] == [
        "for i in range(n):", "    dy[i] *= c", "dth0_x *= c", "dth0_y *= c", "dth0_z *= c"]


def test_products_leave_out_zeros_where_sizes_are_not_known():
    q, text, lowering = printer()
    product = Product("p", arrays.M, arrays.yd, arrays.p)
    assert text(product) == ["# p", "arrow_times(M, yd, p, n, filled)"]
    assert operations(lowering.statements([product])).products == 1
    assert printer(arrows=False)[1](product) == ["# p", "columns_times(M, yd, p, n, n)"]
    wide = product._replace(rows=Number(3))
    assert text(wide) == ["# p", "columns_times(M, yd, p, 3, n)"]
    assert operations(lowering.statements([wide])).products == 0
    rows = uses(lowering.statements([product.differential()]))
    assert [array.name for array in rows.arrays] == ["M", "dyd", "dp"]


def test_repeated_steps():
    q, text, _ = printer()
    inner = Shift("off", arrays.s, scratch("more"))
    assert text(Repeat("columns", counts.j, counts.n, (inner,))) == [
        "# columns", "for j in range(n):", "    # off", "    for i in range(n):",
        "        s[i] += more[i]"]


def test_frame_in_a_plane():
    q, text, _ = printer(planar=True)
    found = search("find", RELATIVE_ROTATIONS, counts.n, arrays.nodes, arrays.R, arrays.frame,
                   arrays.y, operations=1, finds=q.R0)
    assert text(found)[-1] == "R0_cos, R0_sin = frame[0], frame[3]"


@pytest.mark.parametrize("planar", [False, True])
def test_a_component_out_of_the_plane_must_vanish(planar):
    q, text, _ = printer(planar)
    stage = Stage("moment", "element", sets=((q.W, sp.Matrix([q.mass.symbols[0], 0, 0])),))
    if not planar:
        assert text(stage)[-1] == "W_z = 0.0"
        return
    with pytest.raises(AssertionError, match="out-of-plane component"):
        text(stage)
