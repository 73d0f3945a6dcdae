"""The nodes of a model that are interfaces of its superelement, and what each of them keeps."""

from collections.abc import Iterable, Mapping
from typing import NamedTuple

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.model.arguments import dof_block, known
from sebody.model.model import Model
from sebody.model.parts import DofBlock, Node
from sebody.reduction.checks import KEEPS

_REMEDY = "give names of nodes, or a dict of 'full', 'translation' or 'rotation' by names of nodes"


class Interfaces(NamedTuple):
    """Nodes by name, and what each keeps."""

    names: tuple[str, ...]
    keeps: tuple[str, ...]

    @property
    def rows(self) -> list[str]:
        """Names of the rows of the interfaces: positions, then rotations."""
        kept = list(zip(self.names, self.keeps, strict=True))
        return ([f"{name}.position" for name, keep in kept if keep != "rotation"]
                + [f"{name}.rotation" for name, keep in kept if keep != "translation"])

    def blocks(self, model: Model) -> list[DofBlock]:
        """DOF blocks that they keep, of a model with nodes of these names."""
        return [dof_block(model.nodes[name], kind) for name, _, kind in (
            row.rpartition(".") for row in self.rows)]


def interfaces_of(model: Model, wanted: Iterable[Node | str] | Mapping[str, str]) -> Interfaces:
    """The interfaces that a user names.

    Raises
    ------
    InputError
        No node, one that the model does not have or that is named twice, or something else to keep
        than the node has.
    """
    given = (dict(wanted) if isinstance(wanted, Mapping) else
             dict.fromkeys(inputs.items(wanted, "interfaces", _REMEDY)))
    if not given:
        raise InputError(f"interfaces names no node: {_REMEDY}")
    if not isinstance(wanted, Mapping) and len(given) < len(list(wanted)):
        raise InputError("interfaces names a node twice: leave one out")
    names, keeps = [], []
    for node, keep in given.items():
        found = known(model, node)
        has = ("rotation" if found.position is None else
               "translation" if found.rotation is None else "full")
        keep = has if keep is None else inputs.choice(keep, f"interface {found.name!r}", KEEPS)
        if has not in ("full", keep):
            raise InputError(f"interface {found.name!r} is to keep {keep!r}, and the node has "
                             f"{has!r} alone: give {has!r}")
        names.append(found.name)
        keeps.append(keep)
    if "rotation" in keeps and set(keeps) == {"rotation"}:
        raise InputError("no interface keeps its position, so the body has no place: give 'full' "
                         "or 'translation' for one at least")
    return Interfaces(tuple(names), tuple(keeps))
