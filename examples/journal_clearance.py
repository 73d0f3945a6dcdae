"""Slider-crank whose rod turns on the crank pin with a clearance of 0.5 mm, and dry friction.

The journal is a disc in a bore: it flies, hits and slides along the bearing.

Look at ``clearance.normal_force``: the journal flies through the clearance at the start, hits the
bearing, bounces, slides along it and lifts off again twice in each turn. ``clearance.gap`` is zero
or a little less in contact, and ``slider.position.x`` shows next to nothing of all this.
"""

from sebody import Model, sphere
from sebody.scenes.scene import Scene

CRANK, ROD, SPEED = 0.05, 0.12, 100.0
BORE = 0.010


def build(clearance: float = 0.5e-3, friction: float = 0.1, restitution: float = 0.5) -> Scene:
    """The scene, moving from the start.

    Parameters
    ----------
    clearance : float
        Radius of the bore less that of the journal [m].
    friction : float
        Coefficient in the bearing.
    restitution : float
        At an impact of 0.1 m/s.
    """
    model = Model(planar=True)
    model.node("shaft", (0.0, 0.0))
    model.rigid_body("crank", "shaft", 0.5, 2e-4, centre=(CRANK / 2, 0.0))
    model.revolute("shaft", name="bearing")
    model.drive_angle("shaft", lambda t: SPEED * t, name="motor")
    model.attach("pin", (CRANK, 0.0), "shaft")
    model.node("journal", (CRANK, 0.0))
    model.rigid_body("rod", "journal", 0.2, 3e-4, centre=(CRANK + ROD / 2, 0.0))
    model.attach("end", (CRANK + ROD, 0.0), "journal")
    model.node("slider", (CRANK + ROD, 0.0))
    model.rigid_body("piston", "slider", 0.3, 1e-4)
    model.revolute("slider", to="end", name="wrist")
    model.node("guide", (CRANK + ROD, 0.0))
    model.fix("guide")
    model.prismatic("guide", (1.0, 0.0), to="slider", name="guide way")
    model.contact("journal", on=sphere(BORE + clearance, node="pin", inside=True), radius=BORE,
                  stiffness=2e9, restitution=restitution, at_speed=0.1, friction=friction,
                  name="clearance")
    return Scene("journal-clearance", "slider-crank with a clearance of 0.5 mm in a bearing", model,
                 h=2e-5, t_end=0.13, base="shaft", tip="slider")


if __name__ == "__main__":
    from sebody.scenes.scene import main

    main(build)
