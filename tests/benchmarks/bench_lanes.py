"""Ensembles eight runs at a time against one by one, pair by pair in one process.

    python tests/benchmarks/bench_lanes.py [--json] [--runs N] [--pairs N] [SCENE ...]

CPU seconds of one thread, so that ratios hold on a busy machine; `wall` is that of all processors
together for hinged beams of 10 000 runs with ``--runs 10000``. `deviation` is the largest
difference of final positions, relative to the largest position.
"""

import argparse
import json
import resource
import statistics
import time
import warnings

import numpy as np

from sebody.analysis import Ensemble, final, maximum
from sebody.catalogue import builder
from sebody.explore.ensembles import choice, ensemble
from sebody.parameters.table import handle

STEPS = 300
SCENES = {      # name of a scene, options
    "hinged-beam": ("hinged-beam", {}),
    "hinged-beam, B": ("hinged-beam", {"inertia": "b"}),
    "hinged-beam, 12 modes": ("hinged-beam", {"modes": 12}),
    "planar-hinged-beam": ("planar-hinged-beam", {}),
    "spherical-beam": ("spherical-beam", {}),
    "slider-crank": ("slider-crank", {}),
    "four-bar": ("four-bar", {}),
    "squeezer": ("squeezer", {}),
    "heavy-top": ("heavy-top", {}),
    "torque-free-body": ("torque-free-body", {}),
    "chain, 3 links": ("chain", {"links": 3}),
    "chain, 5 links": ("chain", {"links": 5}),
    "chain, 16 links": ("chain", {"links": 16}),
    "hinged-beam, 32 modes": ("hinged-beam", {"modes": 32}),
    "right-angle-frame (best fit)": ("right-angle-frame", {}),
    "hinged-beam, mean axes": ("hinged-beam", {"frame": "mean_axes"}),
    "imported-link": ("imported-link", {}),
    "two-link-arm": ("two-link-arm", {}),
    "half-car": ("half-car", {}),
    "flexible-arm": ("flexible-arm", {}),
    "pole-on-cart": ("pole-on-cart", {})}
STEP = {"chain": 0.25}      # of a scene's own: members with rejected steps are run alone


def compared(name: str, runs: int, pairs: int) -> dict:
    """Median times of a member and step both ways, and how far they differ."""
    scene, options = SCENES[name]
    built = builder(scene)(**options)
    h = built.h * STEP.get(scene, 1.0)
    many = Ensemble(built.model, h)
    if reason := choice.why_one_by_one(many._template):
        return {"one by one": reason}
    parameters, t_end = varied(many, runs), STEPS * h
    outputs = {"end": final(f"{built.tip}.position"), "most": maximum(f"{built.tip}.velocity")}

    def timed(least: float) -> tuple:
        ensemble.WORTH_IT = least
        began = time.process_time()
        outcome = many.run(parameters, t_end, outputs, threads=1)
        return outcome, 1e6 * (time.process_time() - began) / (runs * STEPS)

    together, one_by_one, outcomes = [], [], []
    for pair in range(pairs + 1):           # the first compiles
        outcomes = []
        for least, times in ((0, together), (np.inf, one_by_one))[::1 if pair % 2 else -1]:
            outcome, us = timed(least)
            outcomes.append((least, outcome))
            if pair:
                times.append(us)
    here, there = (dict(outcomes)[least] for least in (0, np.inf))
    size = np.abs(there["end"]).max()
    return {"together": statistics.median(together), "one_by_one": statistics.median(one_by_one),
            "ratio": statistics.median(b / a for a, b in zip(together, one_by_one, strict=True)),
            "in_lanes": here.in_lanes / runs,
            "deviation": float(np.abs(here["end"] - there["end"]).max() / size)}


def varied(many: Ensemble, runs: int) -> dict[str, np.ndarray]:
    """Up to two parameters of a model, around their values."""
    rng, ending = np.random.default_rng(1), (".amplitude", ".stiffness")
    names = [name for name in many.parameters if name.endswith(ending)][:2]
    if not names or any(one.startswith("link 1") for one in names):     # links of a chain are equal
        names = ["gravity"]
    found = {}
    for name in names:
        base = np.asarray(handle(many.model, name).base)
        factors = rng.uniform(0.8, 1.2, runs)
        found[name] = np.multiply.outer(factors, base)
    return found


def all_processors(inertia: str | None, runs: int) -> dict[str, float]:
    """Wall seconds of hinged beams on all processors, with start and outputs; memory in MB."""
    built = builder("hinged-beam")(**({} if inertia is None else {"inertia": inertia}))
    many = Ensemble(built.model, built.h)
    parameters = varied(many, runs)
    outputs = {"tip": maximum("tip.position")}
    ensemble.WORTH_IT = 0
    many.run({name: values[:8] for name, values in parameters.items()}, 3.0, outputs)
    seconds = min(many.run(parameters, 3.0, outputs).seconds for _ in range(3))
    return {"wall": seconds, "mb": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024}


def main(given: list[str] | None = None) -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scenes", nargs="*")
    parser.add_argument("--runs", type=int, default=400)
    parser.add_argument("--pairs", type=int, default=5)
    parser.add_argument("--json", action="store_true", help="for programs")
    chosen = parser.parse_intermixed_args(given)
    warnings.simplefilter("ignore")         # of limits: scenes are what they are
    found = {name: lambda name=name: compared(name, chosen.runs, chosen.pairs)
             for name in chosen.scenes or SCENES}
    if chosen.runs >= 10_000:
        found = {f"all processors{name}": lambda inertia=inertia: all_processors(
            inertia, chosen.runs) for name, inertia in (("", None), (", B", "b"))}
    for name, measure in found.items():
        found[name] = measure()
        if not chosen.json:
            print(f"{name:24}", *(f"{key} {value:.4g}" if isinstance(value, float) else
                                  f"{key}: {value}" for key, value in found[name].items()),
                  flush=True)
    if chosen.json:
        print(json.dumps(found))


if __name__ == "__main__":
    main()
