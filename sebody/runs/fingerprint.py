"""Hash of a model: to see whether a saved run is of another one."""

from collections.abc import Callable, Mapping
from dataclasses import fields, is_dataclass
from hashlib import sha256

import numpy as np

from sebody.basics.version import __version__
from sebody.engine.state import State
from sebody.engine.system import System
from sebody.model.model import Model
from sebody.model.numbering import Numbering
from sebody.model.outside import CONSTANTS, values_read
from sebody.runs.phased_simulation import PhasedSimulation
from sebody.runs.simulation import Simulation
from sebody.runs.user_faults import functions

# arrays of `System.control` that hold no addresses
PLACED = ("tasks", "periods", "offsets", "sensors", "reads", "steps", "factors", "weights",
          "scales", "seeds", "wires", "ends", "inputs", "limits", "parameters")


def fingerprint(run: Simulation | PhasedSimulation) -> str:
    """Hash of what a model is, without addresses of compiled functions.

    Of one with phases also of when its parts act, and of the sensors that tell it.
    """
    if isinstance(run, Simulation):
        return _hashed(run.model, run.numbering, run.system, run.state)
    switches = sorted(run.model.switches.items())
    asked = [repr(run.model.sensors.get(one.release_when[0])) for _, one in switches]
    parts = _hashed(run.model, run.numbering, run.system, run.phases[0].state), switches, asked
    return sha256(repr(parts).encode()).hexdigest()


def _hashed(model: Model, numbering: Numbering, system: System, state: State) -> str:
    kinds = [body.kernel for body in model.bodies.values()] + [
        e.kind for e in (*model.rigid_bodies.values(), *model.constraints, *model.loads)]
    written = [described(one.function) for _, one in functions(model)]
    parts = [repr((numbering.names, kinds, written)).encode()] + [
        array.tobytes() for array in (
            system.constants, system.g_unknown, system.table_times, system.table_pieces,
            system.series_times, system.series_values, system.corners, system.prescribed,
            system.prescribed_factor, system.gravity_fields, model.gravity_field, state.q_start)]
    return sha256(b"".join(parts)).hexdigest()


def whole(run: Simulation) -> str:
    """Hash of all that results of a run follow from: also of its start, scheme and laws.

    Bodies count with what stresses are recovered from.
    """
    parts = [fingerprint(run), repr((__version__, run.h, run.every, tuple(run.scheme)))]
    hashed = sha256("".join(parts).encode())
    control = [getattr(run.system.control, name) for name in PLACED]
    for array in control:
        hashed.update(array.tobytes())
    for block in run.model.dof_blocks():
        hashed.update(block.rate.tobytes() + repr((block.name, block.given)).encode())
    for name, body in run.model.bodies.items():
        hashed.update(name.encode())
        hashed.update(_bytes(body.reduced))
    return hashed.hexdigest()


def _bytes(value: object) -> bytes:
    """A value that may hold arrays and other dataclasses, written the same in every process."""
    if isinstance(value, np.ndarray):
        return repr((str(value.dtype), value.shape)).encode() + value.tobytes()
    if is_dataclass(value):
        return type(value).__name__.encode() + b"".join(
            field.name.encode() + _bytes(getattr(value, field.name))
            for field in fields(value) if not field.name.startswith("_"))
    if isinstance(value, Mapping):
        return b"".join(_bytes(key) + _bytes(one) for key, one in value.items())
    if isinstance(value, list | tuple):
        return b"".join(map(_bytes, value))
    return repr(value).encode() if isinstance(value, CONSTANTS) else type(value).__name__.encode()


def described(function: Callable) -> list[tuple[str, object]]:
    """Description of a function: its bytecode, and by name what it and its helpers read."""
    read = values_read(getattr(function, "py_func", function))      # of what Numba has compiled
    return [(name, _stable(value)) for name, value in read.items()]


def _stable(value: object) -> object:
    """A value as it is written the same in every process."""
    if isinstance(value, np.ndarray):
        return str(value.dtype), value.shape, value.tobytes()
    if isinstance(value, tuple):
        return [_stable(one) for one in value]
    return repr(value) if isinstance(value, CONSTANTS) else getattr(
        value, "__name__", type(value).__name__)
