"""A swinging arm whose box frame and bolted flange are one body, reduced with their joints.

Two longerons and two cross-beams make a box; a flange on its far cross-beam carries a snout by four
bolts, each in tension, that press the plates together: a bushing in their middle. All that,
linearized in the equilibrium of bolts and plates, is one superelement between the hinge and the
tip, which carries a tool. A profile from rest to rest turns the hinge; the tip swings after it.
With ``reduced=False`` the model has all bodies, springs and plates instead.

Look at ``tip.position.z``, and at ``drive.moment``, what turns the arm.
"""

import numpy as np

from sebody import Model, rest_to_rest
from sebody.fem import straight_beam, tube
from sebody.reduction import craig_bampton, reduce_model
from sebody.scenes.scene import Scene

STEEL = {"youngs_modulus": 2.1e11, "poisson_ratio": 0.3, "density": 7850.0}
BOX, SNOUT = tube(0.03, 0.003, **STEEL), tube(0.025, 0.003, **STEEL)
LENGTH, WIDTH, REACH = 1.2, 0.4, 0.8                # m
CIRCLE, GRIP, BOLT = 0.06, 0.02, 2e8                # m, m, N/m: of the bolts
ANGLE, DURATION = 0.8, 0.4                          # rad, s


def arm(model: Model, tension: float) -> None:
    """The box and the snout, from the node ``root`` to the node ``tip``."""
    root, middle = model.node("root", (0, 0, 0)), model.node("flange", (LENGTH, 0, 0))
    corners = {}
    for end, x, at in (("near", 0.0, root), ("far", LENGTH, middle)):
        sides = [model.node(f"{end} {side}", (x, y, 0)) for side, y in (
            ("left", WIDTH / 2), ("right", -WIDTH / 2))]
        beam = straight_beam(sides[0].point, sides[1].point, BOX, 6)
        body = craig_bampton(beam, dict.fromkeys((0, 3, 6), "full"), 4)
        model.superelement(end, body, [sides[0], at, sides[1]])
        corners[end] = sides
    for side, near, far in zip(("left", "right"), *corners.values(), strict=True):
        model.beam(side, (near, far), BOX, elements=6, bodies=1, modes=4)
    plate, tip = model.node("plate", middle.point), model.node("tip", (LENGTH + REACH, 0, 0))
    model.beam("snout", (plate, tip), SNOUT, elements=6, bodies=1, modes=4)
    for node in (middle, plate):
        model.rigid_body(f"{node.name} ring", node, 2.0, (4e-3, 2e-3, 2e-3))
    model.bushing("flange", "plate", stiffness=[5e8] * 3, turning_stiffness=[1e6] * 3,
                  name="contact of the plates")
    for k in range(4):
        y, z = CIRCLE * np.cos(np.pi * k / 2), CIRCLE * np.sin(np.pi * k / 2)
        ends = [model.attach(f"{node.name} bolt {k}", (LENGTH + x, y, z), node)
                for node, x in ((middle, -GRIP), (plate, GRIP))]
        model.spring(*ends, stiffness=BOLT, length=2 * GRIP - tension / BOLT, name=f"bolt {k}")


def build(reduced: bool = True, modes: int = 10, tension: float = 2e4) -> Scene:
    """The scene.

    Parameters
    ----------
    reduced : bool
        Whether the arm is one body.
    modes : int
        Its internal modes.
    tension : float
        In each bolt before the plates give way [N].
    """
    inside, model = Model(units="m kg s N"), Model(units="m kg s N")
    if reduced:
        arm(inside, tension)
        body = reduce_model(inside, ["root", "tip"], modes).damped(0.01)
        nodes = [model.node(name, point) for name, point in zip(("root", "tip"), body.coordinates,
                                                                strict=True)]
        model.superelement("arm", body, nodes)
    else:
        arm(model, tension)
    model.rigid_body("tool", "tip", 5.0, (0.02, 0.02, 0.02))
    model.gravity((0.0, 0.0, -9.81))
    hinge = model.revolute("root", axis=(0.0, -1.0, 0.0), name="hinge")
    model.drive_angle(hinge, rest_to_rest(ANGLE, DURATION, 0.05), name="drive")
    return Scene("bolted-arm", "a box frame and a bolted flange as one swinging body", model,
                 h=5e-4, t_end=0.8, base="root", tip="tip")


if __name__ == "__main__":
    from sebody.scenes.scene import main

    main(build)
