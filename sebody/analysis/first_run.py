"""What a first run compiles: the kernels of its models and the time loop, side by side.

The parts of the loop are compiled for the types of a small model's arrays, which are those of
every model. Kernels are known by name. Nothing is said or done where all is in the cache.
"""

import sys
import time
from collections.abc import Callable, Iterable
from functools import cache
from pathlib import Path
from threading import Lock
from typing import NamedTuple

import numpy as np
from numba import typeof

from sebody.analysis import workers
from sebody.analysis.allocation import allocate
from sebody.analysis.schemes import generalized_alpha
from sebody.analysis.workers import Task
from sebody.assembly.build import build
from sebody.assembly.motions import motion_kernel
from sebody.engine import evaluate, links, loop, matrix, newton, restart, step, step_control
from sebody.engine.state import Record
from sebody.kernels import loader, store
from sebody.kernels.loader import USER_FORCE, element_kernel_name, find
from sebody.kernels.pipeline import is_compiled
from sebody.model.mechanism import Mechanism
from sebody.model.model import Model
from sebody.results import motion, postprocessing

SECONDS_A_LETTER = 7e-5         # of a kernel's file, of one processor
WORTH_IT = 4.0                  # seconds of compiling: starting processes takes one or two

_lock = Lock()
_ready = set()          # kernels and parts of the loop this process need not ask for again


class Part(NamedTuple):
    """A function of the loop, and what it is compiled for."""

    function: Callable
    arguments: str                  # names in `_examples`
    seconds: float                  # of one processor, on its own
    after: tuple[str, ...] = ()     # parts it calls, or takes most of


LOOP = {        # callees of the loop, which waits for them
    "forces in the loop": Part(evaluate.assemble.callee, "whole whole system state vector", 0.6),
    "output": Part(step_control.write_between.callee, "system state record whole", 1.2),
    "correction": Part(newton.apply_correction.callee, "system state scheme flag", 1.1),
    "evaluation": Part(loop._evaluate.callee, "system state scheme whole flag", 0.8,
                       ("forces in the loop",)),
    "conclusion": Part(loop._conclude.callee, "system state record scheme whole", 1.4),
    "solution": Part(matrix.solve.callee, "system state flag", 0.5),
    "beginning": Part(step.begin_step.callee, "system state scheme", 0.7),
    "choice": Part(step_control.choose_step.callee, "system state", 0.1),
}
PARTS = LOOP | {
    "loop": Part(loop.advance, "system state record scheme whole whole flag", 3.6, tuple(LOOP)),
    "sums": Part(matrix.sum_matrices, "system state vector", 1.4),
    "matrix": Part(matrix.refactorize, "system state whole flag", 3.4, ("sums",)),
    "restart": Part(restart.restart, "system state number flag", 2.0, ("solution",)),
    "forces": Part(evaluate.assemble, "whole whole system state vector", 0.3,
                   ("forces in the loop",)),
    "constraints": Part(postprocessing._evaluate_constraints, "system state table table", 0.6,
                        ("forces in the loop",)),
    "energies": Part(postprocessing._evaluate_energies, "system state table table", 0.3,
                     ("forces in the loop",)),
    "reactions": Part(postprocessing._evaluate_forces, "system state table table table", 0.4,
                      ("forces in the loop",)),
    "loads": Part(evaluate.set_loads, "system vector number", 0.3),
    "motions": Part(evaluate.move_prescribed, "system state", 0.2),
    "links": Part(links.place_dependent, "links vector vector vector vector", 0.3),
    "axes": Part(evaluate.to_body_axes, "system vector vector flag", 0.2),
    "movements": Part(motion._evaluate, "whole whole whole indices vector table places vector "
                      "vector movements", 0.3),
    "records": Part(step.write_record, "state record", 0.1),
}


def prepare(models: Iterable[Mechanism]) -> None:
    """Compile what runs of models need and the cache lacks; a line says so."""
    models = list(models)
    bodies = [body for model in models for body in model.bodies.values()]
    kernels = {body.kernel for body in bodies} | {motion_kernel(body) for body in bodies}
    kernels |= {element_kernel_name(e.kind) for model in models
                for e in (*model.rigid_bodies.values(), *model.constraints, *model.loads)}
    if not _ready.issuperset(kernels) or not _ready.issuperset(PARTS):
        compile_missing(kernels, PARTS)


def compile_missing(kernels: Iterable[str], parts: Iterable[str] = (),
                    report: Callable[[str, float], None] | None = None) -> None:
    """Compile kernels and parts of the loop by name, where the cache lacks them.

    Parameters
    ----------
    report : callable, optional
        Called with the name of everything that was compiled and the seconds it took.
    """
    with _lock:
        kernels = {name: path for name in sorted(set(kernels) - _ready) if (path := _file(name))}
        missing = {name: path for name, path in kernels.items() if not is_compiled(path)}
        lacking = [name for name in parts
                   if name not in _ready and not PARTS[name].function._cache.holds_any()]
        _ready.update(kernels, parts)
        seconds = (sum(map(_seconds, missing.values()))
                   + sum(PARTS[name].seconds for name in lacking))
        if (missing or lacking) and seconds >= WORTH_IT:
            _compile(missing, lacking, seconds, report)


def _compile(kernels: dict[str, Path], parts: list[str], seconds: float,
             report: Callable[[str, float], None] | None) -> None:
    what = [f"{len(kernels)} kernel{'s' * (len(kernels) > 1)}"] if kernels else []
    what = " and ".join([*["the time loop"] * bool(parts), *what])
    if not store.writable(Path(loop.__file__)):
        print(f"compiling {what}, about {seconds:.0f} s, at every start: "
              f"{store.not_writable(Path(loop.__file__))}", file=sys.stderr, flush=True)
        return
    seconds /= workers.PROCESSES
    print(f"first run: compiling {what} in {workers.PROCESSES} processes, about {seconds:.0f} s",
          file=sys.stderr, flush=True)
    began = time.perf_counter()
    tasks = [*(Task(name, f"{__name__}:compile_part", (name,), PARTS[name].after)
               for name in parts),
             *(Task(name, "sebody.kernels.loader:load", (name,)) for name in kernels)]
    left = {name: _seconds(path) for name, path in kernels.items()} | _chains(parts)
    workers.call_all(sorted(tasks, key=lambda task: -left[task.name]), report)
    print(f"compiled in {time.perf_counter() - began:.0f} s; later runs find it in the cache",
          file=sys.stderr, flush=True)


def _chains(parts: list[str]) -> dict[str, float]:
    """Seconds from the beginning of each part to the end of what waits for it."""
    found: dict[str, float] = {}
    for name in reversed(PARTS):        # what waits for a part comes after it
        found[name] = PARTS[name].seconds + max(
            (found[other] for other in found if name in PARTS[other].after), default=0.0)
    return {name: found[name] for name in parts}


def compile_part(name: str) -> None:
    """Compile a part of the loop here, or find it in the cache."""
    function, arguments, _, _ = PARTS[name]
    function.compile(tuple(_examples()[name] for name in arguments.split()))


@cache
def _examples() -> dict:
    """Types of arguments, by the names in `PARTS`: from a model that compiles next to nothing."""
    model = Model(planar=True)
    model.node("point", (0.0, 0.0))
    model.rigid_body("mass", "point", 1.0, 1.0)
    system, numbering = build(model)
    state = allocate(model, system, numbering, 1.0, True)
    found = {"system": system, "state": state, "record": Record.of(state, 1), "links": system.links,
             "scheme": generalized_alpha(), "vector": state.residual, "table": state.inverse,
             "movements": np.zeros((1, 1, 1)), "indices": np.zeros((1, 1), dtype=np.int64),
             "places": np.zeros(1, dtype=np.int64), "whole": 1, "number": 1.0, "flag": True}
    return {name: typeof(value) for name, value in found.items()}


def _file(name: str) -> Path | None:
    if name == USER_FORCE:
        return Path(loader.__file__).with_name("user_force.py")
    return find(name)


def _seconds(path: Path) -> float:
    return SECONDS_A_LETTER * path.stat().st_size
