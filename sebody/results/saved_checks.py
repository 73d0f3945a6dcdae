"""Tell whether the parts of a model that a file describes are what the program's own are.

    parts -> names and types of their fields -> bodies, numbers of coordinates -> sizes of members
"""

from collections.abc import Mapping
from dataclasses import fields
from functools import cache
from inspect import isclass
from types import NoneType, UnionType
from typing import Any, NamedTuple, Union, get_args, get_origin, get_type_hints

import numpy as np

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.compiler.user_functions import UserFunction
from sebody.contract.layout import ENERGIES, RECORD
from sebody.model.mechanism import Mechanism
from sebody.model.numbering import Numbering, record_counts
from sebody.model.parts import Element, Superelement
from sebody.reduction.body import ReducedBody
from sebody.reduction.checks import check_layout, coordinate_names
from sebody.reduction.invariant_checks import check_shapes
from sebody.reduction.recovery_checks import check_recovery
from sebody.results.recording import Event, Start

NOTES = {"seconds": float, "failure": str, "warnings": list[str], "error": float | None,
         "all_seconds": float, "stability": str, "start": list | None, "events": list[list],
         "advice": dict[str, list[str]],
         "checksums": dict[str, int]}
_PLAIN = {float: (int, float), int: (int,), str: (str,), bool: (bool,)}


def check_part(part: Any, values: Mapping[str, Any]) -> None:
    """Refuse fields of a part that are missing, unknown or of another type.

    Parameters
    ----------
    part : object
        Of the class that the file names.
    values : mapping
        Its fields.

    Raises
    ------
    ValueError
        They are.
    """
    kind: type = type(part)
    wanted = set(fields_in_files(kind))
    if set(values) != wanted:
        odd = sorted(set(values) ^ wanted)[0]
        raise ValueError(f"a {kind.__name__} {'lacks' if odd in wanted else 'has'} {odd}")
    for name, hint in _hints(kind).items():
        if not _fits(values[name], hint):
            raise ValueError(f"a {kind.__name__} has {inputs.shown(values[name])} for its {name}")
    if isinstance(part, ReducedBody):
        _check_body(part)


def fields_in_files(kind: type) -> list[str]:
    """Names of the fields of a dataclass that files hold: all but private ones.

    These serve the making of runs, such as the body that a rotated one was made of.
    """
    return [one.name for one in fields(kind) if not one.name.startswith("_")]


def check_notes(notes: Mapping[str, Any]) -> None:
    """Refuse what a file says of a run, if it is of other types.

    Raises
    ------
    ValueError
        It is.
    """
    for name, hint in NOTES.items():
        if not _fits(notes[name], hint):
            raise ValueError(f"it has {inputs.shown(notes[name])} for its {name}")
    start = notes["start"]
    if start and not (len(start) == len(Start._fields) and _fits(start[0], dict[str, float])
                      and all(_fits(names, list[str]) for names in start[1:4])
                      and _fits(start[4], float)):
        raise ValueError(f"it has {inputs.shown(start)} for its start")
    for event in notes["events"]:
        if len(event) != len(Event._fields) or not all(map(_fits, event, (float, str, float))):
            raise ValueError(f"it has {inputs.shown(event)} among its events")


def check_tuple(kind: type[NamedTuple], values: list) -> None:
    """The same of a named tuple.

    Raises
    ------
    ValueError
        Too few or too many values, or one of another type.
    """
    if len(values) != len(kind._fields):
        raise ValueError(f"a {kind.__name__} has {len(values)} values of {len(kind._fields)}")
    for name, value in zip(kind._fields, values, strict=True):
        hint = get_type_hints(kind).get(name, object)
        if not _fits(value, hint):
            raise ValueError(f"a {kind.__name__} has {inputs.shown(value)} for its {name}")


@cache
def _hints(kind: type) -> dict[str, Any]:
    hints = get_type_hints(kind)
    return {name: hints[name] for name in fields_in_files(kind)}


def _fits(value: Any, hint: Any) -> bool:
    """Tell whether a value is of a type; compiled functions are None in files."""
    origin, inner = get_origin(hint), get_args(hint)
    if origin in (Union, UnionType):
        return any(_fits(value, one) for one in inner)
    if isclass(hint) and hint in (list, dict):
        return isinstance(value, hint)
    if hint in _PLAIN:
        return isinstance(value, _PLAIN[hint]) and (hint is bool or not isinstance(value, bool))
    if hint is NoneType or hint is None:
        return value is None
    if origin is tuple:
        if not isinstance(value, tuple):
            return False
        if inner[1:] == (...,):
            return all(_fits(one, inner[0]) for one in value)
        return len(value) == len(inner) and all(map(_fits, value, inner))
    if isclass(origin) and issubclass(origin, np.ndarray):
        return isinstance(value, np.ndarray)
    if isclass(origin) and issubclass(origin, Mapping):
        kinds = (*inner, object, object)[:2]
        return isinstance(value, Mapping) and all(
            _fits(k, kinds[0]) and _fits(v, kinds[1]) for k, v in value.items())
    if origin in (list, set):
        return isinstance(value, origin) and all(_fits(one, inner[0]) for one in value)
    if hint is UserFunction:
        return value is None
    if isclass(hint) and hint.__module__.startswith("sebody."):
        return isinstance(value, hint)
    return True


def _check_body(body: ReducedBody) -> None:
    """Sizes and numbers of a superelement's body, which was checked when it was made."""
    check_layout(body.coordinates, body.keeps)
    D = body.coordinates.shape[1]
    n = len(coordinate_names(body.keeps, D, body.modes))
    for name in ("stiffness", "mass", "damping"):
        matrix = getattr(body, name)
        if matrix is not None and (matrix.shape != (n, n) or not np.isfinite(matrix).all()):
            raise ValueError(f"a body of {n} coordinates has a {name} of shape {matrix.shape}, or "
                             "one that is not finite")
    if body.invariants is not None:
        check_shapes(body.invariants, n)
    if body.recovery is not None:
        check_recovery(body.recovery, D == 2, n, n - body.modes,
                       None if body.invariants is None else body.invariants.slaved)


def check_numbering(model: Any, numbering: Any) -> None:
    """Refuse numbers of coordinates that are not those of the model.

    Raises
    ------
    ValueError
        They are not.
    """
    if not (isinstance(model, Mechanism) and isinstance(numbering, Numbering)):
        raise ValueError("it describes no model")
    total = numbering.total
    if not (0 <= numbering.free <= total == len(numbering.names)):
        raise ValueError(f"{numbering.free} unknowns of {total} coordinates, of which "
                         f"{len(numbering.names)} have names")
    sizes = {dof_block: dof_block.start.size for dof_block in model.dof_blocks()}
    ends = [first + sizes.get(key, 1) for key, first in numbering.dof_blocks.items()]
    ends += [numbering.modes.get(name, total + 1) + body.reduced.modes
             for name, body in model.bodies.items()]
    ends += [numbering.multipliers.get(c, total + 1) + c.multipliers
             for c in model.constraints]
    if max(ends, default=0) > total or min(numbering.dof_blocks.values(), default=0) < 0:
        raise ValueError("a coordinate does not belong to the model")
    if len(numbering.time_functions) != len(numbering.port_names):
        raise ValueError("a power port has no name")
    if sorted(numbering.rotations.values()) != list(range(len(numbering.rotations))):
        raise ValueError("rotations are not numbered one after the other")


def member_lengths(model: Mechanism, numbering: Numbering) -> dict[str, int]:
    """Lengths of the members of a file of results of this model, see `saving.MEMBERS`.

    Raises
    ------
    InputError
        A body that places no force.
    """
    counts = record_counts(numbering)
    owners: list[Element | Superelement] = [
        *model.bodies.values(), *model.rigid_bodies.values(), *model.constraints, *model.loads]
    ends = [0]
    for one in owners:
        if one not in numbering.forces_at:
            raise InputError(f"the forces of {one.name!r} have no place")
        ends.append(numbering.forces_at[one] + _width(one))
    return {"width": RECORD.size(counts), "energies": ENERGIES.size(counts),
            "ports": counts["ports"], "supports": numbering.total - numbering.free,
            "forces": max(ends)}


def _width(one: Any) -> int:
    """Numbers of the force of an element."""
    if isinstance(one, Superelement):
        return len(one.reduced.stiffness)
    if one.body is not None:
        return len(one.body.reduced.stiffness)
    if any(one.carried):
        return one.width
    modes = 0 if one.law is None else len(one.law.modes)
    read = sum(equation.multipliers for equation in one.read)
    return sum(dof_block.start.size for dof_block in one.dof_blocks) + one.multipliers + read + (
        one.mode is not None) + modes
