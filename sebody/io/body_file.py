"""Body files: a reduced body in one npz file that any program can read.

Arrays are members by name (``stiffness``, ``mass``, ``coordinates``, ``invariants.J0``,
``recovery.shapes``, ``loads.NAME``, ...); the member ``notes`` is a JSON text with everything else:
format and version, layout, names of the boundary nodes, units, provenance.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field, fields, is_dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.basics.files import check_target, replacing
from sebody.basics.files.array_files import json_of, opened
from sebody.basics.files.checksums import changed, checksums
from sebody.basics.tabular import brief
from sebody.basics.units import parsed_units
from sebody.fem.beam_stress import BeamStress
from sebody.fem.materials import doubts
from sebody.fem.stress import SolidStress, StressModes
from sebody.io.body_table import body_table
from sebody.reduction.body import ReducedBody
from sebody.reduction.checks import check_layout, check_stiffness, coordinate_names
from sebody.reduction.invariants import InertiaInvariants
from sebody.reduction.missing import lacks, sentences
from sebody.reduction.preload import Preload
from sebody.reduction.recovery import Recovery
from sebody.reduction.rigid_motions import rigid_motions

FORMAT, VERSION = "sebody body", 1
TARGET = "body file", (".npz",)     # see `files.check_target`
STRESSES = SolidStress, BeamStress, StressModes     # of a Recovery
# of a ReducedBody
PARTS = {"invariants": InertiaInvariants, "recovery": Recovery, "preload": Preload}
_LEAN = "shapes and mesh of the FE model were left out of the file; write it with them"
_REMEDY = "give one written by 'sebody import' or sebody.io.save_body"


@dataclass(frozen=True, eq=False)
class BodyFile:
    """Contents of a body file, as found: the matrices may be wrong in any way.

    Parameters
    ----------
    parts : dict
        Arguments of `ReducedBody`.
    names : tuple of str
        Of the boundary nodes.
    units : str
        Units of its numbers, such as ``mm t N s``; empty if they are not known.
    provenance : dict of str
        What the body was made from and how.
    changed : tuple of str
        Members that are not those that were written.
    """

    parts: dict[str, Any]
    names: tuple[str, ...]
    units: str = ""
    provenance: Mapping[str, str] = field(default_factory=dict)
    changed: tuple[str, ...] = ()

    __repr__ = brief

    @property
    def mesh(self) -> tuple[NDArray, tuple[tuple[str, NDArray], ...]] | None:
        """FE nodes (n, 3), planar (n, 2), and elements by kind, if the body has its shapes."""
        recovery = self.parts.get("recovery")
        return recovery and (recovery.points, recovery.cells)

    @property
    def cautions(self) -> list[str]:
        """Lacks of the body, and materials of other units: ``what; what to do``."""
        parts = self.parts
        stressed = parts.get("recovery") is not None and bool(parts["recovery"].stress)
        missing = lacks(stressed, parts.get("invariants") is not None, parts.get("missing", {}))
        return sentences(missing, stressed) + doubts(parts.get("materials", ()), self.units)

    def body(self) -> ReducedBody:
        """The body, checked.

        Raises
        ------
        InputError
            See `ReducedBody`, or members that are not those that were written.
        """
        self._check_stiffness()
        reduced = ReducedBody(**self.parts, units=self.units)
        if self.changed:
            raise InputError(f"{', '.join(self.changed)} changed since the file was written; "
                             "import the body again, or write what was changed with "
                             "sebody.io.save_body")
        return reduced

    def _check_stiffness(self) -> None:
        """Refuse a stiffness that resists rigid motion by the names of nodes, where all fits."""
        K, points = (np.asarray(self.parts[name], dtype=float) for name in
                     ("stiffness", "coordinates"))
        keeps = tuple(self.parts["keeps"])
        check_layout(points, keeps)
        called = [name + (f" ({told})" if (told := self.provenance.get(f"interface {name}", "")
                                           ).startswith("node ") else "") for name in self.names]
        names = coordinate_names(keeps, points.shape[1], self.parts.get("modes", 0), called)
        if K.shape == (len(names),) * 2 and np.isfinite(K).all():
            check_stiffness((K + K.T) / 2, rigid_motions(points, keeps, len(K), points.mean(axis=0)
                                                         ), names)


def save_body(body: ReducedBody, path: str | Path, names: tuple[str, ...] | None = None, *,
              units: str = "", provenance: Mapping[str, str] | None = None,
              recovery: bool = True) -> Path:
    """Write a reduced body to an npz file; an older file stays until the new one is complete.

    Parameters
    ----------
    names : tuple of str, optional
        Of the boundary nodes, ``node 0``, ``node 1``, ... by default.
    units : str
        Units of its numbers, such as ``mm t N s``; those of the body by default.
    provenance : dict of str, optional
        What the body was made from and how.
    recovery : bool
        Whether shapes and mesh of the FE model are kept, most of the file's size; without them
        there are no displacements inside the body, but those of its paths.

    Raises
    ------
    InputError
        No body, names that do not fit, or a target that cannot be written.
    WriteError
        Writing fails; an older file is unchanged.
    """
    inputs.instance(body, "body", ReducedBody, "give a ReducedBody")
    names = checked_names(names, len(body.keeps))
    remedy = "give a dict of texts"
    provenance = inputs.mapping({} if provenance is None else provenance, "provenance", remedy)
    for text in (*provenance, *provenance.values()):
        inputs.text(text, "provenance")
    file = BodyFile(body_parts(body), names, str(parsed_units(units) or body.units), provenance)
    return write_body_file(file if inputs.flag(recovery, "recovery") else lean(file), path)


def body_parts(body: ReducedBody) -> dict[str, Any]:
    """Arguments of a body but for its units."""
    return {one.name: getattr(body, one.name) for one in fields(ReducedBody)
            if one.init and one.name != "units"}


def lean(file: BodyFile) -> BodyFile:
    """A body file without the shapes and the mesh of the FE model, but for those of paths."""
    missing = {**file.parts.get("missing", {}), "stresses": _LEAN}
    recovery = file.parts.get("recovery")
    if recovery is not None:
        kept = recovery.places(file.parts.get("paths", {}))
        recovery = replace(recovery.restricted(np.array(kept)), cells=(), outlines=None, stress=(),
                           static=None) if kept else None
    return replace(file, parts={**file.parts, "recovery": recovery, "missing": missing})


def load_body(path: str | Path) -> ReducedBody:
    """The body of a file.

    Raises
    ------
    InputError
        No such file, another kind or version of file, or a body with defects, which ``sebody
        inspect`` lists.
    """
    file = read_body_file(path)
    try:
        return file.body()
    except InputError as error:
        raise InputError(f"body file {path}: {error} ('sebody inspect {path}' says more)"
                         ) from error


def write_body_file(file: BodyFile, path: str | Path) -> Path:
    """Write what a body file holds; see `save_body`."""
    path = check_target(path, *TARGET)
    arrays: dict[str, NDArray] = {}
    texts: dict[str, Any] = {}
    _flatten(file.parts, "", arrays, texts)
    notes = {"format": FORMAT, "version": VERSION, "names": list(file.names), "units": file.units,
             "provenance": dict(file.provenance), "body": texts, "checksums": checksums(arrays)}
    with replacing(path, TARGET[0]) as stream:
        np.savez_compressed(stream, notes=np.array(json.dumps(notes)), **arrays)
    return path


def read_body_file(path: str | Path) -> BodyFile:
    """Contents of a body file, without a check of its matrices.

    Raises
    ------
    InputError
        No such file, one of another kind or version, or parts that are missing, unknown, of
        another type or shape, or not finite.
    """
    with opened(path, TARGET[0], _REMEDY) as reader:
        notes = json_of(reader, "notes")
        if notes["format"] != FORMAT:
            raise InputError(f"{path} is a file of another kind ({inputs.shown(notes['format'])}):"
                             f" {_REMEDY}")
        _check_version(path, notes["version"])
        table = body_table(f"{TARGET[0]} {path}", reader.headers, notes)
        arrays = table.read(reader, others=["notes"])
        return _made(arrays, notes)


def checked_names(names: tuple[str, ...] | None, count: int) -> tuple[str, ...]:
    """Names of so many boundary nodes.

    Raises
    ------
    InputError
        Too many, too few, no text, or twice the same.
    """
    if names is None:
        return tuple(f"node {k}" for k in range(count))
    checked = tuple(inputs.name(name, "name of a boundary node") for name in inputs.items(
        names, "names", "give a text for each boundary node"))
    if len(checked) != count or len(set(checked)) != count:
        raise inputs.refusal("names", checked, f"give {count} different names, one for each "
                             "boundary node")
    return checked


def _check_version(path: Path, version: Any) -> None:
    if version != VERSION:
        newer = isinstance(version, int) and version > VERSION
        raise InputError(f"body file {path} is of version {version}, this program reads {VERSION}: "
                         + ("update sebody" if newer else "import the body again"))


def _flatten(parts: Mapping[str, Any], prefix: str, arrays: dict, texts: dict) -> None:
    """Arrays by dotted names, all other values as JSON can hold them."""
    for name, value in parts.items():
        if is_dataclass(value):
            inner = {one.name: getattr(value, one.name) for one in fields(value)}
            _flatten(inner, f"{prefix}{name}.", arrays, texts)
        elif isinstance(value, np.ndarray):
            arrays[prefix + name] = value
        elif isinstance(value, Mapping):
            arrays |= {f"{prefix}{name}.{key}": one for key, one in value.items()
                       if isinstance(one, np.ndarray)}
            if texted := {key: one for key, one in value.items() if isinstance(one, str)}:
                texts[prefix + name] = texted
        elif value is not None:
            texts[prefix + name] = _named(value, prefix + name, arrays)


def _named(value: Any, name: str, arrays: dict) -> Any:
    """A value for JSON: arrays in lists by their names, stress operators by class and fields."""
    if isinstance(value, list | tuple):
        return [_named(one, f"{name}/{k}", arrays) for k, one in enumerate(value)]
    if isinstance(value, np.ndarray):
        arrays[name] = value
        return {"array": name}
    if is_dataclass(value):
        return {"part": type(value).__name__,
                "fields": {one.name: _named(getattr(value, one.name), f"{name}/{one.name}", arrays)
                           for one in fields(value)}}
    return value


def _made(arrays: dict[str, NDArray], notes: dict) -> BodyFile:
    values = {name: _restored(value, arrays) for name, value in notes["body"].items()}
    values |= {name: array for name, array in arrays.items() if "/" not in name}
    parts = {name: value for name, value in values.items() if "." not in name}
    for part, kind in PARTS.items():
        fields = {name.removeprefix(f"{part}."): value for name, value in values.items()
                  if name.startswith(f"{part}.")}
        if fields:
            parts[part] = kind(**fields)
    for group in ("loads", "outputs", "paths"):
        parts[group] = {name.removeprefix(f"{group}."): array for name, array in arrays.items()
                        if name.startswith(f"{group}.")}
    return BodyFile(parts, checked_names(notes["names"], len(parts["coordinates"])),
                    notes["units"], notes["provenance"],
                    tuple(changed(arrays, notes.get("checksums"))))


def _restored(value: Any, arrays: dict[str, NDArray]) -> Any:
    """Arguments that `_named` was given; lists as tuples, however deep."""
    if isinstance(value, list):
        return tuple(_restored(one, arrays) for one in value)
    if isinstance(value, dict) and "array" in value:
        return arrays[value["array"]]
    if isinstance(value, dict) and "part" in value:
        kind = {one.__name__: one for one in STRESSES}.get(value["part"])
        if kind is None:
            raise ValueError(f"unknown part {inputs.shown(value['part'])}")
        fields = {name: _restored(one, arrays) for name, one in value["fields"].items()}
        return _both_ends(kind(**fields))
    return value


def _both_ends(stress: Any) -> Any:
    """The operator of a file written when the sections at both ends of elements were the same."""
    if not isinstance(stress, BeamStress) or np.ndim(stress.fibres) != 4:
        return stress
    return replace(stress, **{name: np.repeat(getattr(stress, name)[:, None], 2, axis=1)
                              for name in ("fibres", "offsets")})
