"""A reduced body of another material: stiffness, mass and damping by factors."""

from dataclasses import replace

from sebody.reduction.body import ReducedBody
from sebody.reduction.invariants import InertiaInvariants


def scaled(body: ReducedBody, stiffness: float = 1.0, mass: float = 1.0, damping: float = 1.0
           ) -> ReducedBody:
    """The same body with its stiffness, mass and damping multiplied by factors.

    Shapes stay as they are, so that of load modes the modal mass changes; they are not made
    anew. Prestresses are those of the stiffer material: geometric stiffness goes with stiffness.
    """
    return replace(
        body, stiffness=stiffness * body.stiffness, mass=mass * body.mass,
        damping=None if body.damping is None else damping * body.damping,
        invariants=body.invariants and _scaled(body.invariants, stiffness, mass))


def _scaled(i: InertiaInvariants, stiffness: float, mass: float) -> InertiaInvariants:
    # slaved coordinates follow by Q = -G / kap, a ratio of two stiffnesses; E are motions
    return replace(i, mass=mass * i.mass, c0=mass * i.c0, S1=mass * i.S1, J0=mass * i.J0,
                   g=mass * i.g, h=mass * i.h, K=mass * i.K, J2=mass * i.J2,
                   Mbar=mass * i.Mbar, lam=stiffness * i.lam, Ghat=stiffness * i.Ghat)
