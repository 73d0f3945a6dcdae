"""Recordings in files: states, the model, and what was made from arrays that no file can hold.

A file has two kinds of members: named histories, for every program that reads npz files, and those
below `OWN`, from which a `Result` with all data of the saved one is made.
"""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sebody.basics.errors import InputError
from sebody.basics.files import check_target, replacing
from sebody.basics.files.array_files import json_of, opened
from sebody.basics.files.checksums import changed, checksums
from sebody.basics.files.members import Member, Table
from sebody.basics.files.reading import existing
from sebody.basics.units import parsed_units
from sebody.contract.layout import RECORD_T
from sebody.engine.clock import CONTROL
from sebody.model.mechanism import Mechanism
from sebody.model.numbering import Numbering
from sebody.results import hdf5
from sebody.results.description import described, restored
from sebody.results.postprocessing import Forces
from sebody.results.recording import EVALUATED, Event, Recording, Start
from sebody.results.saved_checks import check_notes, member_lengths
from sebody.results.units import unit

OUTPUT = "output file", (".npz", hdf5.SUFFIX)    # what is saved, see `files.check_target`
VERSION = 8
OWN = "sebody/"         # beginning of the names of members that are no named histories
# members of a Recording
NOTES = "seconds", "failure", "warnings", "error", "all_seconds", "stability", "events"
WHAT, REPEAT = "results file", "run the model again"
REMEDY = "give one written by Result.save; 'sebody inspect' reads body files"
NUMBERS = Member((None,), finite=False)     # of the model's arrays
# lengths by the names of `member_lengths`
MEMBERS = {"rows": Member(("states", "width")), "elements": Member(("states", "forces")),
           "supports": Member(("states", "supports")),
           "counters": Member((len(CONTROL.names or ()),), "i", least=0),
           "energies": Member(("states", "energies")), "powers": Member(("states", "ports")),
           "constraint_residuals": Member(("states", 2))}


def check_output(path: str | Path) -> Path:
    """The path of a file of results, refused before anything is computed for it.

    Raises
    ------
    InputError
        See `check_target`; h5py is missing.
    """
    path = check_target(path, *OUTPUT)
    if path.suffix == hdf5.SUFFIX:
        hdf5.check_installed()
    return path


def write(recording: Recording, histories: dict[str, NDArray], advice: dict[str, list[str]],
          path: str | Path) -> Path:
    """Write a file of named histories and of the recording; see `Result.save`."""
    path = check_output(path)
    members = histories | packed(recording, advice)
    with replacing(path, OUTPUT[0]) as file:
        if path.suffix == hdf5.SUFFIX:
            model, units = recording.model, parsed_units(recording.model.units)
            hdf5.write(file, members, {name: unit(name, units) for name in histories},
                       {"title": "results of a run", "superelements": ", ".join(model.bodies),
                        "nodes": ", ".join(model.nodes)})
        else:
            # stubs of NumPy take the members for its argument allow_pickle, too
            np.savez_compressed(file, **members)     # type: ignore[arg-type]
    return path


def packed(recording: Recording, advice: dict[str, list[str]]) -> dict[str, NDArray]:
    """A recording as arrays and texts by name."""
    text, numbers = described(recording.model, recording.numbering)
    notes = {name: getattr(recording, name) for name in NOTES}
    notes |= {"version": VERSION, "start": recording.start, "advice": advice}
    forces = recording.forces
    arrays = {"rows": recording.unique_rows, "numbers": numbers, "model": np.array(text),
              "elements": forces.elements, "supports": forces.sums[:, recording.numbering.free:]}
    arrays |= {name: getattr(recording, name) for name in EVALUATED}
    notes["checksums"] = checksums(arrays)
    arrays["notes"] = np.array(json.dumps(notes))
    return {OWN + name: array for name, array in arrays.items()}


def unpacked(make: Callable[..., Any], path: str | Path) -> Any:
    """Object that `make`, called with the arguments of `Recording`, returns for a file.

    Raises
    ------
    InputError
        No such file, one of another kind or version, or parts that do not fit together.
    """
    file_path, file = existing(path, WHAT, "give one that was saved"), f"{WHAT} {path}"
    with opened(file_path, WHAT, REMEDY, group=OWN.strip("/")) as reader:
        notes = json_of(reader, "notes")
        if notes["version"] != VERSION:
            raise InputError(f"{file} is of version {notes['version']}, this program reads "
                             f"{VERSION}: numpy.load or h5py reads its named histories")
        notes = {"checksums": {}, "stability": "", **notes}     # older files have none
        check_notes(notes)
        text = json_of(reader, "model")
        numbers = Table(file, REPEAT, {"numbers": NUMBERS}).read(
            reader, others=set(reader.headers) - {"numbers"})
        model, numbering = restored(text, numbers["numbers"])
        members = dict(MEMBERS)
        if notes["failure"]:            # what was computed last may have overflowed
            members |= {name: one._replace(finite=False) for name, one in MEMBERS.items()
                        if name != "rows"}
        table = Table(file, REPEAT, members, member_lengths(model, numbering))
        arrays = table.read(reader, others=["notes", "model", "numbers"])
        _check_times(table, arrays["rows"])
        made = _made(make, notes, arrays, model, numbering)
        noted = {"model": np.array(json.dumps(text)), **numbers, **arrays}
        if odd := changed(noted, notes["checksums"]):
            raise table.fault(f"differs from what was saved in {', '.join(odd)}")
        return made


def _check_times(table: Table, rows: NDArray) -> None:
    """Refuse states that are not in the order of their times."""
    t = rows[:, RECORD_T]
    if not len(t):
        raise table.fault("holds no state")
    if not (np.diff(t) > 0).all():
        k = int(np.argmin(np.diff(t) > 0))
        raise table.fault(f"holds times that do not increase: {t[k]:g} is followed by "
                          f"{t[k + 1]:g}")


def _made(make: Callable[..., Any], notes: dict, found: dict[str, NDArray], model: Mechanism,
          numbering: Numbering) -> Any:
    start: list[Any] = [tuple(part) if isinstance(part, list) else part
                        for part in notes["start"] or ()]
    made = make(model, numbering, None, None, found["rows"], start=Start(*start) if start else None,
                **{name: notes[name] for name in NOTES})
    made.warnings = tuple(made.warnings)
    made.events = tuple(Event(*one) for one in made.events)
    sums = np.zeros((len(made.rows), numbering.total))
    sums[:, numbering.free:] = found["supports"]
    # cached properties, which are not evaluated any more
    vars(made).update({name: found[name] for name in EVALUATED}, advice=notes["advice"],
                      forces=Forces(found["elements"], sums))
    return made
