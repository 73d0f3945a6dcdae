"""A crane whose two arms need unlike models, for tests of advice."""

import numpy as np

from sebody import Model
from sebody.fem import Section, planar_beam
from sebody.reduction import craig_bampton

H, T_END = 0.01, 0.4
STIFF, SOFT = (Section(area=a, inertia_y=i, inertia_z=i, torsion=2 * i, youngs_modulus=2.1e6,
                       poisson_ratio=0.3, density=7.8e-3) for a, i in ((9.0, 400.0), (0.2, 0.02)))
POINTS = np.array([[2.0, 1.0], [12.0, 9.0], [50.0, 2.0]])


def crane(still: bool = False, torque: float = 300.0) -> Model:
    """A stout arm that a torque turns, and on it, welded, a soft one with a weight."""
    model = Model(planar=True)
    tip, base, elbow = (model.node(n, POINTS[k]) for n, k in (("tip", 2), ("base", 0),
                                                              ("elbow", 1)))
    for name, section, ends in (("soft", SOFT, (elbow, tip)), ("stout", STIFF, (base, elbow))):
        fe_model = planar_beam(*(n.point for n in ends), section, 6)
        model.superelement(name, craig_bampton(fe_model, [(0, "full"), (6, "full")], 4), ends)
    model.point_mass("weight", tip, 0.02)
    model.revolute(base)
    if not still:
        model.torque(base, 1.0, [(0, 0), (0.1, torque), (0.3, -torque), (0.4, 0.0)])
    return model
