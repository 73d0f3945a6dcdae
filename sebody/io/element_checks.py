"""Elements of a deck against what their type and the nodes of the deck demand."""

from collections.abc import Collection, Iterable, Mapping
from pathlib import Path
from typing import Protocol

from sebody.basics.errors import InputError
from sebody.fem.isoparametric import element_kind

_REMEDY = "the deck is damaged or not the one of the matrices, write it again"


class Group(Protocol):
    """Elements of one type, ``{label: node labels}``."""

    kind: str
    nodes: Mapping[int, tuple[int, ...]]


def check_elements(path: Path, groups: Iterable[Group], nodes: Collection[int],
                   solids: Mapping[str, str]) -> None:
    """Refuse solids with too few or too many nodes, or one that is not there.

    A node may occur twice, in a hexahedron that is collapsed to a wedge.

    Parameters
    ----------
    nodes : collection of int
        Labels of the nodes of the deck.
    solids : mapping
        Names of meshio by type of element; elements of other types are not checked.

    Raises
    ------
    InputError
        There is such an element.
    """
    for group in groups:
        if group.kind not in solids:
            continue
        count = element_kind(solids[group.kind]).values.shape[1]
        for label, own in group.nodes.items():
            what = f"deck {path}: element {label} of type {group.kind}"
            if len(own) != count:
                raise InputError(f"{what} has {len(own)} nodes, in place of {count}: {_REMEDY}")
            missing = [node for node in own if node not in nodes]
            if missing:
                raise InputError(f"{what} has node {missing[0]}, which is not in the deck: "
                                 f"{_REMEDY}")
