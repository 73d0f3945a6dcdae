"""What a model is, as a hash: to see whether a saved run is of another one."""

from collections.abc import Callable
from hashlib import sha256

import numpy as np

from sebody.model.outside import CONSTANTS, values_read
from sebody.runs.simulation import Simulation
from sebody.runs.user_faults import functions


def fingerprint(run: Simulation) -> str:
    """Hash of what a model is, without addresses of compiled functions."""
    system, model = run.system, run.model
    kinds = [body.kernel for body in model.bodies.values()] + [
        e.kind for e in (*model.rigid_bodies.values(), *model.constraints, *model.loads)]
    written = [described(one.function) for _, one in functions(model)]
    parts = [repr((run.numbering.names, kinds, written)).encode()] + [
        array.tobytes() for array in (
            system.constants, system.g_unknown, system.table_times, system.table_pieces,
            system.series_times, system.series_values, system.corners, system.prescribed,
            system.prescribed_factor, model.gravity_field,
            run.state.q_start)]
    return sha256(b"".join(parts)).hexdigest()


def described(function: Callable) -> list[tuple[str, object]]:
    """What a function computes: its bytecode, and by name what it and its helpers read."""
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
