"""A box of stiff members known at its eight corners by their positions only.

No rotations anywhere: the frame is the rotation of best fit of the corners. The box hangs on a
spherical joint, which is one fixed position (`layout="full"` keeps the corners' rotations).

Look at ``tip.velocity``: the push of 0.6 s leaves the box tumbling about its corner, and its
vibrations, ``box.modes``, go on.
"""

from itertools import combinations, product

import numpy as np

from sebody import Model
from sebody.basics import inputs
from sebody.fem import frame
from sebody.reduction import craig_bampton
from sebody.scenes.hinged_beam import SECTION
from sebody.scenes.scene import Scene

SIZES = np.array([30.0, 24.0, 18.0])
CORNERS = np.array(list(product((0.0, 1.0), repeat=3))) * SIZES
PUSH = [(0.0, 0.0), (0.3, 40.0), (0.6, 0.0)]


def build(layout: str = "small", modes: int = 6, elements: int = 4,
          inertia: str | None = None) -> Scene:
    """The scene.

    Parameters
    ----------
    layout : str
        'small': corners without rotation; 'full': with it.
    modes : int
        Internal modes.
    elements : int
        Finite elements a member.
    inertia : str
        Inertia option: a or b of the paper, c or d; by default the best the body can have.
    """
    keeps = {"small": "translation", "full": "full"}
    keep = keeps[inputs.choice(layout, "layout", keeps)]
    edges = [(i, j) for i, j in combinations(range(8), 2)
             if np.count_nonzero(CORNERS[i] != CORNERS[j]) == 1]
    fe_model = frame(CORNERS, edges, SECTION, elements)
    body = craig_bampton(fe_model, [(i, keep) for i in range(8)], modes)
    model = Model()
    nodes = [model.node(name, point, keep) for name, point in zip(
        ("base", "b", "c", "d", "e", "f", "g", "tip"), CORNERS, strict=True)]
    model.superelement("box", body, nodes,
                       frame="positions" if layout == "small" else "converged_mean",
                       inertia=inertia)
    model.fix("base", "position")
    model.force("tip", (0.2, 1.0, -0.6), PUSH)
    return Scene("box", "box of members with eight translation-only corners, on a spherical joint",
                 model, h=0.005, t_end=20.0)


if __name__ == "__main__":
    from sebody.scenes.scene import main

    main(build)
