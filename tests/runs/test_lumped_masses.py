"""Bodies with lumped masses, whose rotations have no inertia of their own."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.linalg import eigh
from scipy.sparse import csr_array, diags_array
from scipy.spatial.transform import Rotation

from sebody import InputError, Model, Simulation, generalized_alpha, simulate
from sebody.analysis import equilibrium, modes, vibrations
from sebody.explore.inspection import inspect
from sebody.fem import Section, straight_beam
from sebody.io import read_body_file, save_body
from sebody.reduction import craig_bampton, reduce

SECTION = Section(area=9.0, inertia_y=6.75, inertia_z=4.0, torsion=8.0, youngs_modulus=2.1e6,
                  poisson_ratio=0.3, density=7.8e-3)
TURN = Rotation.from_rotvec((0.4, -1.1, 0.7)).as_matrix()
COUNT, LENGTH = 6, 60.0
POINTS = np.linspace([3.0, -2.0, 1.0], TURN @ (LENGTH, 0.0, 0.0) + (3.0, -2.0, 1.0), COUNT + 1)


def lumped(share=0.0):
    """A turned beam with masses at its nodes, and a share of a ball's rotary inertia there."""
    beam = straight_beam(POINTS[0], POINTS[-1], SECTION, COUNT, up=TURN @ (0.0, 0.3, 1.0))
    masses = np.full(COUNT + 1, SECTION.area * SECTION.density * LENGTH / COUNT)
    masses[[0, -1]] /= 2
    diagonal = np.hstack([np.repeat(masses[:, None], 3, axis=1),
                          np.repeat(share * masses[:, None], 3, axis=1)]).ravel()
    return replace(beam, mass=csr_array(diags_array(diagonal)), mass_field=None)


def clamped(body, **options):
    """A model of one of these beams, its first end held."""
    model = Model()
    ends = [model.node(name, point) for name, point in zip("ab", POINTS[[0, -1]], strict=True)]
    model.superelement("beam", body, ends, **options)
    model.fix("a")
    return model


ENDS = [(0, "full"), (COUNT, "full")]
ALL = 3 * (COUNT - 1)       # clamped vibrations of nodes with three masses each


@pytest.mark.parametrize("method, count", [("craig-bampton", ALL), ("rubin", 3 * (COUNT + 1) - 5)])
def test_vibrations_are_those_of_the_masses(method, count):
    """Rotations follow: the inverse problem of the FE matrices, whose mass is singular."""
    model = lumped()
    K, M = (matrix.toarray()[6:, 6:] for matrix in (model.stiffness, model.mass))
    periods = np.sort(eigh(M, K, eigvals_only=True))[::-1][:3 * COUNT]
    run = Simulation(clamped(reduce(model, ENDS, count, method)), 1e-3)
    found = vibrations(run)
    # all coordinates are there; condition of the FE stiffness, 1e5, times EPS
    assert_allclose(found.omega, periods**-0.5, rtol=1e-9)
    assert f"; {found.following} motion" in repr(found) and "without mass follow" in repr(found)
    damped = modes(run)
    assert_allclose(damped.omega, found.omega, rtol=1e-9)
    assert damped.following == found.following > 0 and "without mass follow" in repr(damped)


def test_a_damper_on_what_has_no_mass_makes_it_creep():
    """Twist by a damper alone decays as exp(-k / c t), k = G J / L."""
    model = clamped(craig_bampton(lumped(), ENDS, 3))
    axis = TURN @ (1.0, 0.0, 0.0)
    model.torsion_spring("b", damping=400.0, axis=axis)
    found = modes(Simulation(model, 1e-3))
    stiffness = SECTION.shear_modulus * SECTION.torsion / LENGTH
    creep = found.values[np.abs(found.values.imag) < 1e-9]
    # bending, in which the axis turns, has no part of it at rest
    assert_allclose(creep, -stiffness / 400.0, rtol=1e-9)
    assert found.following == 0


def test_inspection_says_what_follows(tmp_path):
    body = craig_bampton(lumped(), ENDS, 2)
    inspection = inspect(read_body_file(save_body(body, tmp_path / "beam.npz", ("a", "b"))))
    text, = [one.text for one in inspection.findings if "singular" in one.text]
    assert "1 motion without mass follow" in text
    # a bar has five rigid motions with inertia
    assert len(inspection.numbers["frequencies"]["rigid"]) == 5
    assert inspection.numbers["frequencies"]["flexible"][0] > 1.0


def framed(share):
    """Two beams, welded by a bent node, that swing on a hinge, with damping and a load."""
    model = Model()
    body = craig_bampton(lumped(share), ENDS, 2).damped(0.0, stiffness=1e-4)
    corner, first = POINTS[-1], POINTS[0]
    model.node("a", first)
    model.node("b", corner)
    model.superelement("arm", body, ["a", "b"])
    turn = Rotation.from_rotvec((0.3, 1.2, -0.4)).as_matrix()
    model.node("c", corner + turn @ (corner - first))
    model.superelement("forearm", body.rotated(turn), ["b", "c"])
    model.revolute("a", (0.2, 1.0, 0.3))
    model.gravity((0.0, 0.0, -980.0))
    model.force("c", (0.0, 1.0, 0.0), [(0.0, 0.0), (0.1, 2e3), (0.3, -1e3)])
    return model


def test_runs_are_those_of_a_vanishing_rotary_inertia():
    """Beside a share of the motion in proportion to the inertia: each tenth leaves a tenth."""
    tips = [simulate(framed(share), 2e-3, 0.3, generalized_alpha(tolerance=1e-11))["c.position"]
            for share in (0.0, 1e-2, 1e-1)]
    moved = np.abs(tips[0] - tips[0][0]).max()
    near, far = (np.abs(tip - tips[0]).max() / moved for tip in tips[1:])
    assert moved > 10.0 and near < 1e-2
    assert far / near == pytest.approx(10.0, rel=0.2)


def test_damping_is_that_of_a_vanishing_rotary_inertia():
    """Beside what damps the twist: of a ratio as much as the root of its inertia."""
    almost, none = (craig_bampton(lumped(share), ENDS, 2).damped(0.02, stiffness=1e-4).damping
                    for share in (1e-8, 0.0))
    assert_allclose(none, almost, atol=1e-3 * np.abs(almost).max())
    along = np.r_[np.zeros(6), TURN[:, 0], -TURN[:, 0], 0.0, 0.0]
    twist = 4e-4 * SECTION.shear_modulus * SECTION.torsion / LENGTH
    assert along @ none @ along == pytest.approx(twist, rel=1e-9)


def test_equilibria_need_no_mass():
    found, expected = (equilibrium(clamped_under_load(share)) for share in (0.0, 1.0))
    assert_allclose(found["b.position"][-1], expected["b.position"][-1], atol=1e-9)


def clamped_under_load(share):
    # load modes answer inertia: without them the shape at rest has none
    model = clamped(craig_bampton(lumped(share), ENDS, 2), stiffening=False)
    model.force("b", (3e2, -2e2, 5e2))
    return model


def test_what_nothing_holds_is_named():
    """A bar with masses on its axis alone, on a ball joint, spins without inertia."""
    model = Model()
    body = craig_bampton(lumped(), ENDS, 2)
    model.superelement("beam", body, [model.node("a", POINTS[0]), model.node("b", POINTS[-1])])
    model.spherical("a")
    with pytest.raises(InputError, match=r"\.rotation\[\d\] moves no mass, and nothing stiff .* "
                                         "add mass or inertia there, fix it, or leave it out"):
        simulate(model, 1e-3, 1e-2)
