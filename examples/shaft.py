"""A shaft in a bearing at one end, driven by a torque at a node that keeps only its rotation.

The gear seat in the middle moves nothing but its angle: three unknowns less (`layout="full"`
compares).

Look at ``gear.angular_velocity.x`` and ``tip.position.y``: the gear seat has a rotation but no
position, and turns the whole shaft, whose end is bent by the push and comes back when it ends.
"""

import numpy as np

from sebody import Model
from sebody.basics import inputs
from sebody.fem import straight_beam
from sebody.reduction import craig_bampton
from sebody.scenes.hinged_beam import SECTION
from sebody.scenes.scene import Scene

LENGTH = 80.0
TORQUE = [(0.0, 0.0), (0.2, 1.0), (0.8, 1.0), (1.0, 0.0)]


def build(layout: str = "small", modes: int = 8, elements: int = 16,
          inertia: str | None = None) -> Scene:
    """The scene.

    Parameters
    ----------
    layout : str
        'small': gear seat without position; 'full': with it.
    modes : int
        Internal modes.
    elements : int
        Finite elements, an even number.
    inertia : str
        Inertia option: a or b of the paper, c or d; by default the best the body can have.
    """
    keeps = {"small": "rotation", "full": "full"}
    keep = keeps[inputs.choice(layout, "layout", keeps)]
    half = inputs.integer(elements / 2, "half the number of elements", least=1)
    start, end = np.zeros(3), np.array([LENGTH, 0.0, 0.0])
    fe_model = straight_beam(start, end, SECTION, elements)
    body = craig_bampton(fe_model, [(0, "full"), (elements, "full"), (half, keep)], modes)
    model = Model()
    base, tip = model.node("base", start), model.node("tip", end)
    gear = model.node("gear", end / 2, keep)
    model.superelement("shaft", body, [base, tip, gear], inertia=inertia)
    model.revolute(base, axis=(1, 0, 0))
    model.torque(gear, (1.0, 0.0, 0.0), TORQUE)
    model.force(tip, (0.0, 4.0, 2.0), TORQUE)
    return Scene("shaft", "shaft driven at a rotation-only node, pushed sideways at its end",
                 model, h=0.005, t_end=3.0)


if __name__ == "__main__":
    from sebody.scenes.scene import main

    main(build)
