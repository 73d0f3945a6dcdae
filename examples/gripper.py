"""Two jaws close on a block, lift it and carry it: friction of points holds it.

Look at ``block.position.y`` and ``hand.position.y``: nothing but friction lifts the block. ``left
low grip.normal_force`` is half of the 20 N of a jaw once the jaws are closed; ``friction=0.05``
lets the block fall.
"""

from sebody import Model, plane
from sebody.scenes.scene import Scene

HALF, HEIGHT = 0.02, 0.03
LIFT = [(0.0, 0.0), (0.3, 0.0), (1.3, 1.0), (2.0, 1.0)]


def build(friction: float = 0.5, grip: float = 20.0) -> Scene:
    """The scene, at rest at the start.

    Parameters
    ----------
    friction : float
        Coefficient of jaws on the block; the floor has the same.
    grip : float
        Force of each jaw [N].
    """
    model = Model(planar=True)
    model.gravity((0.0, -9.81))
    model.node("block", (0.0, HEIGHT))
    model.rigid_body("body", "block", 0.5, 2e-4)
    law = {"stiffness": 1e6, "restitution": 0.3, "friction": friction}
    for name, x, y in (("left foot", -HALF, 0.0), ("right foot", HALF, 0.0)):
        model.attach(name, (x, y), "block")
        model.contact(name, on=plane((0.0, 1.0)), name=f"{name} on the floor", **law)
    model.node("hand", (0.0, 0.1))
    model.fix("hand", "rotation")
    model.move("hand", (0.0, 0.15), LIFT, name="lift")
    for side, name in ((-1.0, "left"), (1.0, "right")):
        model.node(f"{name} jaw", (side * (HALF + 0.002), HEIGHT))
        model.rigid_body(f"{name} finger", f"{name} jaw", 0.1, 1e-5)
        model.node(f"{name} rail", (side * (HALF + 0.002), HEIGHT))
        model.fix(f"{name} rail", "rotation")
        model.move(f"{name} rail", (0.0, 0.15), LIFT, name=f"lift {name}")
        model.prismatic(f"{name} rail", (1.0, 0.0), to=f"{name} jaw", name=f"{name} slide")
        model.force(f"{name} jaw", (-side * grip, 0.0), 1.0, name=f"{name} grip")
        for place, y in (("low", HEIGHT - 0.01), ("high", HEIGHT + 0.01)):
            model.attach(f"{name} {place}", (side * HALF, y), "block")
            model.contact(f"{name} {place}", on=plane((-side, 0.0), node=f"{name} jaw"),
                          name=f"{name} {place} grip", **law)
    return Scene("gripper", "two jaws lift a block by friction", model, h=1e-3, t_end=2.0,
                 base="hand", tip="block")


if __name__ == "__main__":
    from sebody.scenes.scene import main

    main(build)
