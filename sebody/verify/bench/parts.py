"""Time of a step by its parts: each kind of element, the elimination, the rest.

Forces, matrices and the elimination are evaluated many times in the last state of a run, each kind
by itself. The rest of a step is what the loop does besides: prediction, rotations, sums, records.
"""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Iterator
from typing import NamedTuple

from sebody.assembly.batches import make_batches
from sebody.basics import tabular
from sebody.compiler.decorators import compiled
from sebody.contract.layout import RESIDUAL, TANGENT
from sebody.engine.evaluate import run_kernels
from sebody.engine.matrix import refactorize, solve as correction
from sebody.engine.state import EVALUATED
from sebody.runs.simulation import Simulation
from sebody.scenes.scene import Scene

RUNS = 7
ROUNDS, SECONDS = 7, 2e-3       # of each part: the quietest round counts


class Part(NamedTuple):
    """One part of a step."""

    name: str
    count: int              # elements or unknowns
    per_step: float         # evaluations a step
    microseconds: float     # of one evaluation of all of them

    @property
    def us_per_step(self) -> float:
        """Its share of a step [microseconds]."""
        return self.per_step * self.microseconds


class Cost(NamedTuple):
    """Cost of the steps of a scene."""

    scene: str
    unknowns: int
    h: float                # mean step
    steps: int
    us_per_step: float      # of the quietest run
    corrections: float      # a step
    matrices: float         # factorizations a step
    parts: tuple[Part, ...]

    @property
    def rest(self) -> float:
        """Time of a step that no part has [microseconds]."""
        return max(self.us_per_step - sum(part.us_per_step for part in self.parts), 0.0)

    def __str__(self) -> str:
        def row(name: str, count: object, per_step: str, each: str, own: float) -> tuple[str, ...]:
            share = 100.0 * own / self.us_per_step
            return name, str(count), per_step, each, f"{own:.3g}", f"{share:.0f} %"
        rows = [row(part.name, part.count, f"{part.per_step:.3g}", f"{part.microseconds:.3g}",
                    part.us_per_step) for part in self.parts]
        rows.append(row("the rest: loop, records", "", "", "", self.rest))
        title = (f"{self.scene}: {tabular.counted(self.unknowns, 'unknown')}, {self.steps} steps "
                 f"of {self.h:.4g}: {self.us_per_step:.4g} us a step, {self.corrections:.3g} "
                 f"corrections and {self.matrices:.3g} matrices a step")
        return tabular.text(title, ("part", "number", "times a step", "us each", "us a step",
                                    "share"), rows)

    def as_dict(self) -> dict:
        """For JSON."""
        return self._asdict() | {"rest_us_per_step": self.rest, "parts": [
            part._asdict() | {"us_per_step": part.us_per_step} for part in self.parts]}


def cost(scene: Scene) -> Cost:
    """Run a scene several times with its own step, then time the parts in its last state."""
    runs = [Simulation(scene.model, scene.h) for _ in range(RUNS)]
    results = [run.run_to(scene.t_end).result() for run in runs]
    run, last = runs[-1], results[-1]
    steps = max(last.steps, 1)
    return Cost(scene.name, last.numbering.free, float(last.t[-1] - last.t[0]) / steps, last.steps,
                min(one.microseconds_per_step for one in results),
                last.iterations_per_step, last.matrices / steps,
                tuple(_parts(run, last.iterations_per_step, last.matrices / steps)))


def _parts(run: Simulation, corrections: float, matrices: float) -> Iterator[Part]:
    system, state = run.system, run.state
    batches = make_batches(run.model, run.numbering).all
    names = [batch.kernel.__name__.rpartition(".")[2] for batch in batches]
    for task, what, times in ((RESIDUAL, "forces", corrections), (TANGENT, "matrices", matrices)):
        spent, elements = Counter(), Counter()
        for k, (name, batch) in enumerate(zip(names, batches, strict=True)):
            spent[name] += _quietest(_kernels, task, k, system, state)
            elements[name] += len(batch.owners)
        yield from (Part(f"{what} of {name}", elements[name], times, 1e6 * spent[name])
                    for name in spent)
    unknowns = run.numbering.free
    yield Part("sum of matrices, elimination", unknowns, matrices,
               1e6 * _quietest(_factors, system, state, run.dense))
    yield Part("correction from the factors", unknowns, corrections,
               1e6 * _quietest(_corrections, system, state, run.dense))


def _quietest(repeat, *arguments) -> float:
    """Time of one evaluation [s], the least of a few rounds."""
    times, least = 1, float("inf")
    repeat(1, *arguments)       # compiles
    while (spent := _timed(repeat, times, *arguments)) < SECONDS:
        times *= 4
    for _ in range(ROUNDS):
        least = min(least, _timed(repeat, times, *arguments))
    return min(least, spent) / times


def _timed(repeat, times: int, *arguments) -> float:
    began = time.perf_counter()
    repeat(times, *arguments)
    return time.perf_counter() - began


@compiled
def _kernels(times, task, batch, system, state):
    for _ in range(times):
        run_kernels(task, batch, batch + 1, system, state)


@compiled
def _factors(times, system, state, dense):
    for _ in range(times):
        refactorize(system, state, EVALUATED, dense)


@compiled
def _corrections(times, system, state, dense):
    for _ in range(times):
        correction(system, state, dense)
