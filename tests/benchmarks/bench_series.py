"""Series of loads on a foundation: 25 s of the OC4 jacket, by one element and by single loads.

    python tests/benchmarks/bench_series.py [--json] [--pairs N]

37 coordinates, 25 modes, full damping; 31 series of filtered noise at 0.05 s. Processor times of
whole runs, in turns, the best of all.
"""

import argparse
import json
import time

import numpy as np

from sebody import Model, simulate
from sebody.reduction import ReducedBody
from sebody.verify.outside.jacket import NAMES, body, jacket, loads

END, STEPS = 25.0, (0.05, 0.01)


def by_series() -> Model:
    """All columns in one element."""
    model = jacket()
    model.body_series("jacket", loads())
    return model


def single(count: int) -> Model:
    """The first columns as loads on the body."""
    series, held = loads(), body()
    n = len(held.mass)
    rows = [0, 1, 2, 6, 7, 8, *range(12, n)]
    held = ReducedBody(held.stiffness, held.mass, held.coordinates, held.keeps, held.modes,
                       held.damping, base=held.base,
                       loads=dict(zip(NAMES, np.eye(n)[rows], strict=True)))
    model = Model()
    model.foundation("jacket", held, model.node("interface", held.coordinates[0]))
    for name, column in list(zip(NAMES, series.values.T, strict=True))[:count]:
        model.body_load("jacket", name, np.column_stack([series.t, column]))
    return model


MODELS = {"no load": lambda: single(0), "one single load": lambda: single(1),
          "31 single loads": lambda: single(31), "one series of 31 columns": by_series}


def measure(pairs: int) -> list[dict]:
    """Best processor times of the models, for each step."""
    rows = []
    for h in STEPS:
        models = {name: make() for name, make in MODELS.items()}
        best = dict.fromkeys(models, np.inf)
        for model in models.values():
            simulate(model, h, END)
        for _ in range(pairs):
            for name, model in models.items():
                began = time.process_time()
                simulate(model, h, END)
                best[name] = min(best[name], time.process_time() - began)
        rows += [{"model": name, "h": h, "ms": 1e3 * value, "us a step": 1e6 * value * h / END}
                 for name, value in best.items()]
    return rows


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--pairs", type=int, default=5)
    options = parser.parse_args()
    found = measure(options.pairs)
    if options.json:
        print(json.dumps(found, indent=1))
    else:
        print("| model | h | ms | us a step |\n|---|---|---|---|")
        for row in found:
            print(f"| {row['model']} | {row['h']} | {row['ms']:.1f} | {row['us a step']:.1f} |")


if __name__ == "__main__":
    main()
