"""Turning equilibria, frequencies about them, damped and gyroscopic eigenvalues.

References: closed solutions and, for beams cut into linear bodies, the theory of
`sebody.verify.atlas`, which is itself compared with tabulated values.
"""

import numpy as np
import pytest
from helpers import order
from scipy.spatial.transform import Rotation

from sebody import Model, Simulation
from sebody.analysis import equilibrium, linearize, modes, vibrations
from sebody.fem import Section
from sebody.model.numbering import coordinates
from sebody.verify.atlas.theory import beck_load, cantilever, divergence, euler_load, flap

FLAP_6 = 7.360373019            # benchmarks 3.1, eta = 6
STEADY = {                      # benchmarks 2.3: u(L) at the undeformed radius, at the deformed one
    "simo": ((10.0, 2.8e7, 1.4e4, 1.2, 6.0), 5.142857e-4, 5.143175e-4),
    "kane": ((8.0, 5.0311e6, 566.69, 0.20188, 4.0), 1.095700e-4, 1.095718e-4),
    "square": ((0.5, 8e7, 2.667, 3.12, 3000.0), 0.014625, 0.0151572424),
}


def section(axial=1e7, bending=1.0, mass=1.0, torsion=100.0):
    """A section of area one with these stiffnesses and mass a length."""
    return Section(area=1.0, inertia_y=bending / axial, inertia_z=bending / axial,
                   torsion=2 * torsion * bending / axial, youngs_modulus=axial, poisson_ratio=0.0,
                   density=mass)


def turning(bodies, eta, frame="converged_mean", internal=0, elements=48, planar=False,
            inertia=None, **held):
    """A unit cantilever turning about its root, in equilibrium."""
    d = 2 if planar else 3
    model = Model(planar=planar)
    ends = model.node("root", np.zeros(d)), model.node("tip", np.eye(d)[0])
    model.beam("arm", ends, section(**held), elements, bodies, internal, frame=frame,
               inertia=inertia)
    model.fix("root")
    spin = eta if planar else (0.0, 0.0, eta)
    return equilibrium(model, 4, spin=spin), spin


TABLE = {   # benchmarks 4.1: spin of divergence, Euler and Beck loads
    ("node", 1): (3.51602, np.inf, np.inf), ("node", 2): (5.3793, 3.16515, 39.26),
    ("node", 4): (10.1013, 2.60779, 30.89), ("node", 8): (19.7814, 2.50041, 22.35),
    ("chord", 1): (9.8696, 3.0, np.inf), ("chord", 2): (25.704, 2.59666, 24.00),
    ("chord", 4): (69.161, 2.49927, 22.10), ("chord", 8): (190.5, 2.47534, 20.57)}
FLAP = {("node", 1): -52.2, ("node", 2): -23.2, ("node", 4): -5.53, ("node", 8): -1.25,
        ("chord", 1): -8.09, ("chord", 2): -3.30, ("chord", 4): -1.02, ("chord", 8): -0.27}


@pytest.mark.parametrize("frame, bodies", TABLE)
def test_theory_reproduces_the_tables(frame, bodies):
    beam = cantilever(bodies, frame)
    spin, euler, beck = TABLE[frame, bodies]
    assert divergence(beam) == pytest.approx(spin, rel=2e-3)
    assert euler_load(beam) == pytest.approx(euler, rel=1e-4)
    assert beck_load(beam) == pytest.approx(beck, rel=2e-3)
    assert 100 * (flap(beam, 6.0) / FLAP_6 - 1) == pytest.approx(FLAP[frame, bodies], abs=0.06)


@pytest.mark.parametrize("inertia", [None, "material"])
@pytest.mark.parametrize("case", STEADY)
def test_steady_extension(case, inertia):
    """2.3: bodies without axial modes tend to the value at the deformed radius, order 2.

    The load of a single one is ``rho A W^2 L^2 / 3``, but 0.35 of that with option B, which takes
    the momentum of the tip across the axis with the cubic shapes of bending.
    """
    (length, axial, bending, mass, speed), linear, exact = STEADY[case]
    a = speed * length * np.sqrt(mass / axial)
    assert exact == pytest.approx(length * (np.tan(a) / a - 1.0), rel=2e-5)     # the table's digits
    found, counts = [], (1, 4, 16)
    for n in counts:
        model = Model(planar=True)
        ends = model.node("root", (0, 0)), model.node("tip", (length, 0))
        model.beam("arm", ends, section(axial, bending, mass), n, inertia=inertia)
        model.fix("root")
        found.append(equilibrium(model, 4, spin=speed)["tip.position"][-1, 0] - length)
    rotary = mass * bending / axial
    pull, softening = speed**2 * mass * length**2 / 3, speed**2 * mass * length / 3
    if inertia == "material":
        pull = speed**2 * (0.35 * mass * length**2 + rotary)
        softening = speed**2 * (13 / 35 * mass * length + 1.2 * rotary / length)
    assert found[0] == pytest.approx(pull / (axial / length - softening), rel=1e-6)
    assert found[-1] == pytest.approx(exact, rel=3e-3)
    if case == "square":        # the others differ by less than the error of sixteen bodies
        assert abs(found[-1] - exact) < 0.1 * abs(found[-1] - linear)
    errors = np.abs(np.array(found) - length * (np.tan(a) / a - 1.0))
    assert 1.8 < order(1 / np.array(counts), errors) < 2.2


def test_a_turning_equilibrium_goes_on_turning():
    """Started from it, a simulation keeps its shape: nothing vibrates."""
    run, _ = turning(4, 3.0, planar=True, axial=1e3)
    arm = run.model
    arm.nodes["root"].rotation.fixed = False
    free = Simulation(arm, 0.002)
    for part in ("q", "v", "a"):
        for node in arm.nodes.values():
            for own in (node.position, node.rotation):
                if own in free.numbering.dof_blocks and own in run.numbering.dof_blocks:
                    to, of = free.numbering.dof_blocks[own], run.numbering.dof_blocks[own]
                    getattr(free.state, part)[to:to + own.start.size] = getattr(run.state, part)[
                        of:of + own.start.size]
    free.state.aux[:] = free.state.a
    result = free.run_to(1.0).result()
    radius = np.linalg.norm(result["tip.position"], axis=1)[1:]     # row 0 is the model's own
    assert radius[0] > 1.002
    assert radius == pytest.approx(np.full_like(radius, radius[0]), rel=2e-5)
    angle = np.unwrap(np.arctan2(*result["tip.position"].T[::-1]))
    assert angle == pytest.approx(3.0 * result.t, abs=2e-3)


@pytest.mark.parametrize("frame, theory", [("node", "node"), ("converged_mean", "mean")])
def test_flapping_converges_as_predicted(frame, theory):
    """3.1 at eta = 6: with the bodies, as the theory of linear bodies with option B says."""
    errors = {}
    for n in (2, 4, 8):
        found, spin = turning(n, 6.0, frame, internal=2, inertia="material")
        omega = modes(found, spin).omega
        predicted, exact_inertia = (flap(cantilever(n, theory), 6.0, b) for b in (True, False))
        near = omega[np.argmin(np.abs(omega - predicted))]
        assert near == pytest.approx(predicted, rel=2e-3)
        assert near == pytest.approx(exact_inertia, rel=0.03 if n == 2 else 2e-3)
        errors[n] = abs(near / FLAP_6 - 1)
    assert errors[8] < 0.013 and 1.7 < order((1 / 4, 1 / 8), (errors[4], errors[8])) < 2.3


@pytest.mark.parametrize("frame, theory", [("node", "node"), ("converged_mean", "mean")])
@pytest.mark.parametrize("bodies", [2, 4])
def test_spurious_divergence(frame, theory, bodies):
    """In the plane, with option B, at the spin that theory predicts and not before."""
    limit = divergence(cantilever(bodies, theory), option_b=True)
    for factor, stable in ((0.985, True), (1.015, False)):
        found, spin = turning(bodies, factor * limit, frame, planar=True, axial=1e8,
                              inertia="material")
        assert (modes(found, spin).growth.max() < 1e-3) == stable


def test_hinged_beam_turns():
    """3.3: a beam on a spherical joint flaps with the spin and does not lag, however stiff."""
    model = Model()
    ends = model.node("root", (0, 0, 0)), model.node("tip", (1, 0, 0))
    model.beam("arm", ends, section(axial=1e6, bending=30.0), 8, 2)
    model.fix("root", "position")
    spin = (0.0, 0.0, 2.5)
    found = modes(equilibrium(model, 2, spin=spin), spin)
    low = found.omega[found.omega < 5.0]
    assert np.abs(low - 2.5).min() < 1e-6
    assert (low < 1e-3).sum() >= 2      # lag, and the turn about its axis
    assert found.growth.max() < 1e-3


def test_equations_as_joints_turn_alike():
    """A hinge of multipliers about the spin axis: the same equilibrium and frequencies."""
    spin, found = (0.0, 0.0, 3.0), []
    for explicit in (False, True):
        model = Model()
        ends = model.node("root", (0, 0, 0)), model.node("tip", (1, 0, 0))
        model.beam("arm", ends, section(axial=1e3), 4)
        model.revolute("root", (0, 0, 1), explicit=explicit)
        result = equilibrium(model, 2, spin=spin)
        found.append((result["tip.position"][-1], modes(result, spin).omega[3:8]))
    # Newton's last correction is below 1e-11 of the length, and of second order what it leaves
    assert found[1][0] == pytest.approx(found[0][0], abs=1e-12)
    assert found[1][1] == pytest.approx(found[0][1], rel=1e-8)


def shaft(bodies, internal, inertia=None):
    model = Model()
    ends = model.node("a", (0, 0, 0)), model.node("b", (1, 0, 0))
    model.beam("shaft", ends, section(axial=3e7), 48, bodies, internal, inertia=inertia)
    model.fix("a", "position")
    model.fix("b", "position")
    return model


@pytest.mark.parametrize("bodies", [1, 2, 4, 8])
def test_shaft_without_modes(bodies):
    """8.2: in axes that turn with it, omega_n +- W of its own reduced frequencies."""
    still = vibrations(equilibrium(shaft(bodies, 0), 1)).omega
    first = still[still > 1.0][0]
    spin = (0.5 * first, 0.0, 0.0)
    omega = modes(equilibrium(shaft(bodies, 0), 1, spin=spin), spin, "turning").omega / first
    for expected in (0.5, 1.5):
        assert np.abs(omega - expected).min() < 1e-6
    exact = (np.pi)**2
    assert abs(first / exact - 1) < 0.12 / bodies**4 + 1e-5     # converges to the exact ones


def test_shaft_of_one_body_with_modes_is_a_limit_of_option_b():
    """Option B drops the velocity the spin gives to the internal deformation."""
    first = vibrations(equilibrium(shaft(1, 4, "b"), 1)).omega
    first = first[first > 1.0][0]
    assert first == pytest.approx(np.pi**2, rel=1e-4)
    spin = (0.5 * first, 0.0, 0.0)
    omega = modes(equilibrium(shaft(1, 4, "b"), 1, spin=spin), spin, "turning").omega / first
    for expected in (0.575, 1.385):
        assert np.abs(omega - expected).min() < 1e-3


def test_matrices_do_not_depend_on_where_space_points():
    """A turning state as a whole turned by one radian, its spin axis with it: the same motion.

    Unknowns are in axes of bodies and nodes, so the matrices of small motion are the same, too.
    """
    found, spin = turning(2, 6.0, internal=2, elements=8)
    before = linearize(found, spin)
    Q = Rotation.from_rotvec([0.6, -0.7, 0.4]).as_matrix()
    state, numbering = found.state, found.numbering
    for node in found.model.nodes.values():
        at = coordinates(numbering, node.position)
        for part in (state.q, state.v, state.a):
            part[at] = Q @ part[at]
    for matrices in (state.R, state.frames, state.frames_old):
        matrices[:] = (Q @ matrices.reshape(-1, 3, 3)).ravel()
    after = linearize(found, Q @ spin)
    assert np.abs(before.damping).max() > 1.0       # gyroscopic terms are there
    for name in ("mass", "damping", "stiffness"):
        old, new = getattr(before, name), getattr(after, name)
        # sums of products of rotated and rotated back: some ten EPS
        assert np.abs(new - old).max() < 1e2 * np.finfo(float).eps * np.abs(old).max()
