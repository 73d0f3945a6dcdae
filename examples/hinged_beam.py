"""The paper's hinged beam (section 8.1): one superelement spun up by a torque at its hinge."""

import numpy as np

from sebody import Model
from sebody.fem import Section, straight_beam
from sebody.reduction import craig_bampton
from sebody.scenes.scene import Scene

SECTION = Section(area=9.0, inertia_y=6.75, inertia_z=6.75, torsion=11.387,
                  youngs_modulus=2.1e6, poisson_ratio=0.3, density=7.8e-3)
TORQUE = [(0.0, 0.0), (2.5, 1.2e4), (5.0, 1.2e4), (7.5, 0.0)]


def build(frame: str = "converged_mean", inertia: str = "b", modes: int = 4,
          elements: int = 20) -> Scene:
    """The scene: beam of length 100 sqrt(2) along (1, 1, 0), hinged about z at its base."""
    end = np.array([100.0, 100.0, 0.0])
    fe_model = straight_beam(np.zeros(3), end, SECTION, elements)
    body = craig_bampton(fe_model, [(0, "full"), (elements, "full")], modes)
    model = Model()
    base = model.node("base", np.zeros(3))
    tip = model.node("tip", end)
    model.superelement("beam", body, [base, tip], frame=frame, inertia=inertia)
    model.revolute(base, axis=(0, 0, 1))
    model.torque(base, (0, 0, 1), TORQUE)
    return Scene("hinged-beam", "the paper's hinged beam, spun up by a torque at its base",
                 model, h=0.01, t_end=30.0)


if __name__ == "__main__":
    from sebody.scenes.scene import main

    main(build)
