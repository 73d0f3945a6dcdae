"""Shock spectra against integration in time and closed forms; combination of modes."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import solve_ivp
from scipy.linalg import solve_continuous_lyapunov

from sebody import InputError, Model, simulate
from sebody.analysis import combined, effective_masses, equilibrium, shock_spectrum, vibrations

T, PEAK = 0.011, 300.0      # a half sine of 11 ms


def test_a_half_sine_without_damping():
    """Largest response ``u / (u - 1) sin(2 pi / (u + 1))`` during the pulse, ``u = 2 f T`` above 1,
    and ``2 u / (1 - u^2) cos(pi u / 2)`` after it, below 1 (Harris, Shock and Vibration Handbook).
    """
    t = np.linspace(0.0, T, 4001)
    u = np.array([0.05, 0.3, 0.7, 1.3, 1.9, 2.5, 2.9])
    found = shock_spectrum(t, PEAK * np.sin(np.pi * t / T), u / (2 * T), 0.0)
    expected = np.where(u < 1, 2 * u / (1 - u**2) * np.cos(np.pi * u / 2),
                        u / (u - 1) * np.sin(2 * np.pi / (u + 1)))
    # the history between the rows is off by (pi / 4000)^2 / 8; peaks by 4e-6
    assert_allclose(found.acceleration, PEAK * expected, rtol=5e-6)
    assert_allclose(found.displacement, PEAK * expected / (np.pi * u / T)**2, rtol=5e-6)


@pytest.mark.parametrize("ratio", [0.0, 0.05, 0.6, 0.97])
def test_any_history(ratio):
    """Unequal steps, a first and a last row that are not zero, peaks after the end."""
    random = np.random.default_rng(3)
    t = np.cumsum(random.uniform(0.02, 0.3, 12)) - 1.0
    a = random.normal(size=12)
    frequencies = np.array([0.05, 0.4, 1.7, 6.0])
    found = shock_spectrum(t, a, frequencies, ratio)
    for k, w in enumerate(2 * np.pi * frequencies):
        state, largest = np.zeros(2), np.zeros(2)
        ends = np.append(t, t[-1] + 2 * np.pi / w)
        for i in range(12):
            def rate(time, y, i=i, w=w):
                base = np.interp(time, t, a) if i < 11 else 0.0
                return y[1], -base - 2 * ratio * w * y[1] - w * w * y[0]
            times = np.linspace(ends[i], ends[i + 1], 2001)
            x, v = solve_ivp(rate, ends[i:i + 2], state, "DOP853", times, rtol=1e-10,
                             atol=1e-13).y
            largest = np.maximum(largest, [np.abs(2 * ratio * w * v + w * w * x).max(),
                                           np.abs(x).max()])
            state = np.array([x[-1], v[-1]])
        # the peak between points of the integration, a thousandth of a radian or two apart
        assert_allclose([found.acceleration[k], found.displacement[k]], largest, rtol=2e-5)


def test_steps_need_not_be_fine():
    """A triangle by its corners, or by many rows."""
    fine = np.linspace(0.0, 1.0, 1201)
    one = shock_spectrum([0.0, 0.5, 1.0], [0.0, 4.0, 0.0], [0.3, 2.0, 70.0])
    other = shock_spectrum(fine, 4 - 8 * np.abs(fine - 0.5), [0.3, 2.0, 70.0])
    assert_allclose(one.acceleration, other.acceleration, rtol=1e-5)
    assert one.acceleration[2] == pytest.approx(4.0, rel=0.01)      # stiff ones follow the base


def test_peaks_of_a_model():
    """Factors times shapes times a spectrum are the peaks of a run, against its base."""
    model, e, h = Model(), np.array([0.6, 0.0, 0.8]), 2e-3
    ground, mass = model.node("ground", (1.0, 2.0, 0.5)), model.node("mass", (1.0, 2.0, 0.5))
    model.fix(ground)
    model.rigid_body("weight", mass, 3.0, np.diag([0.1, 0.2, 0.25]))
    model.bushing(mass, ground, (900.0, 500.0, 2500.0), turning_stiffness=60.0)
    t, a = np.array([0.0, 0.1, 0.25, 0.4]), np.array([0.0, 2.0, -1.0, 0.0])
    run = equilibrium(model, 1)
    own = vibrations(run)
    peaks = shock_spectrum(t, a, own.frequency, 0.0).displacement
    factors = effective_masses(run).factors @ e
    each = (own.shape("mass.position") * factors * peaks).T     # (modes, 3)
    model.force("mass", -3.0 * e, np.column_stack([t, a]), name="inertia")
    moved = simulate(model, h, 1.2)["mass.position"] - (1.0, 2.0, 0.5)
    # a mode along each axis; the scheme's period error leaves 1e-3 of the peaks
    assert_allclose(combined(each, own.frequency), np.abs(moved).max(axis=0), rtol=3e-3, atol=1e-9)


VALUES = np.array([[3.0, 1.0], [-4.0, 2.0], [1.5, 0.0]])


def test_far_apart_cqc_is_srss():
    far = [1.0, 1e4, 1e8]
    roots = np.sqrt(np.sum(VALUES**2, axis=0))
    assert_allclose(combined(VALUES, far), roots, rtol=1e-14)
    assert_allclose(combined(VALUES, far, 0.02, "CQC"), roots, rtol=1e-6)


def test_equal_modes_add_up():
    assert combined([3.0, 4.0], [5.0, 5.0], 0.01, "CQC") == pytest.approx(7.0, rel=1e-14)
    assert combined([3.0, -4.0], [5.0, 5.0], 0.01, "CQC") == pytest.approx(1.0, rel=1e-13)
    assert combined([3.0, 4.0], [5.0, 5.0], 0.01) == pytest.approx(5.0, rel=1e-14)


def test_correlations_are_those_of_white_noise():
    """Covariances of oscillators by Lyapunov's equation."""
    w, z = np.array([2.0, 2.3, 3.1]), np.array([0.05, 0.02, 0.2])
    A = np.block([[np.zeros((3, 3)), np.eye(3)], [-np.diag(w**2), -2 * np.diag(z * w)]])
    push = np.append(np.zeros(3), np.ones(3))
    P = solve_continuous_lyapunov(A, -np.outer(push, push))[:3, :3]
    size = np.sqrt(np.diag(P))
    expected = np.sqrt(np.einsum("ik,ij,jk->k", VALUES, P / np.outer(size, size), VALUES))
    assert_allclose(combined(VALUES, w, z, "CQC"), expected, rtol=1e-12)
    by_formula = (8 * 0.05**2 * (1 + 0.8) * 0.8**1.5
                  / ((1 - 0.8**2)**2 + 4 * 0.05**2 * 0.8 * (1 + 0.8)**2))     # of equal damping
    assert combined([1.0, 1.0], [0.8, 1.0], 0.05, "CQC")**2 == pytest.approx(2 + 2 * by_formula)


def test_what_is_refused():
    for arguments, said in (
            (([0.0, 0.0], [1.0, 1.0], [1.0]), "ascending"), (([0.0], [1.0], [1.0]), "two times"),
            (([0.0, 1.0], [1.0], [1.0]), "acceleration"), (([0.0, 1.0], [1.0, 0.0], [0.0]),
             "positive"),
            (([0.0, 1.0], [1.0, 0.0], [1.0], 1.0), "damping"),
            (([0.0, 1e3], [1.0, 0.0], [1e6]), "leave out the highest")):
        with pytest.raises(InputError, match=said):
            shock_spectrum(*arguments)
    for arguments, said in (
            (([1.0, 2.0], [1.0]), "frequencies"), (([1.0], [-1.0]), "positive"),
            (([1.0], [1.0], 0.05, "ABS"), "rule"), (([1.0], [1.0], 0.0, "CQC"), "CQC needs"),
            (([1.0], [1.0], [-0.1]), "negative"), ((3.0, [1.0]), "row of finite peaks")):
        with pytest.raises(InputError, match=said):
            combined(*arguments)
