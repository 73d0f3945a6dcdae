"""Reading that the reader of a source returns."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import NamedTuple

from sebody.fem.model import FEModel
from sebody.io.grounded import HeldBody
from sebody.io.modal import ModalBody


class Reading(NamedTuple):
    """An FE model, or a body that the FE program has reduced, and what else its files say.

    Parameters
    ----------
    model : FEModel, dict, ModalBody or HeldBody
        An FE model, the arguments of the `ReducedBody` that the program has made, a body of
        rigid motions and modes, whose boundary is still to be chosen, or one that is held to the
        ground, whose interface has no place yet.
    names : tuple of str
        Of the boundary nodes of a reduced body: the labels of the FE program.
    rotation_nodes : dict of label by label
        Labels of nodes that are there for the rotations of another node alone, and of this node.
    source : str
        Where a reduced body comes from; an FE model has its own `source`.
    notes : dict of str
        For the provenance, such as why there is no geometric stiffness.
    holding : dict of str by label
        Cards of the deck that may hold a node to the ground.
    loading : tuple of str
        Cards of the deck that may prestress the body, or turn rows.
    """

    model: FEModel | dict | ModalBody | HeldBody
    names: tuple[str, ...] = ()
    rotation_nodes: Mapping[int, int] = MappingProxyType({})
    source: str = ""
    notes: Mapping[str, str] = MappingProxyType({})
    holding: Mapping[int, str] = MappingProxyType({})
    loading: tuple[str, ...] = ()

    def cards(self, nodes: list[int], turns: bool) -> str:
        """Cards that may be why a stiffness resists rigid motions, in words; empty if none are.

        Parameters
        ----------
        nodes : list of int
            With the largest forces.
        turns : bool
            Whether rotations alone are resisted.
        """
        labels = nodes if self.model.labels is None else self.model.labels[nodes].tolist()
        found = [self.holding[label] for label in labels if label in self.holding]
        found = list(dict.fromkeys(found)) or (list(self.loading) if turns else [])
        return f"; the deck has {' and '.join(found)}" if found else ""
