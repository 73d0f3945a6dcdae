"""Errata of the paper: the printed form fails where the derived form passes."""

import importlib.util

import numpy as np
import pytest
import sympy as sp
from scipy.spatial.transform import Rotation

from sebody import Simulation, check, generalized_alpha
from sebody.derive import inertia, superelement
from sebody.derive.emit import superelement_text
from sebody.derive.layouts import Layout
from sebody.kernels import load
from sebody.scenes.hinged_beam import build

KERNEL = "superelement_f2_converged_mean_b"


def skew(a):
    return np.array([[0, -a[2], a[1]], [a[2], 0, -a[0]], [-a[1], a[0], 0]])


def inverse_tangent(psi):
    t = np.linalg.norm(psi)
    e = (1 - t / 2 / np.tan(t / 2)) / t**2
    return np.eye(3) + skew(psi) / 2 + e * skew(psi) @ skew(psi)


class PaperMatrices:
    """The matrices of (47)-(51) and (59)-(63) for two full nodes, from the state alone."""

    def __init__(self, case, option="b"):
        n = case.n
        alpha = case.constants[4:6]
        self.M = case.constants[-n * n:].reshape(n, n)
        nodes = Rotation.from_matrix(case.R.reshape(2, 3, 3))
        R0 = check._mean_rotation(case).reshape(3, 3)
        psi = (Rotation.from_matrix(R0).inv() * nodes).as_rotvec()
        parts = [a * inverse_tangent(p) for a, p in zip(alpha, psi, strict=True)]
        B = sum(part.T for part in parts)
        self.U = np.zeros((3, n))
        for j, part in enumerate(parts):
            self.U[:, 6 + 3 * j:9 + 3 * j] = np.linalg.solve(B, part)
        self.P, self.V, self.V1 = np.eye(n), np.zeros((n, 3)), np.zeros((n, 3))
        self.O0, self.OB, self.last = (np.zeros((n, n)) for _ in range(3))
        Om0 = self.U @ case.v
        self.option = option
        for i in (0, 3):
            self.P[i:i + 3, i:i + 3] = R0.T
        for j, R in zip((6, 9), nodes.as_matrix() if option == "a" else (), strict=False):
            self.P[j:j + 3, j:j + 3] = R0.T @ R
        ydot = self.P @ case.v
        p = self.M @ ydot
        for i in (0, 3, 6, 9) if option == "a" else (0, 3):
            self.V[i:i + 3] = skew(ydot[i:i + 3])
            self.V1[i:i + 3] = -skew(p[i:i + 3])
            self.O0[i:i + 3, i:i + 3] = skew(Om0)
        for j in (6, 9):
            self.OB[j:j + 3, j:j + 3] = skew(ydot[j:j + 3])
            self.last[j:j + 3, j:j + 3] = skew(p[j:j + 3])

    def pseudo_damping(self, sign_V1=1.0, last_transposed=False):
        """C1 + C2 + C3 of (61)-(62), with the derived signs unless told otherwise."""
        P, M, V, U, V1 = self.P, self.M, self.V, self.U, sign_V1 * self.V1
        C1 = P.T @ (self.O0 @ M + M @ self.O0.T) @ P
        C2 = (P.T @ (M @ V + V1) @ U
              - U.T @ (V1.T + V.T @ M) @ (P.T if last_transposed else P))
        C3 = (self.OB @ M @ P - self.last if self.option == "b" else
              P.T @ (self.last - self.OB @ M) @ P)
        return C1 + C2 + C3


@pytest.fixture(scope="module", params=["a", "b"])
def state(request):
    case = check.superelement_case(load(KERNEL[:-1] + request.param), 11)
    differences = [(check.evaluate(case._replace(v=case.v + d), 0)[0]
                    - check.evaluate(case._replace(v=case.v - d), 0)[0]) / 2
                   for d in np.eye(case.n)]
    return case, PaperMatrices(case, request.param), np.array(differences).T


def test_erratum_4_velocity_tangent(state):
    """(50)-(51), (62)-(63): the last factor of C2 is P, V1 is minus the skew of the momentum."""
    _, paper, exact = state
    assert check.difference(paper.pseudo_damping(), exact) < 1e-7
    assert check.difference(paper.pseudo_damping(sign_V1=-1.0), exact) > 1e-2
    assert check.difference(paper.pseudo_damping(last_transposed=True), exact) > 1e-2


def test_erratum_4_last_term_of_C3(state):
    """(50): the last term is P^T diag(skew(p_psi)) P; printed without transpose and right P."""
    _, paper, exact = state
    if paper.option == "a":
        printed = (paper.pseudo_damping() - paper.P.T @ paper.last @ paper.P
                   + paper.P @ paper.last)
        assert check.difference(printed, exact) > 1e-2


def test_mass_48_60(state):
    case, paper, _ = state
    J = check.evaluate(case, 1, (1, 0, 0, 1, 1))[1]
    assert check.difference(J, paper.P.T @ paper.M @ paper.P) < 1e-12


def test_erratum_1_power_balance(state):
    """(45), (57): with the frame term -U^T V^T Mbar ydot the force does the work T gains."""
    case, paper, _ = state
    case = check.without(case, "stiffness")
    power = check.evaluate(case, 0)[0] @ case.v
    gain = check.derivative(
        lambda t: check.evaluate(check.along_path(case, t), 2)[2][0], 0.01)
    assert power == pytest.approx(gain, rel=1e-9)
    frame_term = -paper.U.T @ paper.V.T @ paper.M @ paper.P @ case.v
    printed = power - 2.0 * frame_term @ case.v
    assert abs(printed / gain - 1.0) > 1e-3


def printed_kernel(tmp_path, monkeypatch):
    """The kernel with the frame term of (57) as printed, with a plus."""
    right = inertia.position_part

    def printed(q):
        stage, force, on_frame = right(q)
        return stage, force, -on_frame
    monkeypatch.setattr(inertia, "position_part", printed)
    superelement._derived.cache_clear()
    text = superelement_text(superelement.superelement(Layout.parse("f2"), "converged_mean", "b"))
    superelement._derived.cache_clear()
    path = tmp_path / "printed_sign.py"
    path.write_text(text)
    spec = importlib.util.spec_from_file_location("printed_sign", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def energy_spread(kernel, h):
    """Spread of the energy of the freely spinning hinged beam, 8 < t < 12."""
    scene = build()
    if kernel:
        scene.model.bodies["beam"].kernel = kernel
    result = Simulation(scene.model, h, generalized_alpha(0.9, 1e-10)).run_to(12.0).result()
    energy = (result["energy.kinetic"] + result["energy.strain"])[result.t > 8.0]
    return np.ptp(energy) / energy.mean()


def test_erratum_1_energy(tmp_path, monkeypatch):
    """Energy of the free beam converges as h^2; with the printed sign it does not converge."""
    printed = printed_kernel(tmp_path, monkeypatch)
    steps = (0.01, 0.005, 0.0025)
    derived = [energy_spread(None, h) for h in steps]
    wrong = [energy_spread(printed, h) for h in steps]
    assert derived[0] > 2.5 * derived[1] > 6.0 * derived[2]
    assert wrong[2] > 0.7 * wrong[0]
    assert wrong[2] > 5.0 * derived[2]


def small_form(psi, alpha, i, minus):
    """Rows of Upsilon_psi of (29) for node i; printed without the minus sign."""
    blocks = []
    for j, (p, a) in enumerate(zip(psi, alpha, strict=True)):
        off = a * (np.eye(3) + (skew(p) - skew(psi[i])) / 2)
        own = np.eye(3) + skew(psi[i]) / 2
        blocks.append((own if j == i else 0) - off if minus else
                      (own - off if j == i else off))
    return np.hstack(blocks)


def elastic_rotations(nodes, reference, alpha):
    """psi of the paper's mean frame, from scipy's rotation vectors."""
    beta = (reference.inv() * nodes).as_rotvec()
    return ((reference * Rotation.from_rotvec(alpha @ beta)).inv() * nodes).as_rotvec()


def psi_derivative(nodes, reference, alpha):
    """Derivatives of the first node's elastic rotation along all node rotations."""
    def psi(step, d):
        return elastic_rotations(nodes * Rotation.from_rotvec(step * d.reshape(2, 3)), reference,
                                 alpha)[0]
    return np.array([check.derivative(lambda s, d=d: psi(s, d), 0.01) for d in np.eye(6)]).T


@pytest.mark.parametrize("minus, order", [(True, 2), (False, 0)])
def test_erratum_3_off_diagonal_sign(minus, order):
    """(29): the off-diagonal blocks carry a minus; then (20) is off by second order in psi."""
    alpha, random = np.array([0.4, 0.6]), np.random.default_rng(2)
    direction = random.normal(size=3)
    sizes, errors = np.array([0.2, 0.1, 0.05]), []
    for size in sizes:
        psi = size * np.array([direction, -direction * 2 / 3])
        nodes, reference = Rotation.from_rotvec(psi), Rotation.identity()
        exact = psi_derivative(nodes, reference, alpha)
        errors.append(np.abs(small_form(psi, alpha, 0, minus) - exact).max())
    slope = np.polyfit(np.log(sizes), np.log(errors), 1)[0]
    assert slope == pytest.approx(order, abs=0.25)


def test_errata_2_and_5_tilde_over_the_product():
    """(20), (28): only skew(R0^T (x_i - x0)) makes du_i/dTheta; R0^T skew(x_i - x0) does not."""
    R0 = Rotation.from_rotvec([0.4, -0.7, 0.5]).as_matrix()
    d = np.array([1.0, 2.0, -0.5])
    exact = np.array([check.derivative(lambda s, e=e: (
        R0 @ Rotation.from_rotvec(s * e).as_matrix()).T @ d, 0.01) for e in np.eye(3)]).T
    assert np.abs(skew(R0.T @ d) - exact).max() < 1e-12
    assert np.abs(R0.T @ skew(d) - exact).max() > 0.1


def test_erratum_6_left_hand_side_of_52():
    """(52): T is made of Omega_i, not of its rate: a steady spin has energy though no rate."""
    case = check.without(check.superelement_case(load(KERNEL), 1), "stiffness")
    v = np.zeros(case.n)
    v[6:12] = 1.0
    spinning = case._replace(v=v, a=0 * case.a)
    assert check.evaluate(spinning, 2)[2][0] > 0.1


def test_wrong_formula_stops_the_derivation(monkeypatch):
    """A hand form with a wrong sign fails in the derivation, before anything is emitted."""
    from sebody.derive import kinematics
    from sebody.derive.variation import DerivationError
    monkeypatch.setattr(kinematics, "inverse_tangent_transposed_times",
                        lambda psi, b: b + sp.Matrix(3, 1, [0, 0, 1]))
    superelement._derived.cache_clear()
    with pytest.raises(DerivationError, match="variation of the elastic rotation .17."):
        superelement.superelement(Layout.parse("f2"), "converged_mean", "b")
    superelement._derived.cache_clear()
