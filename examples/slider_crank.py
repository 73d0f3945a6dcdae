"""Slider-crank with a flexible rod (Meijaard 1991): the crank turns at constant speed.

The crank pin moves on a circle as prescribed, so the crank takes no unknown; one multiplier keeps
the slider on its line.

Look at ``rod.modes``: the rod bends by its own inertia, once to each side in a turn of the crank
and by 1.5 % of its length (Meijaard 1991), and ``slider.position.x`` shows almost nothing of it.
"""

from math import cos, sin

from sebody import Model
from sebody.fem import Section
from sebody.scenes.scene import Scene

RADIUS, LENGTH, SPEED = 0.15, 0.3, 150.0
SECTION = Section(area=2.8274333882e-5, inertia_y=6.3617251235e-11, inertia_z=6.3617251235e-11,
                  torsion=1.2723450247e-10, youngs_modulus=2e11, poisson_ratio=0.3, density=7870.0)
SLIDER = 0.033
ELEMENTS = 24


def build(bodies: int = 1, modes: int = 5, elements: int = ELEMENTS,
          frame: str = "converged_mean", inertia: str | None = None,
          stiffening: bool | None = None) -> Scene:
    """The scene, moving from the start.

    Parameters
    ----------
    bodies : int
        Number of equal superelements the rod is divided into.
    modes : int
        Internal modes a body.
    elements : int
        Finite elements of the whole rod; bodies with one element and no modes are nonlinear beams.
    frame : str
        Frame of the bodies: converged_mean, or node (attached to their first node).
    inertia : str
        Inertia option: a or b of the paper, c or d; by default the best the body can have.
    stiffening : bool
        With option c: whether stresses stiffen the bodies; by default all but nonlinear beams.
    """
    model = Model(planar=True)
    pin = model.node("pin", (RADIUS, 0.0))
    slider = model.node("slider", (RADIUS + LENGTH, 0.0))
    model.beam("rod", (pin, slider), SECTION, elements, bodies, modes, frame=frame,
               inertia=inertia, stiffening=stiffening)
    model.point_mass("slider", slider, SLIDER)
    model.slider(slider, axis=(1.0, 0.0))
    model.move(pin, (RADIUS, 0.0), (lambda t: cos(SPEED * t) - 1.0,
                                    lambda t: -SPEED * sin(SPEED * t),
                                    lambda t: -SPEED**2 * cos(SPEED * t)))
    model.move(pin, (0.0, RADIUS), (lambda t: sin(SPEED * t),
                                    lambda t: SPEED * cos(SPEED * t),
                                    lambda t: -SPEED**2 * sin(SPEED * t)))
    model.rigid_velocity((0.0, RADIUS * SPEED), -SPEED * RADIUS / LENGTH, about=(RADIUS, 0.0))
    return Scene("slider-crank", "slider-crank with a flexible rod", model, h=2e-5,
                 t_end=0.08378, base="pin", tip="slider")


if __name__ == "__main__":
    from sebody.scenes.scene import main

    main(build)
