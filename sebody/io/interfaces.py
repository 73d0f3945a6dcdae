"""Interfaces as text: ``root=900001/900002``, ``tip=rbe2:FACEB``, ``hook=12:translation``."""

import re
from collections.abc import Iterable, Mapping
from typing import NamedTuple

import numpy as np

from sebody import inputs
from sebody.errors import InputError
from sebody.fem.model import FEModel
from sebody.reduction.boundary import BoundaryItem
from sebody.reduction.checks import KEEPS
from sebody.reduction.interfaces import MeanFace, RigidFace

REMEDY = ("write name=NODE, name=NODE/NODE where rotations have their own node, name=rbe2:SET, "
          "name=rbe3:SET (by area) or name=rbe3-equal:SET; with @x,y,z, the reference point of "
          "a set if that is not its middle, and :translation or :rotation to keep these alone")


class Interface(NamedTuple):
    """A boundary node of the body to be.

    Parameters
    ----------
    name : str
    nodes : tuple of int
        Label of a node, or of two: that of the translations and that of the rotations.
    tie : str
        'rbe2', 'rbe3' or 'rbe3-equal' for a set, else empty.
    node_set : str
        Name of the set.
    point : tuple of float
        Its reference point; the middle of its nodes if empty.
    keeps : str
        Triplets kept; those that the node has if empty.
    """

    name: str
    nodes: tuple[int, ...] = ()
    tie: str = ""
    node_set: str = ""
    point: tuple[float, ...] = ()
    keeps: str = ""


def parsed(interfaces: Mapping[str, str | int] | Iterable[str]) -> list[Interface]:
    """Interfaces in words.

    Parameters
    ----------
    interfaces : dict of texts by name, or texts ``name=...``

    Raises
    ------
    InputError
        A text that cannot be read, or a name given twice.
    """
    if isinstance(interfaces, Mapping):
        pairs = [(name, str(value)) for name, value in interfaces.items()]
    else:
        pairs = []
        for text in inputs.items(interfaces, "interfaces", REMEDY):
            if not isinstance(text, str) or "=" not in text:
                raise inputs.refusal("interface", text, REMEDY)
            pairs.append(tuple(text.split("=", 1)))
    found = [_one(*pair) for pair in pairs]
    names = [one.name for one in found]
    for name in names:
        if names.count(name) > 1:
            raise InputError(f"interface {name!r} is given twice: give each a name of its own")
    return found


def _one(name: str, text: str) -> Interface:
    name = inputs.name(name, "name of an interface").strip()
    text = text.strip()
    if match := re.fullmatch(r"(rbe2|rbe3|rbe3-equal):([^@:]+)(?:@([^@:]+))?(?::(\w+))?", text):
        tie, node_set, place, keeps = match.groups()
        try:
            point = tuple(map(float, place.split(","))) if place else ()
        except ValueError as error:
            raise inputs.refusal(f"interface {name!r}", text, REMEDY) from error
        return Interface(name, (), tie, node_set.strip(), point, _keeps(name, text, keeps))
    if match := re.fullmatch(r"(\d+)(?:/(\d+))?(?::(\w+))?", text):
        first, second, keeps = match.groups()
        nodes = (int(first),) if second is None else (int(first), int(second))
        return Interface(name, nodes, keeps=_keeps(name, text, keeps))
    raise inputs.refusal(f"interface {name!r}", text, REMEDY)


def _keeps(name: str, text: str, keeps: str | None) -> str:
    if keeps not in (None, *KEEPS):
        raise inputs.refusal(f"interface {name!r}", text, REMEDY)
    return keeps or ""


def boundary_items(model: FEModel, interfaces: list[Interface],
                   rotation_nodes: Mapping[int, int]) -> list[BoundaryItem]:
    """The boundary of a reduction.

    Parameters
    ----------
    rotation_nodes : dict of label by label
        See `Reading`.

    Raises
    ------
    InputError
        A node or set there is not, a pair whose second node does not have the rotations of the
        first, or nodes that two interfaces share.
    """
    if not interfaces:
        raise InputError(f"the body has no interface: {REMEDY}")
    items = [_item(model, one, rotation_nodes) for one in interfaces]
    owners: dict[int, str] = {}
    for one, (item, _) in zip(interfaces, items, strict=True):
        for node in [item] if isinstance(item, int) else item.nodes:
            other = owners.setdefault(node, one.name)
            if other != one.name:
                raise InputError(f"interfaces {other!r} and {one.name!r} share "
                                 f"{model.node_name(node)}: give each nodes of its own")
    return items


def _item(model: FEModel, one: Interface, rotation_nodes: Mapping[int, int]) -> BoundaryItem:
    if one.tie:
        return _tied(model, one)
    for label in one.nodes[:1]:
        if label in rotation_nodes and len(one.nodes) == 1:
            raise InputError(f"interface {one.name!r}: node {label} is there for the rotations of "
                             f"node {rotation_nodes[label]}: write {one.name}="
                             f"{rotation_nodes[label]}/{label}")
    if len(one.nodes) == 2 and rotation_nodes.get(one.nodes[1]) != one.nodes[0]:
        known = ", ".join(f"{a}/{b}" for b, a in rotation_nodes.items()) or "none"
        raise InputError(f"interface {one.name!r}: node {one.nodes[1]} does not have the rotations "
                         f"of node {one.nodes[0]}; pairs of the model: {known}")
    node = _node(model, one)
    has = [kind for kind in ("translation", "rotation") if len(model.dofs(node, kind))]
    if not has:
        raise InputError(f"interface {one.name!r}: node {one.nodes[0]} has no rows in the "
                         "matrices: it is tied to another node or its coupling leaves it out "
                         "(CalculiX: *DISTRIBUTING); tie with *RIGID BODY or use a set, "
                         f"{one.name}=rbe3:SET")
    return node, one.keeps or ("full" if len(has) == 2 else has[0])


def _node(model: FEModel, one: Interface) -> int:
    try:
        if model.labels is None:
            return inputs.integer(one.nodes[0], "node", most=len(model.coordinates) - 1)
        return model.node(one.nodes[0])
    except InputError as error:
        raise InputError(f"interface {one.name!r}: {error}") from error


def _tied(model: FEModel, one: Interface) -> BoundaryItem:
    names = {name.upper(): name for name in model.node_sets}
    nodes = model.node_set(names.get(one.node_set.upper(), one.node_set))
    if not nodes:
        raise InputError(f"interface {one.name!r}: node set {one.node_set!r} is empty: name the "
                         "nodes of the face")
    keeps = one.keeps or "full"
    if one.tie != "rbe2":
        place = np.array(one.point) if one.point else None
        return MeanFace(nodes, place, "area" if one.tie == "rbe3" else "equal"), keeps
    point = np.array(one.point) if one.point else model.coordinates[list(nodes)].mean(axis=0)
    return RigidFace(point, nodes), keeps
