"""A right-angle frame hinged at one end, loaded at a node that keeps only its position.

The load node needs no rotation: three unknowns less, and nothing lost (`layout="full"` compares).

Look at ``elbow.position`` and ``tip.position``: the push has parts out of the plane of the frame,
so the corner twists, and the frame turns about its hinge while it vibrates.
"""

import numpy as np

from sebody import Model
from sebody.basics import inputs
from sebody.fem import frame
from sebody.reduction import craig_bampton
from sebody.scenes.hinged_beam import SECTION
from sebody.scenes.scene import Scene

POINTS = np.array([[0.0, 0.0, 0.0], [60.0, 0.0, 0.0], [60.0, 40.0, 0.0]])
PUSH = [(0.0, 0.0), (0.5, 60.0), (1.0, 0.0)]


def build(layout: str = "small", modes: int = 6, elements: int = 10,
          inertia: str | None = None) -> Scene:
    """The scene.

    Parameters
    ----------
    layout : str
        'small': load node without rotation; 'full': with it.
    modes : int
        Internal modes.
    elements : int
        Finite elements a leg.
    inertia : str
        Inertia option: a or b of the paper, c or d; by default the best the body can have.
    """
    keeps = {"small": "translation", "full": "full"}
    keep = keeps[inputs.choice(layout, "layout", keeps)]
    fe_model = frame(POINTS, [(0, 1), (1, 2)], SECTION, elements)
    body = craig_bampton(fe_model, [(0, "full"), (1, "full"), (2, keep)], modes)
    model = Model()
    base, elbow = model.node("base", POINTS[0]), model.node("elbow", POINTS[1])
    tip = model.node("tip", POINTS[2], keep)
    model.superelement("frame", body, [base, elbow, tip], inertia=inertia)
    model.revolute(base, axis=(0, 0, 1))
    model.force(tip, (-1.0, 0.5, 0.3), PUSH)
    return Scene("right-angle-frame", "right-angle frame with a translation-only load node", model,
                 h=0.005, t_end=3.0)


if __name__ == "__main__":
    from sebody.scenes.scene import main

    main(build)
