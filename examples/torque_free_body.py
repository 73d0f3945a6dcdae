"""A rigid body turning freely, started close to its unstable axis: it tumbles (Dzhanibekov).

Look at ``centre.angular_velocity``: the rotation about the middle axis is unstable, so the body
turns over again and again, though no torque acts; ``angular_momentum`` stays the same.
"""

from sebody import Model
from sebody.scenes.scene import Scene


def build(inertia: tuple = (1.0, 2.0, 3.0), spin: tuple = (0.01, 1.0, 0.01)) -> Scene:
    """The scene: a rigid body held at its centre.

    Parameters
    ----------
    inertia : tuple
        Principal moments of inertia.
    spin : tuple
        Initial angular velocity.
    """
    model = Model()
    centre = model.node("centre", (0.0, 0.0, 0.0))
    model.fix(centre, "position")
    model.rigid_body("body", centre, 1.0, inertia)
    model.attach("tip", (0.0, 1.0, 0.0), centre)
    model.initial_velocity(centre, angular=spin)
    return Scene("torque-free-body", "rigid body tumbling freely", model, h=0.01, t_end=40.0,
                 base="centre")


if __name__ == "__main__":
    from sebody.scenes.scene import main

    main(build)
