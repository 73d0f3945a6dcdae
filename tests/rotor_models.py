"""Rotors whose small motion is known: discs in bearings, and a shaft with two discs."""

import numpy as np
from scipy.spatial.transform import Rotation

from sebody import Model
from sebody.fem import Section, circle

TURNED = Rotation.from_rotvec((0.4, -0.9, 0.3)).as_matrix()     # its first column is the shaft
AXIS = TURNED[:, 0]
# steel of the examples of Friswell, Penny, Garvey and Lees, Dynamics of Rotating Machines,
# Cambridge 2010, chapter 5, and of ROSS, docs/examples/example_05_09_*.rst
E, G, RHO = 211e9, 81.2e9, 7810.0
RPM = np.pi / 30.0


def about_shaft(polar, across):
    """Inertia of an axisymmetric disc whose axis is that of the shaft."""
    return TURNED @ np.diag([polar, across, across]) @ TURNED.T


def disc(stiffness, damping=(0.0, 4.0, 4.0), tilting=1e3):
    """A disc of mass 1 in a bearing that stands."""
    model = Model()
    model.node("o", (0, 0, 0))
    model.fix("o")
    model.node("d", (0, 0, 0))
    model.rigid_body("disc", "d", 1.0, about_shaft(2e-3, 1e-3))
    model.bushing("o", to="d", stiffness=stiffness, damping=damping, rotation=TURNED,
                  turning_stiffness=(0.0, tilting, tilting), name="bearing")
    return model


def two_discs(stiffness, damping=0.0, elements=6, order=1):
    """Example 5.9.1 and its variants: a shaft of 1.5 m with two discs, bearings at both ends."""
    model, length = Model(), 1.5
    numbers = list(range(elements + 1))[::order]
    for k in numbers:
        model.node(f"n{k}", length * k / elements * AXIS)
    section = circle(0.025, E, E / (2 * G) - 1, RHO)
    for k in numbers[:-1] if order > 0 else numbers[1:]:
        model.beam(f"shaft {k}", (f"n{k}", f"n{k + 1}"), section, 1, 1, 0)
    for k, outer in ((elements // 3, 0.28), (2 * elements // 3, 0.35)):
        mass = np.pi * (outer**2 - 0.05**2) / 4 * 0.07 * RHO
        squares = outer**2 + 0.05**2
        model.rigid_body(f"disc {k}", f"n{k}", mass, about_shaft(
            mass * squares / 8, mass * (3 * squares / 4 + 0.07**2) / 12))
    for k in (0, elements):
        ground = model.node(f"ground {k}", length * k / elements * AXIS)
        model.fix(ground)
        model.bushing(ground, to=f"n{k}", stiffness=stiffness, damping=damping * np.eye(2),
                      rotation=TURNED[:, [1, 2, 0]], name=f"bearing {k}")
    model.bushing("ground 0", to="n0", stiffness=(1e3, 0, 0), rotation=TURNED, name="thrust")
    return model


def turbine(blades=3, heavier=0.0, nacelle=(4e5, 9e5), damping=200.0, order=1):
    """A hub on a nacelle of unequal springs, with flexible blades: about AXIS, off the origin."""
    model = Model()
    hub, ground = model.node("hub", (0, 0, 0)), model.node("ground", (0, 0, 0))
    model.fix(ground)
    model.rigid_body("hub mass", hub, 60.0, about_shaft(8.0, 5.0))
    for k in range(blades)[::order]:
        psi = 2.0 * np.pi * k / blades
        along = np.cos(psi) * TURNED[:, 1] + np.sin(psi) * TURNED[:, 2]
        tip = model.node(f"tip {k}", 5.0 * along)
        section = Section(4e-3, 2e-6, 8e-6, 4e-6, 7e10, 0.3, 2700.0)
        model.beam(f"blade {k}", (hub, tip), section, 4, 1, 1, up=AXIS)
        model.rigid_body(f"mass {k}", tip, 2.0 + heavier * (k == 0), 0.02 * np.eye(3))
    model.bushing(ground, to=hub, rotation=TURNED, stiffness=(5e6, *nacelle), damping=damping,
                  turning_stiffness=(0.0, 6e6, 9e6), turning_damping=(0.0, 500.0, 500.0),
                  name="nacelle")
    return model


def turbine_on_a_tower(heavier=0.0):
    """A hub with three flexible blades on a nacelle, on a beam that bends more one way."""
    model = Model()
    foot, top, hub = (model.node(name, place) for name, place in (
        ("foot", -8.0 * TURNED[:, 2]), ("top", (0, 0, 0)), ("hub", (0, 0, 0))))
    model.fix(foot)
    steel = Section(8e-3, 1.6e-5, 4e-5, 3e-5, 2.1e11, 0.3, 7850.0)
    model.beam("tower", (foot, top), steel, 4, 1, 2, up=AXIS, damping=0.02)
    model.rigid_body("nacelle", top, 150.0, TURNED @ np.diag([30.0, 40.0, 35.0]) @ TURNED.T)
    model.revolute(hub, AXIS, to=top, name="shaft")
    model.rigid_body("hub mass", hub, 60.0, about_shaft(8.0, 5.0))
    for k in range(3):
        psi = 2.0 * np.pi * k / 3
        tip = model.node(f"tip {k}", 5.0 * (np.cos(psi) * TURNED[:, 1]
                                            + np.sin(psi) * TURNED[:, 2]))
        section = Section(4e-3, 2e-6, 8e-6, 4e-6, 7e10, 0.3, 2700.0)
        model.beam(f"blade {k}", (hub, tip), section, 4, 1, 1, up=AXIS, damping=0.004)
        model.rigid_body(f"mass {k}", tip, 2.0 + heavier * (k == 0), 0.02 * np.eye(3))
    return model
