"""Displacements and stresses inside a body that is restricted to the plane of its FE nodes."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag

from sebody.fem.beam_stress import BeamStress
from sebody.fem.layout import PLANAR, SPATIAL
from sebody.reduction.body import ReducedBody
from sebody.reduction.recovery import Recovery

_NEAR = 1e-9            # of the size of the body: nodes in the plane


def planar_recovery(body: ReducedBody, kept: NDArray, slaved: NDArray, loads: list[int]
                    ) -> Recovery | None:
    """The recovery of the even motions of a body, if all its FE nodes are in the plane.

    Parameters
    ----------
    body : ReducedBody
        In the axes of the plane, whose normal is z.
    kept : (n, n_planar)
        Old reduced coordinates of unit planar ones.
    slaved : (slaved, slaved_planar)
        The same of load modes.
    loads : list of int
        Places of the loads that are kept.

    Returns
    -------
    Recovery or None
        Its FE axes are those of the plane.
    """
    recovery = body.recovery
    if recovery is None or recovery.node_dofs != SPATIAL:
        return None
    off = recovery.points[:, 2] - body.coordinates[0, 2]
    if np.abs(off).max() > _NEAR * np.ptp(recovery.points, axis=0).max():
        return None
    n, first_mode = len(body.mass), len(body.mass) - body.modes
    # of a node: x, y and the angle by its DOFs in FE axes, and these by the former
    to_plane = block_diag(recovery.axes[:2], recovery.axes[2:])
    basis = recovery.by.T @ kept
    bound = np.count_nonzero(kept[:first_mode].any(axis=0))

    def rows(shapes: NDArray) -> NDArray:
        nodes = shapes.reshape(len(recovery.coordinates), 6, -1)
        return np.einsum("ij,njk->nik", to_plane, nodes).reshape(-1, shapes.shape[1])
    static = None
    if recovery.static is not None:
        normal = recovery.axes[2]
        pairs = [(k, m) for k in range(3) for m in range(k, 3)]
        products = np.array([normal[k] * normal[m] for k, m in pairs])
        first = first_mode + len(pairs)
        static = rows(np.hstack([recovery.static[:, :first_mode] @ basis[:first_mode, :bound],
                                 recovery.static[:, first_mode:first] @ products[:, None],
                                 recovery.static[:, first:][:, loads]]))
    return Recovery(
        rows(np.hstack([recovery.shapes[:, :n] @ basis, recovery.shapes[:, n:] @ slaved])),
        recovery.points[:, :2], PLANAR, cells=recovery.cells, labels=recovery.labels,
        outlines=None if recovery.outlines is None else recovery.outlines @ recovery.axes.T,
        stress=tuple(replace(one, forces=one.forces @ block_diag(to_plane.T, to_plane.T))
                     for one in recovery.stress if isinstance(one, BeamStress)),
        static=static, nodes=recovery.nodes)
