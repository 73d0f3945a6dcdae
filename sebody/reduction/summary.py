"""A reduced body in words and numbers."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

Body = Any      # a ReducedBody, whose module imports this one


def summary(body: Body) -> str:
    """Order, mass, frequencies and effective masses of the internal modes, and the notes."""
    nodes, n = len(body.coordinates), len(body.mass)
    lines = [f"{nodes} boundary node{'s' * (nodes > 1)}, {n - body.modes} boundary coordinates, "
             f"{body.modes} internal modes",
             f"mass {body.total_mass:.6g}, centre of mass {_place(body.centre_of_mass)}"]
    lines += [f"boundary node {k} at {_place(point)} keeps {keep!r}"
              for k, (point, keep) in enumerate(zip(body.coordinates, body.keeps, strict=True))]
    if body.modes:
        lines += _modes(body)
    return "\n".join([*lines, *body.notes])


def effective_masses(body: Body) -> NDArray:
    """Part of the mass, and of the moments of inertia about the centre, that each mode moves.

    ``(R^T M_k)^2 / M_kk`` over ``R^T M R``, of the rigid motions R about the centre of mass, with
    the boundary clamped: (modes, 6), planar (modes, 3).
    """
    rigid = body.rigid_modes_about(body.centre_of_mass)
    momenta = rigid.T @ body.mass
    whole = np.einsum("kn,nk->k", momenta, rigid)
    own = slice(len(body.mass) - body.modes, None)
    masses = np.diag(body.mass)[own]
    return (momenta[:, own]**2 / (np.where(masses > 0, masses, np.inf) * whole[:, None])).T


def frequencies(body: Body) -> NDArray:
    """Of the internal modes with the boundary clamped, in cycles per unit of time, (modes,)."""
    own = slice(len(body.mass) - body.modes, None)
    with np.errstate(divide="ignore"):
        squares = np.diag(body.stiffness)[own] / np.diag(body.mass)[own]
    return np.sqrt(np.maximum(squares, 0.0)) / (2 * np.pi)


def _modes(body: Body) -> list[str]:
    parts = effective_masses(body)
    axes = ("x", "y", "about z") if body.planar else ("x", "y", "z", "about x", "about y",
                                                      "about z")
    lines = ["mode  frequency (1/time)  part of the mass " + "".join(f"{a:>9}" for a in axes)]
    rows = [*zip(map("{:4d}".format, range(body.modes)), map("{:16.6g}".format, frequencies(body)),
                 parts, strict=True), (" all", 16 * " ", parts.sum(axis=0))]
    return lines + [f"{name}  {frequency}  {'':18}" + "".join(f"{part:9.4f}" for part in row)
                    for name, frequency, row in rows]


def _place(point: NDArray) -> str:
    return "(" + ", ".join(f"{x:.6g}" for x in point) + ")"
