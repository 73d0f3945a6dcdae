"""A block on a belt, held by a spring: it sticks, breaks away, slides and sticks again.

Look at ``block.velocity.x``: the block rides on the belt at 0.1 m/s, breaks away at 0.4 s, when
``spring.force.norm`` is 4 N, slides back and is caught again, every 0.67 s. ``dry.sticks`` is one
while it sticks.
"""

from sebody import Model
from sebody.scenes.scene import Scene


def build(speed: float = 0.1, static: float = 0.4, dynamic: float = 0.3) -> Scene:
    """The scene, sticking at the start.

    Parameters
    ----------
    speed : float
        Of the belt [m/s].
    static, dynamic : float
        Coefficients of break-away and of sliding.
    """
    model = Model(planar=True)
    model.gravity((0.0, -10.0))
    model.node("block", (0.0, 0.0))
    model.rigid_body("body", "block", 1.0, 1e-3)
    model.initial_velocity("block", (speed, 0.0))
    model.fix(model.node("wall", (-0.3, 0.0), keeps="translation"), "position")
    model.spring("wall", "block", 100.0, name="spring")
    model.node("belt", (0.0, 0.0))
    model.move("belt", (speed, 0.0), lambda t: t, name="drive")
    model.fix("belt", "rotation")
    model.prismatic("belt", (1.0, 0.0), to="block", name="surface")
    model.friction("surface", dynamic, static=static, name="dry")
    return Scene("stick-slip", "a block on a belt sticks and slips", model, h=1e-3, t_end=4.0,
                 base="wall", tip="block")


if __name__ == "__main__":
    from sebody.scenes.scene import main

    main(build)
