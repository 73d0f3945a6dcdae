"""Effect of errors of the displacements in a part on the quantities."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.basics.vectors import cross
from sebody.explore.advice.forms import Part
from sebody.explore.advice.indicators.coordinates import nodal
from sebody.explore.advice.indicators.recorded import Recorded
from sebody.model.parts import Node
from sebody.reduction.body import ReducedBody

FORCES = ("force", "moment", "reaction", "torque", "thrust", "multipliers", "forces")
TURNING = ("moment", "torque")


class Force(NamedTuple):
    """Magnitudes of a force and of a moment."""

    force: float = 0.0
    moment: float = 0.0

    @classmethod
    def of(cls, body: ReducedBody, forces: NDArray) -> "Force":
        """The largest at any node of a body, of its coordinates (n, boundary)."""
        return cls(*(float(np.linalg.norm(one, axis=2).max()) for one in nodal(body, forces)))

    def times(self, factor: float) -> "Force":
        """As many times as large."""
        return Force(factor * self.force, factor * self.moment)

    def with_(self, other: "Force") -> "Force":
        """The larger ones."""
        return Force(*map(max, self, other))


def propagated(recorded: Recorded, part: Part, shifts: NDArray, turns: NDArray,
            force: Force | None = None) -> float:
    """Relative error of the quantities, the largest, from errors in a part.

    The part is taken as held at its first node, and at its last. A node elsewhere moves by
    ``|u| + |theta| d``, with its distance d from the part. Rates of it are those of the history.

    Parameters
    ----------
    shifts : (n, k, d)
        Errors of displacements of the part's nodes; nan of nodes without.
    turns : (n, k, r)
        Errors of their rotations; nan of nodes without.
    force : Force, optional
        Errors at its ends; by default its mass times the second rate of the errors.
    """
    nodes, shifts, turns = recorded.nodes(part), np.nan_to_num(shifts), np.nan_to_num(turns)
    points = np.array([node.point for node in nodes])
    largest = 0.0
    for k in {0, len(nodes) - 1}:
        arms = points - points[k]
        moved = shifts - shifts[:, k, None] - cross(turns[:, k, None], arms[None])
        turned = turns - turns[:, k, None]
        for one in zip(recorded.quantities, recorded.owners, recorded.sizes, strict=True):
            largest = max(largest, _error(recorded, part, moved, turned, force, *one))
    return largest


def _error(recorded: Recorded, part: Part, shifts: NDArray, turns: NDArray, force: Force | None,
           name: str, node: Node | None, size: float) -> float:
    """Relative error of one quantity."""
    own, kind = recorded.nodes(part), name.rpartition(".")[2].removeprefix("local_")
    lever = 0.0 if node is None else min(float(np.linalg.norm(node.point - n.point)) for n in own)
    if kind in ("rotation", "angular_velocity", "angular_acceleration"):
        moved = turns
    else:       # directions are not known: displacements add to what rotations carry
        moved = np.abs(shifts) + lever * np.linalg.norm(turns, axis=2, keepdims=True)
    if kind in ("velocity", "angular_velocity"):
        return _largest(recorded.rate(moved)) / size
    if kind in ("acceleration", "angular_acceleration"):
        return _largest(recorded.rate(recorded.rate(moved))) / size
    if kind.endswith(FORCES):
        if force is None:
            inertia = recorded.mass(part) * _largest(recorded.rate(recorded.rate(moved)))
            extent = max(float(np.linalg.norm(n.point - own[0].point)) for n in own)
            force = Force(inertia, inertia * (extent + lever))
        return (force.moment if kind.endswith(TURNING) else force.force) / size
    return _largest(moved) / (size if kind in ("position", "rotation") else recorded.travel)


def _largest(moved: NDArray) -> float:
    return float(np.linalg.norm(moved, axis=2).max())
