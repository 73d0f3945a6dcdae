"""The scheme as the loop runs it: amplification, damping, periods, and constrained directions."""

import numpy as np
import pytest

from sebody import Model, Simulation, generalized_alpha, hht
from sebody.fem import Section, planar_beam
from sebody.reduction import craig_bampton
from sebody.scenes import hinged_beam, planar_hinged_beam

SECTION = Section(area=1.0, inertia_y=1.0, inertia_z=1.0, torsion=2.0, youngs_modulus=100.0,
                  poisson_ratio=0.3, density=1.0)


def oscillator(scheme, omega_h):
    """A clamped body with one internal mode: a linear oscillator; h is what omega h demands."""
    model = Model(planar=True)
    ends = model.node("a", (0, 0)), model.node("b", (10.0, 0))
    body = craig_bampton(planar_beam((0, 0), (10.0, 0), SECTION, 2), [(0, "full"), (2, "full")], 2)
    model.superelement("body", body, ends, stiffening=False)    # which is not linear
    model.fix("a")
    body = model.bodies["body"].reduced
    omega = np.sqrt(body.stiffness[-2, -2] / body.mass[-2, -2])
    for node in ends:
        node.position.fixed = True
    ends[1].rotation.fixed = True
    return Simulation(model, omega_h / omega, scheme), omega


def amplification(scheme, omega_h):
    """Matrix of one step in (q, h v, h^2 auxiliary acceleration), from three runs of the loop."""
    columns = []
    for k in range(3):
        run, omega = oscillator(replace_tolerance(scheme), omega_h)
        s, h = run.state, run.h
        parts = s.q, s.v, s.aux
        for part, scale in zip(parts, (1.0, 1.0 / h, 1.0 / h**2), strict=True):
            part[:2] = 0.0
            if part is parts[k]:
                part[0] = scale
        s.a[0] = -omega**2 * s.q[0]
        run.run_to(h)
        columns.append([s.q[0], s.v[0] * h, s.aux[0] * h**2])
    return np.array(columns).T


def replace_tolerance(scheme):
    return scheme._replace(tolerance=1e-13)


def closed_form(scheme, omega_h):
    """Matrix of one step of ``x'' + omega^2 x = 0`` in (x, h v, h^2 vdot, h^2 a), row by row.

    Written out from the scheme's own equations, independent of the loop.
    """
    am, af, beta, gamma = scheme[:4]
    w2 = omega_h**2
    # unknowns x1, v1, vdot1, a1 from x0, v0, vdot0, a0 (h = 1)
    left = np.array([[1, 0, 0, -beta], [0, 1, 0, -gamma], [w2, 0, 1, 0],
                     [0, 0, -(1 - af), 1 - am]])
    right = np.array([[1, 1, 0, 0.5 - beta], [0, 1, 0, 1 - gamma], [0, 0, 0, 0],
                      [0, 0, af, -am]])
    return np.linalg.solve(left, right)


@pytest.mark.parametrize("scheme, omega_h, expected", [
    (hht(0.0), 1.0, 1.0), (hht(-0.05), 1.0, 0.996490), (hht(-0.1), 2.0, 0.962366),
    (hht(-0.3), 10.0, 0.684611), (hht(-1 / 3), 100.0, 0.537174),
    (generalized_alpha(0.9), 5.0, 0.994792), (generalized_alpha(0.8), 10.0, 0.929792),
    (generalized_alpha(0.0), 1.0, 0.906563)])
def test_spectral_radius_against_closed_forms(scheme, omega_h, expected):
    radius = np.abs(np.linalg.eigvals(closed_form(scheme, omega_h))).max()
    assert radius == pytest.approx(expected, abs=2e-6)


RADII = {   # benchmarks 9.1, at omega h = 0.1, 0.5, 1, 2, 5, 10, 100
    -0.05: (0.999999, 0.999691, 0.996490, 0.978268, 0.932216, 0.913168, 0.904853),
    -0.1: (0.999999, 0.999450, 0.993847, 0.962366, 0.877913, 0.837803, 0.818402),
    -0.3: (0.999998, 0.999019, 0.989384, 0.937486, 0.787562, 0.684611, 0.549487),
    0.0: (1.0,) * 7,
}
RADII_RHO = {
    0.0: (0.999952, 0.984243, 0.906563, 0.707107, 0.398989, 0.242536, 0.047831),
    0.8: (1.0, 0.999960, 0.999475, 0.995286, 0.967909, 0.929792, 0.834638),
    0.9: (1.0, 0.999996, 0.999942, 0.999438, 0.994792, 0.983763, 0.928449),
}
CASES = [(hht(alpha), radii) for alpha, radii in RADII.items()] + [
    (generalized_alpha(rho), radii) for rho, radii in RADII_RHO.items()]


@pytest.mark.parametrize("scheme, radii", CASES, ids=[*map(str, RADII), *map(str, RADII_RHO)])
def test_spectral_radius(scheme, radii):
    for omega_h, radius in zip((0.1, 0.5, 1, 2, 5, 10, 100), radii, strict=True):
        values = np.linalg.eigvals(amplification(scheme, omega_h))
        assert np.abs(values).max() == pytest.approx(radius, abs=2e-6)


@pytest.mark.parametrize("alpha, omega_h, damping, elongation", [
    (-0.1, 0.5, 1.128789e-3, 2.540631e-2), (-0.3, 0.5, 2.022564e-3, 3.005029e-2),
    (-0.1, 1.0, 6.754746e-3, 9.450001e-2), (0.0, 0.5, 0.0, 2.049704e-2),
    (0.0, 1.0, 0.0, 7.840522e-2)])
def test_damping_and_period(alpha, omega_h, damping, elongation):
    values = np.linalg.eigvals(amplification(hht(alpha), omega_h))
    principal = values[np.argmax(values.imag)]
    rate, turn = -np.log(abs(principal)), np.angle(principal)
    assert rate / np.hypot(rate, turn) == pytest.approx(damping, abs=5e-9)
    assert omega_h / turn - 1.0 == pytest.approx(elongation, rel=1e-5)


def test_leading_terms():
    """xi = -a (1 + a)^2 (omega h)^3 / 8, dT/T = (omega h)^2 (1/12 - a (2 + 3 a) / 8)."""
    alpha, omega_h = -0.2, 0.05
    values = np.linalg.eigvals(amplification(hht(alpha), omega_h))
    principal = values[np.argmax(values.imag)]
    assert -np.log(abs(principal)) / np.angle(principal) == pytest.approx(
        -alpha * (1 + alpha)**2 * omega_h**3 / 8, rel=5e-3)
    assert omega_h / np.angle(principal) - 1 == pytest.approx(
        omega_h**2 * (1 / 12 - alpha * (2 + 3 * alpha) / 8), rel=5e-3)


# constrained directions (benchmarks 9.2)

def held(scheme, push, steps, h=0.01):
    """Velocities and auxiliary accelerations across a slider, after a push it does not allow."""
    model = Model(planar=True)
    node = model.node("ball", (0.0, 0.0), "translation")
    model.point_mass("mass", node, 2.0)
    model.slider(node, (1.0, 0.0))
    run = Simulation(model, h, replace_tolerance(scheme))
    assert run.numbering.multipliers
    run.state.v[1] = push
    found = []
    for k in range(1, steps + 1):
        run.run_to(k * h)
        assert abs(run.state.q[1]) < 1e-12      # linear: within the tolerance after one correction
        found.append((h * run.state.v[1], h * h * run.state.aux[1]))
    return np.array(found)


@pytest.mark.parametrize("scheme", [hht(0.0), hht(-0.05), hht(-0.1), hht(-0.3), hht(-1 / 3),
                                    generalized_alpha(0.9)], ids=str)
def test_powers_of_the_matrix_of_constrained_directions(scheme):
    beta, gamma = scheme.beta, scheme.gamma
    T = np.array([[1 - gamma / beta, 1 - gamma / (2 * beta)], [-1 / beta, 1 - 1 / (2 * beta)]])
    found, state = held(scheme, 1e-3, 40), np.array([1e-5, 0.0])
    for k in range(40):
        state = T @ state
        # powers that pass through zero: 1e-10 of the push, h v = 1e-5
        assert found[k] == pytest.approx(state, rel=1e-7, abs=1e-12 * 1e-3)


def test_weak_instability_without_damping():
    """alpha = 0: h^2 a = (-1)^n 4 n h v_0, growing for ever; damping makes it die out."""
    found, n = held(hht(0.0), 1e-3, 100), np.arange(1, 101)
    assert found[:, 1] == pytest.approx((-1.0)**n * 4 * n * 1e-5, rel=1e-6)
    damped = np.abs(held(hht(-0.1), 1e-3, 100)[:, 1])
    assert damped.max() < 1e-4 and damped[-1] < 1e-6 * damped.max()


def test_index_2_has_no_such_motion():
    """A velocity that the constraint forbids is taken away in the first step."""
    # solved for by one linear equation: 1e-10 of the push, h v = 1e-5
    assert np.abs(held(hht(0.0, index=2), 1e-3, 20)[:, 0]).max() < 1e-15


@pytest.mark.parametrize("scene, steps", [(hinged_beam, 100_000), (planar_hinged_beam, 300_000)])
def test_the_energy_of_two_bodies_does_not_drift(scene, steps):
    """What Newton's iteration leaves must not have one sign; a million steps may gain 1e-5."""
    run = Simulation(scene.build(bodies=2).model, 0.01, output_every=1000).run_to(0.01 * steps)
    result = run.result()
    free = result.t > 7.5       # when the torque has ended
    energy = (result["energy.kinetic"] + result["energy.strain"])[free]
    assert np.abs(energy - energy[0]).max() < 1e-5 * energy[0]
    assert result.iterations_per_step < 2.05
