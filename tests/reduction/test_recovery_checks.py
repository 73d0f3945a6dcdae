"""Shapes that are not those of their body are refused: by name, with what was found."""

from dataclasses import replace

import numpy as np
import pytest

from sebody import InputError
from sebody.fem import Section, planar_beam, rectangle, straight_beam
from sebody.reduction import craig_bampton

SECTION = Section(area=2.0, inertia_y=0.3, inertia_z=0.4, torsion=0.2, youngs_modulus=1e4,
                  poisson_ratio=0.25, density=1.5)
PLANE = craig_bampton(planar_beam((1, 2), (4, 3), SECTION, 5), {0: "full", 5: "full"}, 2)
SPACE = craig_bampton(straight_beam((1, 2, 3), (4, 3, 1), rectangle(0.2, 0.3, 1e4, 0.25, 1.5), 5),
                      {0: "full", 5: "full"}, 2)


def nan(array):
    found = np.array(array, dtype=float)
    found.flat[-1] = np.nan
    return found


@pytest.mark.parametrize("body", [PLANE, SPACE])
@pytest.mark.parametrize("name, change, said", [
    ("shapes", lambda a, own: a[:-1], "recovery.shapes has shape"),
    ("shapes", lambda a, own: a[:, :-1], "recovery.shapes has shape"),
    ("shapes", lambda a, own: nan(a), "recovery.shapes has the entry nan at"),
    ("shapes", lambda a, own: a.tolist(), "recovery.shapes is [["),
    ("coordinates", lambda a, own: a[:, :1], "recovery.coordinates has shape"),
    ("coordinates", lambda a, own: nan(a), "recovery.coordinates has the entry nan"),
    ("static", lambda a, own: a[:-2], "recovery.static has shape"),
    ("static", lambda a, own: a[:, :len(own.mass) - own.modes], "of the boundary and spin there"),
    ("node_dofs", lambda a, own: a[:2][::-1], "recovery.node_dofs is"),
    ("axes", lambda a, own: np.eye(own.coordinates.shape[1]), "belong together"),
    ("labels", lambda a, own: np.arange(3), "recovery.labels has shape (3,), in place of (6)"),
    ("labels", lambda a, own: np.arange(6.0), "give an array of whole numbers"),
    ("nodes", lambda a, own: np.arange(6)[::-1], "recovery.nodes do not ascend"),
    ("cells", lambda a, own: ((a[0][0], a[0][1] + 3),), "recovery.cells[0] has the node 8: give"),
    ("cells", lambda a, own: (("", a[0][1]),), "recovery.cells[0]: kind is ''"),
    ("outlines", lambda a, own: np.zeros((2, 4, 3)), "recovery.outlines has shape"),
    ("stress", lambda a, own: (3,), "recovery.stress[0] is 3: give a SolidStress"),
    ("stress", lambda a, own: (replace(a[0], nodes=a[0].nodes + 9),), "has the node 14: give"),
    ("stress", lambda a, own: (replace(a[0], forces=a[0].forces[1:]),), "stress[0].forces has"),
    ("stress", lambda a, own: (replace(a[0], fibres=nan(a[0].fibres)),) if a[0].fibres.size else
     (replace(a[0], offsets=np.zeros((1, 0, 2))),), "recovery.stress[0]."),
])
def test_shapes_of_another_body_are_refused(body, name, change, said):
    spoilt = change(getattr(body.recovery, name), body)
    with pytest.raises(InputError) as caught:
        replace(body, recovery=replace(body.recovery, **{name: spoilt}))
    assert said in str(caught.value)


def test_what_else_is_no_recovery():
    with pytest.raises(InputError, match="recovery is 'shapes': give a Recovery"):
        replace(PLANE, recovery="shapes")
    with pytest.raises(InputError, match="modes is 1000000000000: the stiffness has 8 rows"):
        replace(PLANE, modes=10**12)
