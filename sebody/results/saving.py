"""Recordings in files: states, the model, and what was made from arrays that no file can hold.

A file has two kinds of members: named histories, for every program that reads npz files, and those
below `OWN`, from which a `Result` is made that knows all that the saved one knew.
"""

import json
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any
from zipfile import BadZipFile

import numpy as np
from numpy.typing import NDArray

from sebody import inputs
from sebody.errors import InputError
from sebody.results import hdf5
from sebody.results.description import described, restored
from sebody.results.postprocessing import Forces
from sebody.results.recording import EVALUATED, Recording, Start

VERSION = 3
OWN = "sebody/"         # beginning of the names of members that are no named histories
NOTES = "seconds", "failure", "warnings", "error", "all_seconds"        # members of a Recording


def packed(recording: Recording) -> dict[str, NDArray]:
    """A recording as arrays and texts by name."""
    text, numbers = described(recording.model, recording.numbering)
    notes = {name: getattr(recording, name) for name in NOTES}
    notes |= {"version": VERSION, "start": recording.start, "advice": recording.advice}
    forces = recording.forces
    arrays = {"rows": recording.rows, "numbers": numbers, "model": np.array(text),
              "notes": np.array(json.dumps(notes)), "elements": forces.elements,
              "supports": forces.sums[:, recording.numbering.free:]}
    arrays |= {name: getattr(recording, name) for name in EVALUATED}
    return {OWN + name: array for name, array in arrays.items()}


def unpacked(make: Callable[..., Any], path: str | Path) -> Any:
    """What `make`, of the arguments of `Recording`, makes of a file.

    Raises
    ------
    InputError
        No such file, or one of another kind or version.
    """
    path = inputs.path(path, "results file")
    try:
        found = _members(path)
        notes = json.loads(str(found["notes"]))
        if notes["version"] != VERSION:
            raise InputError(f"results file {path} is of version {notes['version']}, this program "
                             f"reads {VERSION}: numpy.load or h5py reads its named histories")
        return _made(make, notes, found)
    except FileNotFoundError as error:
        raise InputError(f"results file {path} does not exist: give one that was saved") from error
    except InputError:
        raise
    except (BadZipFile, zlib.error, ValueError, KeyError, IndexError, TypeError, EOFError
            ) as error:
        raise InputError(f"{path} is damaged or no results file: give one written by Result.save; "
                         "'sebody inspect' reads body files") from error
    except OSError as error:
        raise InputError(f"results file {path} cannot be read ({error.strerror}): give another "
                         "one") from error


def _members(path: Path) -> dict[str, NDArray]:
    """The own members of a file of either kind, whatever its name is."""
    with path.open("rb") as file:
        if file.read(len(hdf5.SIGNATURE)) == hdf5.SIGNATURE:
            hdf5.check_installed()
            return hdf5.read(path, OWN.strip("/"))
    with np.load(path, allow_pickle=False) as file:
        return {name.removeprefix(OWN): file[name] for name in file.files
                if name.startswith(OWN)}


def _made(make: Callable[..., Any], notes: dict, found: dict[str, NDArray]) -> Any:
    model, numbering = restored(str(found["model"]), found["numbers"])
    start = notes["start"] and Start(notes["start"][0], tuple(notes["start"][1]))
    made = make(model, numbering, None, None, found["rows"], start=start,
                **{name: notes[name] for name in NOTES})
    made.warnings = tuple(made.warnings)
    sums = np.zeros((len(made.rows), numbering.total))
    sums[:, numbering.free:] = found["supports"]
    # cached properties, which are not evaluated any more
    vars(made).update({name: found[name] for name in EVALUATED}, advice=notes["advice"],
                      forces=Forces(found["elements"], sums))
    return made
