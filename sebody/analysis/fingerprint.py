"""What a model is, as a hash: to see whether a saved run is of another one."""

import inspect
from collections.abc import Callable
from hashlib import sha256
from types import CodeType, ModuleType

import numpy as np

from sebody.analysis.simulation import Simulation
from sebody.analysis.user_faults import functions

CONSTANTS = (bool, int, float, complex, str, bytes, tuple, np.generic, type(None))


def fingerprint(run: Simulation) -> str:
    """Hash of what a model is, without addresses of compiled functions."""
    system, model = run.system, run.model
    kinds = [body.kernel for body in model.bodies.values()] + [
        e.kind for e in (*model.rigid_bodies.values(), *model.constraints, *model.loads)]
    written = [described(one.function) for _, one in functions(model)]
    parts = [repr((run.numbering.names, kinds, written)).encode()] + [
        array.tobytes() for array in (
            system.constants, system.g_unknown, system.table_times, system.table_pieces,
            system.corners, system.prescribed, system.prescribed_factor, model.gravity_field,
            run.state.q_start)]
    return sha256(b"".join(parts)).hexdigest()


def described(value: object, above: tuple[int, ...] = ()) -> object:
    """What a function computes: its bytecode, and the constants and functions it refers to.

    Parameters
    ----------
    value : object
        A function, or something it refers to.
    above : tuple of int
        Functions whose descriptions this is a part of, by their ids.
    """
    value = getattr(value, "py_func", value)        # of a function compiled by Numba
    if isinstance(value, np.ndarray):
        return str(value.dtype), value.shape, value.tobytes()
    if isinstance(value, ModuleType):
        return value.__name__
    if not isinstance(getattr(value, "__code__", None), CodeType):
        return repr(value) if isinstance(value, CONSTANTS) else type(value).__name__
    if id(value) in above:
        return "itself"
    return _code(value, (*above, id(value)))




def _code(function: Callable, above: tuple[int, ...]) -> object:
    used = inspect.getclosurevars(function)
    others = [(name, described(value, above)) for group in (used.nonlocals, used.globals)
              for name, value in sorted(group.items())]
    return _bytes(function.__code__), repr(function.__defaults__), others


def _bytes(code: CodeType) -> object:
    """Bytecode and constants, of functions inside, too."""
    return code.co_code, code.co_names, [
        _bytes(one) if isinstance(one, CodeType) else repr(one) for one in code.co_consts]
