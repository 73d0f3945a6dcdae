"""Compilation for a first run: the kernels of its models and the time loop, side by side.

The parts of the loop are compiled for the types of a small model's arrays, which are those of
every model. Kernels are known by name. Nothing is printed or done if everything is in the cache.
"""

from collections.abc import Callable, Collection, Iterable
from functools import cache
from pathlib import Path
from threading import Lock
from typing import NamedTuple

import numpy as np
from numba import typeof

from sebody.assembly.allocation import allocate
from sebody.assembly.build import build
from sebody.assembly.contracts import check_joints
from sebody.assembly.equal_bodies import (
    compile_together,
    is_compiled_together,
    kernels_together,
    lanes_exist,
)
from sebody.assembly.motions import motion_kernel
from sebody.compiler.choice import way
from sebody.compiler.decorators import is_compiled
from sebody.compiler.first_run import Job, compile_apart
from sebody.compiler.workers import Task
from sebody.contract.names import SUPERELEMENT
from sebody.engine import (
    evaluate,
    iteration,
    links,
    loop,
    matrix,
    newton,
    restart,
    step,
    step_control,
)
from sebody.engine.routines import compile_routine
from sebody.engine.state import Record, State
from sebody.engine.system import System
from sebody.kernels import loader
from sebody.kernels.loader import BY_HAND, element_kernel_name, find
from sebody.model.mechanism import Mechanism
from sebody.model.model import Model
from sebody.results import motion, postprocessing
from sebody.runs.schemes import generalized_alpha

SECONDS_A_LETTER = 7e-5         # of a kernel's file, of one processor
OF_EIGHT = 1.5                  # times that for eight bodies at a time

_lock = Lock()
_ready: set[str] = set()        # kernels and parts of the loop this process need not ask for again


class Part(NamedTuple):
    """A function of the loop, and what it is compiled for."""

    function: Callable | None       # None where it is compiled with what calls it alone
    arguments: str                  # names in `examples`
    seconds: float                  # of one processor, on its own
    after: tuple[str, ...] = ()     # parts it calls, or takes most of
    compile: Callable = way().compile_for


_callee = way().part_of_callers
LOOP = {        # callees of the loop, which waits for them
    "forces in the loop": Part(_callee(evaluate.assemble), "whole whole system state vector", 0.6),
    "output": Part(_callee(step_control.write_between), "system state record whole", 1.2),
    "correction": Part(_callee(newton.correct), "system state scheme flag whole flag", 1.1),
    "evaluation": Part(_callee(iteration.run_wanted), "system state nobody flag flag flag", 0.8,
                       ("forces in the loop",)),
    "works": Part(_callee(iteration.guard_works), "system state nobody flag", 1.0),
    "acceptance": Part(_callee(step.accept), "system state record", 0.7),
    "solution": Part(_callee(matrix.solve), "system state flag", 0.5),
    "beginning": Part(_callee(step.begin_step), "system state scheme", 0.7),
    "choice": Part(_callee(step_control.choose_step), "system state", 0.1),
}
PARTS = {name: part for name, part in LOOP.items() if part.function} | {
    "loop": Part(loop.advance, "system state record scheme whole whole flag", 3.6, tuple(LOOP)),
    "sums": Part(matrix.sum_matrices, "system state vector flag", 1.4),
    "matrix": Part(matrix.refactorize, "system state whole flag", 3.4, ("sums",), compile_routine),
    "restart": Part(restart.restart, "system state number flag", 2.0, ("solution",),
                    compile_routine),
    "forces": Part(evaluate.assemble, "whole whole system state vector", 0.3,
                   ("forces in the loop",)),
    "constraints": Part(postprocessing._evaluate_constraints, "system state table table", 0.6,
                        ("forces in the loop",)),
    "energies": Part(postprocessing._evaluate_energies, "system state table table", 0.3,
                     ("forces in the loop",)),
    "reactions": Part(postprocessing._evaluate_forces, "system state table table table", 0.4,
                      ("forces in the loop",)),
    "loads": Part(evaluate.set_loads, "system vector vector number", 0.3),
    "motions": Part(evaluate.move_prescribed, "system state", 0.2),
    "links": Part(links.place_dependent, "links vector vector vector vector vector", 0.3),
    "axes": Part(evaluate.to_body_axes, "system vector vector flag", 0.2),
    "movements": Part(motion._evaluate, "whole whole whole indices vector table places vector "
                      "vector movements", 0.3),
    "records": Part(step.write_record, "state record", 0.1),
}


def prepare(models: Iterable[Mechanism]) -> None:
    """Compile what runs of models need and the cache lacks; a line says so."""
    models = list(models)
    for model in models:
        check_joints(model)
    bodies = [body for model in models for body in model.bodies.values()]
    kernels = {body.kernel for body in bodies} | {motion_kernel(body) for body in bodies}
    kernels |= {element_kernel_name(e.kind) for model in models
                for e in (*model.rigid_bodies.values(), *model.constraints, *model.loads)}
    together = kernels_together(models)
    if not _ready.issuperset({*kernels, *PARTS, *map(_of_eight, together)}):
        compile_missing(kernels, PARTS, together=together)


def compile_missing(kernels: Iterable[str], parts: Iterable[str] = (),
                    report: Callable[[str, float], None] | None = None,
                    together: Collection[str] = ()) -> None:
    """Compile kernels and parts of the loop by name, where the cache lacks them.

    Parameters
    ----------
    report : callable, optional
        Called with the name of everything that was compiled and the seconds it took.
    together : collection of str
        Kernels that are compiled for eight bodies at a time, too.
    """
    with _lock:
        kernels = {name: path for name in sorted(set(kernels) - _ready) if (path := _file(name))}
        missing = {name: path for name, path in kernels.items() if not is_compiled(path)}
        lacking = [name for name in parts
                   if name not in _ready and not way().is_compiled(PARTS[name].function)]
        of_eight = {name: path for name in sorted(together) if _of_eight(name) not in _ready
                    and (path := _file(name)) and not is_compiled_together(path)}
        _ready.update(kernels, parts, map(_of_eight, together))
        count = len(missing) + len(of_eight)
        what = ["the time loop"] * bool(lacking)
        what += [f"{count} kernel{'s' * (count > 1)}"] * bool(count)
        jobs = _jobs(missing, lacking) + [
            Job(Task(_of_eight(name), "sebody.assembly.equal_bodies:compile_together", (name,),
                     (name,)), OF_EIGHT * _seconds(path)) for name, path in of_eight.items()]
        compile_apart(jobs, " and ".join(what), Path(loop.__file__), report)


def compile_of_eight(kernels: Iterable[str]) -> None:
    """Compile kernels for eight bodies here, or find them in the cache."""
    for name in kernels:
        compile_together(name)


def of_bodies(kernels: Iterable[str]) -> list[str]:
    """Those of some kernels that can be compiled for eight bodies at a time."""
    return [name for name in kernels if name.startswith(SUPERELEMENT)] if lanes_exist() else []


def _of_eight(kernel: str) -> str:
    return f"{kernel} for eight bodies"


def _jobs(kernels: dict[str, Path], parts: list[str]) -> list[Job]:
    return [*(Job(Task(name, f"{__name__}:compile_part", (name,), PARTS[name].after),
                  PARTS[name].seconds) for name in parts),
            *(Job(Task(name, "sebody.kernels.loader:load", (name,)), _seconds(path))
              for name, path in kernels.items())]


def compile_part(name: str) -> None:
    """Compile a part of the loop here, or find it in the cache."""
    part = PARTS[name]
    part.compile(part.function, tuple(examples()[name] for name in part.arguments.split()))


def smallest() -> tuple[System, State]:
    """Arrays of a model that compiles next to nothing; their types are those of every model."""
    model = Model(planar=True)
    model.node("point", (0.0, 0.0))
    model.rigid_body("mass", "point", 1.0, 1.0)
    system, numbering = build(model)
    return system, allocate(model, system, numbering, 1.0, True)


@cache
def examples() -> dict:
    """Types of arguments, by the names in `PARTS`."""
    system, state = smallest()
    parts = {"system": system, "state": state, "record": Record.of(state, 1), "links": system.links,
             "scheme": generalized_alpha(), "vector": state.residual, "table": state.inverse,
             "movements": np.zeros((1, 1, 1)), "indices": np.zeros((1, 1), dtype=np.int64),
             "places": np.zeros(1, dtype=np.int64), "whole": 1, "number": 1.0, "flag": True,
             "nobody": None}
    return {name: typeof(value) for name, value in parts.items()}


def _file(name: str) -> Path | None:
    if name in BY_HAND:
        return Path(loader.__file__).with_name(BY_HAND[name].rpartition(".")[2] + ".py")
    return find(name)


def _seconds(path: Path) -> float:
    return SECONDS_A_LETTER * path.stat().st_size
