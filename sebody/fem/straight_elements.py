"""Straight uniform beam elements by closed forms: what `exact_elements` integrates, at once."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from sebody.fem import beam_element
from sebody.fem.beam_elements import IN_PLANE, BeamElements, symmetric
from sebody.fem.section import StiffnessSection


def straight_elements(nodes: NDArray, pairs: NDArray, lengths: NDArray, axes: NDArray,
                      sections: Sequence[StiffnessSection]) -> BeamElements:
    """One element for each pair of nodes.

    Parameters
    ----------
    nodes : (n_nodes, 3), planar (n_nodes, 2)
    pairs : (n, 2)
        Nodes at the ends of each element.
    lengths : (n,)
    axes : (n, 3, 3)
        Rows: the element's axis x and its section's axes y and z.
    sections : sequence of n StiffnessSection
    """
    planar, dimension = nodes.shape[1] == 2, nodes.shape[1]
    turns = _turns(axes)[:, :, IN_PLANE if planar else np.arange(12)]
    back = turns.transpose(0, 2, 1)
    stiffness, mass, values, slopes, point_inertia = _closed_forms(sections, lengths)
    weights = lengths[:, None] * beam_element.WEIGHTS
    fields = values @ turns[:, None]      # in section axes
    own = np.zeros((len(pairs), 3, 3))
    own[:, :, :dimension] = turns[:, :3, :dimension]
    along = np.einsum("eji,egja->egia", own, fields[:, :, :3])[:, :, :dimension]
    inertia = point_inertia[:, None, 3:] * weights[:, :, None]
    if planar:
        about, inertia = fields[:, :, 5:], inertia[:, :, 2:, None]
    else:
        about = np.einsum("eji,egja->egia", own, fields[:, :, 3:])
        inertia = np.einsum("eji,egj,ejk->egik", own, inertia, own)
    places = beam_element.PLACES[:, None]
    end_forces = (stiffness @ turns).reshape(len(pairs), 2, 6, -1)
    end_forces[:, 0] *= -1      # of the part that lies before the first end on the element
    width = turns.shape[2]
    return BeamElements(
        pairs, symmetric(back @ stiffness @ turns), symmetric(back @ mass @ turns),
        np.zeros((len(pairs), width, width)),
        nodes[pairs[:, 0], None] * (1 - places) + nodes[pairs[:, 1], None] * places,
        point_inertia[:, [0]] * weights, inertia, along, about, weights,
        np.concatenate([values[:, :, 3:], slopes], axis=2) @ turns[:, None],
        np.broadcast_to([1.0, 0.0, 0.0], (*weights.shape, 3)),
        _forces(end_forces[:, 1], lengths), end_forces, [(one, one) for one in sections])


def _turns(axes: NDArray) -> NDArray:
    """From DOFs of the model to those of the elements, in the axes of their sections."""
    turns = np.zeros((len(axes), 12, 12))
    for first in range(0, 12, 3):
        turns[:, first:first + 3, first:first + 3] = axes
    return turns


def _closed_forms(sections: Sequence[StiffnessSection], lengths: NDArray) -> list[NDArray]:
    """Elements of equal section and length share their matrices."""
    known: dict = {}
    keys = list(zip(sections, lengths, strict=True))
    for key in keys:
        if key not in known:
            known[key] = (beam_element.stiffness(*key), beam_element.mass(*key),
                          *beam_element.interpolation(*key, beam_element.PLACES),
                          beam_element.point_inertia(key[0]))
    return [np.array(a) for a in zip(*(known[key] for key in keys), strict=True)]


def _forces(last: NDArray, lengths: NDArray) -> NDArray:
    """Section forces of unit DOFs at the points of integration, of those at the second end."""
    forces = np.repeat(last[:, None], len(beam_element.PLACES), axis=1)
    levers = lengths[:, None, None] * (1 - beam_element.PLACES)[:, None]
    forces[:, :, 4] -= levers * last[:, None, 2]        # x cross the force
    forces[:, :, 5] += levers * last[:, None, 1]
    return forces
