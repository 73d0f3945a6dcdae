"""Motion that simplified models lose.

A body that is made rigid, and one without a mode, move like the full one under constraints
``e = 0`` of what they lose: the amplitude of a mode, or all of a body's deformation. With the rigid
motion of its nodes ``T`` (positions in global, rotations in material axes) and their displacements
``d`` from the rigid body that follows them,

    (24) e = E^T d,   E^T T = 0,   de = E^T xi,   de' = E^T xi',   e'' = E^T (xi'' - gamma)

with ``gamma = omega x (omega x r)`` of positions.
"""

from __future__ import annotations

from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import null_space

from sebody.basics.vectors import skew
from sebody.engine.state import State
from sebody.model.numbering import Numbering, coordinates
from sebody.model.parts import Superelement
from sebody.results import rotations


class Part(NamedTuple):
    """Motion that a simplified model loses in a state: (24)."""

    E: NDArray          # (total, k) of all coordinates
    e: NDArray          # (k,)
    rate: NDArray       # (k,)
    second: NDArray     # (k,)


class Motion(Protocol):
    """A motion that a simplified model does not have."""

    forces: slice | None        # of the body whose forces hold it, among those of all elements

    def at(self, state: State) -> Part:
        """In a state of the full model."""


class Amplitude:
    """The amplitude of an internal mode.

    Parameters
    ----------
    place : int
        Its coordinate.
    total : int
        Number of all coordinates.
    """

    forces: slice | None = None

    def __init__(self, place: int, total: int):
        self.own = slice(place, place + 1)
        self.E = np.eye(total)[:, self.own]

    def at(self, state: State) -> Part:
        return Part(self.E, *(x[self.own].copy() for x in (state.q, state.v, state.a)))


class Deformation:
    """All of a body's deformation.

    Parameters
    ----------
    body : Superelement
    numbering : Numbering
    """

    def __init__(self, body: Superelement, numbering: Numbering):
        reduced, nodes = body.reduced, body.nodes
        self.planar, self.total = reduced.planar, numbering.total
        self.points = reduced.coordinates - reduced.coordinates.mean(axis=0)
        self.size = max(float(np.abs(self.points).max()), np.finfo(float).tiny)
        self.positions = {k: coordinates(numbering, one) for k in reduced.position_nodes
                          if (one := nodes[k].position) is not None}
        self.turns = {k: (coordinates(numbering, one),
                          0 if self.planar else numbering.rotations[one])
                      for k in reduced.rotation_nodes
                      if (one := nodes[k].rotation) is not None}
        first = numbering.modes.get(body.name, 0)
        self.modes = list(range(first, first + reduced.modes))
        self.own = [*(i for own in self.positions.values() for i in own),
                    *(i for own, _ in self.turns.values() for i in own), *self.modes]
        at = numbering.forces_at[body]
        self.forces: slice | None = slice(at, at + len(self.own))

    def at(self, state: State) -> Part:
        d, T, gamma = (self._in_plane if self.planar else self._in_space)(state)
        scale = np.ones(len(self.own))
        scale[:sum(map(len, self.positions.values()))] = 1.0 / self.size
        own = scale[:, None] * null_space((scale[:, None] * T).T)
        E = np.zeros((self.total, own.shape[1]))
        E[self.own] = own
        return Part(E, own.T @ d, own.T @ state.v[self.own],
                    own.T @ (state.a[self.own] - gamma))

    def _in_space(self, state: State) -> tuple[NDArray, NDArray, NDArray]:
        """Displacements, rigid motion and centripetal accelerations of its coordinates."""
        x = {k: state.q[own] for k, own in self.positions.items()}
        R = {k: state.R[9 * r:9 * r + 9].reshape(3, 3) for k, (_, r) in self.turns.items()}
        middle, centre = np.mean(list(x.values()), axis=0), self.points[list(x)].mean(axis=0)
        arms = {k: self.points[k] - centre for k in self.positions}
        axes = rotations.nearest(np.sum(list(R.values()) if R else [
            np.outer(x[k] - middle, arms[k]) for k in x], axis=0))
        d, T = [], []
        for k in x:
            d.append(x[k] - middle - axes @ arms[k])
            T.append(np.hstack([np.eye(3), -skew(x[k] - middle)]))
        for own in R.values():
            d.append(rotations.vectors((axes.T @ own)[None])[0])
            T.append(np.hstack([np.zeros((3, 3)), own.T]))
        return self._with_modes(state, d, T, 6, x, middle)

    def _in_plane(self, state: State) -> tuple[NDArray, NDArray, NDArray]:
        x = {k: state.q[own] for k, own in self.positions.items()}
        angles = {k: float(state.q[own[0]]) for k, (own, _) in self.turns.items()}
        middle, centre = np.mean(list(x.values()), axis=0), self.points[list(x)].mean(axis=0)
        arms = {k: self.points[k] - centre for k in self.positions}
        if angles:
            angle = float(np.mean(list(angles.values())))
        else:
            A = np.sum([np.outer(x[k] - middle, arms[k]) for k in x], axis=0)
            angle = float(np.arctan2(A[1, 0] - A[0, 1], A[0, 0] + A[1, 1]))
        c, s = np.cos(angle), np.sin(angle)
        axes, d, T = np.array([[c, -s], [s, c]]), [], []
        for k in x:
            d.append(x[k] - middle - axes @ arms[k])
            p = x[k] - middle
            T.append(np.column_stack([np.eye(2), [-p[1], p[0]]]))
        for own in angles.values():
            d.append(np.array([own - angle]))
            T.append(np.array([[0.0, 0.0, 1.0]]))
        return self._with_modes(state, d, T, 3, x, middle)

    def _with_modes(self, state: State, d: list, T: list, rigid: int, x: dict, middle: NDArray
                    ) -> tuple[NDArray, NDArray, NDArray]:
        d.append(state.q[self.modes])
        motion = np.vstack([*T, np.zeros((len(self.modes), rigid))])
        rate = np.linalg.lstsq(motion, state.v[self.own], rcond=None)[0]
        if self.planar:
            gamma = [-rate[2]**2 * (p - middle) for p in x.values()]
        else:
            W = skew(rate[3:])
            gamma = [W @ W @ (p - middle) for p in x.values()]
        gamma.append(np.zeros(len(self.own) - sum(map(len, gamma))))
        return np.concatenate(d), motion, np.concatenate(gamma)
