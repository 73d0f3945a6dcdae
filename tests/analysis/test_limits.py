"""The spin at which one linear body diverges, in closed form."""

import numpy as np
import pytest

from sebody import Model
from sebody.analysis.limits import spin_limit
from sebody.fem import Section, planar_beam
from sebody.reduction import ReducedBody, craig_bampton

LENGTH = 2.0
SLENDER = Section(area=1.0, inertia_y=1e-4, inertia_z=1e-4, torsion=1e-4, youngs_modulus=3e4,
                  poisson_ratio=0.3, density=1.0)


@pytest.mark.parametrize("masses", [(1.0, 4.0), (4.0, 1.0)])
@pytest.mark.parametrize("axis", [np.array([0.0, 0.0, 1.0]), None])
def test_the_worst_pivot_counts(masses, axis):
    """A bar without mass between two point masses, its frame along the first end.

    About either end the other mass bends the bar as the tip of a cantilever does, with the
    stiffness ``3 EI / L^3``: the heavier one diverges first.
    """
    bar = craig_bampton(planar_beam((0, 0), (LENGTH, 0), SLENDER, 1), [(0, "full"), (1, "full")], 0)
    mass = np.diag(np.array([*np.repeat(masses, 2), 1e-3, 1e-3]))
    model = Model(planar=True)
    ends = model.node("left", (0.0, 0.0)), model.node("right", (LENGTH, 0.0))
    body = model.superelement("bar", ReducedBody(bar.stiffness, mass, bar.coordinates, bar.keeps),
                              ends, frame="node")
    stiffness = 3 * SLENDER.youngs_modulus * SLENDER.inertia_z / LENGTH**3
    assert stiffness < SLENDER.youngs_modulus * SLENDER.area / LENGTH
    assert spin_limit(body, axis) == pytest.approx(np.sqrt(stiffness / max(masses)), rel=1e-9)
