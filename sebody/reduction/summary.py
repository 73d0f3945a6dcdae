"""Internal modes of a reduced body in numbers and words."""

import numpy as np
from numpy.typing import NDArray


def effective_masses(mass: NDArray, rigid: NDArray, modes: int) -> NDArray:
    """Part of the mass, and of the moments of inertia, that each mode moves.

    ``(R^T M_k)^2 / M_kk`` over ``R^T M R``: of motions R of the clamped boundary.

    Parameters
    ----------
    mass : (n, n)
        Reduced mass, internal modes last.
    rigid : (n, r)
        Rigid motions, rotations about the centre of mass.
    modes : int

    Returns
    -------
    (modes, r)
    """
    momenta = rigid.T @ mass
    whole = np.einsum("kn,nk->k", momenta, rigid)
    own = slice(len(mass) - modes, None)
    masses = np.diag(mass)[own]
    return (momenta[:, own]**2 / (np.where(masses > 0, masses, np.inf) * whole[:, None])).T


def frequencies(stiffness: NDArray, mass: NDArray, modes: int) -> NDArray:
    """Frequencies of the internal modes with the boundary clamped, in cycles per time, (modes,)."""
    own = slice(len(mass) - modes, None)
    with np.errstate(divide="ignore"):
        squares = np.diag(stiffness)[own] / np.diag(mass)[own]
    return np.sqrt(np.maximum(squares, 0.0)) / (2 * np.pi)


def mode_lines(stiffness: NDArray, mass: NDArray, rigid: NDArray, modes: int) -> list[str]:
    """A table of them."""
    if not modes:
        return []
    parts = effective_masses(mass, rigid, modes)
    axes = ("x", "y", "about z") if len(rigid.T) == 3 else ("x", "y", "z", "about x", "about y",
                                                            "about z")
    lines = ["mode  frequency (1/time)  part of the mass " + "".join(f"{a:>9}" for a in axes)]
    rows = [*zip(map("{:4d}".format, range(modes)),
                 map("{:16.6g}".format, frequencies(stiffness, mass, modes)), parts, strict=True),
            (" all", 16 * " ", parts.sum(axis=0))]
    return lines + [f"{name}  {frequency}  {'':18}" + "".join(f"{part:9.4f}" for part in row)
                    for name, frequency, row in rows]


def place(point: NDArray) -> str:
    """A point in brackets; what is rounding of its distance from the origin is shown as zero."""
    rounding = 1e-13 * np.linalg.norm(point)
    return "(" + ", ".join(f"{x if abs(x) > rounding else 0.0:.6g}" for x in point) + ")"
