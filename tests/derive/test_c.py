"""The target C99: nothing of a kernel knows Python or Numba, and its numbers are the same.

`tests/benchmarks/bench_targets.py` does this for all elements.
"""

import pytest
import sympy as sp
from c_kernels import COMPILER, checked, compiled, largest_difference

from sebody.derive.compiler import Variant, statements_of
from sebody.derive.form import counts
from sebody.derive.form.arrays import pointed, scratch
from sebody.derive.form.functions import INVERSE_TANGENT, RELATIVE_ROTATIONS
from sebody.derive.form.statements import If, Let, Point, Set, Zero, compared, invoked
from sebody.derive.form.whole import Quotient, largest, whole
from sebody.derive.passes.lower import STATUS
from sebody.derive.printing.c.expressions import code
from sebody.derive.printing.c.files import file_text
from sebody.derive.printing.c.statements import Block
from sebody.kernels.loader import element_kernel

JOINTS = ("parallel_ground", "coincident", "coincident_ground", "planar_coincident", "on_plane",
          "planar_on_line", "planar_aligned", "distance", "planar_distance", "slide_drive",
          "planar_slide_drive", "planar_turn_drive")
OTHERS = ("planar_spring", "planar_rigid_body", "planar_bushing", "follower_torque",
          "planar_friction_turn_f2", "distance_stop", "planar_sphere_on_plane",
          "planar_table_spring", "table_torsion_spring")
ROUNDING = 1e-13        # of numbers around one: products and sums are fused in other places
needs_compiler = pytest.mark.skipif(COMPILER is None, reason="no C compiler: set CC")


@pytest.fixture(scope="module")
def library(tmp_path_factory):
    text = file_text(map(statements_of, (*JOINTS, *OTHERS)))
    return compiled(text, tmp_path_factory.mktemp("c"))


@needs_compiler
@pytest.mark.parametrize("kind", (*JOINTS, *OTHERS))
def test_numbers_are_those_of_numba(library, kind):
    for seed in (0, 1):
        assert largest_difference(library[f"element_{kind}"], element_kernel(kind), seed) < ROUNDING


@needs_compiler
def test_kernels_of_bodies_are_c_too(tmp_path):
    """Every name is declared before it is used, every call has operands of the right types."""
    source = tmp_path / "body.c"
    source.write_text(file_text([statements_of(Variant("planar-f2d", "converged_mean",
                                                       "material"))]))
    checked(source, "-fsyntax-only")


def test_statements_as_c():
    x, y = scratch("x"), pointed("y", whole=True)
    t = counts.i
    a, b = sp.symbols("a b")
    block = Block(["work", "x"], 0)
    found = block.lines((
        Let((counts.n, counts.N), (largest(t, 3), Quotient(t, whole(3)))),
        Let((counts.n,), (counts.n + 1,)), Point(scratch("z"), pointed("work").at(counts.n)),
        Zero((a,)), Set((a, x[y[t]]), (a**3 + sp.sqrt(a), b / a**2)),
        If(compared(whole(0), "<=", t, "<", counts.n), (Set((b,), (sp.cos(a),)),),
           (invoked(INVERSE_TANGENT, (a,), (b, x[0])),)),
        invoked(RELATIVE_ROTATIONS, (t, y, x.at(3), x, x), (STATUS,))))
    assert found == [
        "int64_t n = (i > 3 ? i : 3);", "int64_t N = i/3;", "n = n + 1;",
        "double *z = work + n;", "double a = 0.0;", "a = sqrt(a) + a*a*a;", "x[y[i]] = b/(a*a);",
        "if (0 <= i && i < n) {", "    double b = cos(a);", "} else {", "    double b;",
        "    inverse_tangent_coefficients(a, &b, &x[0]);", "}",
        "int64_t status = relative_rotations(i, y, x + 3, x, x);"]


@pytest.mark.parametrize("expression, text", [
    ("x**2/3", "(0.3333333333333333)*x*x"), ("z/(x*y)**2", "z/(x*x*y*y)"),
    ("(x + y)/z**2", "(x + y)/(z*z)"), ("x**5", "pow(x, 5)"), ("x/(y*z)", "x/(y*z)"),
    ("1/(2*z)", "(0.5)/z"), ("-sqrt(x)", "-sqrt(x)"), ("atan2(y, x)", "atan2(y, x)")])
def test_expressions(expression, text):
    assert code(sp.sympify(expression)) == text
