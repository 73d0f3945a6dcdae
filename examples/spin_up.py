"""Spin-up of a flexible arm (Kane, Ryan and Banerjee 1987; Simo and Vu-Quoc).

The root turns as prescribed from rest to a final speed in fifteen seconds.

Look at ``tip.position.x:y`` and ``root.reaction_moment``: the tip lags behind by 0.53 m while the
arm speeds up and is straight again at constant speed, since spin stiffens it. Models without
stiffening bend without end.
"""

import math

from sebody import InputError, Model
from sebody.fem import Section
from sebody.scenes.scene import Scene

TIME = 15.0
CASES = {   # length, final speed, axial, shear and bending stiffness, mass a length
    "kane": (8.0, 4.0, 5.0311e6, 1.9350e6, 566.69, 0.20188),
    "simo": (10.0, 6.0, 2.8e7, 1.0e7, 1.4e4, 1.2),
}


def build(case: str = "kane", bodies: int = 8, modes: int = 0, elements: int = 32,
          frame: str = "converged_mean", inertia: str | None = None,
          stiffening: bool | None = None) -> Scene:
    """The scene: the root turns as prescribed.

    Parameters
    ----------
    case : str
        'kane' or 'simo': length, stiffnesses, mass and final speed of the arm.
    bodies : int
        Number of equal superelements the arm is divided into.
    modes : int
        Internal modes a body.
    elements : int
        Finite elements of the whole arm; bodies with one element and no modes are nonlinear beams.
    frame : str
        Frame of the bodies: converged_mean, or node (attached to their first node).
    inertia : str
        Inertia option: a or b of the paper, c or d; by default the best the body can have.
    stiffening : bool
        With option c: whether stresses stiffen the bodies; by default all but nonlinear beams.

    Raises
    ------
    InputError
        An unknown case.
    """
    if case not in CASES:
        raise InputError(f"case is {case!r}: use {' or '.join(CASES)}")
    length, speed, section = CASES[case][0], CASES[case][1], section_of(*CASES[case][2:])
    model = Model(planar=True)
    root, tip = model.node("root", (0.0, 0.0)), model.node("tip", (length, 0.0))
    model.beam("arm", (root, tip), section, elements, bodies, modes, frame=frame, inertia=inertia,
               stiffening=stiffening)
    model.fix("root", "position")
    model.move("root", 1.0, turning(speed), "rotation")
    return Scene("spin-up", "spin-up of a flexible arm", model, h=0.005, t_end=20.0, base="root")


def turning(speed: float) -> tuple:
    """Angle of the root and its rates, up to a constant speed."""
    def angle(t):
        x = min(t / TIME, 1.0)
        return speed * (TIME * (x * x / 2 + (math.cos(2 * math.pi * x) - 1) / (2 * math.pi)**2)
                        + max(t - TIME, 0.0))

    def rate(t):
        x = min(t / TIME, 1.0)
        return speed * (x - math.sin(2 * math.pi * x) / (2 * math.pi))

    def second(t):
        return speed / TIME * (1 - math.cos(2 * math.pi * min(t / TIME, 1.0)))
    return angle, rate, second


def section_of(axial: float, shear: float, bending: float, mass: float) -> Section:
    """A section of area one with these stiffnesses and mass a length.

    Its rotary inertia, density times moment of area, is that of both cases.
    """
    inertia = bending / axial
    return Section(area=1.0, inertia_y=inertia, inertia_z=inertia, torsion=2 * inertia,
                   youngs_modulus=axial, poisson_ratio=0.3, density=mass,
                   shear_factor=shear / (axial / 2.6))


if __name__ == "__main__":
    from sebody.scenes.scene import main

    main(build)
