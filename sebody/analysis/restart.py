"""Save a run to a file and continue it later, bit for bit as if it had not been stopped."""

import json
from dataclasses import fields
from hashlib import sha256
from pathlib import Path
from zipfile import BadZipFile

import numpy as np

from sebody.analysis.simulation import Simulation
from sebody.analysis.tolerance import Tolerance
from sebody.engine.state import PIVOTED, Scheme, State
from sebody.errors import InputError
from sebody.files import check_target, replacing
from sebody.model.model import Model

VERSION = 2
TARGET = "restart file", (".npz",)      # see `files.check_target`


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
                "model": _fingerprint(run)}
    arrays = {field.name: getattr(run.state, field.name) for field in fields(State)}
    with replacing(path, TARGET[0]) as file:
        np.savez(file, settings=json.dumps(settings), relaxed=run.system.relaxed,
                 rows=np.concatenate(run.rows), **arrays)
    return path


def resume(model: Model, path: str | Path) -> Simulation:
    """The simulation of a file, to go on with `run_to`; `model` is built as it was.

    Raises
    ------
    InputError
        No such file, another kind of file, or another model.
    """
    settings, arrays = _read(Path(path))
    tolerance = settings["tolerance"] and Tolerance(*settings["tolerance"])
    run = Simulation(model, settings["h"], Scheme(*settings["scheme"]), settings["every"],
                     tolerance)
    if settings["model"] != _fingerprint(run):
        raise InputError(f"restart file {path} is of another model: build the one it was saved "
                         "from, with the same bodies, joints and loads")
    for field in fields(State):
        getattr(run.state, field.name)[...] = arrays[field.name]
    run.system.relaxed[:] = arrays["relaxed"]
    run.rows = [arrays["rows"]]
    run.seconds = settings["seconds"]
    if run.state.control[PIVOTED]:
        run.factorize()
    return run


def _read(path: Path) -> tuple[dict, dict]:
    try:
        with np.load(path, allow_pickle=False) as file:
            arrays = dict(file)
        settings = json.loads(str(arrays["settings"]))
        version = settings["version"]
    except FileNotFoundError as error:
        raise InputError(f"restart file {path} does not exist: give one that was saved") from error
    except (BadZipFile, ValueError, KeyError, TypeError, EOFError) as error:
        raise InputError(f"{path} is no restart file: give one written by "
                         "sebody.analysis.save_state") from error
    if version != VERSION:
        raise InputError(f"restart file {path} is of version {version}, this program writes "
                         f"{VERSION}: run the model again")
    differing = set(arrays) ^ {"settings", "relaxed", "rows", *(f.name for f in fields(State))}
    if differing:
        raise InputError(f"restart file {path} was written by another version of sebody (it "
                         f"differs in {', '.join(sorted(differing))}): run the model again")
    return settings, arrays


def _fingerprint(run: Simulation) -> str:
    """Hash of what a model is, without addresses of compiled functions."""
    system, model = run.system, run.model
    kinds = [body.kernel for body in model.bodies.values()] + [
        e.kind for e in (*model.rigid_bodies.values(), *model.constraints, *model.loads)]
    parts = [repr((run.numbering.names, kinds)).encode()] + [
        array.tobytes() for array in (
            system.constants, system.g_unknown, system.table_times, system.table_pieces,
            system.prescribed, system.prescribed_factor, model.gravity_field, run.state.q_start)]
    return sha256(b"".join(parts)).hexdigest()
