"""The consistency check: every kernel passes, and a wrong one does not."""

import numpy as np
import pytest

from sebody import InputError, check
from sebody.kernels import load


@pytest.mark.parametrize("name", check.kernel_names())
def test_kernel_is_consistent(name):
    rows = check.check_kernels([name])
    assert len(rows) >= 4
    failed = [row for row in rows if not row.passed]
    assert not failed, check.format_table(failed)
    assert all(row.error <= 1e-7 for row in rows if row.slope is None)


def test_small_increments_differ_to_second_order():
    rows = [r for r in check.check_kernels(["superelement_f2_mean_small_b"]) if r.slope]
    assert rows and all(1.8 < row.slope < 2.3 and row.error > 1e-5 for row in rows)


def test_spin_of_small_increments_differs_to_second_order():
    """U of (44) against U of (19) at beta_0 = 0, through the inertia that W carries."""
    small, exact = (load(f"superelement_f2_{frame}_b") for frame in ("mean_small", "mean"))
    errors, sizes = [], (0.2, 0.1, 0.05)
    for psi in sizes:
        case = check.without(check.superelement_case(exact, 3, psi), "stiffness")
        case = case._replace(reference=check._mean_rotation(case))
        forces = [check.evaluate(case._replace(module=m), 0)[0] for m in (small, exact)]
        errors.append(np.abs(forces[0] - forces[1]).max())
    slope = np.polyfit(np.log(sizes), np.log(errors), 1)[0]
    assert 1.8 < slope < 2.2


@pytest.mark.parametrize("criterion", [*check.EXACT_FORCE.values(), *check.TANGENTS.values()])
def test_check_notices_a_wrong_kernel(criterion, monkeypatch):
    """One force component off by a millionth, or one matrix entry: the criterion must see it."""
    case = check.superelement_case(load("superelement_planar_f2_converged_mean_b"), 0)
    right = check.evaluate

    def wrong(case, task, coefficients=(0, 0, 0, 1, 1)):
        g, J, energy = right(case, task, coefficients)
        g[2] *= 1.0 + 1e-5 * (1 + case.q[2] ** 2)
        J[2, 3] *= 1.001
        return g, J, energy
    assert criterion(case) <= check.LIMIT
    monkeypatch.setattr(check, "evaluate", wrong)
    assert criterion(case) > check.LIMIT


def test_planar_kernel_equals_the_spatial_one_on_planar_states():
    """Positions, angles and matrices embedded in space; equal to rounding."""
    planar = load("superelement_planar_f2_converged_mean_b")
    spatial = load("superelement_f2_converged_mean_b")
    flat = check.superelement_case(planar, 5)
    keep = [0, 1, 3, 4, 8, 11, 12, 13, 14]      # of x, y, z; x, y, z; rotations; modes
    n, end = 15, len(flat.constants) - 2 * 81
    S, M = np.eye(15), np.eye(15)
    S[np.ix_(keep, keep)] = flat.constants[end:end + 81].reshape(9, 9)
    M[np.ix_(keep, keep)] = flat.constants[end + 81:].reshape(9, 9)
    X = np.zeros((2, 3))
    X[:, :2] = flat.constants[6:10].reshape(2, 2)
    constants = np.concatenate([flat.constants[:6], X.ravel(), S.ravel(), M.ravel()])
    q, v, a = np.zeros((3, n))
    q[keep], v[keep], a[keep] = flat.q, flat.v, flat.a
    R = np.concatenate([[np.cos(t), -np.sin(t), 0, np.sin(t), np.cos(t), 0, 0, 0, 1]
                        for t in flat.q[4:6]])
    case = check.Case(spatial, n, np.array([0, 0, n, 0, 1, *range(n)]), constants, q, R, v, a,
                      flat.reference, flat.frames)
    for coefficients in ((1.0, 0.3, 2.0, 1, 1), (0, 0, 1, 0, 1)):
        forces, matrices = zip(*[check.evaluate(c, 1, coefficients)[:2] for c in (flat, case)],
                               strict=True)
        assert check.difference(forces[0], forces[1][keep]) <= 1e-12
        assert check.difference(matrices[0], matrices[1][np.ix_(keep, keep)]) <= 1e-12


def test_unknown_kernel():
    with pytest.raises(InputError, match="kernel 'nothing' is unknown: there are element_"):
        check.check_kernels(["nothing"])
