"""Frames a superelement may have, and the weights of its nodes in the frame."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody import inputs
from sebody.contract.layout import FrameTraits
from sebody.errors import InputError
from sebody.generated import options
from sebody.reduction import ReducedBody, body_weights


class Frame(NamedTuple):
    """A frame as a user chooses it."""

    kernel: str                 # the frame of the generated kernel
    traits: FrameTraits
    on_one_node: bool = False   # one node has all the weight


FRAMES = {name: Frame(name, traits) for name, traits in options.FRAMES.items()}
# Ratio of the spreads of positions from which on their fit is the default: it follows the least of
# them, which has little mass in bodies much longer than wide.
FAR_FROM_A_LINE = 0.2
FRAMES["node"] = FRAMES["converged_mean"]._replace(on_one_node=True)    # the mean of one rotation


def known_frame(frame: str) -> Frame:
    """A frame by its name.

    Raises
    ------
    InputError
        There is none of this name.
    """
    if not isinstance(frame, str) or frame not in FRAMES:
        raise InputError(f"frame {inputs.shown(frame)} is unknown: use one of "
                         f"{', '.join(sorted(FRAMES))}")
    return FRAMES[frame]


def default_frame(body: ReducedBody, inertia: str | None) -> str:
    """The frame of a body whose user asks for none.

    A frame on rotations follows nodes that have little inertia of rotation. The inertia of option C
    then depends on how far the body is bent, the more the lighter the nodes are against the body.
    Positions move with more mass.
    """
    if body.invariants is None or inertia not in (None, "c") or not body.rotation_nodes:
        return "converged_mean"
    points = body.coordinates[list(body.position_nodes)]
    if len(points) < 3:
        return "converged_mean"
    spread = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)
    return "positions" if spread[1] > FAR_FROM_A_LINE * spread[0] else "converged_mean"


def check_frame(name: str, body: ReducedBody, frame: str) -> None:
    """Refuse a frame that the kept triplets cannot define."""
    traits = FRAMES[frame].traits
    if traits.needs_rotations:
        if not body.rotation_nodes:
            others = [repr(n) for n, f in FRAMES.items() if not f.traits.needs_rotations]
            raise InputError(f"superelement {name!r} keeps no rotation, so its frame cannot be "
                             f"{frame!r}: use frame={' or '.join(others)}")
        return
    points = body.coordinates[list(body.position_nodes)]
    spread = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)
    if len(points) < traits.fewest_positions[body.planar] or (
            spread[body.coordinates.shape[1] - 2] < 1e-6 * max(spread[0], 1e-300)):
        raise InputError(f"superelement {name!r}: the nodes that keep their position lie on a "
                         f"line, so the frame {frame!r} cannot see rotations about it: use "
                         "'converged_mean', or keep a node off the line")


def frame_weights(name: str, body: ReducedBody, frame: str,
                  node: int) -> tuple[NDArray, NDArray]:
    """Weights of positions and rotations in the frame; `node` carries frames on one node."""
    if not FRAMES[frame].on_one_node:
        return body_weights(body)
    node = inputs.integer(node, "frame_node")
    if node not in body.position_nodes or node not in body.rotation_nodes:
        raise InputError(f"superelement {name!r}: boundary node {node} cannot carry the frame, it "
                         "needs both its position and its rotation: choose a full node")
    alpha = np.array([float(i == node) for i in body.position_nodes])
    return alpha, np.array([float(i == node) for i in body.rotation_nodes])
