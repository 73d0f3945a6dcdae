"""The recipe that makes sections of any profile with the package sectionproperties."""

import re
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation

from sebody.fem import rectangle

library = pytest.importorskip("sectionproperties.pre.library")
PAGE = Path(__file__).parents[2] / "sebody/model/README.md"
STEEL = {"youngs_modulus": 2.1e11, "poisson_ratio": 0.0, "density": 7850.0}


@pytest.fixture(scope="module")
def section_of():
    """The function of the page."""
    block, = [one for one in re.findall(r"```python\n(.*?)```", PAGE.read_text(), re.DOTALL)
              if "sectionproperties" in one]
    names = {}
    exec(compile(block, str(PAGE), "exec"), names)
    return names["section_of"]


def test_a_turned_rectangle_is_that_of_closed_forms(section_of):
    """Series for torsion, 5/6 for shear; corners have no shear stress, sides those of series."""
    geometry = library.rectangular_section(d=0.03, b=0.06).rotate_section(angle=25.0)
    found = section_of(geometry, 4e-6, **STEEL)
    expected = rectangle(0.06, 0.03, **STEEL)
    # y is the first principal axis, about which the second moment is larger: bending across 0.06
    assert_allclose([found.inertia_y, found.inertia_z],
                    [expected.inertia_z, expected.inertia_y], rtol=1e-9)
    assert found.area == pytest.approx(expected.area, rel=1e-12)
    # quadratic triangles of an eighth of the width
    assert found.torsion == pytest.approx(expected.torsion, rel=2e-3)
    assert_allclose(found.shear_factor, 5 / 6, rtol=2e-3)
    assert len(found.fibres) == 4
    for fibre in found.fibres:
        assert_allclose(np.abs([fibre.y, fibre.z]), [0.015, 0.03], rtol=1e-9)


def test_stresses_of_an_angle_are_in_balance_with_its_forces(section_of):
    """Normal stresses of the fibres against the tensor formula in the profile's own axes."""
    geometry = library.angle_section(d=0.12, b=0.08, t=0.01, r_r=0.008, r_t=0.004, n_r=4)
    found = section_of(geometry, 2e-5, **STEEL)
    from sectionproperties.analysis import Section as Profile
    profile = Profile(geometry)
    profile.calculate_geometric_properties()
    ixx, iyy, ixy = profile.get_ic()
    angle = np.radians(profile.get_phi())
    turn = Rotation.from_euler("z", angle).as_matrix()[:2, :2]    # columns: principal axes
    for moments in ((1.0, 0.0), (0.0, 1.0), (0.3, -2.0)):
        mx, my = turn @ moments
        for fibre in found.fibres:
            x, y = turn @ (fibre.y, fibre.z)
            # unsymmetric bending, e.g. W.D. Pilkey, Formulas for Stress, Strain, ... (2005), 2.3
            bent = ((mx * iyy + my * ixy) * y - (my * ixx + mx * ixy) * x) / (ixx * iyy - ixy**2)
            own = np.array(fibre.stress)[0] @ [0, 0, 0, 0, *moments]
            assert own == pytest.approx(bent, rel=1e-9, abs=1e-9 / found.area)
    # shear stresses are of the size of force over area, and largest of a torque where it is thick
    shear = np.array([fibre.stress for fibre in found.fibres])[:, 1:]
    assert 0.1 < np.abs(shear[:, :, 1:3]).max() * found.area < 20.0
    thin = 1.0 * 0.01 / found.torsion
    assert 0.5 * thin < np.linalg.norm(shear[:, :, 3], axis=1).max() < 1.6 * thin
