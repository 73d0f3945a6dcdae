"""Interfaces as text: ``root=900001/900002``, ``tip=rbe2:FACEB``, ``pin=cylinder:0,0,5;z;12``."""

import re
from collections.abc import Iterable, Mapping
from typing import NamedTuple

import numpy as np

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.fem.cylinders import Cylinder, Middle, middle_of, nodes_on_cylinder_faces
from sebody.fem.model import FEModel
from sebody.reduction.boundary import BoundaryItem
from sebody.reduction.checks import KEEPS
from sebody.reduction.interfaces import MeanFace, RigidFace

REMEDY = ("write name=NODE, name=NODE/NODE where rotations have their own node, name=rbe2:SET, "
          "name=rbe3:SET (by area) or name=rbe3-equal:SET of a node set or surface, "
          "name=cylinder:x,y,z;axis;radius of a hole or a journal; with @x,y,z, the reference "
          "point if that is not the middle, and :translation or :rotation to keep these alone; of "
          "a file that names no places name=@x,y,z")
_AXES = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}
_SHOWN = 5      # nodes left out that a note names


class Round(NamedTuple):
    """The place of a cylinder: a point and a direction of its axis, radius, and length or None."""

    point: tuple[float, ...]
    axis: tuple[float, ...]
    radius: float
    length: float | None

    @property
    def cylinder(self) -> Cylinder:
        """With a unit vector along its axis."""
        axis = np.array(self.axis)
        return Cylinder(np.array(self.point), axis / np.linalg.norm(axis), self.radius)


class Interface(NamedTuple):
    """A boundary node of the body to be.

    Parameters
    ----------
    name : str
    nodes : tuple of int
        Label of a node, or of two: that of the translations and that of the rotations; none, nor a
        set, of a body whose file does not say where its interface is.
    tie : str
        'rbe2', 'rbe3' or 'rbe3-equal' for a set or a cylinder, else empty.
    node_set : str
        Name of the set.
    cylinder : Round, optional
        Whose faces are tied, to its point.
    point : tuple of float
        Reference point of a set, the middle of its faces if empty; or the place of the interface.
    keeps : str
        Triplets kept; those that the node has if empty.
    """

    name: str
    nodes: tuple[int, ...] = ()
    tie: str = ""
    node_set: str = ""
    cylinder: Round | None = None
    point: tuple[float, ...] = ()
    keeps: str = ""


class Tied(NamedTuple):
    """The boundary of a reduction, and what the interfaces are, in words by their names."""

    items: list[BoundaryItem]
    notes: dict[str, str]


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
    checked = [_one(*pair) for pair in pairs]
    names = [one.name for one in checked]
    for name in names:
        if names.count(name) > 1:
            raise InputError(f"interface {name!r} is given twice: give each a name of its own")
    return checked


def _one(name: str, text: str) -> Interface:
    name = inputs.name(name, "name of an interface").strip()
    text = text.strip()
    if match := re.fullmatch(r"(\d+)(?:/(\d+))?(?::(\w+))?", text):
        first, second, keeps = match.groups()
        nodes = (int(first),) if second is None else (int(first), int(second))
        return Interface(name, nodes, keeps=_keeps(name, text, keeps))
    if match := re.fullmatch(r"@([^@:]+)", text):
        return Interface(name, point=_place(name, text, match[1]))
    what = r"cylinder:([^@:]+)|([^@:]+)"
    match = re.fullmatch(rf"(?:(rbe2|rbe3|rbe3-equal):)?(?:{what})(?:@([^@:]+))?(?::(\w+))?", text)
    if not match or not (match[1] or match[2]):
        raise inputs.refusal(f"interface {name!r}", text, REMEDY)
    tie, cylinder, node_set, place, keeps = match.groups()
    point = _place(name, text, place) if place else ()
    try:
        where = _round(cylinder) if cylinder else None
    except ValueError as error:
        raise inputs.refusal(f"interface {name!r}", text, REMEDY) from error
    return Interface(name, (), tie or "rbe2", (node_set or "").strip(), where, point,
                     _keeps(name, text, keeps))


def _place(name: str, text: str, place: str) -> tuple[float, ...]:
    """A point ``x,y,z``."""
    try:
        return tuple(map(float, place.split(",")))
    except ValueError as error:
        raise inputs.refusal(f"interface {name!r}", text, REMEDY) from error


def _round(text: str) -> Round:
    """``x,y,z;axis;radius`` with ``;length`` behind it, if the cylinder is not endless.

    Raises
    ------
    ValueError
        Another text.
    """
    point, axis, radius, *length = text.split(";")
    if len(length) > 1:
        raise ValueError(text)
    x, y, z = map(float, point.split(","))
    direction = _AXES.get(axis.strip().lower()) or tuple(map(float, axis.split(",")))
    return Round((x, y, z), direction, float(radius), float(length[0]) if length else None)


def _keeps(name: str, text: str, keeps: str | None) -> str:
    if keeps not in (None, *KEEPS):
        raise inputs.refusal(f"interface {name!r}", text, REMEDY)
    return keeps or ""


def tied(model: FEModel, interfaces: list[Interface], rotation_nodes: Mapping[int, int]) -> Tied:
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
    items, notes = [], {}
    for one in interfaces:
        if not one.nodes and not one.tie:
            raise InputError(f"interface {one.name!r} is a place, and the file has nodes: {REMEDY}")
        try:
            item, note = _face(model, one) if one.tie else (_node(model, one, rotation_nodes), "")
        except InputError as error:
            if str(error).startswith(f"interface {one.name!r}"):
                raise
            raise InputError(f"interface {one.name!r}: {error}") from error
        items.append(item)
        notes |= {one.name: note} if note else {}
    owners: dict[int, str] = {}
    for one, (item, _) in zip(interfaces, items, strict=True):
        for node in [item] if isinstance(item, int) else item.nodes:
            other = owners.setdefault(node, one.name)
            if other != one.name:
                raise InputError(f"interfaces {other!r} and {one.name!r} share "
                                 f"{model.node_name(node)}: give each nodes of its own")
    return Tied(items, notes)


def _node(model: FEModel, one: Interface, rotation_nodes: Mapping[int, int]) -> BoundaryItem:
    """A node, with what it keeps."""
    for label in one.nodes[:1]:
        if label in rotation_nodes and len(one.nodes) == 1:
            raise InputError(f"node {label} only holds the rotations of node "
                             f"{rotation_nodes[label]}: write {one.name}="
                             f"{rotation_nodes[label]}/{label}")
    if len(one.nodes) == 2 and rotation_nodes.get(one.nodes[1]) != one.nodes[0]:
        known = ", ".join(f"{a}/{b}" for b, a in rotation_nodes.items()) or "none"
        raise InputError(f"node {one.nodes[1]} does not have the rotations of node "
                         f"{one.nodes[0]}; pairs of the model: {known}")
    node = (inputs.integer(one.nodes[0], "node", most=len(model.coordinates) - 1)
            if model.labels is None else model.node(one.nodes[0]))
    has = [kind for kind in ("translation", "rotation") if len(model.dofs(node, kind))]
    if not has:
        raise InputError(f"node {one.nodes[0]} has no rows in the matrices: no element has it, or "
                         "it is tied to another node, or its coupling leaves it out (CalculiX: "
                         "*DISTRIBUTING); name the reference node of its *RIGID BODY, or use a "
                         f"set, {one.name}=rbe3:SET")
    return node, one.keeps or ("full" if len(has) == 2 else has[0])


def _face(model: FEModel, one: Interface) -> tuple[BoundaryItem, str]:
    """A tie of the faces of a set or a cylinder, and what it is in words."""
    nodes = nodes_on_cylinder_faces(model, *one.cylinder) if one.cylinder else _set(model, one)
    dimension = model.coordinates.shape[1]
    there = (model.rows[list(nodes), :dimension] >= 0).all(axis=1)
    left = [node for node, has in zip(nodes, there, strict=True) if not has]
    nodes = tuple(node for node, has in zip(nodes, there, strict=True) if has)
    if not nodes:
        raise InputError(f"none of its {len(left)} nodes has rows in the matrices: no element has "
                         "them, or the FE program has tied them, whose reference node is the "
                         f"interface then, such as {one.name}=900001/900002")
    middle = middle_of(model, nodes)
    if one.cylinder and middle is not None:     # of little of which the faces may be
        middle = Middle(np.array(one.cylinder.point), one.cylinder.cylinder)
    point = np.array(one.point) if one.point else _middle(model, middle, nodes, one)
    keeps = one.keeps or "full"
    note = _described(model, one, nodes, left, middle)
    if one.tie == "rbe2":
        return (RigidFace(point, nodes, one.name), keeps), note
    weights = "area" if one.tie == "rbe3" else "equal"
    return (MeanFace(nodes, point, weights, one.name), keeps), note


def _set(model: FEModel, one: Interface) -> tuple[int, ...]:
    """Nodes of a named set or surface."""
    nodes = model.node_set(set_called(model, one.node_set))
    if not nodes:
        raise InputError(f"node set {one.node_set!r} is empty: name the nodes of the face")
    return nodes


def set_called(model: FEModel, name: str) -> str:
    """Name of a node set as the model writes it; capitals and blanks do not matter."""
    plain = {"".join(known.upper().split()): known for known in model.node_sets}
    return plain.get("".join(name.upper().split()), name)


def _middle(model: FEModel, middle: Middle | None, nodes: tuple[int, ...], one: Interface
            ) -> np.ndarray | None:
    """Reference point: middle of the faces; without faces the mean of nodes, or the face's own."""
    if one.tie == "rbe3-equal":
        return None
    if middle is not None:
        return middle.point
    return model.coordinates[list(nodes)].mean(axis=0) if one.tie == "rbe2" else None


def _described(model: FEModel, one: Interface, nodes: tuple[int, ...], left: list[int],
               middle: Middle | None) -> str:
    """Description of an interface, for the provenance of the body."""
    how = {"rbe2": "rigid face of", "rbe3": "mean by area of", "rbe3-equal": "mean of"}[one.tie]
    text = f"{how} {len(nodes)} nodes"
    if one.point:
        text += ", about the point given"
    elif middle is None and one.tie == "rbe2":
        text += ", about their mean: no faces lie within them"
    elif middle is not None and one.tie != "rbe3-equal":
        text += ", about the centroid of their faces"
        if one.cylinder:
            text = text.replace("centroid of their faces", "point given")
        elif middle.cylinder is not None:
            axis = ", ".join(f"{x:.6g}" for x in middle.cylinder.axis.round(9) + 0.0)
            text = text.replace("centroid of their faces", "middle of the cylinder of radius "
                                f"{middle.cylinder.radius:.6g} along ({axis})")
    if left:
        names = ", ".join(model.node_name(node).removeprefix("node ") for node in left[:_SHOWN])
        text += (f"; {len(left)} nodes without rows left out: {names}"
                 + ", ..." * (len(left) > _SHOWN))
    return text
