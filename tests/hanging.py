"""Weights on ropes over sheaves, in general position."""

import numpy as np
from scipy.spatial.transform import Rotation

from sebody import Model

TURN = Rotation.from_rotvec((0.4, -0.9, 0.3)).as_matrix()
AT = np.array([2.0, -1.0, 0.5])
G = 9.81


def turned(x, y, z=0.0):
    """A place of the plane of the drawing, in general position."""
    return AT + TURN @ (x, y, z)


def hung(points, masses, sheaves=(), flat=False):
    """Point masses and fixed nodes in a turned plane, or in that of a planar model."""
    model = Model(planar=flat)
    for name, point in points.items():
        model.node(name, point if flat else turned(*point), "full" if name in sheaves else
                   "translation")
        if name in masses:
            model.point_mass(f"mass of {name}", name, masses[name])
        else:
            model.fix(name, *[] if name in sheaves else ["position"])
    for name in sheaves:
        model.sheave(f"wheel {name}", name, sheaves[name], **({} if flat else {
            "axis": TURN[:, 2]}))
    model.gravity((0, -G) if flat else TURN @ (0, -G, 0))
    return model


def heights(model, result, name):
    """Height of a node above the origin of the drawing."""
    place = result[f"{name}.position"]
    if model.plane is not None:
        place = model.plane.to_space(f"{name}.position", place)
    return place[:, 1] if place.shape[1] == 2 else (place - AT) @ TURN[:, 1]
