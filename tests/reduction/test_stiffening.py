"""Stiffening of one body that spins, against closed forms, from its constants alone."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from spinning_body import (
    CLAMPED,
    SLENDER,
    Spinning,
    cantilever,
    roots,
    strip,
    turned_resultants,
)

from sebody.fem import Section, frame, planar_beam, straight_beam
from sebody.reduction import component_modes, craig_bampton

# Flap 1, flap 2 and lag 1 of a uniform cantilever that spins about its root (power series of the
# centrifugally tensioned Euler-Bernoulli beam, times sqrt(rho A L^4 / E I))
CANTILEVER = {3: (4.797278532, 23.32026367, 3.743511896),
              6: (7.360373019, 26.80908168, 4.263225420),
              12: (13.17015049, 37.60311233, 5.427049278)}


def spun(body, eta, stiffened=True):
    return roots(*Spinning(body, [0, 0, eta], CLAMPED, stiffened).equilibrium()[:3])


@pytest.mark.parametrize(("eta", "modes", "error"), [
    # errors of the second-order displacement and of few modes: 1e-3 at rest with four of them
    (3, 4, 1e-3), (3, 8, 3e-4), (6, 4, 2e-3), (6, 8, 4e-4), (12, 4, 1.7e-2), (12, 8, 4e-3)])
def test_frequencies_of_a_spinning_cantilever(eta, modes, error):
    """Flap 1 and 2, lag 1 within one per cent up to eta 6 with any modes."""
    found, growth = spun(cantilever(modes=modes), eta)
    for value in CANTILEVER[eta]:
        assert np.min(np.abs(found - value)) < error * value
    assert growth < 1e-8 * found[-1]


def test_without_stiffening_the_cantilever_diverges():
    """Its lag mode at its own frequency, 3.516; its flap mode stays where it was."""
    found, growth = spun(cantilever(), 3.3, stiffened=False)
    assert growth < 1e-8 * found[-1]
    assert spun(cantilever(), 3.6, stiffened=False)[1] > 0.5


@pytest.mark.parametrize("torsion", [0.1, 1e-3])
@pytest.mark.parametrize("modes", [0, 6])
def test_soft_torsion_does_not_diverge(torsion, modes):
    blade = cantilever(replace(SLENDER, torsion=torsion, inertia_x=2e-6, inertia_y=1e-6,
                               inertia_z=1e-6), modes, 16)
    for eta in (1.0, 3.0, 6.0, 30.0):
        found, growth = spun(blade, eta)
        assert growth < 1e-8 * found[-1]


@pytest.mark.parametrize(("inertia_y", "inertia_z"), [(1e-6, 1e-6), (1e-7, 1.9e-6)])
def test_propeller_moment(inertia_y, inertia_z):
    """Spin about z raises the square of a torsion frequency by (I_z - I_y) / (I_z + I_y) W^2."""
    section = replace(SLENDER, torsion=1e-2, axial=1e7, bending_y=1e3, bending_z=1e3,
                      inertia_x=inertia_y + inertia_z, inertia_y=inertia_y, inertia_z=inertia_z)
    blade = cantilever(section, 0, 16)
    squares = []
    for W in (0.0, 8.0):
        body = Spinning(blade, [0, 0, W], CLAMPED)
        M, C, K, *_ = body.equilibrium()
        values, vectors = np.linalg.eig(np.linalg.solve(M, K))
        twist = np.argmax(np.abs(vectors[3]) / np.abs(vectors[:6]).max(axis=0))
        squares.append(values[twist].real)
    exact = (inertia_z - inertia_y) / (inertia_z + inertia_y)
    # bending is stiffer than torsion by 1e5; the shape of torsion is exact to a tenth of that
    assert_allclose((squares[1] - squares[0]) / 64, exact, atol=2e-3)


SQUARE = Section(9.0, 6.75, 6.75, 11.387, 2.1e6, 0.3, 7.8e-3, shear_factor=5 / 6)


def hinged_frequency(body, spin):
    """First bending frequency in the plane of a beam that turns freely about z at its root."""
    spinning = Spinning(body, [0, 0, spin], CLAMPED)
    M, C, K, z, Z = spinning.equilibrium()
    free = spinning.free
    across = (Z.T @ (spinning.g[2] + z @ spinning.K[2]))[free]
    change = (Z.T @ (spinning.h[2, 2] + spinning.J2[2, 2] @ z))[free] * spin
    moment = spinning.J0[2, 2] + spinning.h[2, 2] @ z + z @ spinning.J2[2, 2] @ z / 2
    zero = np.zeros(len(free))
    whole = [np.block([[np.array([[corner]]), row[None]], [column[:, None], block]])
             for corner, row, column, block in ((moment, across, across, M),
                                                (0.0, change, -change, C), (0.0, zero, zero, K))]
    found = roots(*whole)[0]
    return found[found > 1.0]


def test_hinged_beam_at_its_spin():
    """11.142 of geometrically exact beams at 0.906; 10.51 without stiffening in this frame."""
    model = straight_beam([0, 0, 0], [100 * 2**0.5, 0, 0], SQUARE, 40)
    ends = [(0, "full"), (40, "full")]
    found = hinged_frequency(craig_bampton(model, ends, 8), 0.906)
    assert np.min(np.abs(found - 11.142)) < 2e-3
    # stress-carrying modes among the internal ones leave it as it is
    axial = component_modes(model.stiffness, model.mass, np.r_[0:3, 240:243, 3:6, 243:246], 60)
    along = np.abs(axial.fixed_interface.reshape(41, 6, 60)[:, 0]).max(axis=0)
    across = np.abs(axial.fixed_interface.reshape(41, 6, 60)[:, 1:3]).max(axis=(0, 1))
    twice = [int(k) for k in np.flatnonzero(along > across)[:4]]
    more = craig_bampton(model, ends, 60, [*range(8), *twice])
    assert np.min(np.abs(hinged_frequency(more, 0.906) - 11.142)) < 2e-3


def test_a_solid_spins_as_the_beam_does():
    model, ends = strip(2.0)
    body = craig_bampton(model, [(end, "full") for end in ends], 6)
    unit = np.sqrt(2.0 * 2.0 * 40.0**4 / (1e6 * 2.0**4 / 12))      # sqrt(rho A L^4 / E I)
    found, growth = spun(body, 6 / unit)
    flap, _, lag = CANTILEVER[6]
    # bricks of a few hundred DOFs are 1 % stiff, shear at this slenderness 0.3 % soft
    for value in (flap, lag):
        assert np.min(np.abs(found * unit - value)) < 0.01 * value
    assert growth < 1e-8 * found[-1]


def test_turning_a_body_makes_no_resultants():
    """Second-order displacements of a rigid turn: frames of three nodes and faces of solids."""
    section = replace(SLENDER, axial=30.0, bending_y=4.0, bending_z=7.0, torsion=5.0,
                      shear_y=9.0)
    points = [[1, 2, -1], [3, 5, 5], [4, 0, 2]]
    elbow = frame(points, [(0, 1), (2, 1)], section, 3, up=[0.3, -0.5, 1])
    model, ends = strip(2.0, 6)
    for body in (craig_bampton(elbow, {0: "full", 1: "full", 2: "full"}, 2),
                 craig_bampton(elbow, {2: "full", 0: "full"}, 0),
                 craig_bampton(model, [(end, "full") for end in ends], 2)):
        # constraint modes have the rounding of their solution, a condition of 1e5
        assert turned_resultants(body).max() < 1e-9


def counts(body):
    return body.invariants.slaved, body.invariants.resultants


def test_what_does_not_stiffen_is_left_out():
    """Load modes and resultants: tension alone in compact straight beams, all in frames."""
    flat = planar_beam([2, 1], [2.6, 1.8], SLENDER, 12)
    assert counts(craig_bampton(flat, {0: "full", 12: "full"}, 4)) == (2, 1)
    assert counts(cantilever()) == (2, 1)
    # stiff in one plane: its bending twists the beam, as in lateral buckling
    assert counts(cantilever(replace(SLENDER, bending_y=10.0))) == (4, 3)
    points = [[1, 2, -1], [3, 5, 5], [4, 0, 2]]
    elbow = frame(points, [(0, 1), (2, 1)], SLENDER, 6)
    slaved, resultants = counts(craig_bampton(elbow, {0: "full", 1: "full", 2: "full"}, 2))
    assert slaved >= 9 and resultants == 12
    assert counts(craig_bampton(elbow, {0: "full"}, 0)) == (0, 0)     # rigid
    # nothing inside that could move
    assert cantilever(modes=0, elements=1).invariants.slaved == 0


def test_units_and_order_change_nothing():
    """A body in thousandths of the unit of length, its nodes in the other order."""
    found = []
    for unit, reverse in ((1.0, False), (1e3, False), (1.0, True)):
        section = replace(SLENDER, bending_y=unit**2, bending_z=unit**2, torsion=unit**2,
                          mass=1 / unit**2)
        ends = [[0, 0, 0], [unit, 0, 0]]
        model = straight_beam(*(ends[::-1] if reverse else ends), section, 8)
        body = craig_bampton(model, [(0, "full"), (8, "full")], 4)
        held = [3, 4, 5, 9, 10, 11] if reverse else CLAMPED
        found.append(roots(*Spinning(body, [0, 0, 6.0], held).equilibrium()[:3])[0][:4])
    # forces in the unit of length: conditions of 1e10 in other units
    assert_allclose(found[1], found[0], rtol=1e-6)
    assert_allclose(found[2], found[0], rtol=1e-9)
