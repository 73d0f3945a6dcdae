"""Errata of the paper: the printed form fails where the derived form passes.

What the paper prints is written here only, in numpy; sizes are those measured in these states.
"""

import numpy as np
import pytest
from helpers import order
from scipy.spatial.transform import Rotation

from sebody import Simulation, generalized_alpha
from sebody.derive.compiler import Variant, compile_kernel
from sebody.derive.formulas.inertia import option_b
from sebody.derive.kernels import linearize, superelement
from sebody.kernels.loader import load
from sebody.scenes.hinged_beam import build
from sebody.verify.check import definitions, states, superelements

KERNEL = "superelement_f2_converged_mean_material"


def skew(a):
    return np.array([[0, -a[2], a[1]], [a[2], 0, -a[0]], [-a[1], a[0], 0]])


def tangent(psi):
    t = np.linalg.norm(psi)
    a = skew(psi)
    return np.eye(3) - (1 - np.cos(t)) / t**2 * a + (t - np.sin(t)) / t**3 * a @ a


class PaperMatrices:
    """The matrices of (47)-(51) and (59)-(63) for two full nodes, from the state alone."""

    def __init__(self, case, option="material"):
        n = case.n
        constants = states.constants_of(case)
        alpha, self.M = constants["alpha_rs"], constants["M"]
        nodes = Rotation.from_matrix(case.R.reshape(2, 3, 3))
        R0 = definitions.mean_rotation(case).reshape(3, 3)
        psi = (Rotation.from_matrix(R0).inv() * nodes).as_rotvec()
        parts = [a * np.linalg.inv(tangent(p)) for a, p in zip(alpha, psi, strict=True)]
        B = sum(part.T for part in parts)
        self.U = np.zeros((3, n))
        for j, part in enumerate(parts):
            self.U[:, 6 + 3 * j:9 + 3 * j] = np.linalg.solve(B, part)
        self.P, self.V, self.V1 = np.eye(n), np.zeros((n, 3)), np.zeros((n, 3))
        self.O0, self.OB, self.last = (np.zeros((n, n)) for _ in range(3))
        self.Om0 = self.U @ case.v
        self.option = option
        for i in (0, 3):
            self.P[i:i + 3, i:i + 3] = R0.T
        for j, R in zip((6, 9), nodes.as_matrix() if option == "frame_axes" else (), strict=False):
            self.P[j:j + 3, j:j + 3] = R0.T @ R
        self.ydot = self.P @ case.v
        self.p = p = self.M @ self.ydot
        for i in (0, 3, 6, 9) if option == "frame_axes" else (0, 3):
            self.V[i:i + 3] = skew(self.ydot[i:i + 3])
            self.V1[i:i + 3] = -skew(p[i:i + 3])
            self.O0[i:i + 3, i:i + 3] = skew(self.Om0)
        for j in (6, 9):
            self.OB[j:j + 3, j:j + 3] = skew(self.ydot[j:j + 3])
            self.last[j:j + 3, j:j + 3] = skew(p[j:j + 3])

    def pseudo_damping(self, misprint=""):
        """C1 + C2 + C3 of (61)-(62) as derived, or with one of the paper's misprints."""
        P, M, V, U = self.P, self.M, self.V, self.U
        V1 = -self.V1 if misprint == "V1" else self.V1
        C1 = P.T @ (self.O0 @ M + M @ self.O0.T) @ P
        C2 = (P.T @ (M @ V + V1) @ U
              - U.T @ (V1.T + V.T @ M) @ (P.T if misprint == "C2" else P))
        if self.option == "material":
            return C1 + C2 + self.OB @ M @ P - self.last
        last = P @ self.last if misprint == "C3" else P.T @ self.last @ P
        return C1 + C2 - P.T @ self.OB @ M @ P + last


@pytest.fixture(scope="module", params=["frame_axes", "material"])
def state(request):
    """A generic state, its matrices, and differences of the force by the velocities.

    The force is quadratic in the velocities, so that central differences are exact.
    """
    kernel = load(KERNEL.removesuffix("material") + request.param)
    case = superelements.superelement_case(kernel, 11)
    differences = [(states.evaluate(case._replace(v=case.v + d), 0)[0]
                    - states.evaluate(case._replace(v=case.v - d), 0)[0]) / 2
                   for d in np.eye(case.n)]
    return case, PaperMatrices(case, request.param), np.array(differences).T


def test_erratum_4_derived_velocity_tangent(state):
    """(50)-(51), (62)-(63): last factor of C2 is P, V1 is minus the skew of the momentum."""
    case, paper, exact = state
    assert states.difference(paper.pseudo_damping(), exact) < 1e-7
    J = states.evaluate(case, 1, (0, 1, 0, 1, 1))[1]
    # equal but for rounding, of products of up to five matrices of 16 unknowns
    assert states.difference(J, paper.pseudo_damping()) < 1e-12


@pytest.mark.parametrize("misprint, sizes", [
    ("C2", {"frame_axes": 1.192, "material": 0.702}), ("V1",
                                                       {"frame_axes": 4.358, "material": 1.308}),
    ("C3", {"frame_axes": 0.452, "material": 0.0})])        # C3 of (62) is right as printed
def test_erratum_4_printed_velocity_tangent(state, misprint, sizes):
    """Printed: P^T ending C2, V1 = +skew, and in (50) a last term P diag(skew(p_psi)) of C3."""
    _, paper, exact = state
    error = states.difference(paper.pseudo_damping(misprint), exact)
    assert error == pytest.approx(sizes[paper.option], rel=0.01, abs=1e-7)


def test_mass_48_60(state):
    """(48), (60) are right as printed: ``P^T Mbar P``."""
    case, paper, _ = state
    J = states.evaluate(case, 1, (1, 0, 0, 1, 1))[1]
    assert states.difference(J, paper.P.T @ paper.M @ paper.P) < 1e-12      # as above


@pytest.fixture(scope="module")
def printed_kernel(tmp_path_factory):
    """The kernel of option B with the frame term of (57) as printed, with a plus."""
    right = option_b.position_part

    def printed(q):
        stage, force, on_frame = right(q)
        return stage, force, -on_frame

    def forget():
        superelement.node_formulas.cache_clear()
        linearize.node_tangent.cache_clear()

    forget()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(option_b, "position_part", printed)
        text = compile_kernel(Variant("f2", "converged_mean", "material"), shipped=False)
    forget()
    folder = tmp_path_factory.mktemp("kernels")
    (folder / "printed_sign.py").write_text(text)
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("SEBODY_KERNELS", str(folder))
        return load("printed_sign")


def power_and_gain(case):
    """Power of the inertia force and rate of the kinetic energy along a path."""
    case = superelements.without(case, "stiffness")
    gain = states.derivative(
        lambda t: states.evaluate(states.along_path(case, t), 2)[2][0], 0.003)
    return states.evaluate(case, 0)[0] @ case.v, gain


def test_erratum_1_power_balance(state):
    """(45), (57): with the frame term -U^T V^T Mbar ydot the force does the work T gains.

    The last line prints a plus, which misses the balance by twice the power of that term.
    """
    case, paper, _ = state
    power, gain = power_and_gain(case)
    assert power == pytest.approx(gain, rel=1e-9)
    term = -(paper.U.T @ paper.V.T @ paper.p) @ case.v
    assert abs((power - 2 * term) / gain - 1) > 1e-3


def test_erratum_1_power_of_the_printed_kernel(printed_kernel):
    """A kernel with the printed sign is off by exactly 2 W . Omega_0, W = sum of xdot* x p_x."""
    case = superelements.superelement_case(printed_kernel, 11)
    paper = PaperMatrices(case)
    power, gain = power_and_gain(case)
    W = sum(np.cross(paper.ydot[i:i + 3], paper.p[i:i + 3]) for i in (0, 3))
    assert power - gain == pytest.approx(-2 * W @ paper.Om0, rel=1e-7)
    assert abs(power / gain - 1) > 1e-2


def energy_spread(kernel, h):
    """Spread of the energy of the freely spinning hinged beam, 8 < t < 12."""
    scene = build(inertia="material")
    scene.model.bodies["beam"].kernel = kernel
    result = Simulation(scene.model, h, generalized_alpha(0.9, 1e-10)).run_to(12.0).result()
    energy = (result["energy.kinetic"] + result["energy.strain"])[result.t > 8.0]
    return np.ptp(energy) / energy.mean()


def test_erratum_1_energy(printed_kernel):
    """Energy of the free beam converges as h^2; with the printed sign it does not converge."""
    steps = (0.01, 0.005, 0.0025)
    derived = np.array([energy_spread(KERNEL, h) for h in steps])
    printed = np.array([energy_spread("printed_sign", h) for h in steps])
    assert (derived[:-1] / derived[1:] > 3.0).all()
    assert (printed[:-1] / printed[1:] < 1.3).all()
    assert printed[-1] > 20 * derived[-1]


def local_coordinates(x, nodes, reference, alpha):
    """(u, psi) of every node in the paper's mean frame (14)-(16), without the part X."""
    R0 = reference * Rotation.from_rotvec(alpha @ (reference.inv() * nodes).as_rotvec())
    return np.hstack([R0.inv().apply(x - alpha @ x), (R0.inv() * nodes).as_rotvec()])


def exact_upsilon(x, nodes, reference, alpha, i):
    """Derivatives of u_i and psi_i along all positions, then all rotations, by differences."""
    n = x.size

    def moved(d):
        return local_coordinates(x + d[:n].reshape(-1, 3),
                                 nodes * Rotation.from_rotvec(d[n:].reshape(-1, 3)), reference,
                                 alpha)[i]
    columns = [states.derivative(lambda s, d=d: moved(s * d), 0.01) for d in np.eye(2 * n)]
    return np.array(columns).T


def small_displacement_rows(x, psi, R0, alpha, i, misprint=""):
    """Rows Upsilon_iu of (28) as (20) demands, or with one of its misprints."""
    arm = x - alpha @ x
    on_x, on_theta = [], []
    for j, a in enumerate(alpha):
        r = arm[0] if misprint == "first block" and j == 0 else arm[i]
        tilde = R0.T @ skew(r) if misprint == "tilde" else skew(R0.T @ r)
        on_x.append(((i == j) - a) * R0.T)
        on_theta.append(a * tilde @ (np.eye(3) + skew(psi[j]) / 2))
    return np.hstack(on_x + on_theta)


def small_rotation_rows(psi, alpha, i, misprint=""):
    """Rows Upsilon_i,psi of (29) as (20) demands; printed without a minus off the diagonal."""
    blocks = []
    for j, a in enumerate(alpha):
        block = -a * (np.eye(3) + (skew(psi[j]) - skew(psi[i])) / 2)
        if i == j:
            block += np.eye(3) + skew(psi[i]) / 2
        elif misprint == "minus":
            block = -block
        blocks.append(block)
    return np.hstack([np.zeros((3, 3 * len(psi))), *blocks])


def orders(rows, misprint):
    """Order in psi of the error of Upsilon at the last node, where beta_0 = 0; and its size."""
    alpha, random = np.array([0.5, 0.2, 0.3]), np.random.default_rng(2)
    directions, x, turn = random.normal(size=(3, 3, 3))
    directions -= alpha @ directions        # beta_0 = 0
    base = Rotation.from_rotvec(turn[0])
    sizes, errors = np.array([0.1, 0.05, 0.025]), []
    for psi in (size * directions for size in sizes):
        exact = exact_upsilon(x, base * Rotation.from_rotvec(psi), base, alpha, 2)
        part, small = ((slice(0, 3), small_displacement_rows(x, psi, base.as_matrix(), alpha, 2,
                                                             misprint)) if rows == "u" else
                       (slice(3, 6), small_rotation_rows(psi, alpha, 2, misprint)))
        errors.append(np.abs(small - exact[part]).max())
    return order(sizes, errors), errors[-1]


@pytest.mark.parametrize("rows", ["u", "psi"])
def test_small_form_as_derived(rows):
    """(20) and with it (28), (29): first-order agreement with the exact variation (19)."""
    slope, error = orders(rows, "")
    assert slope == pytest.approx(2.0, abs=0.1)
    assert error < 1e-2


@pytest.mark.parametrize("rows, misprint", [("u", "tilde"), ("u", "first block"),
                                            ("psi", "minus")])
def test_errata_2_3_and_5_small_form_as_printed(rows, misprint):
    """Zeroth-order errors of the small form as printed.

    (20), (28): the tilde must cover the product R0^T (x_i - x0), printed over a factor or not at
    all; (28): the first block holds x_i - x0, printed x_1 - x0; (29): off-diagonal blocks carry a
    minus, printed without.
    """
    slope, error = orders(rows, misprint)
    assert slope == pytest.approx(0.0, abs=0.1)
    assert error > 0.1


def steady_turning(case, w):
    """The case in a rigid rotation about the origin with a constant angular velocity."""
    x, nodes = case.q[:6].reshape(2, 3), case.R.reshape(2, 3, 3)
    v = np.concatenate([*np.cross(w, x), *(R.T @ w for R in nodes), np.zeros(case.n - 12)])
    return case._replace(v=v)


def test_erratum_6_left_hand_side_of_52():
    """(52): T is made of Omega_i; the paper prints its rate, which is zero in steady rotation."""
    w = np.array([0.4, -0.3, 0.8])
    case = steady_turning(superelements.superelement_case(load(KERNEL), 1), w)
    paper = PaperMatrices(case)
    R = case.R[:9].reshape(3, 3)
    rate = states.derivative(
        lambda t: (Rotation.from_rotvec(t * w).as_matrix() @ R).T @ w, 0.01)
    kinetic = states.evaluate(case, 2)[2][0]
    printed = paper.ydot.copy()
    printed[6:12] = np.concatenate([rate, rate])
    assert np.abs(rate).max() < 1e-12       # differences over 0.01: EPS / 0.01 times ten
    assert kinetic == pytest.approx(paper.ydot @ paper.M @ paper.ydot / 2, rel=1e-12)
    assert abs(printed @ paper.M @ printed / 2 / kinetic - 1) > 1e-2


def test_erratum_7_rates_of_the_modes_in_53():
    """(53): ydot holds the rates of the internal modes, which the paper's column leaves out."""
    case = superelements.superelement_case(load(KERNEL), 1)
    paper = PaperMatrices(case)
    kinetic = states.evaluate(case, 2)[2][0]
    kept = paper.ydot[:12] @ paper.M[:12, :12] @ paper.ydot[:12] / 2
    assert kinetic == pytest.approx(paper.ydot @ paper.M @ paper.ydot / 2, rel=1e-12)
    assert abs(kept / kinetic - 1) > 1e-2


def test_erratum_7_variations_are_not_increments():
    """(12) against (26): the unknowns are increments, dTheta = T dPsi; equal only at zero."""
    increment = np.array([0.3, -0.2, 0.4])
    here = Rotation.from_rotvec(increment)
    columns = [states.derivative(
        lambda s, e=e: (here.inv() * Rotation.from_rotvec(increment + s * e)).as_rotvec(), 0.01)
        for e in np.eye(3)]
    # sixth-order differences over 0.01: 0.01^6 of a seventh derivative below ten, and EPS / 0.01
    assert np.abs(np.array(columns).T - tangent(increment)).max() < 1e-11
    assert np.abs(np.array(columns).T - np.eye(3)).max() > 0.1
