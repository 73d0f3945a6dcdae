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
    own = body.recovery
    if own is None or own.node_dofs != SPATIAL:
        return None
    off = own.points[:, 2] - body.coordinates[0, 2]
    if np.abs(off).max() > _NEAR * np.ptp(own.points, axis=0).max():
        return None
    n, held = len(body.mass), len(body.mass) - body.modes
    # of a node: x, y and the angle by its DOFs in FE axes, and these by the former
    to_plane = block_diag(own.axes[:2], own.axes[2:])
    basis = own.by.T @ kept
    bound = np.count_nonzero(kept[:held].any(axis=0))

    def rows(shapes: NDArray) -> NDArray:
        nodes = shapes.reshape(len(own.coordinates), 6, -1)
        return np.einsum("ij,njk->nik", to_plane, nodes).reshape(-1, shapes.shape[1])
    static = None
    if own.static is not None:
        normal = own.axes[2]
        pairs = [(k, m) for k in range(3) for m in range(k, 3)]
        products = np.array([normal[k] * normal[m] for k, m in pairs])
        first = held + len(pairs)
        static = rows(np.hstack([own.static[:, :held] @ basis[:held, :bound],
                                 own.static[:, held:first] @ products[:, None],
                                 own.static[:, first:][:, loads]]))
    return Recovery(
        rows(np.hstack([own.shapes[:, :n] @ basis, own.shapes[:, n:] @ slaved])),
        own.points[:, :2], PLANAR, cells=own.cells, labels=own.labels,
        outlines=None if own.outlines is None else own.outlines @ own.axes.T,
        stress=tuple(replace(one, forces=one.forces @ block_diag(to_plane.T, to_plane.T))
                     for one in own.stress if isinstance(one, BeamStress)),
        static=static, nodes=own.nodes)
