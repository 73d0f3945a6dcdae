"""Eigenvalues of gyroscopic motion: no growth where there is none, and what rounding leaves."""

import numpy as np
import pytest

from sebody import Model, Simulation
from sebody.analysis import campbell, equilibrium, frequency_response, modes
from sebody.basics.errors import LimitWarning
from sebody.fem import circle
from sebody.small_motion.eigenvalues import EPS, eigenvalues

AXIS = np.array([1.0, 2.0, 0.5]) / np.sqrt(5.25)
BAR = circle(0.01, 7e10, 0.3, 2700.0)
CRITICAL = 4.730040745**2 * 0.005 * np.sqrt(7e10 / 2700.0)      # of the clamped bar of length 1


def shaft(bodies, inertia):
    """A bar between bearings that hold its direction, free to turn and to stretch."""
    model = Model()
    a, b, end = (model.node(name, s * AXIS) for name, s in (("a", 0.0), ("b", 1.0), ("end", 1.0)))
    model.beam("bar", [a, b], BAR, 16, bodies, 4 if bodies < 8 else 0, inertia=inertia)
    model.revolute(a, AXIS)
    model.fix(end)
    model.cylindrical(end, AXIS, to=b)
    return model


@pytest.mark.parametrize("bodies", [1, 8])
@pytest.mark.parametrize("inertia", "bcd")
@pytest.mark.parametrize("share", [0.6, 1.4])
def test_undamped_shafts_neither_grow_nor_decay(bodies, inertia, share):
    """Below the critical speed the stiffness is positive, above it gyroscopic forces hold them.

    Frequencies reach 1.4e5 1/s with eight bodies: rounding of these is all that may be left. Of
    the turn about the axis, which has no stiffness, it is the root of that of the stiffness.
    """
    spin = share * CRITICAL * AXIS
    found = modes(equilibrium(shaft(bodies, inertia), 2, spin=spin), spin, "turning")
    assert np.abs(found.growth).max() < 1e-9
    assert np.all(np.abs(found.growth) <= found.rounding)
    turning = found.omega < 1.0
    assert np.count_nonzero(turning) == 2
    assert found.rounding[~turning].max() < 1e-6 and found.rounding[turning].max() < 0.1


def test_campbell_diagrams_show_no_growth_of_rounding():
    found = campbell(shaft(8, "d"), CRITICAL * np.array([0.25, 0.5, 0.75]), AXIS, count=6, steps=1,
                     frame="turning")
    assert np.abs(found.growth).max() < 1e-9


def congruent(seed, *matrices):
    """The same motion in other coordinates, whose condition is about 1e2."""
    X = np.random.default_rng(seed).normal(size=matrices[0].shape) + 2.0 * np.eye(len(matrices[0]))
    return [X.T @ A @ X for A in matrices]


def pairs(k, g, c):
    """Matrices of ``z'' + (c - i g) z' + k z = 0``, z = x + i y, and their eigenvalues."""
    turn = np.array([[0.0, 1.0], [-1.0, 0.0]])
    M = np.eye(2 * len(k))
    C = np.kron(np.diag(g), turn) + np.kron(np.diag(c), np.eye(2))
    K = np.kron(np.diag(k), np.eye(2))
    damping = c - 1j * g
    root = np.sqrt(damping**2 / 4 - k + 0j)
    values = np.concatenate([-damping / 2 + root, -damping / 2 - root])
    values = np.where(values.imag < 0.0, values.conj(), values)
    return (M, C, K), values[np.argsort(values.imag)]


@pytest.mark.parametrize("k, g, c", [
    ((1.0, 40.0, 3e4, 1e10), (0.5, 30.0, 2.0, 100.0), 0.0),         # positive
    ((-1.0, 40.0, 3e4, 1e10), (2.5, 30.0, 2.0, 100.0), 0.0),        # held by gyroscopic forces
    ((-1.0, 40.0, 3e4, 1e10), (1.5, 30.0, 2.0, 100.0), 0.0),        # not held by them: flutter
    ((1.0, 40.0, 3e4, 1e10), (0.5, 30.0, 2.0, 100.0), 1e-5),        # damped a little
    ((1.0, 40.0, 3e4, 1e10), (0.5, 30.0, 2.0, 100.0), (0.5, 1e-4, 5.0, 1e3))])
@pytest.mark.parametrize("seed", range(3))
def test_closed_forms_are_met_within_the_rounding_that_is_said(k, g, c, seed):
    own, exact = pairs(np.array(k), np.array(g), np.broadcast_to(c, 4).astype(float))
    found = eigenvalues(*congruent(seed, *own))
    order = [int(np.argmin(np.abs(found.values - one))) for one in exact]
    error = np.abs(found.values[order] - exact)
    assert np.all(error <= 10.0 * found.rounding[order])
    assert found.rounding.max() < 1e-2      # rounding of 1e10 in a square of 1, times 1e2
    if not np.any(c) and exact.real.max() == 0.0 and min(k) > 0.0:
        assert not found.values.real.any()


@pytest.mark.parametrize("seed", range(4))
def test_rounding_is_that_of_the_matrices(seed):
    """Matrices changed in their last digits: eigenvalues move by what is said, no more."""
    own, _ = pairs(np.array([1.0, 40.0, 3e4, 1e10]), np.array([0.5, 30.0, 2.0, 100.0]),
                   np.array([0.5, 1e-4, 5.0, 1e3]))
    matrices = congruent(seed, *own)
    found, rng = eigenvalues(*matrices), np.random.default_rng(seed)
    changed = eigenvalues(*(A * (1.0 + 100.0 * EPS * rng.uniform(-1.0, 1.0, A.shape))
                            for A in matrices))
    moved = np.abs(found.values - changed.values)
    assert np.all(moved <= 100.0 * found.rounding)
    assert moved.max() > 0.1 * found.rounding.max()


def test_motions_without_mass_have_no_frequency():
    """Of a mass that is singular the other motions are left: here one spring with a mass."""
    M, C, K = np.diag([2.0, 0.0]), np.zeros((2, 2)), np.array([[3.0, -1.0], [-1.0, 1.0]])
    found = eigenvalues(M, C, K)
    assert found.values == pytest.approx([1j], abs=1e-12)


def disc(planar=False, spin=50.0):
    """A disc on a bushing that spins about AXIS, or in a plane."""
    model = Model(planar=planar)
    origin = (0.0, 0.0) if planar else (0.0, 0.0, 0.0)
    model.node("o", origin)
    model.fix("o")
    model.node("d", origin)
    inertia = 2e-3 if planar else 1e-3 * (np.eye(3) + np.outer(AXIS, AXIS))
    model.rigid_body("disc", "d", 1.0, inertia)
    turning = 0.0 if planar else (1e1, 1e1, 1e1)
    model.bushing("o", to="d", stiffness=1e4, turning_stiffness=turning)
    model.initial_velocity("d", angular=spin if planar else spin * AXIS)
    return model


@pytest.mark.parametrize("planar", [False, True])
def test_modes_of_what_spins_want_the_spin(planar, recwarn):
    """The warning names it; nothing is said with it, at rest, or of a rotation that is slow."""
    suggested = "50" if planar else r"\(21.8218, 43.6436, 10.9109\)"
    with pytest.warns(LimitWarning, match="modes of a state that rotates at up to 50 rad a unit of "
                      f"time, without spin=: .* Give spin={suggested}, the angular velocity of"):
        modes(Simulation(disc(planar), 1e-3))
    recwarn.clear()
    modes(Simulation(disc(planar), 1e-3), 50.0 if planar else 50.0 * AXIS)
    modes(Simulation(disc(planar, 0.0), 1e-3))
    modes(Simulation(disc(planar, 1e-4), 1e-3))
    assert not [one for one in recwarn if "spin=" in str(one.message)]
    model = disc(planar)
    model.force("d", (0.6, 0.8) if planar else AXIS, 1.0, name="push")
    with pytest.warns(LimitWarning, match="a harmonic response of a state that rotates at up to"):
        frequency_response(Simulation(model, 1e-3), "push", "d.position", [3.0])
    recwarn.clear()
    frequency_response(Simulation(model, 1e-3), "push", "d.position", [3.0],
                       50.0 if planar else 50.0 * AXIS)
    assert not [one for one in recwarn if "spin=" in str(one.message)]
