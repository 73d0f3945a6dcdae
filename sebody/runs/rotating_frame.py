"""A steady rotation of everything, and matrices of small motion in axes that rotate with it.

In axes that rotate with the angular velocity W of the state, a position moves as x + xi, a rotation
as R exp(theta). Then dv = xi' + W x xi, da = xi'' + 2 W x xi' + W x (W x xi), and with the material
W of the node dOmega = theta' + W x theta, dA = theta'' + W x theta'. This holds for the ends of
rigid links, too, whose xi follows from those of root and arms: so element matrices are summed for
all coordinates, in global axes, combined, and only then reduced to the unknowns.

Where some parts turn and others stand (`Turning`), every unknown is in axes of its own part, and W
is that of this part: the end of a link has a share of its motion from each of root and arms.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import csc_matrix, diags

from sebody.assembly.axes import in_frames
from sebody.basics import inputs
from sebody.basics.vectors import skew
from sebody.contract.layout import AT_FRAME, AT_POSITIONS
from sebody.model.mechanism import Mechanism
from sebody.model.numbering import coordinates
from sebody.model.parts import DofBlock
from sebody.results.result import Result
from sebody.runs.simulation import Simulation


class Turning(NamedTuple):
    """Rotation of a part: about a line through a point, at a multiple of the spin."""

    point: NDArray
    factor: float


class Spin:
    """A steady rotation about the origin of everything, or of the parts that are given."""

    def __init__(self, velocity: NDArray, planar: bool,
                 parts: Mapping[DofBlock, Turning] | None = None):
        self.velocity, self.planar, self.parts = velocity, planar, parts

    @classmethod
    def of(cls, model: Mechanism, velocity: ArrayLike | None) -> Spin:
        """The spin of a model that a user gives, none by default.

        Raises
        ------
        InputError
            The wrong shape or no numbers.
        """
        planar = model.planar
        if velocity is None:
            velocity = 0.0 if planar else np.zeros(3)
        return cls(np.array(inputs.number(velocity, "spin", remedy="give a number")) if planar else
                   inputs.vector(velocity, "spin", 3, remedy="give three numbers"), planar)

    def times(self, factor: float) -> Spin:
        """The spin multiplied by a factor."""
        return Spin(factor * self.velocity, self.planar, self.parts)

    def turning(self, dof_block: DofBlock) -> Turning | None:
        """Rotation of a block; None of one that stands."""
        if self.parts is None:
            return Turning(np.zeros(2 if self.planar else 3), 1.0)
        return self.parts.get(dof_block)

    @property
    def rotates(self) -> bool:
        """Tell whether the angular velocity is not zero."""
        return bool(np.any(self.velocity))

    @property
    def squared(self) -> float:
        """Square of the angular velocity."""
        return float(np.sum(self.velocity**2))

    def move(self, run: Simulation) -> None:
        """Set velocities and accelerations to those of the rotation, of fixed nodes, too."""
        state = run.state
        state.v[:], state.a[:] = 0.0, 0.0
        if not self.rotates:
            return
        for dof_block, at in _dof_blocks(run):
            turns = self.turning(dof_block)
            if turns is None:
                continue
            if dof_block.rotational:
                state.v[at] = turns.factor * (self.velocity if self.planar else
                                              _material(run, dof_block, self.velocity))
            else:
                across = turns.factor * self.across
                state.v[at] = across @ (state.q[at] - turns.point)
                state.a[at] = across @ state.v[at]

    @property
    def across(self) -> NDArray:
        """The operator ``W x``."""
        if self.planar:
            return float(self.velocity) * np.array([[0.0, -1.0], [1.0, 0.0]])
        return skew(self.velocity)

    def moved(self, run: Simulation | Result, G: csc_matrix
              ) -> tuple[csc_matrix, csc_matrix, csc_matrix]:
        """Derivatives of velocity and acceleration by motion, and of acceleration by its rate.

        Of all coordinates, in global axes, by the unknowns.

        Parameters
        ----------
        G : (total, unknowns)
            `motion`.
        """
        factors = np.zeros(run.numbering.free)
        for dof_block, at in _dof_blocks(run):
            turns = self.turning(dof_block)
            if dof_block.solved and turns is not None:
                factors[at] = turns.factor
        found = [csc_matrix(G.shape) for _ in range(3)]
        for factor in np.unique(factors[factors != 0.0]):
            own = G @ diags((factors == factor).astype(float))
            for k, operator in enumerate(self.operators(run, factor)):
                found[k] = found[k] + operator @ own
        return tuple(found)

    def operators(self, run: Simulation | Result, factor: float = 1.0
                  ) -> tuple[csc_matrix, csc_matrix, csc_matrix]:
        """The same by all coordinates, as if all were in axes that turn at a multiple of the spin.
        """
        velocity, place, rate = (_Blocks() for _ in range(3))
        for dof_block, at in _dof_blocks(run):
            if not dof_block.rotational:
                across = factor * self.across
                velocity.add(at, at, across)
                place.add(at, at, across @ across)
                rate.add(at, at, 2.0 * across)
            elif not self.planar:
                across = skew(_material(run, dof_block, factor * self.velocity))
                velocity.add(at, at, across)
                rate.add(at, at, across)
        total = run.numbering.total
        return tuple(one.matrix(total, total) for one in (velocity, place, rate))


def fastest_spin(run: Simulation | Result) -> tuple[NDArray, float]:
    """The largest angular velocity of a node, (3,) in global axes or (1,), and its size."""
    assert run.state is not None        # of a result that is no file
    rates = run.state.v
    spins = [rates[at] if run.model.planar else _rotation(run, dof_block) @ rates[at]
             for dof_block, at in _dof_blocks(run) if dof_block.rotational]
    fastest = max(spins, key=np.linalg.norm, default=np.zeros(1))
    return fastest, float(np.linalg.norm(fastest))


def motion(run: Simulation | Result) -> csc_matrix:
    """Motion of all coordinates, in global axes, by that of the unknowns, in the axes of these.

    Fixed and prescribed coordinates rest; the end of a rigid link moves as
    ``xi = xi_root + sum_i R_i (theta_i x r_i)``.
    """
    numbering, blocks = run.numbering, _Blocks()
    axes = _axes_of_positions(run)
    ordinary = np.ones(numbering.free, dtype=bool)
    for first, own in axes.items():
        at = list(range(first, first + len(own)))
        ordinary[at] = False
        blocks.add(at, at, own)
    ones = np.flatnonzero(ordinary)
    blocks.add_entries(ones, ones, np.ones(len(ones)))
    for dof_block in numbering.dependent:
        begin = dof_block.parents()[0]
        at, root = (coordinates(numbering, t) for t in (dof_block, begin))
        if begin.solved:
            blocks.add(at, root, axes.get(root[0], np.eye(len(at))))
        for rotation, arm in dof_block.arms:
            if rotation.solved:
                blocks.add(at, coordinates(numbering, rotation), _lever(run, rotation, arm))
    return blocks.matrix(numbering.total, numbering.free)


def summed(run: Simulation | Result) -> csc_matrix:
    """Sum of the element matrices of all coordinates, in global axes, as they are in `State.J`."""
    unknowns, total = run.arrays_of_loop[0].g_unknown, run.numbering.total
    sums = csc_matrix((np.ones(unknowns.size), (unknowns, np.arange(unknowns.size))),
                      shape=(total, unknowns.size))
    return csc_matrix(sums @ by_element(run))


def by_element(run: Simulation | Result) -> csc_matrix:
    """Derivatives of the forces of all elements by all coordinates, in global axes.

    Rows are in the order of `State.g`; of the matrices that are in `State.J`.
    """
    (system, state), blocks = run.arrays_of_loop, _Blocks()
    turned = in_frames(run.model, run.numbering, system)
    for b, (count, width, stride) in enumerate(zip(system.count, system.width, system.stride,
                                                   strict=True)):
        forces = np.arange(system.at_g[b], system.at_g[b + 1]).reshape(count, width)
        unknowns = system.g_unknown[forces]
        J = state.J[system.at_J[b]:system.at_J[b + 1]].reshape(count, width, width).copy()
        if turned[b]:
            index = system.index[system.at_index[b]:system.at_index[b + 1]].reshape(count, stride)
            frames = np.array([_frame(run, k) for k in index[:, AT_FRAME]])
            d = frames.shape[1]
            for first in range(0, d * index[0, AT_POSITIONS], d):
                part = slice(first, first + d)
                J[:, part] = frames @ J[:, part]
                J[:, :, part] = J[:, :, part] @ frames.transpose(0, 2, 1)
        rows, columns = np.broadcast_arrays(forces[:, :, None], unknowns[:, None, :])
        blocks.add_entries(rows.ravel(), columns.ravel(), J.ravel())
    return blocks.matrix(int(system.at_g[-1]), run.numbering.total)


def of_levers(run: Simulation | Result, forces: NDArray) -> csc_matrix:
    """Derivative of the moments of the forces at the ends of rigid links as their arms turn.

    Parameters
    ----------
    forces : (coordinates,)
        Sums of the element forces, in global axes.
    """
    numbering, blocks = run.numbering, _Blocks()
    for dof_block in numbering.dependent:
        force = forces[coordinates(numbering, dof_block)]
        for rotation, arm in dof_block.arms:
            if not rotation.solved:
                continue
            at = coordinates(numbering, rotation)
            if run.model.planar:
                blocks.add(at, at, np.array([[-(_rotation(run, rotation) @ arm) @ force]]))
            else:
                blocks.add(at, at, skew(arm) @ skew(_rotation(run, rotation).T @ force))
    return blocks.matrix(numbering.free, numbering.free)


class _Blocks:
    """Entries of a sparse matrix; those at one place add up."""

    def __init__(self) -> None:
        self._rows: list[NDArray] = [np.zeros(0, dtype=int)]
        self._columns: list[NDArray] = [np.zeros(0, dtype=int)]
        self._values: list[NDArray] = [np.zeros(0)]

    def add(self, rows: list[int], columns: list[int], values: NDArray) -> None:
        """Add a block."""
        row, column = np.broadcast_arrays(np.array(rows)[:, None], np.array(columns)[None])
        self.add_entries(row.ravel(), column.ravel(), values.ravel())

    def add_entries(self, rows: NDArray, columns: NDArray, values: NDArray) -> None:
        """Add single entries."""
        self._rows.append(rows)
        self._columns.append(columns)
        self._values.append(values)

    def matrix(self, height: int, width: int) -> csc_matrix:
        """All of them."""
        values, rows, columns = (np.concatenate(one) for one in (
            self._values, self._rows, self._columns))
        return csc_matrix((values, (rows, columns)), shape=(height, width))


def _dof_blocks(run: Simulation | Result) -> list[tuple[DofBlock, list[int]]]:
    """DOF blocks of the model's nodes that are in it, with their coordinates."""
    dof_blocks = dict.fromkeys(t for n in run.model.nodes.values()
                               for t in (n.position, n.rotation))
    return [(t, coordinates(run.numbering, t)) for t in dof_blocks if t in run.numbering.dof_blocks]


def _rotation(run: Simulation | Result, dof_block: DofBlock) -> NDArray:
    if run.model.planar:
        angle = run.arrays_of_loop[1].q[run.numbering.dof_blocks[dof_block]]
        return np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    k = run.numbering.rotations[dof_block]
    return run.arrays_of_loop[1].R[9 * k:9 * k + 9].reshape(3, 3)


def _material(run: Simulation | Result, dof_block: DofBlock, velocity: NDArray) -> NDArray:
    return _rotation(run, dof_block).T @ velocity


def _lever(run: Simulation | Result, rotation: DofBlock, arm: NDArray) -> NDArray:
    """``R (theta x r)`` by theta."""
    R = _rotation(run, rotation)
    if run.model.planar:
        x, y = R @ arm
        return np.array([[-y], [x]])
    return -R @ skew(arm)


def _frame(run: Simulation | Result, k: int) -> NDArray:
    """The frame of a superelement, (d, d)."""
    frame = run.arrays_of_loop[1].frames[9 * k:9 * k + 9].reshape(3, 3)
    if run.model.planar:
        c, s = frame[0, 0], frame[1, 0]
        return np.array([[c, -s], [s, c]])
    return frame


def _axes_of_positions(run: Simulation | Result) -> dict[int, NDArray]:
    """First unknown of every position that is not solved for in global axes -> its axes."""
    return {int(first): _frame(run, k) for first, k in run.arrays_of_loop[0].rotated}
