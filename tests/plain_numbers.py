"""Numbers of kernels and of runs, with the way of compiling that this process has.

``python tests/plain_numbers.py FILE.npz NAME...`` keeps those of kernels and scenes by name.
"""

import os
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
from readings import TABLE

from sebody import Model, simulate
from sebody.compiler.choice import VARIABLE, way
from sebody.contract.layout import ACCELERATION, ENERGY, RESIDUAL, TANGENT, VELOCITY
from sebody.contract.names import PREFIXES, SUPERELEMENT
from sebody.kernels.loader import load
from sebody.runs.first_run import prepare
from sebody.verify.bench.own import cases
from sebody.verify.check.elements import element_case
from sebody.verify.check.states import arguments, called
from sebody.verify.check.superelement_cases import superelement_case

FACTORS = (0.7, 0.4, 1.3, 1.0, 0.9)     # of the parts of a matrix, all different
STEPS = 40
FUNCTIONS = "functions"                 # a model with functions of users


def of_kernel(name: str) -> dict[str, np.ndarray]:
    """What a kernel writes in two seeded states, in all tasks, over the largest of each."""
    module, found = load(name), {}
    case_of = superelement_case if name.startswith(SUPERELEMENT) else element_case
    for seed in (0, 1):
        case = case_of(module, seed)
        for task in (RESIDUAL, TANGENT, ENERGY, VELOCITY, ACCELERATION):
            given = arguments(case, FACTORS)
            status = called(case, task, given)
            for field in ("forces", "matrices", "energies"):
                values = np.append(getattr(given, field), status)
                found[f"{name} {seed} {task} {field}"] = values / max(np.abs(values).max(), 1.0)
    return found


def of_scene(name: str) -> dict[str, np.ndarray]:
    """Positions of nodes in short runs of the cases of a scene, or of a model, over the largest."""
    if name in TABLE:
        return _of_run(name, TABLE[name].build(), TABLE[name].h)
    found = {}
    for case in cases(name)[:2]:
        scene = case.build()
        prepare([scene.model])
        found |= _of_run(f"{name} {case.variant}", scene.model, scene.h)
    return found


def of_functions() -> dict[str, np.ndarray]:
    """A run with a load and a force that are functions of Python; the load fails in the end."""
    model = Model(planar=True)
    node = model.node("weight", (1.0, 0.0))
    model.rigid_body("weight", node, 2.0, 0.1)

    def load(t):
        return 3.0 * np.sin(9.0 * t) / (1.0 - t)

    def pull(t, x, v, force):
        force[0], force[1] = -40.0 * (x[0] - 1.0) - v[0], -20.0 * x[1] ** 3 + t
    model.force(node, (0.6, 0.8), load)
    model.user_force("pull", [node], pull)
    return _of_run(FUNCTIONS, model, 5e-3)


def _of_run(name: str, model: Model, h: float) -> dict[str, np.ndarray]:
    result = simulate(model, h, STEPS * h)
    positions = [result[other] for other in result.names() if other.endswith(".position")]
    size = max(np.abs(values).max() for values in positions)
    values = np.concatenate([values.ravel() for values in positions])
    return {f"{name} positions": values / size}


def compared(folder: Path, *names: str) -> tuple[dict[str, float], dict[str, float]]:
    """Largest differences between the two ways, by what is compared, and seconds of each way."""
    files, seconds = {}, {}
    for plain in ("0", "1"):
        path, began = folder / f"{plain}.npz", time.perf_counter()
        subprocess.run([sys.executable, __file__, path, *names], check=True,
                       env={**os.environ, VARIABLE: plain})
        seconds[plain] = time.perf_counter() - began
        files[plain] = np.load(path)
    a, b = files["0"], files["1"]
    assert set(a) == set(b) and (a["way"], b["way"]) == ("entry", "plain")
    return {key: float(np.abs(a[key] - b[key]).max()) for key in a if key != "way"}, seconds


def main(path: str, *names: str) -> None:
    """Keep the numbers."""
    found = {"way": np.array(way().__name__.rpartition(".")[2])}
    for name in names:
        found |= (of_functions() if name == FUNCTIONS else
                  of_kernel(name) if name.startswith(PREFIXES) else of_scene(name))
    np.savez(path, **found)


if __name__ == "__main__":
    main(*sys.argv[1:])
