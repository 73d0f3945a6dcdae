"""A model with its turning part at another azimuth, and its matrices there.

In *base* coordinates every part is told in its own axes: what turns in axes that turn with it, what
stands in axes of space. In coordinates u with ``z = P(phi) u``, phi the azimuth and W its rate,

    M_u = P^T M P,  C_u = P^T (C P + 2 W M P'),  K_u = P^T (K P + W C P' + W^2 M P'')

where primes of P are derivatives by phi. Here ``P = exp(G phi)``: G has -S of what turns, for
standing axes, or S of what stands, for turning axes (S: see `generators`), or is zero.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm

from sebody.assembly.evaluation import evaluate
from sebody.assembly.numbering import coordinates
from sebody.contract.layout import RESIDUAL
from sebody.engine.evaluate import to_body_axes
from sebody.engine.links import place_dependent
from sebody.results.result import Result
from sebody.runs.rotating_frame import Spin, Turning, motion
from sebody.runs.simulation import Simulation
from sebody.runs.state_derivatives import turning
from sebody.runs.turning_parts import turning_bodies, unit
from sebody.small_motion.rotation import generators

Matrices = tuple[NDArray, NDArray, NDArray]


@contextmanager
def steady(run: Simulation | Result, spin: Spin, azimuth: float = 0.0) -> Iterator[None]:
    """The state of a run with the rates of a rotation of its parts, turned by an azimuth.

    Without parts the state is left as it is.
    """
    if spin.parts is None:
        yield
        return
    state = run.state
    kept, turns = state.now.copy(), state.turns.copy()
    try:
        if azimuth:
            _turn(run, spin, azimuth)
        spin.move(run)
        yield
    finally:
        state.now[:], state.turns[:] = kept, turns


def _turn(run: Simulation | Result, spin: Spin, azimuth: float) -> None:
    """Turn what turns about its line."""
    state, numbering, planar = run.state, run.numbering, spin.planar
    assert spin.parts is not None
    forces = _constraint_forces(run)
    direction = unit(spin)
    for dof_block, turns in spin.parts.items():
        angle = turns.factor * azimuth
        at = coordinates(numbering, dof_block)
        Q = expm(angle * generators.about(direction))
        if not dof_block.rotational:
            state.q[at] = turns.point + Q @ (state.q[at] - turns.point)
        elif planar:
            state.q[at] += angle * direction
        else:
            k = numbering.rotations[dof_block]
            R = state.R[9 * k:9 * k + 9].reshape(3, 3)
            R[:] = Q @ R
    turned = turning_bodies(run.model, spin.parts)
    for k, name in enumerate(run.model.bodies):
        if name in turned:
            Q = np.eye(3)
            own = expm(turned[name][1].factor * azimuth * generators.about(direction))
            Q[:len(own), :len(own)] = own
            for frames in (state.frames, state.frames_old):
                frame = frames[9 * k:9 * k + 9].reshape(3, 3)
                frame[:] = Q @ frame
    place_dependent(run.arrays_of_loop[0].links, state.q, state.v, state.a, state.R, state.turns)
    if forces:
        _rebalance(run)


def _constraint_forces(run: Simulation | Result) -> bool:
    multipliers = run.arrays_of_loop[0].is_multiplier[:run.numbering.free] > 0
    return bool(np.any(run.state.q[:run.numbering.free][multipliers]))


def _rebalance(run: Simulation | Result) -> None:
    """Set multipliers to those that leave the smallest forces: their axes may have turned."""
    n, state, system = run.numbering.free, run.state, run.arrays_of_loop[0]
    multipliers = np.flatnonzero(system.is_multiplier[:n] > 0)
    moving = np.setdiff1d(np.arange(n), multipliers)

    def left() -> NDArray:
        evaluate(system, state, RESIDUAL, RESIDUAL, "the state")
        residual = state.residual.copy()
        to_body_axes(system, state.frames, residual, False)
        return residual[moving]
    state.q[multipliers] = 0.0
    rest, columns = left(), []
    for k in multipliers:
        state.q[k] = 1.0
        columns.append(left() - rest)
        state.q[k] = 0.0
    state.q[multipliers] = np.linalg.lstsq(np.array(columns).T, -rest, rcond=1e-12)[0]


class Base(NamedTuple):
    """Unknowns, positions in global axes, by kind and by the part they belong to."""

    axes: NDArray           # (n, n) from the unknowns' own axes to global ones
    still: NDArray          # (n, n) generator G of standing axes, of a unit azimuth
    turned: NDArray         # (n, n) and of turning axes
    places: NDArray         # (n,) of bool: positions, whose axes turn with the azimuth
    spatial: NDArray        # (n, n) generator that turns axes of positions of what turns

    @classmethod
    def of(cls, run: Simulation | Result, spin: Spin) -> Base:
        """Those of a run whose parts turn."""
        n, numbering, direction = run.numbering.free, run.numbering, unit(spin)
        assert spin.parts is not None
        still, turned, spatial = (np.zeros((n, n)) for _ in range(3))
        places = np.zeros(n, dtype=bool)
        nodes = dict.fromkeys(t for node in run.model.nodes.values()
                              for t in (node.position, node.rotation) if t is not None)
        for dof_block in nodes:
            if not dof_block.solved or dof_block not in numbering.dof_blocks:
                continue
            at = coordinates(numbering, dof_block)
            S = _of_block(run, dof_block.rotational, dof_block, direction)
            _put(still, turned, spin.parts.get(dof_block), at, S)
            if not dof_block.rotational:
                places[at] = True
                if dof_block in spin.parts:
                    spatial[np.ix_(at, at)] = spin.parts[dof_block].factor * S
        turning_ones = turning_bodies(run.model, spin.parts)
        for name, body in run.model.bodies.items():
            first = numbering.modes[name]
            at = list(range(first, first + body.reduced.modes))
            _put(still, turned, turning_ones.get(name, (body, None))[1], at,
                 generators.of_modes(body, direction))
        return cls(motion(run)[:n].toarray(), still, turned, places, spatial)


def _of_block(run: Simulation | Result, rotational: bool, dof_block, direction: NDArray
              ) -> NDArray:
    if not rotational:
        return generators.about(direction)
    if len(direction) == 1:
        return np.zeros((1, 1))
    k = run.numbering.rotations[dof_block]
    return generators.about(run.state.R[9 * k:9 * k + 9].reshape(3, 3).T @ direction)


def _put(still: NDArray, turned: NDArray, turns: Turning | None, at: list[int], S: NDArray
         ) -> None:
    """The generator of a block: backwards of what turns, forwards of what stands."""
    if turns is not None:
        still[np.ix_(at, at)] = -turns.factor * S
    else:
        turned[np.ix_(at, at)] = S


def base_matrices(run: Simulation | Result, spin: Spin, azimuth: float = 0.0) -> Matrices:
    """Mass, damping and stiffness of the unknowns in base coordinates, in their own axes."""
    with steady(run, spin, azimuth):
        return tuple(X.toarray() for X in turning(run, spin))


def substituted(matrices: Matrices, speed: float, P: NDArray, P1: NDArray, P2: NDArray
                ) -> Matrices:
    """The matrices in coordinates ``z = P u``, with derivatives of P by the azimuth."""
    M, C, K = matrices
    return (P.T @ M @ P, P.T @ (C @ P + 2.0 * speed * M @ P1),
            P.T @ (K @ P + speed * C @ P1 + speed**2 * M @ P2))
