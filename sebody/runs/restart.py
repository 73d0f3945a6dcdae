"""Save a run to a file and continue it later, bit for bit as if it had not been stopped.

Of a run with phases, the members of each one have its number before their names.
"""

import json
from collections.abc import Mapping
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError, SimulationError
from sebody.basics.files import check_target, replacing
from sebody.basics.files.array_files import json_of, opened
from sebody.basics.files.checksums import changed, checksums
from sebody.basics.files.members import Header, Member, Reader, Table
from sebody.contract.layout import RECORD_T
from sebody.engine.clock import CLOCK, CONTROL
from sebody.engine.scalars import numbers_of, record
from sebody.engine.state import AHEAD, EVALUATED, FINEST, JUMP, REASONS, Scheme, State
from sebody.model.model import Model
from sebody.runs.fingerprint import fingerprint
from sebody.runs.phased_simulation import PhasedSimulation
from sebody.runs.phases import Phase
from sebody.runs.planning import Plan
from sebody.runs.simulation import Simulation
from sebody.runs.steps import MOST_STEPS
from sebody.runs.thresholds import DID
from sebody.runs.tolerance import Tolerance

VERSION = 8
TARGET = "restart file", (".npz",)      # see `files.check_target`
SETTINGS = {"h", "every", "seconds", "scheme", "tolerance", "plan", "model"}
OF_START = "regularized", "massless", "inertias", "massless_axes"  # of the system
REMEDY, REPEAT = "give one that was saved by sebody.analysis.save_state", "run the model again"
OFF = 1e-6          # of a step, by which rounding may put a time off
# largest values of counters; others count steps, of which no run has more than MOST_STEPS
MOST = {"unit": FINEST, "level": FINEST.bit_length(), "wanted": EVALUATED,
        "reason": max(REASONS), "pivoted": 1, "adaptive": 1, "secant": 1, "regularized": 1,
        "meets": JUMP, "split": 1, "inside": 1, "restart": AHEAD, "due": 1}
FINITE = ("rows", "now", "aux", "q_old", "R_old", "v_old", "a_old", "aux_old", "changes", "fitted",
          "fit")


def save_state(run: Simulation | PhasedSimulation, path: str | Path) -> Path:
    """Write the state of a simulation and what it has recorded to an npz file.

    Raises
    ------
    InputError
        A target that cannot be written, see `check_target`.
    WriteError
        Writing fails; an older file is unchanged.
    """
    path = check_target(path, *TARGET)
    inputs.instance(run, "run", Simulation | PhasedSimulation,
                    "give a Simulation or a PhasedSimulation")
    phases = list[Simulation](run.phases) if isinstance(run, PhasedSimulation) else [run]
    arrays: dict[str, NDArray] = {}
    for k, phase in enumerate(phases):
        phase.flush()
        own = _arrays(phase.state) | {name: getattr(phase.system, name) for name in OF_START}
        own["rows"] = phase.rows.all()
        prefix = _prefix(isinstance(run, PhasedSimulation), k)
        arrays |= {prefix + name: array for name, array in own.items()}
    settings = {"version": VERSION, "h": run.h, "every": phase.every,
                "seconds": sum(one.seconds for one in phases), "scheme": list(run.scheme),
                "tolerance": phase.tolerance and list(phase.tolerance),
                "plan": [phase.plan.schedule.tolist(), *phase.plan[1:]],
                "model": fingerprint(run), "checksums": checksums(arrays)}
    if isinstance(run, PhasedSimulation):
        settings["reached"] = run.reached
    with replacing(path, TARGET[0]) as file:
        # stubs of NumPy take the arrays for its argument allow_pickle, too
        np.savez(file, settings=json.dumps(settings), **arrays)      # type: ignore[arg-type]
    return path


def resume(model: Model, path: str | Path, threads: int = 1) -> Simulation | PhasedSimulation:
    """The simulation of a file, to be continued with `run_to`; `model` is built as it was.

    The run may continue with another number of `threads`. Phases of a run are made again, each from
    the end of the one before.

    Raises
    ------
    InputError
        No such file, another kind of file, another model, or numbers that no run has.
    """
    file = f"{TARGET[0]} {path}"
    with opened(path, TARGET[0], REMEDY, TARGET[1]) as reader:
        settings = _settings(file, json_of(reader, "settings"), reader.headers)
        run = _begun(file, model, settings, threads)
        if isinstance(run, Simulation):
            _restore(file, run, _Part(reader, ""), settings)
            last = run
        else:
            for k, reached in enumerate(settings["reached"]):
                _restore(file, run.phases[-1], _Part(reader, _prefix(True, k)), settings)
                _change(file, run, reached)
            last = run.phases[-1]
            _restore(file, last, _Part(reader, _prefix(True, len(run.events))), settings)
    last.seconds = settings["seconds"]
    return run


def _prefix(phased: bool, number: int) -> str:
    """The prefix of the names of the members of a phase."""
    return f"{number}/" if phased else ""


class _Part:
    """The members of a file whose names begin with a prefix, without it."""

    def __init__(self, reader: Reader, prefix: str):
        self._reader, self.prefix = reader, prefix
        self.headers: Mapping[str, Header] = {
            name.removeprefix(prefix): header for name, header in reader.headers.items()
            if name.startswith(prefix)}

    def read(self, name: str) -> NDArray:
        """A member by name."""
        return self._reader.read(self.prefix + name)


def _restore(file: str, run: Simulation, part: _Part, settings: Mapping[str, Any]) -> None:
    """Put the state and the rows of a file in place of those of a run at its start."""
    table = Table(file, REPEAT, _members(run), {"width": run.rows.stretches[0].shape[1]})
    try:
        arrays = table.read(part, others=["settings"])
    except InputError as error:
        same = part.headers.keys() - {"settings"} == table.members.keys()
        if same and " of shape " in str(error):
            raise _other_model(file) from error
        raise
    _check_numbers(table, run, arrays)
    noted = {name.removeprefix(part.prefix): number for name, number in
             (settings.get("checksums") or {}).items() if name.startswith(part.prefix)}
    if odd := changed(arrays, noted):
        raise table.fault(f"differs from what was saved in {', '.join(odd)}")
    for name, array in _arrays(run.state).items():
        array[...] = arrays[name]
    for name in OF_START:
        getattr(run.system, name)[:] = arrays[name]
    run.rows.stretches = [arrays["rows"]]
    run.aid.forget()


def _change(file: str, run: PhasedSimulation, reached: list) -> None:
    """Begin the next phase of a run that is made again."""
    odd = [one for one in reached if not (isinstance(one, list) and len(one) == 2 and
           one[0] in run.waiting() and one[1] in DID)]
    if odd:
        raise InputError(f"{file} lets go of {inputs.shown(odd[0])} at t = {run.time:.6g}, which "
                         f"this model does not: {REPEAT}")
    if not reached and not run.switches_now():
        raise InputError(f"{file} begins a phase that changes nothing at t = {run.time:.6g}: "
                         f"{REPEAT}")
    try:
        run.change([(name, did) for name, did in reached])
    except SimulationError as error:
        raise InputError(f"{file}: {error}: {REPEAT}") from error


def _settings(file: str, settings: Any, headers: Mapping[str, Header]) -> dict:
    """Settings of the run in the file, of a version and with the members that are read."""
    if settings["version"] != VERSION:
        raise InputError(f"{file} is of version {settings['version']}, this program reads "
                         f"{VERSION}: {REPEAT}")
    reached = settings.get("reached")
    if "reached" in settings and not (isinstance(reached, list) and
                                      all(isinstance(one, list) for one in reached)):
        raise InputError(f"{file} has {inputs.shown(reached)} for what was reached: {REPEAT}")
    own = {*OF_START, "rows", *(field.name for field in fields(State))}
    prefixes = [""] if reached is None else [f"{k}/" for k in range(len(reached) + 1)]
    wanted = {"settings", *(prefix + name for prefix in prefixes for name in own)}
    differing = SETTINGS - set(settings) | set(headers) ^ wanted
    if differing:
        raise InputError(f"{file} was written by another version of sebody (it differs in "
                         f"{', '.join(sorted(differing))}): {REPEAT}")
    return settings


def _begun(file: str, model: Model, settings: dict, threads: int
           ) -> Simulation | PhasedSimulation:
    """A simulation with the settings of a file, at its start."""
    inputs.instance(model, "model", Model, "give a sebody.Model")
    for name, kind in (("scheme", list), ("model", str), ("tolerance", list | None),
                       ("plan", list)):
        if not isinstance(settings[name], kind):
            raise InputError(f"{file} has {inputs.shown(settings[name])} for its {name}: {REPEAT}")
    inputs.number(settings["seconds"], f"{file}: seconds", least=0, remedy=REPEAT)
    phased, plan = "reached" in settings, _plan(file, settings["plan"])
    if model.switches and not phased:
        raise _other_model(file)
    try:
        tolerance = settings["tolerance"] and Tolerance(*settings["tolerance"])
        how = (model, settings["h"], Scheme(*settings["scheme"]), settings["every"], tolerance,
               None, threads)
        run = PhasedSimulation(*how) if phased else Simulation(*how, plan)
    except TypeError as error:      # too many numbers of the scheme or the tolerance, or too few
        raise InputError(f"{file} has an unknown scheme {settings['scheme']} or tolerance "
                         f"{settings['tolerance']}: {REPEAT}") from error
    if settings["model"] != fingerprint(run):
        raise _other_model(file)
    return run


def _plan(file: str, numbers: list) -> Plan:
    """The plan of a file."""
    try:
        lengths, finer, allowed, logged, seconds, stiff = numbers
        schedule = np.array(lengths, dtype=float).reshape(-1, 2)
        plan = Plan(schedule, float(finer), float(allowed), int(logged), float(seconds),
                    bool(stiff))
        if (schedule > 0.0).all() and min(plan.finer, plan.allowed) > 0.0 <= min(plan[3:]):
            return plan
    except (TypeError, ValueError):
        pass
    raise InputError(f"{file} has a plan of steps that no run has: {REPEAT}")


def _other_model(file: str) -> InputError:
    return InputError(f"{file} is of another model: build the one it was saved from, with the same "
                      "bodies, joints and loads")


def _members(run: Simulation) -> dict[str, Member]:
    """Requirements of the members of a file of this run; scratch memory may hold anything."""
    members = {"rows": Member((None, "width")), "regularized": Member((1,), "i", least=0),
               "massless": Member((1,), "i", least=0)}
    for name in ("inertias", "massless_axes"):
        members[name] = Member(getattr(run.system, name).shape, least=0)
    for name, array in _arrays(run.state).items():
        members[name] = Member(array.shape, array.dtype.kind, finite=name in FINITE)
    return members


def _arrays(state: State) -> dict[str, NDArray]:
    """The members of a state by name; scalars as arrays that share their memory."""
    arrays = {field.name: getattr(state, field.name) for field in fields(State)}
    return {name: numbers_of(value) if isinstance(value, np.record) else value
            for name, value in arrays.items()}


def _check_numbers(table: Table, run: Simulation, arrays: Mapping[str, NDArray]) -> None:
    """Refuse counters and times that no run can have reached."""
    control, clock = record(CONTROL, arrays["control"]), record(CLOCK, arrays["clock"])
    rows = arrays["rows"]
    for name in CONTROL.names or ():
        most = MOST.get(name, MOST_STEPS if name != "corner" else run.system.corners.size)
        if not 0 <= control[name] <= most:
            raise table.fault(f"holds {control[name]} in control for {name}, outside 0 to {most:g}")
    for name in ("time", "step", "current_step"):
        if not np.isfinite(clock[name]):
            raise table.fault(f"holds {clock[name]} in clock for {name}")
    t, grid, h = rows[:, RECORD_T], control.grid, run.h
    reached = (grid + control.unit / FINEST) * h
    # variable steps go past the grid, and phases end inside fixed ones
    past = np.inf if run.tolerance is not None else h if isinstance(run, Phase) else OFF * h
    if clock.step != h or not reached - OFF * h <= clock.time <= reached + past:
        raise table.fault(f"holds the time {clock.time:g} after {grid} steps of {clock.step:g}")
    if not 0.0 < clock.current_step <= h + past:
        raise table.fault(f"holds a step of {clock.current_step:g} with an output grid of {h:g}")
    if len(t) and abs(t[0] - run.time) > OFF * h:
        raise table.fault(f"holds states from t = {t[0]:g} on, of a phase that begins at t = "
                          f"{run.time:g}")
    if not len(t) or not (np.diff(t) > 0).all() or t[-1] > clock.time + OFF * h:
        raise table.fault("holds states that are not in the order of their times up to "
                          f"{clock.time:g}")
