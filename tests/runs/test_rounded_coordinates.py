"""Bodies whose FE nodes lie in a plane but for the digits of a file."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sebody import Model, simulate
from sebody.fem import Section, frame
from sebody.reduction import craig_bampton

SECTION = Section(area=4e-4, inertia_y=1.3e-8, inertia_z=1.3e-8, torsion=2e-8,
                  youngs_modulus=7e10, poisson_ratio=0.3, density=2700.0)


def stool(digits):
    """Four feet in a plane and the mass above them, turned, with coordinates of some digits."""
    seat = np.array([[0.2, 0.2, 0.5], [-0.2, 0.2, 0.5], [-0.2, -0.2, 0.5], [0.2, -0.2, 0.5]])
    points = np.vstack([seat * [1.5, 1.4, 0.0], seat])
    points = points @ Rotation.from_rotvec([0.7, -0.4, 0.9]).as_matrix().T
    members = [(k, 4 + k) for k in range(4)] + [(4 + k, 4 + (k + 1) % 4) for k in range(4)]
    points = np.round(points, digits)
    return points, craig_bampton(frame(points, members, SECTION, 4),
                                 [(k, "full") for k in range(4)], 6)


def path(digits, **options):
    points, body = stool(digits)
    model = Model()
    feet = [model.node(f"foot {k}", points[k]) for k in range(4)]
    model.superelement("stool", body, feet, **options)
    model.rigid_velocity((0.1, 0.2, 0.3), (2.0, -1.0, 6.0), points.mean(axis=0))
    model.force("foot 0", (20.0, -30.0, 10.0), [(0, 0), (0.002, 1), (0.02, 1), (0.022, 0)])
    run = simulate(model, 5e-4, 0.05)
    assert run.cuts == 0
    return np.array([run[f"foot {k}.position"] for k in range(4)])


@pytest.mark.filterwarnings("ignore::sebody.LimitWarning")      # of energy, in two seldom frames
@pytest.mark.parametrize("options", [{"inertia": "rigid_part"}, {"inertia": "material"},
                                     {"frame": "converged_mean"}, {}])
def test_digits_of_coordinates_move_a_path_as_far_as_they_move_the_nodes(options):
    """With six digits the frame had weights of 1e5 and runs found no accelerations."""
    exact = path(15, **options)
    for digits in (4, 6, 8):
        assert np.abs(path(digits, **options) - exact).max() < 3 * 10.0**-digits
