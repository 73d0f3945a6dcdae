"""A trolley carries a hanging load along a crane of two girders, which come from a CalculiX deck.

The girders are bodies of solid elements, imported with a path along their tops and static modes of
loads on it. They rest on two fixed legs and on two legs that hinge at both ends, so that no girder
is strained along itself. One wheel of the trolley keeps to its rail in all directions, the other
one is free across. The load is picked up within a second, and then moved by 10 m in 6 s; places
and forces count from those under the crane's own weight.

Look at ``load.position.x``, which swings behind the trolley and on after it stops, and at
``left.normal_force`` and ``right.normal_force``, which share the load as it hangs nearer to one
girder. Colour the page by von Mises stress: the bend of the girders follows the trolley.
"""

from sebody import Model, rest_to_rest
from sebody.basics import inputs
from sebody.fem import rectangle
from sebody.io import load_body
from sebody.scenes.crane_girder import FILE, HEIGHT, LENGTH, WIDTH
from sebody.scenes.scene import Scene

GAUGE, LEGS, ROPE = 3.0, 5.0, 4.0               # m: between the girders, of the legs, of the rope
WHEEL, TROLLEY, LOAD, G = 400.0, 800.0, 5000.0, 9.81    # kg, m/s^2
START, WAY, PICKED_UP, MOVED = 4.0, 10.0, 1.0, 6.0      # m, m; s, s
NEARER = 1 / 3                                  # of the gauge: where the load hangs


def build(load: float = LOAD) -> Scene:
    """The scene, at rest, with the load on the ground.

    Parameters
    ----------
    load : float
        Mass that is carried [kg].
    """
    load = inputs.number(load, "load", above=0)
    model = Model(units="m kg s N")
    carriage = rectangle(HEIGHT, WIDTH, youngs_modulus=2.1e11, poisson_ratio=0.3, density=2747.5)
    sides, top = {"left": 0.0, "right": GAUGE}, HEIGHT / 2
    for side, y in sides.items():
        ends = [model.node(f"{side} {name}", (x, y, 0.0))
                for name, x in (("near", 0.0), ("far", LENGTH))]
        model.superelement(f"{side} girder", load_body(FILE), ends)
        model.fix(ends[0], "position")
        foot = model.node(f"{side} foot", (LENGTH, y, -LEGS), "translation")
        model.fix(foot, "position")
        model.distance(ends[1], foot, name=f"{side} leg")
        model.path(f"{side} rail", on=f"{side} girder", nodes="RAIL")
    for end in ("near", "far"):
        model.beam(f"{end} carriage", (f"left {end}", f"right {end}"), carriage, 4, 1, 2,
                   up=(0, 0, 1))
    trolley = model.node("trolley", (START, NEARER * GAUGE, top))
    model.rigid_body("trolley frame", trolley, TROLLEY, (600.0, 60.0, 600.0),
                     centre=(START, GAUGE / 2, top))
    for side, y in sides.items():
        wheel = model.node(f"{side} wheel", (START, y, top), "translation")
        model.point_mass(f"{side} wheels", wheel, WHEEL)
        model.path_joint(wheel, f"{side} rail", name=side)
        model.drive_way(side, rest_to_rest(WAY, MOVED, PICKED_UP), name=f"{side} engine")
    model.spherical(model.attach("axle", (START, 0.0, top), trolley), "left wheel")
    model.slider("right wheel", (0, 1, 0), trolley, name="across")
    hung = model.node("load", (START, NEARER * GAUGE, top - ROPE), "translation")
    model.point_mass("crate", hung, load)
    model.distance(hung, trolley, name="rope")
    model.force(hung, (0, 0, -load * G), rest_to_rest(1.0, PICKED_UP), name="weight")
    return Scene("crane", "a trolley with a hanging load on two girders", model, h=5e-3, t_end=10.0,
                 base="left wheel", tip="load")


if __name__ == "__main__":
    from sebody.scenes.scene import main

    main(build)
