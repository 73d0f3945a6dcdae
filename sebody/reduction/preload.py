"""Forces between the interfaces of a body that is under stress where it is undeformed.

A body reduced under tension is held by forces f0 on its interfaces, in balance with each other.
They turn with the body, so they have a stiffness of their own, which resists rigid motion of the
interfaces at fixed forces. Forces along lines between points that move with the interfaces carry
them: each with a potential, in balance and without a frame. With the places ``p = x + R r`` of the
ends of a line, its vector ``d = p_b - p_a``, length l, direction n and tension t,

    f0 = sum_lines J^T t n,       J: d' = J y'                                  (1)
    K0 = sum_lines J^T (s n n^T + t / l (1 - n n^T)) J + K_r                    (2)

where s is the stiffness along the line and K_r are the second derivatives of ``t n . R r``. The
matrix of the body is what the lines leave, ``K_total - K0``, and costs no force in rigid motion. A
line in tension is a spring without free length, s = t / l; one in compression has twice its length
as free length, s = -t / l. In a model they are such springs.

Six lines between two interfaces carry any force and moment. A single one does where the force is
along it, as in a string.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import combinations, product

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import qr

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.basics.tabular import brief, counted
from sebody.basics.vectors import axes_cross
from sebody.reduction.rigid_motions import rigid_motions

BALANCED = 1e-6         # of the forces times the size: a sum of them that is none
CARRIED = 1e-9          # of the forces: what lines leave of them
BESIDE = 0.5            # of the distance of the interfaces: how far points lie beside them


@dataclass(frozen=True, eq=False)
class Preload:
    """Lines that carry the forces of a body on its interfaces where it is undeformed.

    Parameters
    ----------
    nodes : (m, 2) of int
        Boundary nodes at the ends of each line.
    arms : (m, 2, D)
        Places of the ends relative to these nodes, in FE axes [length]; zero of a node that keeps
        its position alone.
    tension : (m,)
        [force]
    """

    nodes: NDArray
    arms: NDArray
    tension: NDArray

    __repr__ = brief

    @property
    def told(self) -> str:
        """The preload, in words."""
        return ("under stress where it is undeformed: "
                f"{counted(len(self.tension), 'line')} of up to {np.abs(self.tension).max():.6g}")

    def ends(self, coordinates: NDArray) -> NDArray:
        """Places of both ends of every line, (m, 2, D)."""
        return coordinates[self.nodes] + self.arms

    def rotated(self, rotation: NDArray) -> Preload:
        """The preload of the body rotated about the FE origin by (D, D), in the old axes."""
        return replace(self, arms=self.arms @ rotation.T)

    def forces(self, coordinates: NDArray, keeps: tuple[str, ...], size: int) -> NDArray:
        """Equation (1): forces that hold the undeformed body, (size,)."""
        found = np.zeros(size)
        for (i, j), (a, b), (n, _), t in self._lines(coordinates):
            found += t * (_jacobian(i, j, a, b, keeps, size).T @ n)
        return found

    def stiffness(self, coordinates: NDArray, keeps: tuple[str, ...], size: int) -> NDArray:
        """Equation (2): stiffness of the lines, (size, size)."""
        found = np.zeros((size, size))
        for (i, j), (a, b), (n, length), t in self._lines(coordinates):
            J, along = _jacobian(i, j, a, b, keeps, size), np.outer(n, n)
            found += J.T @ ((abs(t) * along + t * (np.eye(len(n)) - along)) / length) @ J
            for node, arm, force in ((i, a, -t * n), (j, b, t * n)):
                if arm.any():
                    at = _rotation_rows(node, keeps, len(n))
                    found[np.ix_(at, at)] += _turned(force, arm)
        return found

    def _lines(self, coordinates: NDArray):
        ends = self.ends(coordinates)
        for nodes, arms, (start, end), tension in zip(self.nodes, self.arms, ends, self.tension,
                                                      strict=True):
            length = float(np.linalg.norm(end - start))
            yield nodes, arms, ((end - start) / length, length), float(tension)


def preload_of(value: object, coordinates: NDArray, keeps: tuple[str, ...], size: int
               ) -> Preload | None:
    """Lines that carry forces, None of no forces; a Preload is checked.

    Parameters
    ----------
    value : Preload or (size,)
        Or the forces that hold the undeformed body, in its coordinates.
    coordinates : (n_nodes, D)
    keeps : tuple of str

    Raises
    ------
    InputError
        Neither, forces on internal modes, forces that are not in balance, or moments that no line
        between the interfaces can carry.
    """
    if isinstance(value, Preload):
        return _checked(value, coordinates, keeps)
    forces = inputs.vector(value, "preload", size, remedy=f"give {size} forces, or a Preload")
    D = coordinates.shape[1]
    bound = _bound(keeps, D)
    if np.any(forces[bound:]):
        raise InputError("preload acts on internal modes: give forces on the interfaces alone, "
                         "zeros behind them")
    span = float(np.linalg.norm(np.ptp(coordinates, axis=0))) or 1.0
    units = np.ones(size)
    units[D * sum(keep != "rotation" for keep in keeps):] = 1.0 / span      # moments
    scale = float(np.abs(forces * units).max())
    if scale == 0.0:
        return None
    _refuse_unbalanced(forces, coordinates, keeps, scale * span)
    for offset in (0.0, BESIDE * span):
        lines = _candidates(coordinates, keeps, offset)
        found = _carrying(forces, coordinates, keeps, lines, units)
        if found is not None:
            return found
    raise InputError("preload has forces or moments that no lines between the interfaces can "
                     "carry, such as moments of interfaces that keep 'translation' alone, or of "
                     "one interface: let them keep 'full'")


def _checked(given: Preload, coordinates: NDArray, keeps: tuple[str, ...]) -> Preload:
    """A Preload whose arrays fit the body."""
    D, count = coordinates.shape[1], len(given.tension)
    nodes = np.array(given.nodes)
    if nodes.shape != (count, 2) or nodes.dtype.kind not in "iu" or (
            count and not (nodes.min() >= 0 and nodes.max() < len(keeps))):
        raise InputError(f"preload.nodes has shape {nodes.shape}: give two boundary nodes, from 0 "
                         f"to {len(keeps) - 1}, for each of {count} lines")
    arms = inputs.array(given.arms, "preload.arms", (count, 2, D))
    tension = inputs.vector(given.tension, "preload.tension", count)
    for k, (pair, both) in enumerate(zip(nodes, arms, strict=True)):
        for node, arm in zip(pair, both, strict=True):
            if keeps[node] == "rotation" or (arm.any() and keeps[node] != "full"):
                raise InputError(f"preload line {k} ends beside boundary node {node}, which keeps "
                                 f"{keeps[node]!r}: let it keep 'full'")
        if not np.linalg.norm(coordinates[pair[1]] + both[1] - coordinates[pair[0]] - both[0]) > 0:
            raise InputError(f"preload line {k} has no length: give it two places")
    for array in (nodes, arms, tension):
        array.flags.writeable = False
    return Preload(nodes, arms, tension)


def _refuse_unbalanced(forces: NDArray, coordinates: NDArray, keeps: tuple[str, ...],
                       moment: float) -> None:
    D = coordinates.shape[1]
    sums = rigid_motions(coordinates, keeps, len(forces), coordinates.mean(axis=0)).T @ forces
    span = float(np.linalg.norm(np.ptp(coordinates, axis=0))) or 1.0
    largest = max(np.abs(sums[:D]).max() * span, np.abs(sums[D:]).max())
    if largest > BALANCED * moment:
        raise InputError(f"preload is not in balance: its forces add up to {sums[:D]}, its moments "
                         f"to {sums[D:]}; give the forces of a body that nothing else holds")


def _candidates(coordinates: NDArray, keeps: tuple[str, ...], offset: float) -> Preload:
    """Lines between interfaces, or also between points beside those that keep rotations."""
    D = coordinates.shape[1]
    beside = [np.zeros(D), *(offset * np.eye(D) if offset else ())]
    held = [i for i, keep in enumerate(keeps) if keep != "rotation"]
    nodes, arms = [], []
    for i, j in combinations(held, 2):
        for a, b in product(beside if keeps[i] == "full" else beside[:1],
                            beside if keeps[j] == "full" else beside[:1]):
            # short lines turn fast, and are stiff
            if np.linalg.norm(coordinates[j] + b - coordinates[i] - a) > offset / 2:
                nodes.append((i, j))
                arms.append((a, b))
    return Preload(np.array(nodes, dtype=int).reshape(-1, 2), np.array(arms).reshape(-1, 2, D),
                   np.ones(len(nodes)))


def _carrying(forces: NDArray, coordinates: NDArray, keeps: tuple[str, ...], lines: Preload,
              units: NDArray) -> Preload | None:
    """As few of some lines as carry the forces; None if they cannot."""
    columns = np.array([replace(lines, nodes=lines.nodes[[k]], arms=lines.arms[[k]],
                                tension=np.ones(1)).forces(coordinates, keeps, len(forces))
                        for k in range(len(lines.tension))]).reshape(-1, len(forces)).T
    A, b = columns * units[:, None], forces * units
    if not A.shape[1]:
        return None
    _, R, order = qr(A, mode="economic", pivoting=True)
    pivots = np.abs(np.diag(R))
    chosen = np.sort(order[:int(np.sum(pivots > 1e-9 * pivots[0]))])
    tension = np.linalg.lstsq(A[:, chosen], b, rcond=None)[0]
    if np.abs(A[:, chosen] @ tension - b).max() > CARRIED * np.abs(b).max():
        return None
    carries = np.abs(tension) > CARRIED * np.abs(tension).max()
    at = chosen[carries]
    return Preload(lines.nodes[at], lines.arms[at], tension[carries])


def _bound(keeps: tuple[str, ...], dimension: int) -> int:
    return (dimension * sum(keep != "rotation" for keep in keeps)
            + (1 if dimension == 2 else 3) * sum(keep != "translation" for keep in keeps))


def _position_rows(node: int, keeps: tuple[str, ...], dimension: int) -> NDArray:
    before = sum(keep != "rotation" for keep in keeps[:node])
    return dimension * before + np.arange(dimension)


def _rotation_rows(node: int, keeps: tuple[str, ...], dimension: int) -> NDArray:
    turns = 1 if dimension == 2 else 3
    first = dimension * sum(keep != "rotation" for keep in keeps)
    return first + turns * sum(keep != "translation" for keep in keeps[:node]) + np.arange(turns)


def _jacobian(i: int, j: int, a: NDArray, b: NDArray, keeps: tuple[str, ...], size: int
              ) -> NDArray:
    """Rate of the vector of a line by the coordinates, (D, size)."""
    D = len(a)
    found = np.zeros((D, size))
    for node, arm, sign in ((i, a, -1.0), (j, b, 1.0)):
        found[:, _position_rows(node, keeps, D)] += sign * np.eye(D)
        if arm.any():
            found[:, _rotation_rows(node, keeps, D)] += sign * axes_cross(arm[:, None])[..., 0].T
    return found


def _turned(force: NDArray, arm: NDArray) -> NDArray:
    """Second derivatives of ``force . R arm`` by the rotation vector."""
    dot = float(force @ arm)
    if len(arm) == 2:
        return np.array([[-dot]])
    return (np.outer(force, arm) + np.outer(arm, force)) / 2 - dot * np.eye(3)
