"""The motion of the reference, as indicators need it: displacements of the nodes in their parts."""

from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.explore.advice.forms import Part
from sebody.model.model import Model
from sebody.model.parts import Node
from sebody.model.variants import divide
from sebody.reduction.body import ReducedBody
from sebody.results import rotations
from sebody.results.result import Result

MORE = 2            # times the most modes that forms have, which are looked at
STATES = 400        # states that are looked at


class Deformation(NamedTuple):
    """Deformation of nodes against axes that follow them: their mean rotation, or best fit."""

    shifts: NDArray     # (n, k, d) displacements in these axes; nan of nodes without a position
    turns: NDArray      # (n, k, 3 or 1) rotations against them; nan of nodes without one
    axes: NDArray       # (n, d, d)


class Recorded:
    """A run of the reference model, with the quantities that are to be kept.

    Parameters
    ----------
    given : Model
        As the user gave it.
    result : Result
    quantities : list of str
    sizes : list of float
        Largest changes of the quantities.
    frequencies : list of float
        That are to be kept, angular ones.
    parts : list of Part
        All that deform.
    """

    def __init__(self, given: Model, result: Result, quantities: list[str],
                 sizes: list[float], frequencies: list[float], parts: list[Part]):
        self.given, self.result, self.quantities, self.sizes = given, result, quantities, sizes
        self.frequencies, self.parts = frequencies, parts
        self.every = max(1, len(result.rows) // STATES)
        self.duration = float(result.t[-1])
        self.interval = self.every * float(result.t[1] - result.t[0])
        self.indicated: dict[tuple, float] = {}     # errors by indicator and what they depend on
        self.vibration: tuple | None = None         # of all parts, once it was looked at
        self._found: dict[tuple, Deformation] = {}
        self._bodies: dict[tuple[str, int], list[tuple[list[Node], ReducedBody]]] = {}

    def nodes(self, part: Part) -> list[Node]:
        """Nodes of a part in the reference model; of a beam from end to end."""
        bodies = self.result.model.bodies
        listed = [node for name in part.superelements(part.detailed) for node in bodies[name].nodes]
        return list(dict.fromkeys(listed))

    def bodies(self, part: Part, count: int) -> list[tuple[list[Node], ReducedBody]]:
        """Bodies of a part divided into so many, with all modes; their nodes in the reference."""
        key = part.name, count
        if key not in self._bodies:
            nodes = self.nodes(part)
            if part.beam is None:
                self._bodies[key] = [(nodes, part.body)]
            else:
                places = [round(k * (len(nodes) - 1) / count) for k in range(count + 1)]
                made = divide(self.given, part.name, count, part.elements,
                              modes=_seen(part, count)).model
                self._bodies[key] = [
                    ([nodes[i], nodes[j]], body.reduced) for i, j, body in zip(
                        places, places[1:], made.beams[-1].parts, strict=False)]
        return self._bodies[key]

    def accelerations(self, nodes: list[Node], body: ReducedBody) -> NDArray:
        """Accelerations of a body's boundary, in its axes at the start, (n, coordinates)."""
        axes = self.deformation(nodes).axes
        places = [np.einsum("nji,nj->ni", axes, self.read(nodes[k], "acceleration"))
                  for k in body.position_nodes]
        turns = [self.read(nodes[k], "angular_acceleration") for k in body.rotation_nodes]
        turns = [one[:, None] if one.ndim == 1 else np.einsum("nji,nj->ni", axes, one)
                 for one in turns]
        return np.hstack([*places, *turns])

    def spins(self, nodes: list[Node]) -> NDArray:
        """Angular velocities of the axes of a body, (n, 3 or 1)."""
        axes = self.deformation(nodes).axes
        return _angles(np.swapaxes(axes[:-1], 1, 2) @ axes[1:]) / self.interval

    def rate(self, history: NDArray) -> NDArray:
        """Rate of a history at the examined states."""
        return np.gradient(history, self.interval, axis=0)

    def deformation(self, nodes: list[Node]) -> Deformation:
        """Deformation of some nodes of a part."""
        key = tuple(node.name for node in nodes)
        if key not in self._found:
            self._found[key] = self._deformation(nodes)
        return self._found[key]

    def _deformation(self, nodes: list[Node]) -> Deformation:
        points = np.array([node.point for node in nodes])
        read = [self.read(node, "position") for node in nodes]
        placed = [k for k, one in enumerate(read) if one is not None]
        nowhere = np.full_like(read[placed[0]], np.nan)
        x = np.stack([nowhere if one is None else one for one in read], axis=1)
        R = [self.read(node, "rotation") for node in nodes]
        known = [_matrices(one) for one in R if one is not None]
        arms = points - points[placed].mean(axis=0)
        places = x - x[:, placed].mean(axis=1)[:, None]
        axes = rotations.nearest(sum(known) if known else np.einsum("nki,kj->nij", places, arms))
        shifts = np.einsum("nji,nkj->nki", axes, places) - arms
        planar, parts = points.shape[1] == 2, []
        for one in R:
            local = None if one is None else np.swapaxes(axes, 1, 2) @ _matrices(one)
            parts.append(np.full((len(x), 1 if planar else 3), np.nan) if local is None else
                         _angles(local))
        return Deformation(shifts, np.stack(parts, axis=1), axes)

    def read(self, node: Node, quantity: str) -> NDArray | None:
        """A history of a node at the examined states; None without this DOF block."""
        dof_block = getattr(node, "rotation" if "rotation" in quantity or "angular" in quantity
                          else "position")
        if dof_block is None or dof_block not in self.result.numbering.dof_blocks:
            return None
        return self.result[f"{node.name}.{quantity}"][::self.every]

    @cached_property
    def motion_frequency(self) -> float:
        """Mean angular frequency of the motion of the nodes: of accelerations over velocities."""
        v, a = (np.stack([one for node in self.result.model.nodes.values()
                          if (one := self.read(node, name)) is not None])
                for name in ("velocity", "acceleration"))
        size = float(np.sqrt((v**2).mean()))
        return float(np.sqrt((a**2).mean())) / size if size > 0.0 else 0.0

    def mass(self, part: Part) -> float:
        """Mass of a part."""
        return sum(body.total_mass for _, body in self.bodies(part, 1))

    @cached_property
    def travel(self) -> float:
        """Largest displacement of any node of the model."""
        paths = [self.read(node, "position") for node in self.result.model.nodes.values()]
        return max(float(np.linalg.norm(x - x[0], axis=1).max()) for x in paths if x is not None)

    @cached_property
    def owners(self) -> list[Node | None]:
        """The node that each quantity belongs to, None of others."""
        nodes = self.result.model.nodes
        return [nodes.get(name.rpartition(".")[0]) for name in self.quantities]


def _seen(part: Part, count: int) -> int:
    """Modes of each of so many bodies of a beam: more than any form has, where its mesh has them.

    So what forms with all their modes leave out is seen, too.
    """
    most = max(form.modes for form in part.forms if form.bodies == count)
    inner = (part.elements // count - 1) * (3 if part.planar else 6)
    return max(most, min(MORE * most, inner))


def _matrices(history: NDArray) -> NDArray:
    """Rotation matrices of a history of matrices, or of angles in a plane."""
    if history.ndim == 3:
        return history
    c, s = np.cos(history), np.sin(history)
    return np.stack([np.stack([c, -s], axis=1), np.stack([s, c], axis=1)], axis=1)


def _angles(R: NDArray) -> NDArray:
    """Rotation vectors of moderate rotations, (n, 3), in a plane (n, 1)."""
    if R.shape[1] == 2:
        return np.arctan2(R[:, 1, 0], R[:, 0, 0])[:, None]
    return rotations.vectors(R)
