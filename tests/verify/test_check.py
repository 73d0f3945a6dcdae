"""The consistency check: every kernel passes, and a wrong one does not."""

import importlib.util
import types
from pathlib import Path

import numpy as np
import pytest
from helpers import order

from sebody import InputError
from sebody.catalogue import kernel_files
from sebody.contract.layout import (
    ACCELERATION,
    ALONG,
    POTENTIAL,
    POWERS,
    TRANSPOSED,
    VELOCITY,
)
from sebody.kernels import packed_groups, tapes
from sebody.kernels.loader import load
from sebody.quantities import algebra, motion
from sebody.quantities.expressions import Sum
from sebody.verify import check
from sebody.verify.check import (
    definitions,
    elements,
    products,
    quantities,
    states,
    superelements,
)


@pytest.mark.parametrize("name", kernel_files())
def test_kernel_is_consistent(name):
    rows = check.check_kernels([name])
    assert len(rows) >= 4
    failed = [row for row in rows if not row.passed]
    assert not failed, check.table(failed)
    judged = [row for row in rows if row.slope is None and row.criterion != superelements.SIZE]
    assert judged and all(row.error <= 1e-7 for row in judged)
    assert {row.state for row in rows} == {0, 1}


@pytest.mark.parametrize("name", [
    "superelement_f2_converged_mean_floating_field", "element_rigid_body", "element_spring",
    "element_body_load_converged_mean"])
def test_products_are_those_of_the_matrix(name):
    """Those that gradients in the tests compile anyway; `sebody check` has them all."""
    rows = check.check_kernels(["products_" + name])
    assert {row.criterion for row in rows} == {"forces", "products with weights",
                                               "products with motions"}
    assert all(row.passed and row.limit == 1e-12 for row in rows), check.table(rows)


@pytest.mark.parametrize("name", ["planar_friction_turn_f2", "sphere_on_plane"])
def test_products_of_laws_are_those_of_the_matrix_and_of_what_they_keep(name):
    """In every branch: sticking, slipping, smooth, open."""
    rows = check.check_kernels([f"products_element_{name}"])
    assert len({row.criterion for row in rows}) == 4 * (3 + (name == "sphere_on_plane"))
    assert all(row.passed for row in rows), check.table(rows)
    assert {row.limit for row in rows} == {1e-12, 1e-7}


@pytest.mark.parametrize("criterion", ["products with weights", "products with motions"])
def test_check_notices_wrong_products(criterion, monkeypatch):
    name = "products_element_spring"
    (case, _), *_ = products.cases(name)
    called = products.called

    def wrong(case, task, given):
        status = called(case, task, given)
        given.matrices[:] *= 1.0 + 1e-9 * (task in (ALONG, TRANSPOSED))
        return status
    monkeypatch.setattr(products, "called", wrong)
    error = products.CRITERIA[criterion](case, load(name), np.random.default_rng(0))
    assert error > products.LIMIT


@pytest.mark.parametrize("name", ["superelement_f2_converged_mean_floating_field",
                                  "products_superelement_f2_converged_mean_floating_field"])
def test_entries_that_are_used_twice(name, monkeypatch):
    """As those of large bodies are: as they stand, and transposed."""
    monkeypatch.setattr(packed_groups, "MANY", 1)
    rows = check.check_kernels([name])
    assert all(row.passed for row in rows), check.summary(rows)


def test_small_increments_differ_to_second_order():
    rows = [r for r in check.check_kernels(["superelement_f2_mean_small_material"]) if r.slope]
    assert rows and all(1.8 < row.slope < 2.3 and row.error > 1e-5 for row in rows)


def test_spin_of_small_increments_differs_to_second_order():
    """U of (44) against U of (19) at beta_0 = 0, through the inertia that W carries."""
    small, exact = (load(f"superelement_f2_{frame}_material") for frame in ("mean_small", "mean"))
    errors, sizes = [], (0.2, 0.1, 0.05)
    for psi in sizes:
        case = superelements.without(superelements.superelement_case(exact, 3, psi), "stiffness")
        case = case._replace(reference=definitions.mean_rotation(case))
        forces = [states.evaluate(case._replace(module=m), 0)[0] for m in (small, exact)]
        errors.append(np.abs(forces[0] - forces[1]).max())
    assert 1.8 < order(sizes, errors) < 2.2


def slightly_wrong(monkeypatch):
    """Every force, matrix and energy of the check a little off in one place."""
    right = states.evaluate

    def wrong(case, task, coefficients=(0, 0, 0, 1, 1)):
        g, J, energy = right(case, task, coefficients)
        g[2] *= 1.0 + 1e-5 * (1 + case.q[2] ** 2)
        J[2, 1] *= 1.001
        energy[[0, 5, POTENTIAL, POWERS]] *= 1.001
        if task in (VELOCITY, ACCELERATION):
            g[-1] *= 1.001
        return g, J, energy
    for module in (states, superelements, elements):
        monkeypatch.setattr(module, "evaluate", wrong)


CRITERIA = {*superelements.EXACT_FORCE.values(), *superelements.TANGENTS.values(),
            *superelements.ENERGY_SUMS.values()}


@pytest.mark.parametrize("name", ["planar_f2_converged_mean_material", "f2_mean_material",
                                  "f2t1_positions_material"])
@pytest.mark.parametrize("criterion", sorted(CRITERIA, key=lambda c: c.__name__))
def test_check_notices_a_wrong_superelement(criterion, name, monkeypatch):
    case = superelements.superelement_case(load("superelement_" + name), 0)
    assert criterion(case) <= states.LIMIT
    slightly_wrong(monkeypatch)
    assert criterion(case) > states.LIMIT


@pytest.mark.parametrize("motion", ["q", "v", "a"])
def test_check_notices_modes_that_meet(motion, monkeypatch):
    case = superelements.superelement_case(load("superelement_f2_converged_mean_material"), 0)
    assert states.mode_coupling(case) < 1e-14
    right = states.evaluate

    def wrong(case, task, coefficients=(0, 0, 0, 1, 1)):
        g, J, energy = right(case, task, coefficients)
        g[-1] += 1e-5 * getattr(case, motion)[-2]
        return g, J, energy
    monkeypatch.setattr(states, "evaluate", wrong)
    assert states.mode_coupling(case) > states.LIMIT


@pytest.mark.parametrize("name, criterion", [
    ("parallel_ground", elements.joint_force), ("parallel", elements.joint_acceleration),
    ("turn_drive", elements.joint_velocity), ("turn_drive", elements.joint_acceleration),
    ("slide_drive", elements.drive_power), ("distance", elements.element_tangent),
    ("coincident", elements.joint_force), ("coincident", elements.joint_acceleration),
    ("torque", elements.power), ("torque", elements.element_tangent),
    ("rigid_body", elements.hamilton), ("rigid_body", elements.body_momentum),
    ("rigid_body", elements.tangent_mass), ("rigid_body", elements.tangent_rate),
    ("spring", elements.force_at_rest), ("bushing", elements.power)])
def test_check_notices_a_wrong_element(name, criterion, monkeypatch):
    case = elements.element_case(load("element_" + name), 0)
    assert criterion(case) <= states.LIMIT
    slightly_wrong(monkeypatch)
    assert criterion(case) > states.LIMIT


def mutant(name, old, new, folder):
    """A kernel with one line of its file changed."""
    text = Path(load(name).__file__).read_text()
    assert text.count(old) == 1, f"{old!r} is not once in {name}: choose another line"
    path = folder / f"{name}.py"
    path.write_text(text.replace(old, new))
    spec = importlib.util.spec_from_file_location(f"mutant_{name}", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize("old, new, failing", [
    # sign of the frame's moment on the nodes
    ("g[j3] = alpha_r*wp_z + m_z + pwd_z", "g[j3] = m_z + pwd_z - alpha_r*wp_z",
     {"force = dV/dq (30)", "Hamilton's force (45), (57)", "tangent, configuration"}),
    # a term of the matrix
    ("dg[j3] = alpha_r*dwp_z + dm_z + dpwd_z", "dg[j3] = alpha_r*dwp_z + dm_z",
     {"tangent, velocity (61)", "tangent, mass (60)"})])
def test_check_notices_a_changed_line(old, new, failing, tmp_path):
    name = "superelement_planar_f2_converged_mean_material"
    rows = superelements.check_superelement(name, mutant(name, old, new, tmp_path))
    assert failing <= {row.criterion for row in rows if not row.passed}


@pytest.mark.parametrize("name, claim", [
    ("f2_converged_mean_material", {"INERTIA": "frame_axes"}), ("f2_converged_mean_frame_axes",
                                                                {"INERTIA": "material"}),
    ("f2_converged_mean_material", {"FRAME": "mean"}), ("f2t1_positions_material",
                                                        {"FRAME": "converged_mean"})])
def test_check_notices_a_kernel_that_is_not_what_it_says(name, claim):
    """Forces and tangents fit the energies of the other frame or option just as well."""
    module = types.SimpleNamespace(**vars(load("superelement_" + name)) | claim)
    case = superelements.superelement_case(module, 0)
    assert superelements.elastic_force(case) <= states.LIMIT
    assert superelements.inertia_force(case) <= states.LIMIT
    assert superelements.energies(case) > 1e-6


def test_asymmetric_stiffness_has_no_potential():
    case = superelements.superelement_case(load("superelement_f2_converged_mean_material"), 0)
    S = states.constants_of(case)["S"].copy()
    S[1, 0] *= 1.01
    case = states.changed(case, S=S)
    assert superelements.elastic_force(case) > states.LIMIT
    assert superelements.asymmetry(case) > states.LIMIT


@pytest.mark.parametrize("name", ["superelement_f2_mean_material",
                                  "superelement_planar_f2_positions_material"])
def test_matrix_is_linear_in_its_coefficients(name):
    case = superelements.superelement_case(load(name), 1)
    parts = [states.evaluate(case, 1, c)[1] for c in ((1, 0, 0, 1, 1), (0, 1, 0, 1, 1),
                                                     (0, 0, 1, 1, 1))]
    J = states.evaluate(case, 1, (2.0, -0.3, 1.7, 1, 1))[1]
    # three sums of 15 products, relative to the largest
    assert states.difference(J, 2.0 * parts[0] - 0.3 * parts[1] + 1.7 * parts[2]) <= 1e-14


@pytest.mark.parametrize("name", [n for n in kernel_files() if n.startswith("superelement_")])
def test_paper_tangent_lacks_a_term_that_falls_with_the_deformation(name):
    """The paper's (31) is symmetric; the consistent matrix has a term of the size of y more."""
    module, sizes = load(name), (0.3, 0.03)
    terms = []
    for psi in sizes:
        case = superelements.superelement_case(module, 2, psi)
        case = case._replace(v=0 * case.v, a=0 * case.a,
                             q=np.r_[case.q[:case.first_mode], 0 * case.q[case.first_mode:]])
        terms.append(superelements.geometric_term(case))
        K = states.evaluate(case, 1, (0, 0, 1, 0, 1))[1]
        symmetric = not module.FRAME.endswith("_small")
        # two orders of the same sums, of up to 24 x 24 products
        assert not symmetric or states.difference(K, K.T) <= 1e-13
    assert 1e-3 < terms[0] < 1 and terms[1] < terms[0] / 3


def test_planar_kernel_equals_the_spatial_one_on_planar_states():
    """Positions, angles and matrices embedded in space; equal to rounding."""
    planar = load("superelement_planar_f2_converged_mean_material")
    spatial = load("superelement_f2_converged_mean_material")
    flat = superelements.superelement_case(planar, 5, gravity=1.0)
    keep = [0, 1, 3, 4, 8, 11, 12, 13, 14]      # of x, y, z; x, y, z; rotations; modes
    n, given = 15, states.constants_of(flat)
    S, M, of_translations = np.eye(15), np.eye(15), np.zeros((15, 3))
    S[np.ix_(keep, keep)], M[np.ix_(keep, keep)] = given["S"], given["M"]
    of_translations[keep, :2] = given["mass_columns"]
    X = np.zeros((2, 3))
    X[:, :2] = given["X"]
    q, v, a = np.zeros((3, n))
    q[keep], v[keep], a[keep] = flat.q, flat.v, flat.a
    R = np.concatenate([[np.cos(t), -np.sin(t), 0, np.sin(t), np.cos(t), 0, 0, 0, 1]
                        for t in flat.q[4:6]])
    case = states.with_constants(
        states.Case(spatial, n, states.index_row(n, 2, 2), np.zeros(0), q, R, v, a,
                    flat.reference, flat.frames, flat.field * [1, 1, 0]),
        given | {"X": X, "S": S, "M": M, "mass_columns": of_translations,
                 "mass_rows": of_translations.T, "mc": [*given["mc"], 0.0], "full": [n]})
    for coefficients in ((1.0, 0.3, 2.0, 1, 1), (0, 0, 1, 0, 1)):
        forces, matrices = zip(*[states.evaluate(c, 1, coefficients)[:2] for c in (flat, case)],
                               strict=True)
        # stiff axial forces of small stretches: EPS times some thousand
        assert states.difference(forces[0], forces[1][keep]) <= 1e-12
        assert states.difference(matrices[0], matrices[1][np.ix_(keep, keep)]) <= 1e-12


def test_quantities_are_those_of_their_histories(monkeypatch):
    """With rates and weights of their tapes; what is wrong is noticed, by the name of the row."""
    rows = check.check_kernels(["quantities"])
    failed = [row for row in rows if not row.passed]
    assert not failed, check.table(failed)
    kinds = {row.kernel for row in rows}
    assert {"quantity joint: angle", "quantity node of a body: moment in a plane",
            "quantity contact, stop or friction: normal_force", "quantity energy.kinetic",
            "quantity controller: states"} <= kinds and len(kinds) > 70
    assert check.verdict(rows) == f"{len(rows)} criteria of {len(kinds)} quantities hold"
    monkeypatch.setattr(motion, "dot", lambda a, b: 1.001 * algebra.dot(a, b)
                        if isinstance(a[0], Sum) else algebra.dot(a, b))
    bad = {(row.kernel, row.criterion) for row in check.check_kernels(["quantities"])
           if not row.passed}
    assert ("quantity joint: rate", quantities.VALUE) in bad
    assert not {criterion for _, criterion in bad} - {quantities.VALUE}
    monkeypatch.undo()

    def wrong(*tape):       # rates of the computed numbers are not written
        tapes.play_along(*tape[:-1], tape[-1].copy())
    monkeypatch.setattr(quantities, "play_along", wrong)
    bad = {row.criterion for row in check.check_kernels(["quantities"]) if not row.passed}
    assert bad == {quantities.ALONG, quantities.TRANSPOSED}


def test_unknown_kernel():
    with pytest.raises(InputError, match="kernel 'nothing' is unknown: there are revolute, "):
        check.check_kernels(["nothing"])


def row(criterion="force", error=1e-9, slope=None, limit=1e-7, kernel="element_a"):
    return states.CheckRow(kernel, criterion, 0, error, slope, limit)


@pytest.mark.parametrize("made, passed", [
    (row(), True), (row(error=2e-7), False), (row(error=float("nan")), False),
    (row(error=0.1, limit=float("inf")), True),
    (row(error=0.1, slope=1.9, limit=1.8), True), (row(error=0.1, slope=1.7, limit=1.8), False)])
def test_limits_of_errors_and_of_orders(made, passed):
    assert made.passed is passed


def test_summary_shows_the_worst_of_each_criterion_and_what_fails():
    wrong = row(error=3e-7, kernel="element_b")
    rows = [row(), wrong, row("order", 0.1, 2.2, 1.8), row("order", 0.01, 1.9, 1.8, "element_c"),
            row("size", 0.5, None, float("inf"))]
    head, force, order, size, empty, titles, failed = check.summary(rows).splitlines()
    assert head.split() == ["criterion", "count", "worst", "limit", "kernel"]
    assert force.split() == ["force", "2", "3.0e-07", "1e-07", "element_b"]
    assert order.split() == ["order", "2", "order", "1.90", ">", "1.8", "element_c"]
    assert size.split() == ["size", "1", "5.0e-01", "none", "element_a"]
    assert not empty and titles.startswith("kernel")
    assert failed.split() == ["element_b", "force", "0", "3.0e-07", "1e-07", "FAILED"]
    assert check.verdict(rows) == "1 of 4 criteria fail"
    rows.remove(wrong)
    assert "FAILED" not in check.summary(rows) and "kernel  " not in check.summary(rows)
    assert check.verdict(rows) == "3 criteria of 2 kernels hold"


def test_an_error_that_is_no_number_is_the_worst():
    rows = [row(error=1.0), row(error=float("nan"), kernel="element_b"), row(error=2.0)]
    assert "nan" in check.summary(rows).splitlines()[1]
