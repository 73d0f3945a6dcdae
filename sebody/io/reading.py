"""What the reader of a source returns."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import NamedTuple

from sebody.fem.model import FEModel
from sebody.reduction.body import ReducedBody


class Reading(NamedTuple):
    """An FE model, or a body that the FE program has reduced, and what else its files say.

    Parameters
    ----------
    model : FEModel or ReducedBody
    names : tuple of str
        Of the boundary nodes of a reduced body: the labels of the FE program.
    rotation_nodes : dict of label by label
        Labels of nodes that are there for the rotations of another node alone, and of this node.
    notes : dict of str
        For the provenance, such as why there is no geometric stiffness.
    """

    model: FEModel | ReducedBody
    names: tuple[str, ...] = ()
    rotation_nodes: Mapping[int, int] = MappingProxyType({})
    notes: Mapping[str, str] = MappingProxyType({})
