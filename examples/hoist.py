"""A winch on the ground lifts a load by a block and tackle at the tip of a boom that bends.

The boom hinges at its foot and hangs on a stay, a rope of its own. The hoisting rope leads from the
drum over the sheaves of the head and of the hook to its dead end, in as many falls as wanted: each
carries its share of the load, and the drum winds as many times its way. The load stands on the
ground at first, with the rope free of tension; the winch lifts it in 4 s.

Look at ``hoist.tension``, which is a share of the weight once the load hangs, at ``stay.tension``,
at ``hook.position.y``, and at ``motor.power``.
"""

from sebody import Model, plane, rest_to_rest
from sebody.basics import inputs
from sebody.fem import rectangle
from sebody.scenes.scene import Scene

TIP, MAST, DRUM, WINDING = (4.0, 3.0), (-1.5, 3.5), (-1.5, 0.3), 0.2     # m
HOOK, LIFTED, G = 0.5, 1.2, 9.81                # m, m, m/s^2
SHEAVES = 0.12, 0.08                            # m: the smallest, and by how much others are larger
STEEL = {"youngs_modulus": 2.1e11, "poisson_ratio": 0.3, "density": 7850.0}


def build(falls: int = 4, load: float = 1000.0) -> Scene:
    """The scene.

    Parameters
    ----------
    falls : int
        Parts of the rope that carry the load.
    load : float
        Mass of the load and the hook [kg].
    """
    falls, load = inputs.integer(falls, "falls", least=1), inputs.number(load, "load", above=0)
    model = Model(planar=True, units="m kg s N")
    for name, point in (("foot", (0.0, 0.0)), ("tip", TIP), ("mast", MAST), ("drum", DRUM)):
        model.node(name, point)
    model.node("hook", (TIP[0], HOOK), "translation")
    model.fix("mast")
    model.revolute("foot", name="hinge")
    model.beam("boom", ("foot", "tip"), rectangle(0.2, 0.1, **STEEL), 6, 1, 3, damping=0.02)
    model.rigid_body("drum", "drum", 60.0, 1.2)
    model.revolute("drum", name="axle")
    model.point_mass("load", "hook", load)
    model.gravity((0.0, -G))
    model.contact("hook", on=plane((0.0, 1.0), (0.0, HOOK)), stiffness=5e6, restitution=0.3,
                  name="ground")
    model.rope("stay", ("mast", "tip"), stiffness=4e7, damping=1e6)
    model.sheave("winch", "drum", WINDING)
    blocks = {"head": (falls + 1) // 2, "hook": falls // 2}
    for name, count in blocks.items():
        for k in range(count):
            model.sheave(f"{name} {k + 1}", "tip" if name == "head" else name,
                         SHEAVES[0] + k * SHEAVES[1])
    passed = [f"{name} {k + 1}" for k in range(blocks["head"]) for name in blocks
              if k < blocks[name]]
    dead_end = "hook" if falls % 2 else "tip"
    model.rope("hoist", ("winch", *passed, dead_end), 1e7, damping=2e5, wrap="-")
    model.drive_angle("axle", rest_to_rest(falls * LIFTED / WINDING, 4.0), name="motor")
    return Scene("hoist", f"a block and tackle of {falls} falls on a boom", model, h=2e-3,
                 t_end=6.0, base="foot", tip="hook")


if __name__ == "__main__":
    from sebody.scenes.scene import main

    main(build)
