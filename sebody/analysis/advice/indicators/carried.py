"""What errors of the displacements in a part do to the quantities."""

import numpy as np
from numpy.typing import NDArray

from sebody.analysis.advice.forms import Part
from sebody.analysis.advice.indicators.recorded import Recorded
from sebody.model.parts import Node

FORCES = ("force", "moment", "reaction", "torque", "thrust", "multipliers", "forces")


def carried(recorded: Recorded, part: Part, shifts: NDArray, turns: NDArray) -> float:
    """Relative error of the quantities, the largest, from errors in a part.

    A node elsewhere moves by ``|u| + |theta| d``, with its distance d from the part. Rates of it
    are those of the history; forces change by the part's mass times its second rate.

    Parameters
    ----------
    shifts : (n, k, d)
        Errors of displacements of the nodes.
    turns : (n, k, r)
        Errors of their rotations; nan of nodes without.
    """
    turns = np.nan_to_num(turns)
    return max((_one(recorded, part, shifts, turns, *one) for one in zip(
        recorded.quantities, recorded.owners, recorded.sizes, strict=True)), default=0.0)


def _one(recorded: Recorded, part: Part, shifts: NDArray, turns: NDArray, name: str,
         node: Node | None, size: float) -> float:
    own, kind = recorded.nodes(part), name.rpartition(".")[2].removeprefix("local_")
    lever = 0.0 if node is None else min(float(np.linalg.norm(node.point - n.point)) for n in own)
    if kind in ("rotation", "angular_velocity", "angular_acceleration"):
        moved = turns
    else:       # signs are not known: displacements add to what rotations carry
        moved = np.abs(shifts) + lever * np.linalg.norm(turns, axis=2, keepdims=True)
    if kind in ("velocity", "angular_velocity"):
        return _largest(recorded.rate(moved)) / size
    if kind in ("acceleration", "angular_acceleration"):
        return _largest(recorded.rate(recorded.rate(moved))) / size
    if kind.endswith(FORCES):
        force = part.body.total_mass * part.given.bodies * _largest(
            recorded.rate(recorded.rate(moved)))
        extent = max(float(np.linalg.norm(n.point - own[0].point)) for n in own)
        return force * (extent + lever if kind.endswith(("moment", "torque")) else 1.0) / size
    return _largest(moved) / (size if kind in ("position", "rotation") else recorded.travel)


def _largest(moved: NDArray) -> float:
    return float(np.linalg.norm(moved, axis=2).max())
