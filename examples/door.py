"""A door with friction in its hinge falls shut against a stop, and bounces.

Look at ``pins.angle`` and ``pins.rate``: the stop at 1.4 rad takes in the door, by 0.05 rad, and
sends it back at 0.44 rad/s, which dry friction then lowers evenly, to 0.3 rad/s at the end. Where
the rate passes zero the friction of the hinge, ``dry.moment``, changes its sign.
"""

from sebody import Model
from sebody.scenes.scene import Scene


def build(friction: float = 0.15, restitution: float = 0.4) -> Scene:
    """The scene, turning from the start.

    Parameters
    ----------
    friction : float
        Coefficient in the hinge.
    restitution : float
        Of the stop, at 1 rad/s.
    """
    model = Model()
    model.gravity((0.0, 0.0, -9.81))
    model.node("hinge", (0.0, 0.0, 0.0))
    model.rigid_body("leaf", "hinge", 20.0, (6.7, 1.1, 7.8), centre=(0.4, 0.0, 1.0))
    model.attach("edge", (0.8, 0.0, 1.0), "hinge")
    model.revolute("hinge", axis=(0.0, 0.0, 1.0), name="pins")
    model.friction("pins", friction, static=1.3 * friction, radius=0.01, arm=0.5,
                   takes="whole", name="dry")
    model.stop("pins", lower=-0.2, upper=1.4, restitution=restitution, at_speed=1.0, stiffness=2e4,
               name="frame")
    model.initial_velocity("hinge", angular=(0.0, 0.0, 1.5))
    return Scene("door", "a door with hinge friction and a stop", model, h=2e-3, t_end=4.0,
                 base="hinge", tip="edge")


if __name__ == "__main__":
    from sebody.scenes.scene import main

    main(build)
