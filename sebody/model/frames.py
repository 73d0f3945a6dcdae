"""Frames a superelement may have, and the weights of its nodes in the frame."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.contract.traits import FrameTraits
from sebody.generated import options
from sebody.reduction.body import ReducedBody
from sebody.reduction.mean_rotation import central_inertia
from sebody.reduction.weights import body_weights


class Frame(NamedTuple):
    """A frame as a user chooses it."""

    kernel: str                 # the frame of the generated kernel
    traits: FrameTraits
    on_one_node: bool = False   # one node has all the weight


FRAMES = {name: Frame(name, traits) for name, traits in options.FRAMES.items()}
# Ratio of the spreads of positions from which on their fit is the default: it follows the least of
# them, which has little mass in bodies much longer than wide.
FAR_FROM_A_LINE = 0.2
# A body is not straight from these on: distance of the centre of mass from the nodes' line over its
# length, and angle between this line and a principal axis; radius of gyration about it, likewise.
CROOKED, OFF_LINE = 0.01, 0.15
SLENDER = 1e-10     # ratio of moments of inertia below which there are no mean axes
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
    Positions move with more mass; where they are too few, mean axes follow the mass itself. Of
    straight bodies, which have hardly any inertia about their axis, mean axes follow torsion.
    """
    field = inertia is None or options.INERTIA_OPTIONS[inertia].field
    if body.invariants is None or not field or not body.rotation_nodes:
        return "converged_mean"
    points = body.coordinates[list(body.position_nodes)]
    if len(points) > 2:
        spread = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)
        if spread[1] > FAR_FROM_A_LINE * spread[0]:
            return "positions"
    return "mean_axes" if mass_off_line(body) else "converged_mean"


def mass_off_line(body: ReducedBody) -> bool:
    """Tell whether the mass of a body is off the line of its nodes, so that it is not straight.

    Then the centre of mass is off this line, or the line is no principal axis of inertia, or the
    radius of gyration about it is large. In a plane only the centre of mass is known.
    """
    points = body.coordinates[list(body.position_nodes)]
    if len(points) < 2:
        return False
    axis = np.linalg.svd(points - points.mean(axis=0))[2][0]
    length, arm = np.ptp(points @ axis), body.centre_of_mass - points.mean(axis=0)
    if np.linalg.norm(arm - arm @ axis * axis) > CROOKED * length:
        return True
    if body.planar or body.invariants is None:
        return False
    J = body.invariants.about(body.centre_of_mass).J0 / body.total_mass
    about = axis @ J @ axis
    turned = np.linalg.norm(J @ axis - about * axis)
    return bool(turned > CROOKED * (np.trace(J) - about) / 2 or about > (OFF_LINE * length)**2)


def check_base_frame(name: str, body: ReducedBody, frame: str, node: int) -> None:
    """Refuse a frame that moves against the base of a body without coupling with its base.

    Local coordinates are then not those that its mass is of.
    """
    if body.rests and not (FRAMES[frame].on_one_node and node == body.base):
        raise InputError(f"superelement {name!r} is held to the ground without inertial coupling "
                         "with its base, so its mass is that of motions relative to its base, and "
                         f"the frame {frame!r} would give wrong frequencies (of a tower by a "
                         f"third): use frame='node' with frame_node={body.base}, as "
                         "model.foundation does, or give grounded_body coupling= and rigid_mass=")


def check_frame(name: str, body: ReducedBody, frame: str) -> None:
    """Refuse a frame that the kept DOF blocks cannot define."""
    traits = FRAMES[frame].traits
    if traits.modes:
        moments = np.linalg.eigvalsh(central_inertia(body))
        if not moments[0] > SLENDER * moments[-1]:
            listed = ", ".join(f"{moment:.3g}" for moment in moments)
            raise InputError(f"superelement {name!r} has hardly any inertia about an axis (moments "
                             f"{listed} about its centre of mass), so the frame {frame!r} cannot "
                             "determine rotations about it: use 'converged_mean'")
        return
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
                         f"line, so the frame {frame!r} cannot determine rotations about it: use "
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
