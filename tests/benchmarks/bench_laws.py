"""Cost of continuous controllers a step: a beam on a hinge with the same springs as laws.

``python tests/benchmarks/bench_laws.py [--pairs N] [--json FILE]``: runs in turn in one process, of
each the best time.
"""

import argparse
import json
import time

import numpy as np

from sebody import Model, Simulation
from sebody.fem import StiffnessSection, planar_beam
from sebody.reduction import craig_bampton

SECTION = StiffnessSection(axial=1e4, bending_y=1.0, bending_z=1.0, torsion=1.0, mass=1.0,
                           inertia_x=0.0, inertia_y=0.0, inertia_z=0.0)
BODY = craig_bampton(planar_beam((0, 0), (1, 0), SECTION, elements=20),
                     [(0, "full"), (20, "full")], modes=4)
STEPS, H = 5000, 1e-3


def proportional(t, y, x, rates, u, parameters):
    """A torsion spring and damper."""
    u[0] = -2.0 * y[0] - 0.5 * y[1]


def filtered(t, y, x, rates, u, parameters):
    """The same of filtered angles, a state each."""
    for i in range(x.size):
        rates[i] = 10.0 * (y[0] - x[i])
    u[0] = -2.0 * x[0] - 0.5 * y[1]


def beam(states=None):
    """A beam with a motor; with a spring in place of a law where `states` is None."""
    model = Model(planar=True)
    hub, tip = model.node("hub", (0.0, 0.0)), model.node("tip", (1.0, 0.0))
    model.superelement("beam", BODY, [hub, tip])
    model.rigid_body("rotor", hub, 1.0, 0.1)
    model.revolute(hub, name="hinge")
    model.actuator("motor", joint="hinge")
    if states is None:
        model.torsion_spring(hub, stiffness=2.0, damping=0.5)
    else:
        model.controller("loop", filtered if states else proportional,
                         ["hinge.angle", "hinge.rate"], ["motor"], states=np.zeros(states))
    model.rigid_velocity((0.0, 0.0), 0.1, about=(0.0, 0.0))
    return model


def main():
    """Print a table, or write it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--pairs", type=int, default=20)
    parser.add_argument("--json")
    given = parser.parse_args()
    cases = {"spring and damper": None, "law without states": 0, "one state": 1, "four states": 4}
    runs = {name: Simulation(beam(states), H).run_to(0.1) for name, states in cases.items()}
    best = dict.fromkeys(runs, np.inf)
    for _ in range(given.pairs):
        for name, run in runs.items():
            begun = time.perf_counter()
            run.run_to(run.time + STEPS * H)
            best[name] = min(best[name], 1e6 * (time.perf_counter() - begun) / STEPS)
    for name, value in best.items():
        print(f"{name:20} {value:6.2f} us a step, "
              f"{runs[name].result().iterations_per_step:.2f} iterations")
    if given.json:
        with open(given.json, "w", encoding="utf-8") as file:
            json.dump(best, file, indent=1)


if __name__ == "__main__":
    main()
