"""What sampled controllers cost: microseconds a sample and a call from Python, best of several.

    python tests/benchmarks/bench_control.py [--json FILE]

A rotor and a hinged beam (20 elements, 4 modes) with a PID; every row compares runs that alternate.
"""

import argparse
import json
import time

from sebody import Model, Simulation
from sebody.control import pid
from sebody.fem import StiffnessSection, planar_beam
from sebody.reduction import craig_bampton

STEP, COUNT, REPEATS = 1e-3, 4000, 5
SECTION = StiffnessSection(axial=1e4, bending_y=1.0, bending_z=1.0, torsion=1.0, mass=1.0,
                           inertia_x=0.0, inertia_y=0.0, inertia_z=0.0)
BODY = craig_bampton(planar_beam((0, 0), (1, 0), SECTION, elements=20),
                     [(0, "full"), (20, "full")], modes=4)


def build(flexible: bool, period: float | None) -> Simulation:
    """A rotor, perhaps with a beam, under a PID."""
    model = Model(planar=True)
    hub = model.node("hub", (0.0, 0.0))
    if flexible:
        model.superelement("beam", BODY, [hub, model.node("tip", (1.0, 0.0))])
    model.rigid_body("rotor", hub, 1.0, 0.1)
    model.revolute(hub, name="hinge")
    model.rigid_velocity((0.0, 0.0), 0.01)
    model.actuator("motor", joint="hinge")
    if period:
        model.controller("pid", pid(2.0, 0.5, 0.5, 50.0, 1e-4), ["hub.rotation"], ["motor"],
                         period)
    return Simulation(model, STEP)


def sampled(flexible: bool) -> dict[str, float]:
    """Microseconds a step without a controller, and a sample more."""
    best = {"step": float("inf"), "sampled step": float("inf")}
    for _ in range(REPEATS):
        for name, period in (("step", None), ("sampled step", STEP)):
            run = build(flexible, period)
            began = time.perf_counter()
            run.run_to(COUNT * STEP)
            best[name] = min(best[name], (time.perf_counter() - began) / COUNT * 1e6)
    run = build(flexible, STEP)
    run.run_to(COUNT * STEP)
    return best | {"sample": best["sampled step"] - best["step"],
                   "factorizations a sample": run.result().matrices / COUNT}


def calls() -> dict[str, float]:
    """Microseconds of a call from Python beyond the step in it."""
    run = build(False, None)
    run.run_to(10 * STEP)
    best = dict.fromkeys(("read", "set_input", "run_to"), float("inf"))
    step = sampled(False)["step"]
    for _ in range(REPEATS):
        for name, call in (("read", lambda k: run.read("hub.rotation")),
                           ("set_input", lambda k: run.set_input("motor", 1e-6 * (k % 2)))):
            began = time.perf_counter()
            for k in range(COUNT):
                call(k)
            best[name] = min(best[name], (time.perf_counter() - began) / COUNT * 1e6)
        run.set_input("motor", 0.0)
        run.run_to(run.time + STEP)
        first = round(run.time / STEP)
        began = time.perf_counter()
        for k in range(1, COUNT + 1):
            run.run_to((first + k) * STEP)
        best["run_to"] = min(best["run_to"], (time.perf_counter() - began) / COUNT * 1e6 - step)
    return best


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--json", help="file for the numbers")
    given = parser.parse_args()
    found = {"rotor": sampled(False), "hinged beam": sampled(True), "calls": calls()}
    for what, numbers in found.items():
        print(f"{what:12}", ", ".join(f"{name} {value:.3g}" for name, value in numbers.items()))
    if given.json:
        with open(given.json, "w") as file:
            json.dump(found, file, indent=1)


if __name__ == "__main__":
    main()
