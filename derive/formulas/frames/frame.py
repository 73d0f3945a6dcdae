"""Floating frames: where the frame is, how it varies, and what it returns to the unknowns.

Each frame is a condition on the nodes. Its variation is the differential of that condition, and
the force on an unknown is the moment ``W`` on the frame pulled back through the same variation.
"""

from collections.abc import Callable
from typing import NamedTuple

import sympy as sp

from sebody.contract.traits import FrameTraits
from sebody.derive.form.arrays import Place
from sebody.derive.form.functions import INVERSE_TANGENT
from sebody.derive.form.spaces import Quantity
from sebody.derive.form.steps import Solve, Stage, Step, Sum, Values
from sebody.derive.formulas import arrays
from sebody.derive.formulas.elastic import VirtualWork
from sebody.derive.formulas.quantities import Quantities
from sebody.derive.symbolic.variation import check_same


class Condition(NamedTuple):
    """A condition on the local coordinates in a frame: ``sum_j weight_j of_j = 0``.

    Beside it the weighted displacements add up to zero in every frame, (14).
    """

    of: Quantity                        # displacements of the nodes, their rotation vectors, ...
    weight: sp.Matrix                   # three rows, of constants of what carries it
    constants: tuple[Quantity, ...]     # these


class Frame(NamedTuple):
    """A floating frame derived for one space."""

    locate: tuple[Step, ...]        # R0, and psi_j with it
    velocity: tuple[Step, ...]      # Om0 from the velocities of the nodes
    variation: tuple[Step, ...]     # dth0 from their variations
    pull: tuple[Step, ...]          # W -> wp
    work: Callable[[Quantities], VirtualWork]   # of the elastic forces, as rotations vary with it
    position: sp.Matrix             # force of wp on R0^T delta x_i
    origin: sp.Matrix               # force of wp on R0^T delta x_0, summed over positions
    rotation: sp.Matrix = sp.zeros(3, 1)    # force of wp on delta Theta_j
    mode: sp.Matrix = sp.zeros(1, 1)    # force of wp on the variation of an internal mode
    on_psi: sp.Matrix = sp.zeros(3, 1)      # of wp on delta psi_j, pulled back with elastic ones
    differentials: tuple[Stage, ...] = ()   # of what `locate` computes, once dth0 is known
    # its parts by what carries them add up to zero: linear, and of the sign of the equation in
    # `velocity`; none of a frame without one
    conditions: tuple[Condition, ...] = ()


class FrameOption(NamedTuple):
    """A choice of floating frame: what it needs, and its derivation."""

    traits: FrameTraits
    derive: Callable[[Quantities], Frame]
    equations: str      # where they stand: those of Cardona (2000) by their numbers, or a file
    # the whole of that of its `Frame`; of frames that depend on the last step to first order
    condition: Callable[[Quantities], Condition] | None = None


def origin_stage(q: Quantities, result: Quantity, of: Quantity) -> Stage:
    """Weighted mean (14), (18) of positions, or of their variations or velocities."""
    return Stage("origin of the frame, (14)", "position",
                 adds=((result, q.alpha.symbols[0] * of.symbols),))


def kept_rotation(q: Quantities) -> Stage:
    """A rotation of the frame that was computed by stages, where the caller finds it."""
    R0 = q.R0.symbols
    places = (0, 1, 3, 4) if q.space.planar else range(9)
    entries = [(q.space.quantity(f"frame_{k}", "scalar", "element", arrays.frame, Place(k)),
                sp.Matrix([R0[k]])) for k in places]
    return Stage("rotation of the frame, kept", "element", sets=tuple(entries))


def inverse_tangent_values(q: Quantities, of: Quantity,
                           outputs: tuple[Quantity, Quantity]) -> tuple[Step, ...]:
    """Coefficients of ``T^-1`` and their derivatives, once per node; none in a plane."""
    if q.space.planar:
        return ()
    return (Values("coefficients of T^-1", outputs, INVERSE_TANGENT, of, 30),)


def pulled_back(q: Quantities, sums: tuple[Sum, ...], equation: tuple[Sum, ...],
                weight: sp.Symbol | None = None) -> Solve:
    """``B^T wp = W`` where ``B`` is the matrix of the frame's equation in its rate.

    Parameters
    ----------
    sums : tuple of Sum
        ``B^T wp``, proved.
    equation : tuple of Sum
        The frame's with wp in place of its rate; sums without the rate may follow.
    """
    unknown = q.wp.symbols
    for short, part in zip(sums, equation, strict=False):
        matrix = sp.Matrix.hstack(*[
            part.summand.diff(u) if isinstance(u, sp.Symbol) else sp.zeros(3, 1) for u in unknown])
        check_same("transposed equation of the frame", short.summand, matrix.T * unknown)
    return Solve("B^T wp = W", q.wp, sums, -q.W.symbols, "B", transposed=True, weight=weight)
