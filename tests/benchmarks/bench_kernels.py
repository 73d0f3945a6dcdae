"""Gains of specialised kernels and of planar layouts, as ratios measured in one run.

    python tests/benchmarks/bench_kernels.py

The generic kernel is the same text with the counts of triplets read at run time.
"""

import importlib.util
import re
import statistics
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from sebody import simulate
from sebody.kernels.abi import call_kernel
from sebody.kernels.layout import RESIDUAL, TANGENT
from sebody.kernels.loader import load
from sebody.kernels.pipeline import compiled
from sebody.scenes import hinged_beam, planar_hinged_beam
from sebody.studies.check.states import arguments, difference, evaluate
from sebody.studies.check.superelements import superelement_case
from sebody.studies.references import tip_error

LAYOUTS = ("f2_converged_mean_b", "f2t1_converged_mean_b", "t8_positions_b",
           "planar_f2_converged_mean_b")
COUNTS = ("N_POSITIONS", "N_ROTATIONS", "ROTATIONS", "MODES")
BODY = "    n = width\n"        # the first line of a kernel's body


@compiled
def repeat(times, address, task, stride, width, given):
    for _ in range(times):
        call_kernel(address, task, 1, stride, width, given)


def nanoseconds(module, case, task, times):
    """Time of one evaluation, median of seven."""
    given, samples = arguments(case), []
    for _ in range(7):
        began = time.perf_counter()
        repeat(times, module.kernel.address, task, len(case.index), case.n, given)
        samples.append((time.perf_counter() - began) / times * 1e9)
    return statistics.median(samples)


def generic(module, folder):
    """The kernel's text with the counts read at run time, from the numbers of a load."""
    text = Path(module.__file__).read_text()
    for found in (text.count(BODY), *(len(re.findall(rf"^{name} = \d+ *(?:#.*)?$", text, re.M))
                                      for name in COUNTS)):
        if found != 1:
            raise ValueError(f"{module.__file__} is not written as expected: change `generic`")
    reads = "".join(f"    {name} = int(loads[{k}])\n" for k, name in enumerate(COUNTS))
    path = Path(folder) / (module.__name__.rpartition(".")[2] + "_generic.py")
    path.write_text(text.replace(BODY, BODY + reads))
    spec = importlib.util.spec_from_file_location(path.stem, path)
    made = importlib.util.module_from_spec(spec)
    sys.modules[path.stem] = made
    spec.loader.exec_module(made)
    return made


def compare(name, folder, times=20000):
    """Residual and matrix of a kernel and of its generic text: nanoseconds, two pairs."""
    module = load("superelement_" + name)
    case = superelement_case(module, 0)
    case = case._replace(loads=np.array([getattr(module, n) for n in COUNTS], dtype=float))
    other = generic(module, folder)
    for one, same in zip(evaluate(case, TANGENT), evaluate(case._replace(module=other), TANGENT),
                         strict=True):
        if difference(same, one) > 1e-12:
            raise ValueError(f"the generic text of {name} computes something else")
    return [nanoseconds(m, case, task, count) for task, count in (
        (RESIDUAL, times), (TANGENT, times // 10)) for m in (module, other)]


def step_times(t_end=30.0, runs=7):
    """Microseconds a step of the hinged beam, spatial and planar, and their tip errors."""
    for name, scene in (("spatial", hinged_beam), ("planar", planar_hinged_beam)):
        results = [simulate(scene.build().model, 0.01, t_end) for _ in range(runs)]
        error = tip_error("hinged_beam", results[0].t, results[0]["tip.position"])
        yield name, statistics.median(r.microseconds_per_step for r in results), error, results[0]


def main():
    """Print both tables."""
    print(f"{'kernel':30} {'residual ns':>12} {'generic':>9} {'ratio':>6}   "
          f"{'matrix ns':>10} {'generic':>9} {'ratio':>6}")
    with tempfile.TemporaryDirectory() as folder:
        for name in LAYOUTS:
            row = compare(name, folder)
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
