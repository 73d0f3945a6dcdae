"""Equal blades on a hub, and multi-blade coordinates.

Coordinates q_k of N blades, each in axes of its own blade, are with ``psi_k = phi + 2 pi k / N``

    q_k = a_0 + sum_n (a_nc cos n psi_k + a_ns sin n psi_k) + (-1)^k a_d

with the last term where N is even. The sums say what a hub and its support feel, in standing axes.
"""

from __future__ import annotations

from collections import defaultdict
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag, expm

from sebody.assembly.numbering import coordinates
from sebody.basics.errors import InputError
from sebody.model.parts import DofBlock, Node, Superelement
from sebody.results.result import Result
from sebody.runs.rotating_frame import Spin
from sebody.runs.simulation import Simulation
from sebody.runs.turning_parts import unit
from sebody.small_motion.rotation import generators

NEAR = 1e-6         # of the model's size: where a blade's node is that of another one


class Blades(NamedTuple):
    """Coordinates of equal blades among the unknowns, positions in global axes.

    Attributes
    ----------
    columns : (N, m)
        Coordinates of every blade, in the same order.
    own : (N, m, m)
        Turns coordinates of a blade into axes of the first.
    """

    columns: NDArray
    own: NDArray

    def at(self, azimuth: float) -> tuple[NDArray, NDArray, NDArray]:
        """Coordinates of all blades, (N m, N m), by multi-blade ones; derivatives by the azimuth.
        """
        N, m = self.columns.shape
        psi = azimuth + 2.0 * np.pi * np.arange(N) / N
        found = []
        for derivative in range(3):
            columns = [np.ones(N) * (derivative == 0)]
            for n in range(1, (N - 1) // 2 + 1):
                shift = derivative * np.pi / 2
                columns += [n**derivative * np.cos(n * psi + shift),
                            n**derivative * np.sin(n * psi + shift)]
            if N % 2 == 0:
                columns.append((-1.0)**np.arange(N) * (derivative == 0))
            T = np.kron(np.array(columns).T, np.eye(m))
            found.append(block_diag(*(one.T for one in self.own)) @ T)
        return tuple(found)


def found_blades(run: Simulation | Result, spin: Spin, hub: Node) -> Blades:
    """The blades of a hub.

    Raises
    ------
    InputError
        Fewer than three parts beyond the hub are alike.
    """
    groups = _beyond(run, spin, hub)
    direction, size = unit(spin), NEAR * run.model.size()
    turning = generators.about(direction)
    remaining = list(groups)
    while remaining:
        first = remaining.pop(0)
        like = [one for one in remaining if len(one.nodes) == len(first.nodes)
                and len(one.bodies) == len(first.bodies)]
        N = 1 + len(like)
        if N < 3:
            continue
        blades = [first]
        for k in range(1, N):
            Q = expm(2.0 * np.pi * k / N * turning)
            blades += [one for one in (_ordered(other, first, Q, hub.point, size)
                                       for other in like) if one is not None]
        if len(blades) == N:
            return _coordinates(run, blades, turning)
    raise InputError(f"beyond hub {hub.name!r} there are no three or more parts that a turn of "
                     "the N-th part of a revolution brings to each other: name the node where the "
                     "blades join, and give all blades nodes and bodies alike")


class _Part(NamedTuple):
    """Parts that hang together beyond the hub."""

    nodes: list[Node]
    bodies: list[Superelement]


def _beyond(run: Simulation | Result, spin: Spin, hub: Node) -> list[_Part]:
    """Parts that turn and are held together by the hub alone."""
    model, parts = run.model, spin.parts
    assert parts is not None
    blocks: dict[DofBlock, DofBlock] = {}

    def top(one: DofBlock) -> DofBlock:
        while (above := blocks.setdefault(one, one)) is not one:
            one = above
        return one

    def tie(several: list[DofBlock]) -> None:
        own = [t for t in several if t.solved and t in parts
               and t not in (hub.position, hub.rotation)]
        for one in own[1:]:
            blocks[top(one)] = top(own[0])
    for node in model.nodes.values():
        tie([t for t in (node.position, node.rotation) if t is not None])
    for body in model.bodies.values():
        tie([*body.positions, *body.rotations])
    for element in (*model.constraints, *model.loads, *model.rigid_bodies.values()):
        tie(list(element.dof_blocks))
    nodes, bodies = defaultdict(list), defaultdict(list)
    for node in model.nodes.values():
        own = [t for t in (node.position, node.rotation) if t is not None and t.solved
               and t in parts and t not in (hub.position, hub.rotation)]
        if own:
            nodes[top(own[0])].append(node)
    for body in model.bodies.values():
        own = [t for t in (*body.positions, *body.rotations) if t.solved and t in parts
               and t not in (hub.position, hub.rotation)]
        if own:
            bodies[top(own[0])].append(body)
    return [_Part(own, bodies[key]) for key, own in nodes.items()]


def _ordered(other: _Part, first: _Part, Q: NDArray, centre: NDArray, size: float) -> _Part | None:
    """A part in the order of the first, which Q turns to it; None if it does not."""
    nodes = []
    for node in first.nodes:
        there = centre + Q @ (node.point - centre)
        near = [one for one in other.nodes if np.linalg.norm(one.point - there) < size]
        if not near:
            return None
        nodes.append(near[0])
    bodies = []
    for body in first.bodies:
        middle = np.mean([one.point for one in body.nodes], axis=0)
        there = centre + Q @ (middle - centre)
        near = [one for one in other.bodies if one.reduced.modes == body.reduced.modes
                and np.linalg.norm(np.mean([p.point for p in one.nodes], axis=0) - there) < size]
        if not near:
            return None
        bodies.append(near[0])
    return _Part(nodes, bodies)


def _coordinates(run: Simulation | Result, blades: list[_Part], turning: NDArray) -> Blades:
    N, columns, own = len(blades), [], []
    for k, blade in enumerate(blades):
        Q = expm(2.0 * np.pi * k / N * turning)
        at, axes = [], [np.zeros((0, 0))]
        for dof_block in dict.fromkeys(t for node in blade.nodes
                                       for t in (node.position, node.rotation)
                                       if t is not None and t.solved):
            at += coordinates(run.numbering, dof_block)
            axes.append(np.eye(1) if run.model.planar and dof_block.rotational else Q.T)
        for body, like in zip(blade.bodies, blades[0].bodies, strict=True):
            first = run.numbering.modes[body.name]
            at += range(first, first + body.reduced.modes)
            axes.append(np.diag(_signs(body, like, Q)))
        columns.append(at)
        own.append(block_diag(*axes))
    return Blades(np.array(columns), np.array(own))


def _signs(body: Superelement, like: Superelement, Q: NDArray) -> NDArray:
    """Signs of internal modes against those of a body that Q turns to this one."""
    b = len(body.reduced.mass) - body.reduced.modes
    width = len(Q)
    own, other = (one.reduced.mass[:b, b:] for one in (body, like))
    turned = other.copy()
    for first in range(0, b - b % width, width):
        turned[first:first + width] = Q @ other[first:first + width]
    return np.where(np.sum(own * turned, axis=0) < 0.0, -1.0, 1.0)
