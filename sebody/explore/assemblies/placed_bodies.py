"""Bodies inside an assembly, in its state: where they are, and how they move with it."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag

from sebody.assembly.body_constants import frame_constants
from sebody.assembly.contracts import counts_of
from sebody.assembly.floating import frame_conditions
from sebody.generated.options import CONDITIONS
from sebody.model.frames import FRAMES
from sebody.model.parts import Superelement
from sebody.reduction.body import ReducedBody
from sebody.results.motion import body_motion
from sebody.results.result import Result

Motion = Callable[[str], NDArray]       # rows of a quantity of small motion by its name


class Placed(NamedTuple):
    """A body in the state of an assembly."""

    name: str
    body: ReducedBody       # as it lies in the state
    shift: NDArray          # from its coordinates to places, (D,)
    rows: NDArray           # (n_b, n) motion of its coordinates, in axes of space
    y: NDArray              # (n_b,) its deformation in the state, in these axes
    frame: NDArray          # (r, n_b) rotation of its frame by its coordinates
    slaved: NDArray         # (s_b, n) motion of its slaved coordinates beside that of second order

    def place(self, points: NDArray) -> NDArray:
        """Places of points of the undeformed body."""
        return points + self.shift


def placed_bodies(held: Result, motion: Motion) -> list[Placed]:
    """All superelements of a result's model, in its last state."""
    return [_placed(held, body, motion) for body in held.model.bodies.values()]


def _placed(held: Result, body: Superelement, motion: Motion) -> Placed:
    state = body_motion(held, body, slice(-1, None))
    R, own = state.rotation[0], body.reduced
    still = np.abs(R - np.eye(len(R))).max() < 1e-14
    angles = len(own.rotation_nodes)
    by = block_diag(np.kron(np.eye(len(own.position_nodes)), R),
                    np.eye(angles) if own.planar else np.kron(np.eye(angles), R),
                    np.eye(own.modes))
    turned = own if still else own.rotated(R)
    origin = body.alpha @ turned.coordinates[list(own.position_nodes)]
    rows = [motion(f"{body.nodes[i].name}.position") for i in own.position_nodes]
    rows += [motion(f"{body.nodes[i].name}.rotation") for i in own.rotation_nodes]
    rows += [motion(f"{body.name}.modes")] if own.modes else []
    return Placed(body.name, turned, state.origin[0] - origin, np.vstack(rows), by @ state.y[0],
                  (np.eye(1) if own.planar else R) @ _turning(body) @ by.T,
                  np.zeros((0 if own.invariants is None else own.invariants.slaved,
                            rows[0].shape[1])))


def _turning(body: Superelement) -> NDArray:
    """Rotation of the frame by the coordinates of a body, (r, n), to first order, in its axes."""
    own, D = body.reduced, body.reduced.coordinates.shape[1]
    kernel = FRAMES[body.frame].kernel
    if (kernel, own.planar) not in CONDITIONS:      # incremental frames follow the mean rotation
        kernel = FRAMES["converged_mean"].kernel
    conditions = frame_conditions(kernel, counts_of(body), frame_constants(body))
    return np.linalg.solve(conditions @ own.rigid_modes, conditions)[D:]
