"""Elastic forces from the strain energy ``V = y^T Sbar y / 2``, (24)-(30)."""

from typing import NamedTuple

import sympy as sp

from .quantities import Quantities
from .rotations import inverse_tangent_times, inverse_tangent_transposed_times
from .variation import check_same, coefficients


class VirtualWork(NamedTuple):
    """Forces conjugate to the variations a frame leaves to be pulled back."""

    position: sp.Matrix     # on R0^T delta x_i
    rotation: sp.Matrix     # on delta Theta_j, directly
    origin: sp.Matrix       # on R0^T delta x_0, summed over positions
    frame_positions: sp.Matrix  # on delta Theta_0, summed over positions
    frame_rotations: sp.Matrix  # on delta Theta_0, summed over rotations
    mean: sp.Matrix | None = None   # on sum alpha_j delta Theta_j (small increments only)


def virtual_work(q: Quantities, du: sp.Matrix, dpsi: sp.Matrix,
                 mean: sp.Matrix | None = None) -> VirtualWork:
    """Coefficients of ``delta V = sum f_i . delta u_i + sum m_j . delta psi_j``, (30).

    ``Sbar`` is constant, so ``delta V = (Sbar y) . delta y`` and only the variations (17) of the
    local coordinates enter.

    Parameters
    ----------
    du, dpsi : sympy.Matrix
        Variations of the local displacement and rotation of one node.
    mean : sympy.Matrix, optional
        Symbols of ``sum alpha_j delta Theta_j`` where `dpsi` contains them.
    """
    of_position = q.f.symbols.dot(du)
    of_rotation = q.m.symbols.dot(dpsi)
    dth0, psi, m = q.dth0.symbols, q.psi.symbols, q.m.symbols
    moment = check_same("elastic moment (30)", inverse_tangent_transposed_times(psi, m),
                        _of(of_rotation, q.dth.symbols))
    on_frame = check_same("elastic moment on the frame (30)", -inverse_tangent_times(psi, m),
                          _of(of_rotation, dth0))
    return VirtualWork(
        position=_of(of_position, q.dx.symbols), rotation=moment,
        origin=_of(of_position, q.dx0.symbols), frame_positions=_of(of_position, dth0),
        frame_rotations=on_frame,
        mean=None if mean is None else _of(of_rotation, mean))


def _of(form, variables):
    """Coefficients where the space has a component, zero where a plane has none."""
    return sp.Matrix([coefficients(form, [v])[0] if isinstance(v, sp.Symbol) else 0
                      for v in variables])
