"""Traits of frames and inertia options of superelements, declared beside their formulas."""

from collections.abc import Callable
from typing import NamedTuple

from sebody.contract.layout import Part


class FrameTraits(NamedTuple):
    """Properties of a floating frame."""

    summary: str
    needs_rotations: bool = True    # averages rotations of nodes; else follows positions
    modes: bool = False             # these, rotations and internal modes
    fewest_positions: tuple[int, int] = (1, 1)      # in space, in a plane
    planar: bool = True             # False: in a plane the frame equals another one
    exact: bool = True              # forces are derivatives of the energy
    incremental: bool = False       # averages rotation increments of the step
    constants: tuple[Part, ...] = ()        # read in addition to SUPERELEMENT_CONSTANTS


class InertiaTraits(NamedTuple):
    """Properties of an inertia option."""

    summary: str
    letter: str                     # of Cardona's options (a, b) and of those beyond the paper
    rank: int                       # options of a higher rank describe more of the motion
    cost: float                     # of an operation, relative to option A: measured
    softening: float                # of stiffness by a spin: share of (spin / frequency)^2
    material: bool                  # T in material angular velocities; else in those of the frame
    modes_apart: bool = False       # internal modes meet in S, M and C alone, nowhere else
    rates: bool = False             # T in rates of deformation: frames that depend on the state
    # alone, and the same kernels for bodies with and without damping
    field: bool = False             # T of the displacement field, from integrals over the body
    constants: tuple[Part, ...] = ()        # read in addition to SUPERELEMENT_CONSTANTS


class Condition(NamedTuple):
    """The conditions on local coordinates of a body in its frame, beside zero mean displacements.

    A sum over the nodes vanishes: coefficients times the displacement or rotation of each. Or one
    over all coordinates does. In incremental frames it is zero to first order.
    """

    of: str                     # position | rotation | coordinate
    constants: tuple[str, ...]  # that the coefficients are made of, by name: those of a node
    coefficients: Callable      # (rows, components) of the constants of a node, in this order
