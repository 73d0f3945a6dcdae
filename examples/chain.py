"""A chain of equal links on revolute joints, falling from the horizontal under gravity.

Neighbouring links share the position of their joint; each keeps a rotation of its own there, and
two multipliers keep the axes together.

Look at the path ``tip.position.x:y`` and at ``tip.velocity.norm``: like the end of a whip the tip
reaches 48 m/s, nearly three times the speed of a body in free fall, while the total of ``energy``
stays the same.
"""

import numpy as np

from sebody import Model
from sebody.basics import inputs
from sebody.fem import Section, straight_beam
from sebody.reduction import ReducedBody, craig_bampton
from sebody.scenes.scene import Scene

SECTION = Section(area=4e-4, inertia_y=1.33e-8, inertia_z=1.33e-8, torsion=2.25e-8,
                  youngs_modulus=2.1e11, poisson_ratio=0.3, density=7800.0)
GRAVITY = (0.0, -9.81, 0.0)
AXIS = (0.0, 0.0, 1.0)


def link_body(modes: int = 4, elements: int = 10) -> ReducedBody:
    """One link: a slender steel beam, one metre long."""
    fe_model = straight_beam(np.zeros(3), np.array([1.0, 0.0, 0.0]), SECTION, elements)
    return craig_bampton(fe_model, [(0, "full"), (elements, "full")], modes)


def build(links: int = 16, modes: int = 4, inertia: str | None = None) -> Scene:
    """The scene: a chain let go from the horizontal.

    Parameters
    ----------
    links : int
        Number of links, the first one hinged to the ground.
    modes : int
        Internal modes a link.
    inertia : str
        Inertia option: a or b of the paper, c or d; by default the best the body can have.
    """
    links = inputs.integer(links, "links", least=1, most=100_000)
    body, model = link_body(modes), Model()
    model.gravity(GRAVITY)
    base = model.node("base", np.zeros(3))
    model.revolute(base, axis=AXIS)
    last = base
    for k in range(links):
        end = model.node("tip" if k == links - 1 else f"joint {k + 1}", (k + 1.0, 0.0, 0.0))
        model.superelement(f"link {k + 1}", body, [last, end], inertia=inertia)
        if k < links - 1:
            last = model.node(f"base {k + 2}", end.point, at=end)
            model.revolute(end, AXIS, to=last)
    return Scene("chain", f"chain of {links} flexible links falling under gravity", model, h=0.01,
                 t_end=2.0)


if __name__ == "__main__":
    from sebody.scenes.scene import main

    main(build)
