"""The chain rule on the manifold, and that no formula with an error survives the derivation."""

import pytest
import sympy as sp

from sebody.derive.form.spaces import Space
from sebody.derive.form.steps import Stage
from sebody.derive.formulas import elastic, elements, forces, joints, kinematics
from sebody.derive.formulas.frames import positions
from sebody.derive.formulas.inertia import option, option_a, option_b, rigid_part
from sebody.derive.formulas.quantities import Quantities
from sebody.derive.kernels import linearize, superelement
from sebody.derive.kernels.layouts import Layout
from sebody.derive.passes.linearize import Linearizer
from sebody.derive.symbolic import rotations, variation
from sebody.derive.symbolic.rotations import cross
from sebody.derive.symbolic.variation import (
    DerivationError,
    along,
    check_same,
    coefficients,
    differential,
    rotating,
)

PSI = sp.Matrix(sp.symbols("p_x p_y p_z"))
TH = sp.Matrix(sp.symbols("th_x th_y th_z"))
R = sp.Matrix(3, 3, sp.symbols("R_0:9"))
X = sp.Matrix(sp.symbols("x_x x_y x_z"))


def test_differential_is_the_sum_of_partial_derivatives():
    x, y, z, dx, dy = sp.symbols("x y z dx dy")
    f = sp.sin(x * y) / (1 + x**2) + z * sp.exp(y) - x * y * z
    expected = sp.diff(f, x) * dx + sp.diff(f, y) * dy
    assert sp.simplify(differential(f, {x: dx, y: dy}) - expected) == 0


def test_differential_of_what_does_not_move():
    x, z = sp.symbols("x z")
    assert differential(z**2, {x: 1}) == 0
    assert differential(sp.Integer(3), {x: 1}) == 0
    assert differential(x * z, {x: sp.S.Zero}) == 0


def test_differential_may_depend_on_the_point():
    """Rules hold expressions: here a rotation about z, whose square turns twice as fast."""
    x, y = sp.symbols("x y")
    rules = {x: -y, y: x}
    assert sp.expand(differential(x**2 + y**2, rules)) == 0
    assert sp.expand(differential(x**2 - y**2, rules) + 4 * x * y) == 0


def test_differential_of_a_matrix_is_that_of_its_entries():
    rotated = differential(R.T * X, rotating(R, TH))
    assert sp.expand(rotated - rotations.skew(TH).T * R.T * X) == sp.zeros(3, 1)


def test_turning_and_along_skip_numbers():
    """In a plane vectors and rotations have constant entries, which have no differential."""
    c, s, w = sp.symbols("c s w")
    plane = sp.Matrix([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    rules = rotating(plane, sp.Matrix([0, 0, w]))
    assert rules == {c: -s * w, s: c * w}
    x, dx = sp.symbols("x dx")
    assert along(sp.Matrix([x, 0]), sp.Matrix([dx, 0])) == {x: dx}


def test_coefficients_of_a_linear_form():
    a, b = sp.symbols("a b")
    assert coefficients(a * TH[0] - 2 * b * TH[2] + 5, TH) == sp.Matrix([a, 0, -2 * b])


def test_check_same_returns_the_short_form():
    short = X.cross(TH)
    assert check_same("equal", short, rotations.skew(X) * TH) == short


def test_check_same_names_the_wrong_formula():
    wrong = sp.eye(3) - rotations.skew(PSI) / 2 + (
        rotations.inverse_tangent(PSI) - sp.eye(3) - rotations.skew(PSI) / 2)
    with pytest.raises(DerivationError, match="inverse of T: the short form differs .* of its "
                                              "size; correct the formula"):
        check_same("inverse of T", wrong * rotations.tangent(PSI), sp.eye(3))


@pytest.mark.parametrize("size, accepted", [(sp.Rational(1, 10**30), False),
                                            (sp.Rational(1, 10**45), True)])
def test_check_same_sees_thirty_digits(size, accepted):
    """Rounding of 50 digits is let through, an error thirty digits down is not."""
    if accepted:
        check_same("small error", X * (1 + size), X)
    else:
        with pytest.raises(DerivationError, match="small error"):
            check_same("small error", X * (1 + size), X)


def test_check_same_sees_one_wrong_entry():
    short = sp.Matrix([X[0], X[1], X[2] + TH[0]])
    with pytest.raises(DerivationError, match="one entry"):
        check_same("one entry", short, X)


def test_frames_are_orthogonal_where_they_are_said_to_be():
    same = (rotations.skew(R.T * X), R.T * rotations.skew(X) * R)
    check_same("a rotation", *same, [R])
    with pytest.raises(DerivationError, match="any matrix"):
        check_same("any matrix", *same)


def test_frames_in_a_plane_turn_about_z():
    c, s = sp.symbols("c s")
    plane = sp.Matrix([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    check_same("plane", plane.T * plane, sp.eye(3), [plane])
    with pytest.raises(DerivationError, match="no frame"):
        check_same("no frame", plane.T * plane, sp.eye(3))


def test_proof_does_not_depend_on_the_run():
    """The random points follow from the name of the formula alone."""
    wrong = (sp.ImmutableMatrix(X), sp.ImmutableMatrix(2 * X), ())
    messages = []
    for _ in range(2):
        variation._prove.cache_clear()
        with pytest.raises(DerivationError) as caught:
            variation._prove("twice", *wrong)
        messages.append(str(caught.value))
    assert messages[0] == messages[1]


@pytest.fixture
def fresh():
    """No derivation remembered, before and after."""
    remembered = superelement.node_formulas, linearize.node_tangent
    for function in remembered:
        function.cache_clear()
    yield
    for function in remembered:
        function.cache_clear()


def derive(inertia_option="material", frame="converged_mean", layout="f2"):
    return linearize.linearized(
        superelement.superelement(Layout.parse(layout), frame, inertia_option))


def with_short(stage, change):
    return stage._replace(short=tuple(change(s) for s in stage.short))


@pytest.mark.parametrize("layout", ["f2", "planar-f2"])
def test_wrong_hand_form_of_a_stage(monkeypatch, fresh, layout):
    """A sign lost in the hand form of (17): derivation fails, before anything is emitted."""
    right = kinematics.local_displacement

    def wrong(q):
        r = q.X.symbols + q.u.symbols
        return with_short(right(q), lambda s: s - 2 * cross(r, q.dth0.symbols))
    monkeypatch.setattr(superelement, "local_displacement", wrong)
    with pytest.raises(DerivationError, match="differential of u: the short form differs"):
        derive(layout=layout)


def test_wrong_hand_form_of_velocities(monkeypatch, fresh):
    right = kinematics.local_velocity
    monkeypatch.setattr(superelement, "local_velocity",
                        lambda q: with_short(right(q), lambda s: s - cross(q.vs.symbols,
                                                                           q.dth0.symbols)))
    with pytest.raises(DerivationError, match="differential of vs"):
        derive()


def test_wrong_variation_of_the_elastic_rotation(monkeypatch, fresh):
    """T^-1 in place of T^-T on the frame's variation in (17)."""
    monkeypatch.setattr(kinematics, "difference_of_rates", lambda psi, of, frame:
                        rotations.inverse_tangent_times(psi, of - frame))
    with pytest.raises(DerivationError, match=r"variation of the elastic rotation \(17\)"):
        derive()


def test_wrong_acceleration_of_the_nodes(monkeypatch, fresh):
    """A cross product of the wrong sense in the inertia options."""
    monkeypatch.setattr(option, "cross", lambda a, b: -cross(a, b))
    with pytest.raises(DerivationError, match=r"rate of xdot\* \(46\), \(58\)"):
        derive()


@pytest.mark.parametrize("module, option, name", [
    (option_b, "material", r"moment of option B \(57\)"), (option_a, "frame_axes",
                                                           r"variation of Omega\* \(42\)")])
def test_wrong_variation_of_angular_velocities(monkeypatch, fresh, module, option, name):
    """The sign of Omega x dTheta in (56) decides that of the moment."""
    right = kinematics.angular_velocity_variation

    def wrong(space):
        q = Quantities(space)
        return right(space) - 2 * cross(q.Om.symbols, q.dth.symbols)
    monkeypatch.setattr(module, "angular_velocity_variation", wrong)
    with pytest.raises(DerivationError, match=name):
        derive(option)


def test_wrong_variation_of_the_best_fit(monkeypatch, fresh):
    monkeypatch.setattr(positions, "cross", lambda a, b: -cross(a, b))
    with pytest.raises(DerivationError, match="variation of the rotation of best fit"):
        derive(frame="positions", layout="f3")


def test_wrong_gradient_of_a_constraint(monkeypatch):
    """The matrix of a joint must have the constraint force as its column and as its row."""
    monkeypatch.setattr(elements, "conjugate_to",
                        lambda form, variables: -2 * elastic.conjugate_to(form, variables))
    with pytest.raises(DerivationError, match="constraint force is the gradient"):
        elements.linearized(joints.parallel(False))


def test_dead_torque_turns_in_material_axes():
    """``d(R^T m) = (R^T m) x dTheta``: second-order term of a fixed-direction torque."""
    torque = elements.linearized(forces.torque(False, False))
    block, = torque.blocks
    R, m = block.state.symbols, torque.constants[0].symbols
    amplitude, c_stiffness = sp.symbols("amplitude c_stiffness")
    expected = -amplitude * c_stiffness * rotations.skew(R.T * m) * block.direction.symbols
    check_same("fixed-direction torque", sp.Matrix(torque.linear), expected, [R])


def test_out_of_plane_component_is_refused():
    """An expression that leaves the plane cannot be stored there."""
    with pytest.raises(DerivationError, match="out-of-plane component"):
        Space(True).components("vector", X)


@pytest.mark.parametrize("planar", [False, True])
def test_linearizer_of_a_stage(planar):
    """The differential of a stage moves what it sets, so that later stages see it."""
    q = Quantities(Space(planar))
    chain = Linearizer(q.space, along(q.v.symbols, q.dv.symbols))
    first = chain.stage(Stage("square", "position", sets=((q.h, 2 * q.v.symbols),)))
    assert first.sets[0][1] == 2 * q.dv.symbols
    second = chain.stage(Stage("sum", "position", adds=((q.F, 3 * q.h.symbols),)))
    assert second.adds[0] == (q.space.d(q.F), 3 * q.space.d(q.h).symbols)


@pytest.mark.parametrize("name, message", [
    ("along_tangent", "tangent of the rigid part"), ("turned", "rotation of the rigid part"),
    ("on_first", "inertia on the first moment"), ("on_phi", "inertia on the rotation"),
    ("on_frame", "inertia of a rigid part on the frame"), ("momentum", "velocity of the centre")])
def test_wrong_rigid_part(monkeypatch, name, message):
    """A factor lost in one of its formulas: derivation fails, before anything is emitted."""
    right = getattr(rigid_part, name)
    monkeypatch.setattr(rigid_part, name, lambda *given: right(*given) * 2)
    with pytest.raises(DerivationError, match=message):
        rigid_part.prove.__wrapped__()
