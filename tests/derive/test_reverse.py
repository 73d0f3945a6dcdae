"""Transposed products: the steps of a column read backwards give the transpose of its matrix.

Both are executed as plain Python, with generic constants in generic states: no kernel is compiled.
`tests/benchmarks/bench_transposed.py` does the same for all kernels that are shipped.
"""

import numpy as np
import pytest
import sympy as sp
from plain_kernels import evaluated, executed
from products_kernels import ROUNDING, element_error, superelement_error

from sebody.contract.layout import TANGENT
from sebody.derive.compiler import Variant, compile_kernel
from sebody.derive.form import counts
from sebody.derive.form.arrays import scratch
from sebody.derive.form.functions import CLEAR, PACKED_TIMES
from sebody.derive.form.spaces import Space
from sebody.derive.form.steps import Product, Repeat, Shift, Stage, call
from sebody.derive.formulas import arrays
from sebody.derive.passes.reverse import Reversal, transposed_forms
from sebody.derive.symbolic.variation import DerivationError
from sebody.kernels.loader import load
from sebody.verify.check.states import evaluate
from sebody.verify.check.superelement_cases import superelement_case


@pytest.mark.parametrize("layout, frame, inertia, options", [
    ("f2", "converged_mean", "material", {}), ("planar-f2d", "converged_mean", "material",
                                               {"damping": 0.3}),
    ("planar-f2m2", "converged_mean", "floating_field", {"damping": 0.3})])
def test_superelements(layout, frame, inertia, options):
    assert superelement_error(Variant(layout, frame, inertia), **options) <= ROUNDING


@pytest.mark.parametrize("kind", [
    "parallel_ground", "coincident", "on_plane", "distance", "planar_on_line", "slide_drive",
    "planar_slide_drive", "planar_turn_drive", "planar_rigid_body", "torque", "follower_force",
    "mode_force", "planar_spring", "planar_torsion_spring", "planar_bushing"])
def test_elements(kind):
    assert element_error(kind) <= ROUNDING


def test_plain_python_is_what_the_compiled_kernel_does():
    """What the products are compared with: forces and matrix of a shipped kernel of option C."""
    module = load("superelement_planar_f2_converged_mean_floating_field")
    case = superelement_case(module, 0, gravity=3.0, damping=0.3)
    plain = executed(compile_kernel(Variant("planar-f2", "converged_mean", "floating_field")))
    factors = (0.7, 0.4, 1.3, 1, 1)
    mine = evaluated(case._replace(module=plain), TANGENT, factors)
    forces, matrix, _ = evaluate(case, TANGENT, factors)
    turn = np.eye(case.n)
    for at in (0, 2):
        turn[at:at + 2, at:at + 2] = mine.frames.reshape(3, 3)[:2, :2]
    assert np.abs(mine.forces - forces).max() < 1e-11 * np.abs(forces).max()
    mine = turn @ mine.matrices.reshape(matrix.shape) @ turn.T
    assert np.abs(mine - matrix).max() < 1e-11 * np.abs(matrix).max()


def test_transposed_forms():
    a, b, c, x, y = sp.symbols("a b c x y")
    assert transposed_forms([a * x + b * y, c * x, a], [x, y, c], [a, b]) == {
        a: x * x + c, b: x * y}
    for other in (x * y, x**2 + y, x + a, sp.sin(x)):
        with pytest.raises(DerivationError, match="is not linear in x.*, so it has no transpose"):
            transposed_forms([other], [a], [x, y])


def test_steps_without_a_transpose_are_refused():
    space, step = Space(False), Shift("s", scratch("s"), scratch("y"))
    t = space.quantity("t", "scalar", "element")

    def backwards(*steps):
        return Reversal(space, steps, (scratch("y"),), {}).reversed()
    with pytest.raises(DerivationError, match="step 'again' has no transpose"):
        backwards(Repeat("again", counts.j, counts.n, (step,)))
    with pytest.raises(DerivationError, match="calls packed_times, of which no transpose is known"):
        backwards(call("product", PACKED_TIMES, scratch("A"), scratch("y"), scratch("s"), counts.n))
    with pytest.raises(DerivationError, match="step 'twice' changes t by itself other than by add"):
        backwards(Stage("twice", "element", sets=((t, 2 * t.symbols),)))


def test_bars_of_what_is_written_twice_begin_anew():
    """``s = M y`` before and after ``s += y``: only the last product has a bar to give."""
    def product(title):
        return Product(title, arrays.M, arrays.y, arrays.s)
    found = Reversal(Space(False), (product("one"), Shift("s", arrays.s, arrays.y),
                                    product("other")), (arrays.y,), {}).reversed()
    titles = [step.title for step in found.steps]
    assert titles == ["transposed: other", "overwritten: other", "transposed: s",
                      "transposed: one", "overwritten: one"]
    assert found.steps[1].function is CLEAR
