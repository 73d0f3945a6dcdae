"""Everyday mechanisms with redundant joints: does each run in every position, and what it costs.

    python tests/benchmarks/bench_everyday.py [--json]

Runs of 2 s with h = 0.01, in plain axes, turned by 30 degrees about x, turned at random, and turned
in mm and t, with parts created in the other order. The models are those of `tests/everyday.py`.
"""

import argparse
import json
import sys
import warnings
from pathlib import Path

import numpy as np

from sebody import InputError, Model, Simulation, SimulationError

sys.path.insert(0, str(Path(__file__).parents[1]))
from everyday import MODELS, Place

H, T_END, TIMES = 0.01, 2.0, 20
PLACES = {"plain": Place(),
          "30 deg": Place(np.array([[1, 0, 0], [0, np.sqrt(0.75), -0.5], [0, 0.5, np.sqrt(0.75)]])),
          "random": Place.at_random(1),
          "mm, t": Place.at_random(2, length=1e3, mass=1e-3, backwards=True)}


def measured(model: Model, times: int) -> dict[str, float | str]:
    """Iterations and microseconds a step, the quickest of several runs, or why there is no run."""
    quickest, found = np.inf, {}
    for _ in range(times):
        try:
            result = Simulation(model, H).run_to(T_END).result()
        except InputError:
            return {"failure": "refused"}
        except SimulationError as error:
            return {"failure": f"stops at {error.result.t[-1]:.3g}"}
        quickest = min(quickest, result.microseconds_per_step)
        found = {"unknowns": result.numbering.free, "iterations": result.iterations_per_step,
                 "matrices": result.matrices, "cuts": result.cuts, "microseconds": quickest,
                 "balance": result.energy_balance()}
    return found


def main(arguments: list[str] | None = None, times: int = TIMES) -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--json", action="store_true", help="numbers by model and place")
    as_json = parser.parse_args(arguments).json
    warnings.simplefilter("ignore")
    found = {}
    for name, (make, _) in MODELS.items():
        found[name] = {place: measured(make(where), times) for place, where in PLACES.items()}
        if not as_json:
            print(f"{name:16}" + "".join(f"{_cell(one):>22}" for one in found[name].values()),
                  flush=True)
    if as_json:
        print(json.dumps(found))


def _cell(one: dict) -> str:
    if "failure" in one:
        return one["failure"]
    return f"{one['iterations']:.2f} it., {one['microseconds']:.1f} us"


if __name__ == "__main__":
    main()
