"""Gains of specialised kernels and of planar layouts, as ratios measured in one run.

    python tests/benchmarks/bench_kernels.py [--json]

A general kernel reads the counts of nodes at run time; a specialised one has them as constants.
"""

import argparse
import json
import time
from statistics import median

from sebody import simulate
from sebody.compiler.decorators import compiled
from sebody.contract.layout import RESIDUAL, TANGENT
from sebody.contract.names import general_layout, superelement_name
from sebody.kernels.abi import call_kernel
from sebody.kernels.loader import load
from sebody.scenes import hinged_beam, planar_hinged_beam
from sebody.verify.check.states import arguments, difference, evaluate
from sebody.verify.check.superelement_cases import superelement_case
from sebody.verify.references import tip_error

KERNELS = (("f2", "converged_mean"), ("f2t1", "converged_mean"), ("f2t1", "positions"),
           ("planar-f2", "converged_mean"))
ROUNDS = 15


@compiled
def repeat(times, address, task, stride, width, given):
    for _ in range(times):
        call_kernel(address, task, 1, stride, width, given)


def nanoseconds(cases, task, times):
    """Time of one evaluation of each case, the quietest of rounds in turn."""
    given, samples = [arguments(case) for case in cases], [[] for _ in cases]
    for _ in range(ROUNDS):
        for case, arrays, sample in zip(cases, given, samples, strict=True):
            began = time.perf_counter()
            repeat(times, case.module.kernel.address, task, len(case.index), case.n, arrays)
            sample.append((time.perf_counter() - began) / times * 1e9)
    return [min(sample) for sample in samples]


def compare(layout, frame, times=5000):
    """Residual and matrix of a specialised kernel and of the general one: nanoseconds, two pairs.

    Raises
    ------
    ValueError
        They compute different things.
    """
    special = load(superelement_name(layout, frame, "material"))
    general = load(superelement_name(general_layout(layout), frame, "material"))
    case = superelement_case(special, 0)
    cases = case, case._replace(module=general)
    for one, same in zip(*(evaluate(c, TANGENT) for c in cases), strict=True):
        if difference(same, one) > 1e-12:
            raise ValueError(f"the general kernel of {layout} computes something else")
    return [t for task, count in ((RESIDUAL, times), (TANGENT, times // 10))
            for t in nanoseconds(cases, task, count)]


def step_times(t_end=30.0, runs=7):
    """Microseconds a step of the hinged beam, spatial and planar, and their tip errors."""
    for name, scene in (("spatial", hinged_beam), ("planar", planar_hinged_beam)):
        results = [simulate(scene.build().model, 0.01, t_end) for _ in range(runs)]
        error = tip_error("hinged_beam", results[0].t, results[0]["tip.position"])
        yield name, median(r.microseconds_per_step for r in results), error, results[0]


def main(arguments=None):
    """Print both tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--json", action="store_true", help="the first table, for programs")
    as_json = parser.parse_args(arguments).json
    rows = {f"{layout}:{frame}": compare(layout, frame) for layout, frame in KERNELS}
    if as_json:
        names = "residual", "residual_general", "matrix", "matrix_general"
        print(json.dumps({key: dict(zip(names, row, strict=True)) for key, row in rows.items()}))
        return
    print(f"{'kernel':26} {'residual ns':>12} {'general':>9} {'ratio':>6}   "
          f"{'matrix ns':>10} {'general':>9} {'ratio':>6}")
    for key, row in rows.items():
        print(f"{key:26} {row[0]:12.0f} {row[1]:9.0f} {row[1] / row[0]:6.2f}   "
              f"{row[2]:10.0f} {row[3]:9.0f} {row[3] / row[2]:6.2f}")
    times = {}
    for name, us, error, run in step_times():
        times[name] = us
        print(f"hinged beam, {name:8} {run.numbering.free:3d} unknowns {us:6.2f} us a step, "
              f"{run.iterations_per_step:.2f} iterations, tip error {error:.2e}")
    print(f"spatial / planar: {times['spatial'] / times['planar']:.2f}")


if __name__ == "__main__":
    main()
