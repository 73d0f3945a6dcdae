"""A ball is dropped on a flexible plate, a wide beam clamped at one end: it lands near its tip.

Look at ``ball.position.y`` and ``tip.position.y``: the ball falls for 0.143 s and throws the tip
down, which comes back and strikes it a second time 0.03 s later; this pair of peaks of
``landing.normal_force`` repeats after the next flight.
"""

from sebody import Model, plane
from sebody.fem import Section
from sebody.scenes.scene import Scene

LENGTH, WIDTH, THICKNESS = 0.5, 0.1, 4e-3


def build(modes: int = 4, height: float = 0.1) -> Scene:
    """The scene, the ball at rest above the tip.

    Parameters
    ----------
    modes : int
        Internal modes of the plate.
    height : float
        Of the ball's lowest point above the plate [m].
    """
    bend = WIDTH * THICKNESS**3 / 12
    section = Section(area=WIDTH * THICKNESS, inertia_y=bend, inertia_z=bend, torsion=2 * bend,
                      youngs_modulus=7e10, poisson_ratio=0.3, density=2700.0)
    model = Model(planar=True)
    model.gravity((0.0, -9.81))
    model.node("wall", (0.0, 0.0))
    model.fix("wall")
    model.node("tip", (LENGTH, 0.0))
    model.beam("plate", ("wall", "tip"), section, 20, 2, modes, damping=0.01)
    model.node("ball", (LENGTH - 0.06, 0.02 + height))
    model.rigid_body("sphere", "ball", 0.2, 0.4 * 0.2 * 0.02**2)
    model.contact("ball", on=plane((0.0, 1.0), node="tip"), radius=0.02, stiffness=1e7,
                  restitution=0.8, friction=0.2, name="landing")
    return Scene("ball-on-beam", "a ball bounces on a flexible plate", model, h=5e-4, t_end=0.5,
                 base="wall", tip="ball")


if __name__ == "__main__":
    from sebody.scenes.scene import main

    main(build)
