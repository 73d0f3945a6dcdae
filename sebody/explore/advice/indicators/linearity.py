"""Error of linear stiffness by large local rotations."""

import numpy as np

from sebody.explore.advice.forms import Form, Part
from sebody.explore.advice.indicators.propagated import propagated
from sebody.explore.advice.indicators.recorded import Recorded
from sebody.explore.advice.indicators.vibration import strain_force

MISSED = 0.5        # of the square of a local rotation, by which the deformation is off


def local_rotations(recorded: Recorded, part: Part, bodies: int) -> list[float]:
    """Largest rotations of nodes against the axes of their bodies, of a part in so many bodies."""
    return [float(np.nan_to_num(np.linalg.norm(recorded.deformation(nodes).turns, axis=2)).max())
            for nodes, _ in recorded.bodies(part, bodies)]


def linearity(recorded: Recorded, part: Part, form: Form) -> float:
    """Error from the local rotations theta in a form: ``theta^2 / 2`` of the deformation.

    The error of each body of a beam is its own square, weighted by its part of the rotation.
    """
    if form.bodies == part.detailed.bodies:
        return 0.0
    return bent(recorded, part, form.bodies)


def bent(recorded: Recorded, part: Part, bodies: int) -> float:
    """Error of linear theory in a part of so many bodies."""
    whole = recorded.deformation(recorded.nodes(part))
    rotations = np.array(local_rotations(recorded, part, bodies))
    square = (rotations**3).sum() / max(rotations.sum(), 1e-300)
    return min(MISSED * square, 1.0) * propagated(recorded, part, whole.shifts, whole.turns,
                                               strain_force(recorded, part))
