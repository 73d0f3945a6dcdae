"""Elastic forces from the strain energy ``V = y^T Sbar y / 2``, (24)-(30)."""

from typing import NamedTuple

import sympy as sp

from sebody.derive.form.steps import Product
from sebody.derive.formulas import arrays
from sebody.derive.formulas.kinematics import elastic_rotation_variation, local_displacement
from sebody.derive.formulas.quantities import Quantities
from sebody.derive.symbolic.rotations import (
    cross,
    inverse_tangent_times,
    inverse_tangent_transposed_times,
)
from sebody.derive.symbolic.variation import check_same, coefficients

ELASTIC = Product("elastic force, s = Sbar y", arrays.S, arrays.y, arrays.s)


class VirtualWork(NamedTuple):
    """Forces conjugate to the variations a frame leaves to be pulled back."""

    position: sp.Matrix         # on R0^T delta x_i
    origin: sp.Matrix           # on R0^T delta x_0, summed over positions
    frame_positions: sp.Matrix  # on delta Theta_0, summed over positions
    rotation: sp.Matrix         # on delta Theta_j, directly
    frame_rotations: sp.Matrix  # on delta Theta_0, summed over rotations
    mean: sp.Matrix | None = None   # on sum alpha_j delta Theta_j, summed (small increments only)


def virtual_work(q: Quantities) -> VirtualWork:
    """Coefficients of ``delta V = sum f_i . delta u_i + sum m_j . delta psi_j``, (30).

    ``Sbar`` is constant, so ``delta V = (Sbar y) . delta y`` and only the exact variations (17)
    of the local coordinates enter.
    """
    of_rotation = q.m.symbols.dot(elastic_rotation_variation(q))
    psi, m = q.psi.symbols, q.m.symbols
    return VirtualWork(
        *_of_positions(q),
        rotation=check_same("elastic moment (30)", inverse_tangent_transposed_times(psi, m),
                            conjugate_to(of_rotation, q.dth.symbols)),
        frame_rotations=check_same("elastic moment on the frame (30)",
                                   -inverse_tangent_times(psi, m),
                                   conjugate_to(of_rotation, q.dth0.symbols)))


def virtual_work_small(q: Quantities) -> VirtualWork:
    """The same with the paper's small increments (20), (28)-(29).

    ``delta psi_i = (I + psi_i~/2) dTheta_i - sum_j a_j (I + (psi_j~ - psi_i~)/2) dTheta_j``: the
    sum is ``dTheta_0`` of (43) less ``psi_i~/2`` times the mean of the variations.
    """
    psi, m, mean = q.psi.symbols, q.m.symbols, q.space.quantity("dmean", "axial", "element")
    varied = (q.dth.symbols + cross(psi, q.dth.symbols) / 2 - q.dth0.symbols
              + cross(psi, mean.symbols) / 2)
    work = m.dot(varied)
    rotation, frame, of_mean = (conjugate_to(work, d.symbols) for d in (q.dth, q.dth0, mean))
    return VirtualWork(*_of_positions(q), rotation=rotation, frame_rotations=frame, mean=of_mean)


def _of_positions(q: Quantities) -> tuple[sp.Matrix, sp.Matrix, sp.Matrix]:
    work = q.f.symbols.dot(local_displacement(q).short[0])
    return tuple(conjugate_to(work, d.symbols) for d in (q.dx, q.dx0, q.dth0))


def conjugate_to(form, variables):
    """Coefficients where the space has a component, zero where a plane has none."""
    return sp.Matrix([coefficients(form, [v])[0] if isinstance(v, sp.Symbol) else 0
                      for v in variables])
