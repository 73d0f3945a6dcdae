"""Axial forces that a body without geometric stiffening takes no notice of.

The virial of the forces s on the positions x of a body, ``sum s x^T``, is its force times its
length; a rotation t of a node against the line of the positions, which lengthens or shortens that
line, does the work ``t . M t / 2`` with

    M = tr(sum s x^T) 1 - sum s x^T

for a rod with the tension N and the direction e ``N L (1 - e e^T)``. The structure has this beside
its own stiffness against t, for a rod ``3 E I / L``; the body has not.

It has another error instead. Its forces are in equilibrium on the line of its positions, but its
stiffness is in the axes of its frame, which may turn by t from that line: then the displacements u
that keep the positions where they are do the work ``t . sum u x s``, while the tension gives
``t . M t / 2``. What is left when t has done its best is

    y . S y / 2 - c . M^-1 c / 2,     c = sum u x s.

With the frame on the mean rotation a rod loses all stiffness at the *tension* ``12 E I / L^2``, on
the rotation of one end at ``3 E I / L^2``: beyond, it folds up in its frame.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import null_space

from sebody.basics.vectors import skew
from sebody.model.parts import Superelement
from sebody.results import rotations
from sebody.runs.limits.spin_stability import fit, rows_of

PASSES = 30         # of the rotation of best fit
LEAST = 1e-9        # share of a largest eigenvalue of geometry below which others are none
ROUNDED = 1e-13     # likewise, of scaled stiffnesses


class Load(NamedTuple):
    """The axial force of a body in a state."""

    force: float        # tension; compression is negative
    share: float        # of it in that which counts as much as the body's own stiffness
    folding: float      # of a tension in that at which the body folds up; 0 if it never does
    tilt: float         # angle between the line of the positions and the frame [rad]

    @property
    def described(self) -> str:
        """In words."""
        return f"{'tension' if self.force > 0.0 else 'compression'} {abs(self.force):.3g}"

    @property
    def consequence(self) -> str:
        """Other errors of the body."""
        if self.force < 0.0:
            return ", and the body does not buckle at the right load"
        if self.folding > 0.0:
            return (f", and under {self.force / self.folding:.3g} the body folds up in its frame "
                    "unless its ends are clamped")
        return ""


class Axial(NamedTuple):
    """Limits of axial forces of a body; p positions, r rotations, n coordinates."""

    stiffness: NDArray      # (n, n)
    moved: NDArray          # (p, 3, n) displacements by y
    points: NDArray         # (p, 3) about their mean
    flexible: NDArray       # (r, 3, 3) roots of the rotations of nodes by moments of unit size
    compliance: NDArray     # (n, n) with the frame and one node held

    @classmethod
    def of(cls, part: Superelement) -> "Axial | None":
        """Those of a body; None of one that stiffens, or bends without rotations of its nodes."""
        body = part.reduced
        if part.stiffening or len(part.positions) < 2 or not part.rotations:
            return None
        moved, rotated = rows_of(body)
        points = np.zeros((len(moved), 3))
        points[:, :body.coordinates.shape[1]] = body.coordinates[list(body.position_nodes)]
        points -= points.mean(axis=0)
        line = np.linalg.pinv(_moments(points), rcond=LEAST)
        turned = line @ np.einsum("jik,jkn->in", [skew(x) for x in points], moved)
        seen = (line @ _moments(points)) @ (rotated - turned)
        held = (fit(body, moved) if part.frame == "positions" else
                np.einsum("j,jin->in", part.alpha_r, rotated))
        compliance = _compliance(body.stiffness, np.vstack([moved[0], held]))
        values, axes = np.linalg.eigh(seen @ compliance @ np.swapaxes(seen, 1, 2))
        return cls(body.stiffness, moved, points,
                   axes * np.sqrt(np.maximum(values, 0.0))[:, None, :], compliance)

    def bound(self, y: NDArray) -> NDArray:
        """An upper bound of the shares of states y, (k, n): (k,)."""
        forces, places = self._forces(y), self.points + np.einsum("jin,kn->kji", self.moved, y)
        virial = np.linalg.norm(np.einsum("kji,kjl->kil", forces, places), axis=(1, 2))
        return 3.0 * virial * (self.flexible**2).sum(axis=(1, 2)).max()

    def load(self, y: NDArray) -> Load:
        """In a state y, (n,); on the positions as they were, turned to where they are.

        A body that has folded up is longer: by as much as its tension is above the limit.
        """
        places = self.points + self.moved @ y
        places = places - places.mean(axis=0)
        turn = self._turn(places)
        forces = self._forces(y[None])[0] @ turn
        virial = np.einsum("ji,jl->il", forces, self.points)
        virial = (virial + virial.T) / 2
        work = np.trace(virial) * np.eye(3) - virial
        shares = np.linalg.eigvalsh(np.swapaxes(self.flexible, 1, 2) @ work @ self.flexible)
        values, axes = np.linalg.eigh(virial)
        k = int(np.argmax(np.abs(values)))
        force = values[k] / np.ptp(self.points @ axes[:, k])
        return Load(float(force), float(np.abs(shares).max()), self._folding(forces, work),
                    float(np.linalg.norm(rotations.vectors(turn))))

    def _forces(self, y: NDArray) -> NDArray:
        """On the positions, (k, p, 3)."""
        return np.einsum("jin,kn->kji", self.moved, y @ self.stiffness)

    def _turn(self, places: NDArray) -> NDArray:
        """The smallest rotation that fits the undeformed positions to these."""
        turn, line = np.eye(3), np.linalg.pinv(_moments(self.points), rcond=LEAST)
        for _ in range(PASSES):
            turn = turn @ rotations.matrices(
                line @ np.cross(self.points, places @ turn).sum(axis=0))
        return turn

    def _folding(self, forces: NDArray, work: NDArray) -> float:
        """Largest ratio of ``c . M^-1 c`` to ``y . S y``, of tensions alone."""
        values, axes = np.linalg.eigh(work)
        pulled = values > LEAST * np.abs(values).max()
        if not pulled.any():
            return 0.0
        c = -np.einsum("jik,jkn->in", [skew(s) for s in forces], self.moved)
        c = (axes[:, pulled].T @ c) / np.sqrt(values[pulled])[:, None]
        return float(np.linalg.eigvalsh(c @ self.compliance @ c.T)[-1])


def _compliance(stiffness: NDArray, held: NDArray) -> NDArray:
    """Inverse of a stiffness, (n, n), where some combinations of coordinates are zero, (k, n)."""
    scale = 1.0 / np.sqrt(np.maximum(np.diag(stiffness), 1e-300))
    free = scale[:, None] * null_space(held * scale)
    own = free.T @ stiffness @ free
    return free @ np.linalg.pinv(own, rcond=ROUNDED, hermitian=True) @ free.T


def _moments(points: NDArray) -> NDArray:
    """``sum |x|^2 1 - x x^T``, (3, 3)."""
    return (points**2).sum() * np.eye(3) - points.T @ points
