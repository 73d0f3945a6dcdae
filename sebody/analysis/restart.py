"""Save a run to a file and continue it later, bit for bit as if it had not been stopped."""

import json
from dataclasses import fields
from pathlib import Path
from zipfile import BadZipFile

import numpy as np

from sebody import inputs
from sebody.analysis.fingerprint import fingerprint
from sebody.analysis.simulation import Simulation
from sebody.analysis.tolerance import Tolerance
from sebody.engine.state import CURRENT_STEP, PIVOTED, STEP, TIME, Scheme, State
from sebody.errors import InputError
from sebody.files import check_target, replacing
from sebody.model.model import Model

VERSION = 3
TARGET = "restart file", (".npz",)      # see `files.check_target`
SETTINGS = {"h", "every", "seconds", "scheme", "tolerance", "model"}
OF_START = "relaxed", "massless", "inertias", "thin"    # of the system, found at the start
FINITE = ("rows", "now", "aux", "q_old", "R_old", "v_old", "a_old", "aux_old")


def save_state(run: Simulation, path: str | Path) -> Path:
    """Write the state of a simulation and what it has recorded to an npz file.

    Raises
    ------
    InputError
        A target that cannot be written, see `check_target`.
    WriteError
        Writing fails; an older file is unchanged.
    """
    path = check_target(path, *TARGET)
    settings = {"version": VERSION, "h": run.h, "every": run.every, "seconds": run.seconds,
                "scheme": list(run.scheme), "tolerance": run.tolerance and list(run.tolerance),
                "model": fingerprint(run)}
    arrays = {field.name: getattr(run.state, field.name) for field in fields(State)}
    with replacing(path, TARGET[0]) as file:
        np.savez(file, settings=json.dumps(settings), rows=np.concatenate(run.rows), **arrays,
                 **{name: getattr(run.system, name) for name in OF_START})
    return path


def resume(model: Model, path: str | Path) -> Simulation:
    """The simulation of a file, to go on with `run_to`; `model` is built as it was.

    Raises
    ------
    InputError
        No such file, another kind of file, or another model.
    """
    path = inputs.path(path, *TARGET)
    settings, arrays = _read(path)
    tolerance = settings["tolerance"] and Tolerance(*settings["tolerance"])
    run = Simulation(model, settings["h"], Scheme(*settings["scheme"]), settings["every"],
                     tolerance)
    fits = {field.name: getattr(run.state, field.name) for field in fields(State)}
    if settings["model"] != fingerprint(run) or any(
            arrays[name].shape != array.shape for name, array in fits.items()):
        raise InputError(f"restart file {path} is of another model: build the one it was saved "
                         "from, with the same bodies, joints and loads")
    times = {"clock": arrays["clock"][[TIME, STEP, CURRENT_STEP]]}
    for name, array in ({name: arrays[name] for name in FINITE} | times).items():
        if not np.isfinite(array).all():
            raise InputError(f"restart file {path} holds numbers in {name} that are not finite: "
                             "run the model again")
    for name, array in fits.items():
        array[...] = arrays[name]
    for name in OF_START:
        getattr(run.system, name)[:] = arrays[name]
    run.rows = [arrays["rows"]]
    run.seconds = settings["seconds"]
    if run.state.control[PIVOTED]:
        run.exchanges.factorize()
    return run


def _read(path: Path) -> tuple[dict, dict]:
    try:
        with np.load(path, allow_pickle=False) as file:
            arrays = dict(file)
        settings = json.loads(str(arrays["settings"]))
        version, missing = settings["version"], SETTINGS - set(settings)
    except FileNotFoundError as error:
        raise InputError(f"restart file {path} does not exist: give one that was saved") from error
    except (BadZipFile, ValueError, KeyError, TypeError, EOFError) as error:
        raise InputError(f"{path} is no restart file: give one written by "
                         "sebody.analysis.save_state") from error
    except OSError as error:
        raise InputError(f"restart file {path} cannot be read ({error.strerror or error}): give "
                         "another one") from error
    if version != VERSION:
        raise InputError(f"restart file {path} is of version {version}, this program writes "
                         f"{VERSION}: run the model again")
    wanted = {"settings", "rows", *OF_START, *(field.name for field in fields(State))}
    differing = missing | set(arrays) ^ wanted
    if differing:
        raise InputError(f"restart file {path} was written by another version of sebody (it "
                         f"differs in {', '.join(sorted(differing))}): run the model again")
    return settings, arrays
