"""What leaving weak stress resultants out of bodies with many interfaces changes, and saves.

    python tests/benchmarks/bench_resultants.py [--json] [--times N]

Frames in space, a plate and a block with five or six interfaces and 40 modes, turned. Errors are
those of six frequencies, and of the motion, beside the same body with all its resultants: under 16
spins about random axes and 16 forces or moments, with one or two interfaces held, that move the
body by a tenth of its size. Cost is that of a residual beside option B's in one run.
"""

import argparse
import json
import sys
from pathlib import Path

import numpy as np
from bench_inertia import arguments, nanoseconds

from sebody import Model, Simulation
from sebody.contract.layout import RESIDUAL

sys.path.insert(0, str(Path(__file__).parents[1]))
from many_interfaces import (
    cases,
    errors,
    patched_block,
    random_star,
    ring,
    star,
    with_all,
    without_any,
)

BODIES = {
    "star of five arms": (star, (40,), {}),
    "another": (random_star, (40, 3), {}),
    "soft along its arms": (random_star, (40, 4), {"axial": 3e3}),
    "of flat arms, 1 : 48": (random_star, (40, 5), {"bending": 48.0}),
    "of six arms": (random_star, (40, 6, 6), {}),
    "ring, six interfaces": (ring, (40,), {}),
    "plate, five patches": (patched_block, (40, 0.02, 1), {}),
    "block, five patches": (patched_block, (40, 0.3, 2), {}),
}
SAMPLES = 20


def simulation(body, option):
    """A body that flies with random rates."""
    model = Model()
    nodes = [model.node(f"n{k}", point) for k, point in enumerate(body.coordinates)]
    model.superelement("body", body, nodes, **option)
    run, random = Simulation(model, 0.01), np.random.default_rng(0)
    for row in (run.state.v, run.state.a):
        row[:] = random.normal(size=len(row))
    return run


def cost(bodies, times):
    """Residuals of the bodies over that of the first one with option B."""
    runs = [simulation(bodies[0], {"inertia": "material"}),
            *(simulation(body, {}) for body in bodies)]
    given = [arguments(run) for run in runs]
    # many short samples: the quietest of them are those that nothing else ran beside
    spent = np.min([nanoseconds(given, RESIDUAL, times) for _ in range(SAMPLES)], axis=0)
    return [one / spent[0] for one in spent[1:]]


def measure(name, times):
    """Numbers of one body."""
    make, given, options = BODIES[name]
    body, whole = make(*given, **options), with_all(make, *given, **options)
    bare, loads = without_any(body), cases(whole, 0)
    kept, none = errors(body, whole, loads), errors(bare, whole, loads)
    of_all, of_kept, of_none = cost([whole, body, bare], times)
    return {
        "coordinates": len(body.mass), "resultants": whole.invariants.resultants,
        "kept": body.invariants.resultants, "frequency, largest": kept[:, 0].max(),
        "frequency, median": np.median(kept[:, 0]), "motion, largest": kept[:, 1].max(),
        "motion, median": np.median(kept[:, 1]), "without any, largest": none[:, 0].max(),
        "without any, median": np.median(none[:, 0]), "cost of all": of_all,
        "cost of kept": of_kept, "cost of none": of_none}


def main(given=None):
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--json", action="store_true", help="for programs")
    parser.add_argument("--times", type=int, default=20, help="evaluations in a sample")
    chosen = parser.parse_args(given)
    rows = {name: measure(name, chosen.times) for name in BODIES}
    if chosen.json:
        print(json.dumps(rows))
        return
    print("| body | kept | frequency | motion | frequency without any | cost, all | kept | none |\n"
          "|---|---|---|---|---|---|---|---|")
    for name, row in rows.items():
        pairs = " | ".join(f"{row[f'{what}, largest']:.2g}, {row[f'{what}, median']:.2g}"
                           for what in ("frequency", "motion", "without any"))
        print(f"| {name} | {row['kept']} of {row['resultants']} | {pairs} | "
              + " | ".join(f"{row[f'cost of {one}']:.1f}" for one in ("all", "kept", "none"))
              + " |")


if __name__ == "__main__":
    main()
