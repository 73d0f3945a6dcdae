"""N four-bar mechanism: parallel rockers and couplers that fall through flat configurations.

One degree of freedom. Each rocker and coupler is one angle; a coupler hangs on the tip of its
rocker by a rigid link, and two multipliers close each loop.

Look at ``B0.position.x:y``: the rockers go round, and twice in each turn all bars are in one line,
where the linkage has no unique motion; ``energy`` passes these places unchanged.
"""

from sebody import Model
from sebody.basics import inputs
from sebody.scenes.scene import Scene

GRAVITY = (0.0, -9.81)
INERTIA = 1.0 / 12.0        # of a rod of mass and length one about its middle


def build(loops: int = 2) -> Scene:
    """The scene: upright, its first joint moving with velocity one (IFToMM benchmark A02).

    Parameters
    ----------
    loops : int
        Number of four-bar loops side by side.
    """
    loops = inputs.integer(loops, "loops", least=1, most=100_000)
    model = Model(planar=True)
    model.gravity(GRAVITY)
    for k in range(loops + 1):
        foot = model.node(f"ground {k}", (k, 0.0))
        model.fix(foot, "position")
        model.rigid_body(f"rocker {k}", foot, 1.0, INERTIA, centre=(k, 0.5))
        model.attach(f"B{k}", (k, 1.0), foot)
    for k in range(loops):
        left = model.node(f"coupler {k}", (k, 1.0), at=f"B{k}")
        model.rigid_body(f"coupler {k}", left, 1.0, INERTIA, centre=(k + 0.5, 1.0))
        right = model.attach(f"end {k}", (k + 1.0, 1.0), left)
        model.spherical(right, f"B{k + 1}")
    model.initial_velocity("ground 0", angular=-1.0)
    return Scene("four-bar", f"{loops} four-bar loops", model, h=1e-3, t_end=10.0, base="ground 0",
                 tip="B0")


if __name__ == "__main__":
    from sebody.scenes.scene import main

    main(build)
