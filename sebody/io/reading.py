"""What the reader of a source returns."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import NamedTuple

from sebody.fem.model import FEModel
from sebody.io.modal import ModalBody


class Reading(NamedTuple):
    """An FE model, or a body that the FE program has reduced, and what else its files say.

    Parameters
    ----------
    model : FEModel, dict or ModalBody
        An FE model, the arguments of the `ReducedBody` that the program has made, or a body of
        rigid motions and modes, whose boundary is still to be chosen.
    names : tuple of str
        Of the boundary nodes of a reduced body: the labels of the FE program.
    rotation_nodes : dict of label by label
        Labels of nodes that are there for the rotations of another node alone, and of this node.
    source : str
        Where a reduced body comes from; an FE model has its own `source`.
    notes : dict of str
        For the provenance, such as why there is no geometric stiffness.
    """

    model: FEModel | dict | ModalBody
    names: tuple[str, ...] = ()
    rotation_nodes: Mapping[int, int] = MappingProxyType({})
    source: str = ""
    notes: Mapping[str, str] = MappingProxyType({})
