"""A wind turbine's blade that spins up: sections that couple bending and torsion, twist, prebend.

Stiffness and mass are those of a blade of some 5 MW, in round numbers. Its four superelements turn
equally under a load at the tip, so the soft outer part has more of them.

Look at ``tip.position.x`` and ``blade 2.node0.section_forces``: the spin draws the prebent blade
straight, and its weight bends it to and fro once a turn.
"""

import numpy as np

from sebody import Model
from sebody.fem import Axis, GeneralSection, Stations
from sebody.scenes.scene import Scene
from sebody.scenes.spin_up import turning

LENGTH, SPEED = 60.0, 1.2
# place, chord, thickness, mass a length, tension, bending flapwise and edgewise, torsion
TABLE = np.array([
    [0.00, 3.5, 3.5, 700, 1.0e10, 1.8e10, 1.8e10, 5.0e9],
    [0.10, 3.8, 2.8, 430, 6.0e9, 6.3e9, 9.0e9, 1.3e9],
    [0.20, 4.6, 1.8, 340, 3.0e9, 2.9e9, 5.5e9, 4.0e8],
    [0.40, 4.0, 1.1, 280, 2.0e9, 8.0e8, 2.8e9, 1.0e8],
    [0.60, 3.2, 0.7, 200, 1.2e9, 2.0e8, 1.1e9, 3.0e7],
    [0.80, 2.5, 0.5, 120, 6.0e8, 3.0e7, 3.0e8, 7.0e6],
    [0.95, 1.6, 0.3, 45, 1.5e8, 3.0e6, 4.0e7, 1.0e6],
    [1.00, 0.6, 0.1, 15, 5.0e7, 4.0e5, 5.0e6, 2.0e5]])
TWIST = [[0.0, 0.23], [0.2, 0.2], [0.6, 0.07], [1.0, 0.0]]


def section(chord: float, thickness: float, mass: float, tension: float, flap: float, edge: float,
            torsion: float) -> GeneralSection:
    """A section with y along the flap and z along the chord, its mass behind the axis."""
    K = np.diag([tension, tension / 20, tension / 20, torsion, edge, flap])
    K[3, 5] = K[5, 3] = 0.08 * np.sqrt(torsion * flap)      # bending flapwise twists
    behind, about = 0.05 * chord, mass * np.array([thickness, chord])**2 / 16
    M = np.diag([mass] * 3 + [about.sum(), about[1], about[0]])
    M[0, 4] = M[4, 0] = mass * behind
    M[1, 3] = M[3, 1] = -mass * behind
    M[3, 3] += mass * behind**2
    M[4, 4] += mass * behind**2
    angle = 2 * np.pi * np.arange(24) / 24
    thick = np.where(np.cos(angle) < 0, 1.0, 1 - 0.7 * np.cos(angle)**2 * (thickness < chord))
    outline = np.column_stack([thickness / 2 * np.sin(angle) * thick,
                               chord * (np.cos(angle) / 2 + 0.15 * (thickness < chord))])
    return GeneralSection(K, M, tuple(map(tuple, outline.tolist())), retardation=0.002)


def build(bodies: int = 4, modes: int = 4, elements: int = 32, divide: str = "rotation") -> Scene:
    """The scene.

    Parameters
    ----------
    bodies : int
        Superelements from root to tip.
    modes : int
        Internal modes of each; none with as many bodies as elements, which are nonlinear beams.
    elements : int
        Finite elements of the blade.
    divide : str
        How bodies end: rotation, they turn equally under a load, or length.
    """
    s = np.linspace(0, 1, 7)
    axis = Axis(np.column_stack([-2.0 * s**2, 0 * s, LENGTH * s]), TWIST, up=(1.0, 0.0, 0.0))
    stations = Stations(TABLE[:, 0], [section(*row[1:]) for row in TABLE])
    model = Model(units="m kg s N")
    root, tip = (model.node(name, axis.position(place))
                 for name, place in (("root", 0.0), ("tip", 1.0)))
    model.beam("blade", (root, tip), stations, elements, bodies, modes, axis=axis, divide=divide)
    model.fix(root, "position")
    hub = model.revolute(root, axis=(1.0, 0.0, 0.0), name="hub")
    model.drive_angle(hub, turning(SPEED))
    model.gravity((0.0, 0.0, -9.81))
    return Scene("blade", "blade of a wind turbine that spins up", model, h=0.01, t_end=24.0,
                 base="root")


if __name__ == "__main__":
    from sebody.scenes.scene import main

    main(build)
