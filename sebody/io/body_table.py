"""Contents of a body file: its notes, and the members with their types and shapes."""

from collections.abc import Iterator, Mapping
from typing import Any

from sebody.basics import inputs
from sebody.basics.files.members import Header, Member, Table
from sebody.basics.units import parsed_units
from sebody.fem.materials import checked_materials
from sebody.reduction.checks import KEEPS
from sebody.reduction.invariants import LENGTHS
from sebody.reduction.missing import checked_missing

REMEDY = "import the body again"
_MATRIX = Member(("n", "n"))
_OPTIONAL = {
    "damping": _MATRIX,
    "recovery.shapes": Member(("rows", None)), "recovery.coordinates": Member(("nodes", "D")),
    "recovery.axes": Member(("D", "D")), "recovery.by": _MATRIX,
    "recovery.labels": Member(("nodes",), "i"), "recovery.nodes": Member(("nodes",), "i"),
    "preload.nodes": Member(("lines", 2), "i"), "preload.arms": Member(("lines", 2, "D")),
    "preload.tension": Member(("lines",)),
    "recovery.outlines": Member((None, None, 3)), "recovery.static": Member(("rows", None)),
    **{f"invariants.{name}": Member(shape) for name, shape in LENGTHS.items()}}
_MEMBERS = {"stiffness": _MATRIX, "mass": _MATRIX, "coordinates": Member(("boundary", "D")),
            **{name: one._replace(needed=False) for name, one in _OPTIONAL.items()}}
# which all are there or none
_GROUPS = {"invariants": [f"invariants.{name}" for name in LENGTHS],
           "recovery": ["recovery.shapes", "recovery.coordinates"],
           "preload": ["preload.nodes", "preload.arms", "preload.tension"]}


def body_table(file: str, headers: Mapping[str, Header], notes: dict) -> Table:
    """The table of the members of a body file with these notes.

    Parameters
    ----------
    file : str
        For messages.

    Raises
    ------
    InputError
        Notes that no body has.
    """
    members = dict(_MEMBERS)
    for group, needed in _GROUPS.items():
        if any(name.startswith(f"{group}.") for name in headers):
            members |= {name: members[name]._replace(needed=True) for name in needed}
    members |= {name: Member(("n",)) for name in headers if name.startswith("loads.")}
    members |= {name: Member((None, "n")) for name in headers if name.startswith("outputs.")}
    members |= {name: Member((None,), "i", least=0) for name in headers
                if name.startswith("paths.")}
    members |= {name: _listed(name) for name in _references(notes["body"])}
    table = Table(file, REMEDY, members)
    _check_notes(table, notes)
    D = headers["coordinates"].shape[-1:] if "coordinates" in headers else ()
    lengths = {"boundary": len(notes["body"]["keeps"]), "r": 1 if D == (2,) else 3}
    dofs = notes["body"].get("recovery.node_dofs")
    coordinates = headers.get("recovery.coordinates")
    if dofs is not None and coordinates is not None:
        lengths |= {"rows": len(dofs) * coordinates.shape[0] if coordinates.shape else 0}
    table.lengths |= lengths
    return table


def _listed(name: str) -> Member:
    """A member that belongs to a list: cells, or numbers of a stress operator."""
    last = name.rpartition("/")[2]
    if name.startswith("recovery.cells/"):
        return Member((None, None), "i", least=0, below="nodes")
    if last == "nodes":
        return Member((None, ...), "i", least=-1, below="nodes")
    return Member((None, None, ...))


def _references(value: Any) -> Iterator[str]:
    """Names of the members that notes refer to."""
    if isinstance(value, dict) and "array" in value:
        yield value["array"]
    elif isinstance(value, dict | list):
        for one in value.values() if isinstance(value, dict) else value:
            yield from _references(one)


def _check_notes(table: Table, notes: dict) -> None:
    """Refuse notes of other types."""
    for name, kind in (("names", list), ("units", str), ("provenance", dict), ("body", dict)):
        if not isinstance(notes[name], kind):
            raise table.fault(f"has {inputs.shown(notes[name])} for its {name}")
    body = notes["body"]
    keeps = body.get("keeps")
    if not isinstance(keeps, list) or any(one not in KEEPS for one in keeps):
        raise table.fault(f"has {inputs.shown(keeps)} for what its nodes keep")
    modes = body.get("modes", 0)
    if type(modes) is not int or modes < 0:
        raise table.fault(f"has {inputs.shown(modes)} for its number of modes")
    base = body.get("base")
    if base is not None and (type(base) is not int or not 0 <= base < len(keeps)):
        raise table.fault(f"has {inputs.shown(base)} for the node of its base")
    checked_missing(body.get("missing", {}), f"{table.file}: missing")
    checked_materials(body.get("materials", []), f"{table.file}: materials")
    parsed_units(notes["units"], f"{table.file}: units")
    if not all(isinstance(text, str) for pair in notes["provenance"].items() for text in pair):
        raise table.fault("has a provenance that is not a text")
