"""What a sweep costs beside its runs: tasks of a cluster, models built anew.

    python tests/benchmarks/bench_sweep.py [--json]
"""

import argparse
import json
import pickle
import time
from collections.abc import Sequence

import numpy as np

from sebody import Model
from sebody.analysis import final
from sebody.explore.sweep import batches, executors as places
from sebody.explore.sweep.design import design
from sebody.explore.sweep.variations import Distribution
from sebody.scenes.scene import Scene

MEMBERS, TASKS = 100, 200
OUTPUTS = (("tip", final("tip.position")),)


def build(length: float = 1.0) -> Scene:
    """A mass on a spring: a step takes a fraction of a microsecond."""
    model = Model(planar=True)
    anchor, tip = model.node("anchor", (0.0, 0.0)), model.node("tip", (length, 0.5))
    model.fix(anchor)
    model.rigid_body("bob", tip, 2.0, 0.3)
    model.spring(tip, anchor, stiffness=80.0, name="spring")
    return Scene("spring", "a mass on a spring", model, h=0.01, t_end=0.1, base="anchor")


def tasks(count: int) -> list[list[batches.Batch]]:
    """Tasks of a hundred runs that differ in the spring's stiffness."""
    made = design({}, {"spring.stiffness": Distribution("uniform", (50.0, 120.0))},
                         count * MEMBERS, 1)
    return batches.tasks_of(batches.Plan("spring", build, (), OUTPUTS), made.columns, set(),
                            np.arange(made.runs), MEMBERS)


def cluster(count: int) -> dict[str, float]:
    """Milliseconds a task beside its runs on two workers, and bytes each way."""
    todo = tasks(count)
    alone = time.perf_counter()
    for task in todo[:20]:
        answers = batches.run_task(task)
    alone = (time.perf_counter() - alone) / 20
    with places.cluster(None, 2) as run:
        list(run(iter(todo[:4])))
        began = time.perf_counter()
        list(run(iter(todo)))
        each = (time.perf_counter() - began) / count
    return {"task": 1e3 * alone, "beside it on two workers": 1e3 * max(each - alone / 2, 0.0),
            "bytes sent": len(pickle.dumps(todo[0])), "bytes back": len(pickle.dumps(answers))}


def structures(count: int) -> dict[str, float]:
    """Milliseconds a run that builds its model anew, and of these what the model itself takes."""
    lengths = {"length": np.linspace(1.0, 2.0, count).astype(object)}
    todo = batches.tasks_of(batches.Plan("lengths", build, (), OUTPUTS), lengths, {"length"},
                            np.arange(count), count)
    batches.run_task(todo[0][:1])
    began = time.perf_counter()
    for k in range(count):
        build(1.0 + k / count)
    models = (time.perf_counter() - began) / count
    began = time.perf_counter()
    for task in todo:
        batches.run_task(task)
    return {"run": 1e3 * (time.perf_counter() - began) / count, "of it the model": 1e3 * models}


def main(arguments: Sequence[str] | None = None, count: int = TASKS) -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args(arguments)
    found = {"structures, ms": structures(5 * count), "tasks, ms": cluster(count)}
    if options.json:
        print(json.dumps(found))
        return
    for what, numbers in found.items():
        for name, value in numbers.items():
            print(f"{what:16} {name:28} {value:10.3f}")


if __name__ == "__main__":
    main()
