"""A machine bed that stands on the ground, with a column, a moving axis and a coolant tank.

The bed is a body whose base, the soles of its feet, is held. A carriage of 400 kg runs along it by
a profile from rest to rest and pushes the bed with the force of its drive; column and tool swing
after it stops. Coolant sloshes in a tank on the bed, given by its mass, frequencies and
participation factors. Displacements count from the place where the weights hold the machine.

Look at ``carriage.position.x`` and at ``tool.position.x``, which swings by a hundredth of a
millimetre when the carriage starts and stops; ``drive.thrust`` is what the bed takes.
"""

import numpy as np

from sebody import Model, rest_to_rest
from sebody.fem import frame, tube
from sebody.reduction import RigidFace, appendage, grounded_from_fe
from sebody.scenes.scene import Scene

IRON = {"youngs_modulus": 1.1e11, "poisson_ratio": 0.26, "density": 7200.0}
LENGTH, WIDTH, HEIGHT, COLUMN = 3.0, 0.8, 0.6, 1.5      # m
CARRIAGE, COOLANT = 400.0, 60.0                         # kg
STROKE, DURATION = 1.2, 0.5                             # m, s


def bed():
    """FE model of two beams on six feet with a column at one end, its feet, rail and tool."""
    along, across = np.linspace(0.0, LENGTH, 4), (-WIDTH / 2, WIDTH / 2)
    rails = [(x, y, HEIGHT) for y in across for x in along]
    feet = [(x, y, 0.0) for y in across for x in along[[0, 2, 3]]]
    column = [(0.0, 0.0, HEIGHT), (0.0, 0.0, HEIGHT + COLUMN), (0.5, 0.0, HEIGHT + COLUMN)]
    points = rails + feet + column
    members = [(k + i, k + i + 1) for k in (0, 4) for i in range(3)]
    members += [(1, 5), (2, 6), (3, 7), (0, 14), (14, 4), (14, 15), (15, 16)]
    members += [(k + i, 8 + k // 4 * 3 + n) for k in (0, 4) for n, i in enumerate((0, 2, 3))]
    return frame(points, members, tube(0.14, 0.02, **IRON), 3), range(8, 14), (1, 2, 5, 6), 16


def build(duration: float = DURATION) -> Scene:
    """The scene.

    Parameters
    ----------
    duration : float
        Of the stroke of the carriage [s].
    """
    fe, feet, rail, tool = bed()
    places = fe.coordinates
    middle, floor = places[list(rail)].mean(axis=0), (LENGTH / 2, 0.0, 0.0)
    body = grounded_from_fe(fe, [(RigidFace(middle, rail), "full"), (tool, "full")],
                            RigidFace(floor, tuple(feet)), 8).damped(0.01)
    model = Model(units="m kg s N")
    nodes = [model.node("rail", middle), model.node("tool", places[tool])]
    model.foundation("bed", body, nodes)
    model.rigid_body("spindle", "tool", 80.0, (2.0, 2.0, 1.0))
    carriage = model.node("carriage", middle + (-0.6, 0.0, 0.0))
    model.rigid_body("table", carriage, CARRIAGE, (20.0, 25.0, 30.0), carriage.point + (0, 0, 0.2))
    model.prismatic(carriage, axis=(1.0, 0.0, 0.0), to="rail", name="guide")
    model.drive_slide(carriage, rest_to_rest(STROKE, duration, 0.1), (1.0, 0.0, 0.0), "rail",
                      name="drive")
    water = np.sqrt(0.6 * COOLANT) * np.eye(6)[:2]      # of which six tenths slosh
    model.superelement("coolant", appendage(np.diag([COOLANT] * 3 + [5.0] * 3), [1.1, 1.3], water,
                                            0.02, point=middle), ["rail"])
    return Scene("machine-bed", "a machine bed on the ground with a moving axis", model, h=0.001,
                 t_end=1.2, base="rail", tip="tool")


if __name__ == "__main__":
    from sebody.scenes.scene import main

    main(build)
