"""Newton's iteration of scenes: corrections and matrices a step, and what it leaves of the error.

    python tests/benchmarks/bench_iterations.py [--json] [--energy STEPS] [SCENE ...]

Counts are exact and do not depend on the machine. The deviation is that of coordinates and velocities from
a run with tolerance 1e-12, relative to the largest of each kind. With ``--energy`` three models
without damping run for so many steps with the trapezoidal rule (rho 1): energy then stays as it
was, but for what the iteration leaves in every step.
"""

import argparse
import json
import warnings

import numpy as np

from sebody import Model, Simulation, generalized_alpha
from sebody.catalogue import builder

SCENES = {
    "hinged-beam B": ("hinged-beam", {"inertia": "b"}, 3000),
    "hinged-beam C": ("hinged-beam", {"inertia": "c"}, 3000),
    "planar-hinged-beam": ("planar-hinged-beam", {}, 3000),
    "spherical-beam": ("spherical-beam", {}, 1500),
    "spherical-beam-strong": ("spherical-beam-strong", {}, 1500),
    "slider-crank": ("slider-crank", {}, 3000),
    "four-bar": ("four-bar", {}, 2000),
    "four-bar, 2 loops": ("four-bar", {"loops": 2}, 2000),
    "squeezer": ("squeezer", {}, 3000),
    "heavy-top": ("heavy-top", {}, 2000),
    "heavy-top, constraints": ("heavy-top", {"explicit": True}, 2000),
    "torque-free-body": ("torque-free-body", {}, 2000),
    "stick-slip": ("stick-slip", {}, 2000),
    "journal-clearance": ("journal-clearance", {}, 2000),
    "two-link-arm": ("two-link-arm", {}, 2000),
    "pole-on-cart": ("pole-on-cart", {}, 2000),
    "door": ("door", {}, 2000),
    "chain, 3 links": ("chain", {"links": 3}, 1000),
}
EXACT = 1e-12       # tolerance of the run that others are compared with


def deviation(rows: np.ndarray, exact: np.ndarray, simulation: Simulation) -> dict[str, float]:
    """Largest differences of recorded states, relative to the largest number of a kind."""
    parts, found = simulation.state.recorded_parts, {}
    free = simulation.system.is_multiplier[:simulation.state.q.size] == 0.0
    for name in ("q", "v", "R"):
        here, there = rows[:, parts[name]], exact[:, parts[name]]
        if name != "R":
            here, there = here[:, free], there[:, free]
        if here.size:
            found[name] = float(np.abs(here - there).max() / max(np.abs(there).max(), 1e-300))
    return found


def measure(scene: str, options: dict, steps: int) -> dict:
    """Counts of a run, and its deviation from the same run with a tolerance of 1e-12."""
    built = builder(scene)(**options)
    steps = min(steps, round(built.t_end / built.h))
    runs = {}
    for name, scheme in (("own", generalized_alpha()), ("exact", generalized_alpha(tolerance=EXACT))):
        run = runs[name] = Simulation(built.model, built.h, scheme)
        run.run_to(steps * built.h)
    own, control = runs["own"], runs["own"].state.control
    rows, exact = (runs[name].rows.all() for name in ("own", "exact"))
    return {"steps": int(control.steps), "unknowns": int(own.system.diagonal.size),
            "corrections": int(control.iterations) / int(control.steps),
            "matrices": int(control.matrices), "cuts": int(control.cuts),
            **deviation(rows, exact, own)}


def main(given: list[str] | None = None) -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scenes", nargs="*", default=list(SCENES))
    parser.add_argument("--json", action="store_true", help="for programs")
    chosen = parser.parse_args(given)
    found = {}
    for name in chosen.scenes:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            try:
                row = found[name] = measure(*SCENES[name])
            except Exception as e:
                print(name, repr(e)[:300]); continue
        if not chosen.json:
            print(f"{name:24}", *(f"{key} {value:.3g}" if key != "corrections" else f"{key} {value:.3f}" for key, value in row.items()), flush=True)
    if chosen.json:
        print(json.dumps(found))


if __name__ == "__main__":
    main()
