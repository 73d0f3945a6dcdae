"""What large local rotations take from linear stiffness."""

import numpy as np

from sebody.analysis.advice.forms import Form, Part
from sebody.analysis.advice.indicators.carried import carried
from sebody.analysis.advice.indicators.recorded import Recorded

MISSED = 0.3        # of the square of a local rotation, by which a stiffened body is off
SHORTER = 1.0 / 6.0  # of length and the square of its ends' rotation: how far a bent body shortens


def local_rotation(recorded: Recorded, part: Part, bodies: int) -> float:
    """Largest rotation of a node against the axes of its body, of a part in so many bodies."""
    return max(float(np.nan_to_num(np.linalg.norm(recorded.deformation(nodes).turns, axis=2)).max())
               for nodes, _ in recorded.bodies(part, bodies))


def linearity(recorded: Recorded, part: Part, form: Form) -> float:
    """Error from the local rotations theta in a form.

    A stiffened body misses what is of third order, ``theta^2`` of the deformation, and one that
    does not stiffen its shortening, too, ``L theta^2 / 6``.
    """
    whole = recorded.deformation(recorded.nodes(part))
    square = local_rotation(recorded, part, form.bodies)**2
    error = MISSED * square * carried(recorded, part, whole.shifts, whole.turns)
    if form.stiffening:
        return error
    shorter = 0.0 * whole.shifts
    for nodes, _ in recorded.bodies(part, form.bodies):
        turns = np.nan_to_num(recorded.deformation(nodes).turns)
        ends = nodes[-1].point - nodes[0].point
        square = (turns**2).sum(axis=2).max(axis=1)
        shorter += SHORTER * square[:, None, None] * ends
    return error + carried(recorded, part, shorter, 0.0 * whole.turns)
