"""Axes in which the constants of bodies have the most zeros."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sebody.assembly.body_constants import superelement_constants
from sebody.explore.ensembles.handles import handle
from sebody.fem import rectangle
from sebody.model.model import Model

SECTION = rectangle(6.0, 4.0, youngs_modulus=2.1e5, poisson_ratio=0.3, density=7.85e-9)


@pytest.mark.parametrize("seed", range(12))
def test_constants_of_turned_bodies_are_in_proportion_to_their_mass(seed):
    """With a stiffness the mass has no effect on, zeros included, whatever the directions.

    Moments of inertia across a slender beam are nearly equal, and principal axes as uncertain as
    rounding over their difference; a factor must not move what rounding leaves across a limit.
    """
    turn = Rotation.random(random_state=seed).as_matrix()
    ends = np.array([[1.0, -3.0, 2.0], [1.0, -3.0, 2.0] + 310.0 * turn[0]])
    model = Model(units="mm t N s")
    model.beam("beam", [model.node("a", ends[0]), model.node("b", ends[1])], SECTION, elements=8,
               bodies=1, modes=5)
    factor, found = handle(model, "beam.mass"), []
    for value in (1.0, 3.0, 0.7):
        factor.set(np.array(value))
        found.append(superelement_constants(model.bodies["beam"]))
        factor.reset()
    one, *others = found
    for value, other in zip((3.0, 0.7), others, strict=True):
        for name in ("turn", "axes", "order", "stretched", "lam", "E"):
            scale = np.abs(one[name]).max()
            np.testing.assert_allclose(other[name], one[name], rtol=0, atol=1e-13 * scale)
        for name in ("Mz", "moment_columns", "J0"):
            scale = np.abs(one[name]).max()
            np.testing.assert_allclose(other[name], value * np.asarray(one[name]), rtol=0,
                                       atol=1e-13 * scale * value)
