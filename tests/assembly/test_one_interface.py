"""Bodies with one interface and no modes, which have no coordinate of deformation: rigid bodies."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sebody import Model, simulate
from sebody.analysis import Ensemble, final
from sebody.fem import frame, rectangle
from sebody.reduction import craig_bampton

TURN = Rotation.from_rotvec((0.7, -0.4, 0.9)).as_matrix()
SECTION = rectangle(0.03, 0.02, youngs_modulus=7e10, poisson_ratio=0.3, density=2700.0)
H, T_END = 1e-3, 0.1


def star(dimension):
    """Three unequal arms off the origin, kept where they meet."""
    points = np.array([[2, -1, 0.5], [3, -1, 0.5], [1.5, -0.1, 0.7], [2.3, -1.8, 0.1]])
    points = points @ TURN.T if dimension == 3 else points[:, :2]
    return craig_bampton(frame(points, [(0, 1), (0, 2), (0, 3)], SECTION, 3), [(0, "full")], 0)


def thrown(dimension, rigid):
    """The star as a superelement or as a rigid body, spinning and pushed."""
    body, model = star(dimension), Model(planar=dimension == 2)
    node = model.node("centre", body.coordinates[0])
    if rigid:
        J = body.invariants.about(body.centre_of_mass).J0
        model.rigid_body("star", node, body.total_mass, J if dimension == 3 else J[0, 0],
                         body.centre_of_mass)
    else:
        model.superelement("star", body, [node])
    model.rigid_velocity(np.arange(1.0, 1.0 + dimension),
                         np.array([4.0, -7.0, 9.0]) if dimension == 3 else 9.0,
                         about=body.centre_of_mass)
    model.force(node, TURN[:dimension, 0] if dimension == 3 else (0.6, 0.8),
                [(0, 0), (0.02, 40.0), (0.05, -10.0)], name="push")
    return model


@pytest.mark.parametrize("dimension", [3, 2])
def test_it_moves_as_a_rigid_body(dimension):
    """It ended in a ValueError of NumPy: no matrix of it had any column."""
    run, rigid = (simulate(thrown(dimension, kind), H, T_END) for kind in (False, True))
    size = np.ptp(run["centre.position"], axis=0).max()
    assert size > 0.1
    # Newton's iteration leaves 1e-8 of a step
    assert np.abs(run["centre.position"] - rigid["centre.position"]).max() < 1e-7 * size
    end = run["centre.position"][-1]
    found = Ensemble(thrown(dimension, False), H).run(
        {"push.amplitude": np.array([1.0, 2.0])}, T_END, {"end": final("centre.position")})
    assert not found.failures
    np.testing.assert_allclose(found["end"][0], end, rtol=0, atol=1e-10 * np.abs(end).max())
