"""Loads on FE models: sums, moments and deflections."""

import numpy as np
import pytest
from scipy.sparse.linalg import spsolve
from scipy.spatial.transform import Rotation

from sebody import InputError
from sebody.fem import StiffnessSection, hexahedral_block, loads, planar_beam, straight_beam

TURN = Rotation.from_rotvec([0.7, -0.4, 0.9]).as_matrix()
SHIFT = np.array([3.0, -2.0, 5.0])
SIZE = np.array([4.0, 1.0, 0.5])


def plate():
    """Bricks away from the origin, and the nodes of their upper face."""
    bricks = hexahedral_block([1, 2, 3], SIZE, (6, 2, 1), 1e4, 0.3, 1.0)
    z = bricks.coordinates[:, 2]
    return bricks, np.flatnonzero(z == z.max())


def test_other_loads():
    bricks, top = plate()
    t = loads.traction(bricks, top, (1.0, 2.0, 3.0)).reshape(-1, 3).sum(axis=0)
    assert t == pytest.approx(4.0 * np.array([1.0, 2.0, 3.0]))
    weight = loads.body_force(bricks, (0.0, -9.81, 1.0)).reshape(-1, 3).sum(axis=0)
    assert weight == pytest.approx(np.prod(SIZE) * np.array([0.0, -9.81, 1.0]))
    one = loads.point_load(bricks, 5, (1.0, 0.0, -1.0))
    assert np.array_equal(one[bricks.dofs(5)], (1.0, 0.0, -1.0)) and np.abs(one).sum() == 2.0


SECTION = StiffnessSection(axial=1e6, bending_y=50.0, bending_z=70.0, torsion=40.0, mass=2.0,
                           inertia_x=2e-3, inertia_y=1e-3, inertia_z=1e-3)


def test_line_load_of_a_clamped_beam():
    """Euler's beam: w L^4 / (8 E I) and w L^3 / (6 E I) at the tip, in both planes, turned."""
    ends = SHIFT, SHIFT + 2.0 * TURN[:, 0]
    beam = straight_beam(*ends, SECTION, 5, up=TURN[:, 1])
    w = TURN @ (0.0, 0.3, -0.2)
    p = loads.line_load(beam, w)
    y = np.zeros(len(p))
    y[6:] = spsolve(beam.stiffness[6:, 6:], p[6:])
    tip, turn = y[-6:-3] @ TURN, y[-3:] @ TURN
    assert tip == pytest.approx([0, 0.3 * 16 / (8 * 70), -0.2 * 16 / (8 * 50)], abs=1e-12)
    assert turn == pytest.approx([0, 0.2 * 8 / (6 * 50), 0.3 * 8 / (6 * 70)], abs=1e-12)
    half = loads.line_load(beam, w, nodes=range(3)).reshape(-1, 6)[:, :3].sum(axis=0)
    assert half == pytest.approx(0.8 * w)


def test_line_load_in_a_plane():
    """w L^4 / (8 E I) across an oblique beam."""
    along, across = np.array([0.8, 0.6]), np.array([-0.6, 0.8])
    beam = planar_beam(SHIFT[:2], SHIFT[:2] + 2 * along, SECTION, 4)
    y = spsolve(beam.stiffness[3:, 3:], loads.line_load(beam, 0.3 * across)[3:])
    assert y[-3:-1] @ across == pytest.approx(0.3 * 16 / (8 * 70), rel=1e-9)
    assert y[-1] == pytest.approx(0.3 * 8 / (6 * 70), rel=1e-9)


@pytest.mark.parametrize("make, message", [
    (lambda b: loads.pressure(b, [0, 1, 2]), "pressure: the model has no outer face with all"),
    (lambda b: loads.pressure(b, "top"), "node set 'top' is unknown"),
    (lambda b: loads.pressure(b, [0, 900]), "pressure: a node"),
    (lambda b: loads.line_load(b, (0, 0, 1)), "line load: no beam of the model"),
    (lambda b: loads.point_load(b, 3, (0, 0, 1), (1, 0, 0)), "node 3 has no rotations")])
def test_places_that_carry_no_such_load(make, message):
    with pytest.raises(InputError, match=message):
        make(plate()[0])
