"""Newton's iteration of scenes: corrections and matrices, and what its tolerance leaves of errors.

    python tests/benchmarks/bench_iterations.py [--json] [--energy STEPS] [SCENE ...]

Counts do not depend on how busy a machine is. Deviations are those of coordinates, velocities and
rotations from a run with tolerance 1e-12, relative to the largest of each kind. With ``--energy``
beams and rigid bodies without loads run for so many steps: largest gain and loss of their energy,
which the scheme keeps but for vibrations (rho 0.9) or altogether (rho 1).
"""

import argparse
import json
import warnings

import numpy as np

from sebody import Simulation, generalized_alpha
from sebody.catalogue import builder

SCENES = {      # name of a scene, options, steps
    "hinged-beam, B": ("hinged-beam", {"inertia": "b"}, 3000),
    "hinged-beam": ("hinged-beam", {}, 3000),
    "planar-hinged-beam": ("planar-hinged-beam", {}, 3000),
    "spherical-beam": ("spherical-beam", {}, 1500),
    "spherical-beam-strong": ("spherical-beam-strong", {}, 1500),
    "slider-crank": ("slider-crank", {}, 3000),
    "four-bar": ("four-bar", {}, 2000),
    "squeezer": ("squeezer", {}, 3000),
    "heavy-top": ("heavy-top", {}, 2000),
    "heavy-top, constraints": ("heavy-top", {"explicit": True}, 2000),
    "torque-free-body": ("torque-free-body", {}, 2000),
    "stick-slip": ("stick-slip", {}, 2000),
    "journal-clearance": ("journal-clearance", {}, 2000),
    "pole-on-cart": ("pole-on-cart", {}, 2000),
    "door": ("door", {}, 2000),
    "chain, 3 links": ("chain", {"links": 3}, 1000)}
FREE = {        # scene, options, end of its loads, rho
    "planar-hinged-beam": ("planar-hinged-beam", {}, 7.5, 0.9),
    "hinged-beam": ("hinged-beam", {}, 7.5, 0.9),
    "hinged-beam, rho 1": ("hinged-beam", {}, 7.5, 1.0),
    "two hinged beams": ("hinged-beam", {"bodies": 2}, 7.5, 0.9),
    "torque-free-body, rho 1": ("torque-free-body", {}, 0.0, 1.0)}
EXACT = 1e-12       # tolerance of the run that others are compared with


def counts_and_deviations(scene: str, options: dict, steps: int) -> dict[str, float]:
    """Corrections a step and matrices of a run, and its deviation from one of tolerance EXACT."""
    built = builder(scene)(**options)
    steps = min(steps, round(built.t_end / built.h))
    own, exact = (Simulation(built.model, built.h, scheme).run_to(steps * built.h)
                  for scheme in (generalized_alpha(), generalized_alpha(tolerance=EXACT)))
    control = own.state.control
    return {"unknowns": int(own.system.diagonal.size), "steps": int(control.steps),
            "corrections": int(control.iterations) / int(control.steps),
            "matrices": int(control.matrices), **_deviations(own, exact)}


def _deviations(own: Simulation, exact: Simulation) -> dict[str, float]:
    """Largest differences of recorded states, relative to the largest number of a kind."""
    found, parts = {}, own.state.recorded_parts
    free = own.system.is_multiplier[:own.state.q.size] == 0.0
    for name in ("q", "v", "R"):
        here, there = (run.rows.all()[:, parts[name]] for run in (own, exact))
        if name != "R":
            here, there = here[:, free], there[:, free]
        if here.size:
            found[name] = float(np.abs(here - there).max() / max(np.abs(there).max(), 1e-300))
    return found


def energy(scene: str, options: dict, begin: float, rho: float, steps: int) -> dict[str, float]:
    """Largest gain and loss of energy after all loads have ended, relative to it."""
    built = builder(scene)(**options)
    result = Simulation(built.model, built.h, generalized_alpha(rho=rho),
                        output_every=max(1, steps // 1000)).run_to(built.h * steps).result()
    free = result.t > begin
    total = (result["energy.kinetic"] + result["energy.strain"])[free]
    return {"corrections": result.iterations_per_step, "gain": float((total / total[0] - 1).max()),
            "loss": float((1 - total / total[0]).max())}


def main(given: list[str] | None = None) -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scenes", nargs="*")
    parser.add_argument("--energy", type=int, metavar="STEPS")
    parser.add_argument("--json", action="store_true", help="for programs")
    chosen = parser.parse_intermixed_args(given)
    cases = FREE if chosen.energy else SCENES
    warnings.simplefilter("ignore")         # of limits: scenes are what they are
    found = {}
    for name in chosen.scenes or cases:
        row = found[name] = (energy(*FREE[name], chosen.energy) if chosen.energy else
                             counts_and_deviations(*SCENES[name]))
        if not chosen.json:
            print(f"{name:24}", *(f"{key} {value:.4g}" for key, value in row.items()), flush=True)
    if chosen.json:
        print(json.dumps(found))


if __name__ == "__main__":
    main()
