"""Bodies given by a moving frame and modes: with boundary nodes, where the modes let these move."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import LinAlgError, eigh, null_space

from sebody.basics.errors import InputError
from sebody.reduction.rigid_motions import rigid_motions

_SPAN = 1e-8    # smallest singular value of the nodes' motions, relative to the largest


class ModalNode(NamedTuple):
    """A node: its place, displacements and rotations (3, nq) in the modes."""

    name: str
    point: NDArray
    phi: NDArray | None
    psi: NDArray | None

    @property
    def turns(self) -> bool:
        """Tell whether the modes turn it; shapes of zeros are those of a node without rotations."""
        return bool(np.any(self.psi))


class ModalBody(NamedTuple):
    """Matrices (6 + nq, 6 + nq) of rigid motions about the origin, then of modes."""

    mass: NDArray
    stiffness: NDArray
    nodes: list[ModalNode]
    source: str
    damping: NDArray | None = None

    def keeps(self, label: str) -> str:
        """Triplets that a node has."""
        turns = [node.turns for node in self.nodes if node.name == label]
        return "translation" if turns == [False] else "full"

    def with_boundary(self, labels: list[str], keeps: list[str]) -> dict:
        """Arguments of the `ReducedBody` whose boundary are some nodes.

        What the nodes leave of the modes becomes vibration modes with the boundary clamped.

        Raises
        ------
        InputError
            Unknown nodes, or modes that do not span the motions of these nodes.
        """
        by_name = {node.name: node for node in self.nodes}
        for label in labels:
            if label not in by_name:
                raise InputError(f"{self.source} has no node {label}: there are "
                                 f"{', '.join(by_name)}")
        chosen = [by_name[label] for label in labels]
        for node, keep in zip(chosen, keeps, strict=True):
            if keep != "translation" and not node.turns:
                raise InputError(f"{self.source}: node {node.name} has no rotations: keep "
                                 ":translation")
        points = np.array([node.point for node in chosen])
        motion = self._motion(chosen, points, tuple(keeps))
        rows, whole = motion.shape
        scale = self._scale(points)
        of_rows = np.concatenate([np.full(3 * sum(k != "rotation" for k in keeps), scale[0]),
                                  np.ones(rows - 3 * sum(k != "rotation" for k in keeps))])
        unit_free = motion * scale / of_rows[:, None]
        spread = np.linalg.svd(unit_free, compute_uv=False)
        if rows > whole or spread[-1] <= _SPAN * spread[0]:
            free = int(np.sum(spread > _SPAN * spread[0])) if rows <= whole else whole
            raise InputError(
                f"{self.source}: its {whole - 6} modes and rigid motion give the nodes "
                f"{', '.join(labels)} {min(free, whole)} of {rows} independent motions: name fewer "
                "nodes, keep :translation, or write it with constraint modes of these nodes")
        static = scale[:, None] * np.linalg.pinv(unit_free) / of_rows
        inner = scale[:, None] * null_space(unit_free, rcond=_SPAN)
        return self._parts(static, inner, points, tuple(keeps))

    def _motion(self, nodes: list[ModalNode], points: NDArray, keeps: tuple[str, ...]) -> NDArray:
        """Boundary coordinates (held, 6 + nq) of unit rigid motions and modes."""
        moves = [node.phi for node, keep in zip(nodes, keeps, strict=True) if keep != "rotation"]
        turns = [node.psi for node, keep in zip(nodes, keeps, strict=True) if keep != "translation"]
        modes = np.vstack([*moves, *turns])
        return np.hstack([rigid_motions(points, keeps, len(modes), np.zeros(3)), modes])

    def _scale(self, points: NDArray) -> NDArray:
        """Scale of rigid motions and modes, so that all have the same unit."""
        length = float(np.ptp(points, axis=0).max()) or 1.0
        kinetic = np.sqrt(np.diag(self.mass)[0] * length**2)
        masses = np.sqrt(np.diag(self.mass)[6:].clip(np.finfo(float).tiny))
        return np.concatenate([np.full(3, length), np.ones(3), kinetic / masses])

    def _parts(self, static: NDArray, inner: NDArray, points: NDArray, keeps: tuple[str, ...]
               ) -> dict:
        K, M = self.stiffness, self.mass
        basis = static
        if inner.shape[1]:
            held = inner.T @ K @ inner
            try:
                squares, turn = eigh(held, inner.T @ M @ inner)
                static = static - inner @ np.linalg.solve(held, inner.T @ K @ static)
            except LinAlgError as error:
                raise InputError(f"{self.source}: modes without mass or stiffness: leave them out"
                                 ) from error
            if squares[0] <= 0:
                raise InputError(f"{self.source}: with these nodes clamped the body still moves "
                                 "without strain: name more nodes")
            basis = np.hstack([static, inner @ turn])
        stiffness = basis.T @ K @ basis
        count = static.shape[1]
        stiffness[:count, count:] = stiffness[count:, :count].T * 0.0
        stiffness[count:, :count] = 0.0         # zero but for rounding
        damping = {} if self.damping is None else {"damping": basis.T @ self.damping @ basis}
        return {"stiffness": stiffness, "mass": basis.T @ M @ basis, **damping,
                "coordinates": points, "keeps": keeps, "modes": inner.shape[1]}
