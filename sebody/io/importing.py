"""From the files of an FE program to a body and its file."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.linalg import eigh

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.basics.files import check_target
from sebody.basics.units import parsed_units
from sebody.fem.model import FEModel
from sebody.io.body_file import TARGET, BodyFile, body_parts, write_body_file
from sebody.io.damping import with_damping
from sebody.io.grounded import HeldBody
from sebody.io.interfaces import Interface, parsed, tied
from sebody.io.modal import ModalBody
from sebody.io.paths import named_sets, parsed_paths
from sebody.io.reading import Reading
from sebody.io.reduced import chosen_interfaces
from sebody.io.registry import naming, read_source
from sebody.io.rigid import rigid_residual
from sebody.reduction.accuracy import Accuracy
from sebody.reduction.body import ReducedBody
from sebody.reduction.factor import Factor
from sebody.reduction.free import Resisted
from sebody.reduction.grounded import grounded_body
from sebody.reduction.massless import condensed
from sebody.reduction.methods import free_frequencies, reduce
from sebody.reduction.path_loads import PathLoads
from sebody.reduction.watch import SILENT, Watch, watching


def read_fe_model(path: str | Path, kind: str | None = None) -> FEModel:
    """The FE model in the files of a program.

    Parameters
    ----------
    path : str or Path
        One of its files; those beside it with the same stem are found.
    kind : str, optional
        Name of the source, see `SOURCES`; guessed from the files by default.

    Raises
    ------
    InputError
        Files that cannot be used, or that hold reduced matrices.
    """
    model = read_source(path, kind).model
    if not isinstance(model, FEModel):
        raise InputError(f"{path} holds matrices that are reduced already: use import_body")
    return model


def import_body(path: str | Path, interfaces: Mapping[str, str | int] | Iterable[str] = (),
                modes: int | Accuracy = 0, method: str = "craig-bampton", *,
                kind: str | None = None, units: str = "", base: "ArrayLike | None" = None,
                damping: float | Sequence[float] = 0.0, output: str | Path | None = None,
                compare_free: bool = False, factor: Factor | None = None,
                paths: "Mapping[str, str | PathLoads] | Iterable[str]" = (),
                progress: Callable[[str], Any] | bool | None = None) -> ReducedBody:
    """A body of the files of an FE program, as ``sebody import`` makes it.

    Parameters
    ----------
    path : str or Path
        One of the files; those beside it with the same stem are found.
    interfaces : dict of texts by name, or texts ``name=...``
        Boundary nodes in order: the label of a node, two labels ``"1/2"`` where rotations have a
        node of their own, ``"rbe2:SET"`` and ``"rbe3:SET"`` for named sets and surfaces, or
        ``"cylinder:x,y,z;axis;radius"`` for a hole; ``"@x,y,z"`` for the place of an interface that
        the file of a foundation does not name. Of files with reduced matrices their own
        boundary nodes, all of them and in their order by default.
    modes : int or Accuracy
        Number of internal modes, or what they are to achieve.
    method : 'craig-bampton', 'guyan', 'macneal' or 'rubin'
        See `sebody.reduction.reduce`.
    kind : str, optional
        Name of the source, see `SOURCES`; guessed from the files by default.
    units : str
        Units of the numbers, such as ``mm t N s``.
    base : (3,), optional
        Of files with reduced matrices of a structure whose base is held: a place of this base
        [length], see `sebody.reduction.grounded_body`.
    damping : float or sequence of float
        Part of critical damping of the free vibration modes: of all, or of each from the lowest
        up, the last number also of those beyond.
    output : str or Path, optional
        Body file to write.
    compare_free : bool
        Compare the first free frequencies of the body with those of the FE model without
        interfaces: what its rigid faces stiffen. It takes another factorization.
    factor : function, optional
        Factors the stiffness in the place of SuperLU, see `sebody.reduction.reduce`.
    paths : texts, or dict of texts by name
        Paths that nodes of a model will slide along: names of node sets whose nodes lie in a line.
        ``"RAIL"`` keeps the shapes at the nodes of this set, adds static modes of unit loads at 7
        of them in both directions across, and `Model.path` takes the name for its `nodes`.
        ``"RAIL:z"`` has loads along z of the FE axes alone, ``"RAIL:5"`` at 5 of its nodes,
        ``"RAIL:z:5"`` both; in a dict any name for a path of such a text.
    progress : function of a text, or True, optional
        Is told what takes long, what it will cost, and what costs less; True for lines on standard
        error.

    Raises
    ------
    InputError
        Files, interfaces or counts that cannot be used; nothing is written.
    WriteError
        The body file cannot be written.
    """
    if output is not None:
        check_target(output, *TARGET)
    watch = watching(progress)
    wanted = Wanted(parsed(interfaces), modes, method, units, damping,
                    inputs.flag(compare_free, "compare_free"), base, factor, parsed_paths(paths))
    watch.stage(f"reading {path}")
    file = imported(read_source(path, kind), wanted, path, watch)
    with naming(path):
        body = file.body()
    if output is not None:
        write_body_file(file, output)
    return body


class Wanted(NamedTuple):
    """Request of what to make of the files, see `import_body`."""

    interfaces: list[Interface]
    modes: int | Accuracy = 0
    method: str = "craig-bampton"
    units: str = ""
    damping: float | Sequence[float] = 0.0
    compare_free: bool = False
    base: ArrayLike | None = None
    factor: Factor | None = None
    paths: Mapping[str, PathLoads] = {}


def imported(reading: Reading, wanted: Wanted, path: str | Path, watch: Watch = SILENT
             ) -> BodyFile:
    """Body that is to be written of a reading."""
    model, units = reading.model, str(parsed_units(wanted.units) or "")
    if not isinstance(model, FEModel):
        if wanted.paths:
            raise InputError(f"path {next(iter(wanted.paths))!r}: {path} holds matrices that are "
                             "reduced already, of which nothing is known of nodes inside: import "
                             "the whole FE model, with its node sets")
        return _damped(_grounded(_reduced(reading, wanted.interfaces, wanted.modes, units),
                                 wanted.base), wanted.damping)
    if wanted.base is not None:
        raise InputError(f"base is given, and {path} holds a whole FE model: import it free, with "
                         "the base as an interface")
    interfaces, method = wanted.interfaces, wanted.method
    boundary = tied(model, interfaces, reading.rotation_nodes)
    try:
        body = reduce(model, boundary.items, wanted.modes, method,
                      paths=named_sets(model, wanted.paths), judged=True,
                      factor=wanted.factor, progress=watch)
    except Resisted as error:
        raise InputError(f"{path}: {error}{reading.cards(error.nodes, error.turns)}") from error
    except InputError as error:
        by_area = any(one.tie == "rbe3" for one in interfaces) and "weights='equal'" in str(error)
        raise InputError(f"{path}: {error}" + by_area * ", rbe3-equal:SET") from error
    names = tuple(one.name for one in interfaces)
    provenance = {"source": model.source or str(path), "method": f"{method}, {body.modes} modes",
                  "FE matrices": f"{model.stiffness.shape[0]} rows, |K R| of rigid "
                  f"motions up to {rigid_residual(model):.4e} of a row's entries", **reading.notes,
                  **{f"interface {name}": note for name, note in boundary.notes.items()}}
    for note in body.notes:
        if note.startswith(_ACCURACY):
            provenance["accuracy"] = note.removeprefix(_ACCURACY)
    if wanted.compare_free:
        provenance["free part"] = _compared(body, free_frequencies(model, _COMPARED, watch))
    return _damped(BodyFile(body_parts(body), names, units or model.units, provenance),
                   wanted.damping)


_COMPARED = 6       # free frequencies
_STIFFENED = 0.02   # relative difference of frequencies from which rigid faces matter


def _compared(body: ReducedBody, free: NDArray) -> str:
    """Free frequencies of the FE model and how far those of the body are off, in words."""
    own = condensed(body.mass, body.stiffness)
    squares = eigh((own.stiffness + own.stiffness.T) / 2, own.mass, eigvals_only=True)
    rigid = body.rigid_modes.shape[1]
    hertz = np.sqrt(np.maximum(squares, 0.0))[rigid:rigid + len(free)] / (2 * np.pi)
    off = hertz / free[:len(hertz)] - 1
    text = ", ".join(f"{one:.5g} ({part:+.2%})" for one, part in zip(free, off, strict=False))
    stiff = np.abs(off).max(initial=0.0) > _STIFFENED
    return (f"its free frequencies, and how far those of the body are off: {text}"
            + "; where that matters, tie faces by rbe3 or keep more modes" * bool(stiff))


_ACCURACY = "accuracy: "        # beginning of a note of a reduction


def _damped(file: BodyFile, ratios: float | Sequence[float]) -> BodyFile:
    """The body with modal damping."""
    if not np.any(ratios):
        return file
    body = file.body().damped(ratios)
    shown = ", ".join(f"{ratio:g}" for ratio in np.atleast_1d(ratios))
    return replace(file, parts=body_parts(body), provenance={
        **file.provenance, "damping": f"{shown} of critical, of the free vibration modes"
        + " from the lowest up, the last also of those beyond" * (np.ndim(ratios) > 0)})


def _reduced(reading: Reading, interfaces: list[Interface], modes: int | Accuracy,
             units: str) -> BodyFile:
    """A body that the FE program has reduced, its nodes named."""
    if modes:
        raise InputError(f"modes is {inputs.shown(modes)}, but the files hold matrices that are "
                         "reduced already: leave modes out")
    provenance = {"source": reading.source, "method": "reduced by the FE program", **reading.notes,
                  **{f"interface {one.name}": f"node {one.nodes[0]}" for one in interfaces
                     if one.nodes and str(one.nodes[0]) != one.name}}
    if isinstance(reading.model, HeldBody):
        return _held(reading.model, interfaces, units, provenance)
    modal = isinstance(reading.model, ModalBody)
    for one in interfaces:
        if len(one.nodes) != 1 or (one.keeps and not modal):
            raise InputError(f"interface {one.name!r}: the body is reduced already, so write "
                             f"{one.name}=NODE")
    labels = [str(one.nodes[0]) for one in interfaces] or list(reading.names)
    names = tuple(one.name for one in interfaces) or reading.names
    if modal:
        keeps = {label: one.keeps for label, one in zip(labels, interfaces, strict=False)}
        chosen = [keeps.get(label) or reading.model.keeps(label) for label in labels]
        parts, notes = with_damping(reading.model.with_boundary(labels, chosen), "De", ())
        return BodyFile(parts, names, units, {**provenance, **notes})
    return chosen_interfaces(BodyFile(reading.model, reading.names, units, provenance), labels,
                             names)


def _grounded(file: BodyFile, base: ArrayLike | None) -> BodyFile:
    """The body of matrices whose base is held, where its place is given."""
    if base is None:
        return file
    parts = file.parts
    if parts.get("base") is not None:
        raise InputError("base is given twice: the file is of a body that is held already, leave "
                         "it out")
    body = grounded_body(*(parts[name] for name in ("stiffness", "mass", "coordinates", "keeps",
                                                    "modes")), parts.get("damping"), base,
                         units=file.units, outputs=parts.get("outputs"))
    return replace(file, parts={**body_parts(body), "missing": parts.get("missing", {})},
                   names=(*file.names, "base"))


def _held(model: HeldBody, interfaces: list[Interface], units: str, provenance: dict[str, str]
          ) -> BodyFile:
    """A body held to the ground with its interface at a place that is given."""
    points = [one for one in interfaces if one.point and not one.tie]
    if len(points) != 1 or len(interfaces) != 1:
        raise InputError(f"{model.path} does not say where its interface is: give its place, one "
                         "interface name=@x,y,z, on the command line --interface X Y Z")
    if units not in ("", model.units):
        raise InputError(f"units are {units}, and {model.path} is in {model.units}: leave units "
                         "out")
    one = points[0]
    body = model.body(one.point)
    if model.series is not None:
        provenance = {**provenance, "loads": f"{model.series!r}: give them by Model.body_series"}
    return BodyFile(body_parts(body), (one.name, "base"), model.units, provenance)
