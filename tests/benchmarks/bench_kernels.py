"""Gains of specialised kernels and of planar layouts, as ratios measured in one run.

    python tests/benchmarks/bench_kernels.py

The generic kernel is the same text with the counts of triplets read at run time.
"""

import importlib.util
import statistics
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from numba import njit

from sebody import simulate
from sebody.kernels.abi import ENERGIES, call_kernel, padded
from sebody.kernels.layout import RESIDUAL, TANGENT
from sebody.kernels.loader import load
from sebody.scenes import hinged_beam, planar_hinged_beam
from sebody.studies.check import superelements

LAYOUTS = ("f2_converged_mean_b", "f2t1_converged_mean_b", "t8_positions_b",
           "planar_f2_converged_mean_b")


@njit(cache=True)
def repeat(times, address, task, stride, width, index, constants, q, R, v, a, reference, frames,
           T, loads, coefficients, g, J, work, energy):
    for _ in range(times):
        call_kernel(address, task, 1, stride, width, (
            index, constants, q, R, v, a, reference, frames, T, loads, coefficients, g, J, work,
            energy))


def nanoseconds(module, case, task, times=20000):
    """Time of one evaluation, median of seven."""
    n, counts = case.n, [module.N_POSITIONS, module.N_ROTATIONS, module.ROTATIONS, module.MODES]
    work = np.zeros(module.WORK_ROWS * padded(max(n, 9 * max(module.N_ROTATIONS, 1))))
    T = np.tile(np.eye(3).ravel(), max(module.N_ROTATIONS, 1))
    samples = []
    for _ in range(7):
        began = time.perf_counter()
        repeat(times, module.kernel.address, task, len(case.index), n, case.index,
               case.constants, case.q, case.R, case.v, case.a, case.reference,
               case.frames.copy(), T, np.array(counts, dtype=float), np.ones(8), np.zeros(n),
               np.zeros(n * n), work, np.zeros(ENERGIES))
        samples.append((time.perf_counter() - began) / times * 1e9)
    return statistics.median(samples)


def generic(module, folder):
    """The kernel's text with the counts read at run time."""
    text = Path(module.__file__).read_text().replace("    n = width\n", (
        "    n = width\n"
        "    N_POSITIONS, N_ROTATIONS = int(loads[0]), int(loads[1])\n"
        "    ROTATIONS, MODES = int(loads[2]), int(loads[3])\n"))
    path = Path(folder) / (module.__name__.rpartition(".")[2] + "_generic.py")
    path.write_text(text)
    spec = importlib.util.spec_from_file_location(path.stem, path)
    made = importlib.util.module_from_spec(spec)
    sys.modules[path.stem] = made
    spec.loader.exec_module(made)
    return made


def step_times():
    """Microseconds a step of the hinged beam, spatial and planar, and their tip errors."""
    reference = np.load(Path(__file__).parents[1] / "data" / "hinged_beam.npz")["tip_position"]
    for name, scene in (("spatial", hinged_beam), ("planar", planar_hinged_beam)):
        runs = [simulate(scene.build().model, 0.01, 30.0) for _ in range(7)]
        tip = runs[0]["tip.position"]
        exact = reference[:, :tip.shape[1]]
        error = np.linalg.norm(tip - exact) / np.linalg.norm(exact)
        yield name, statistics.median(r.microseconds_per_step for r in runs), error, runs[0]


def main():
    """Print both tables."""
    print(f"{'kernel':30} {'residual ns':>12} {'generic':>9} {'ratio':>6}   "
          f"{'matrix ns':>10} {'generic':>9} {'ratio':>6}")
    with tempfile.TemporaryDirectory() as folder:
        for name in LAYOUTS:
            module = load("superelement_" + name)
            other, case = generic(module, folder), superelements.superelement_case(module, 0)
            row = [nanoseconds(m, case, task, times) for task, times in (
                (RESIDUAL, 20000), (TANGENT, 2000)) for m in (module, other)]
            print(f"{name:30} {row[0]:12.0f} {row[1]:9.0f} {row[1] / row[0]:6.2f}   "
                  f"{row[2]:10.0f} {row[3]:9.0f} {row[3] / row[2]:6.2f}")
    times = {}
    for name, us, error, run in step_times():
        times[name] = us
        print(f"hinged beam, {name:8} {run.numbering.free:3d} unknowns {us:6.2f} us a step, "
              f"{run.iterations_per_step:.2f} iterations, tip error {error:.2e}")
    print(f"spatial / planar: {times['spatial'] / times['planar']:.2f}")


if __name__ == "__main__":
    main()
