"""Friction in 32 joints: rejected steps and time beside the frictionless chain, interleaved.

    python tests/benchmarks/bench_friction.py [--pairs 20] [--json FILE]
"""

import argparse
import json
from pathlib import Path

import numpy as np

from sebody import Model, Simulation

LINKS, LENGTH, H, T_END = 32, 0.1, 5e-3, 2.0


def chain(friction: float) -> Model:
    """A chain of links on hinges with equations, released at half a radian."""
    model = Model(planar=True)
    along = LENGTH * np.array([np.sin(0.5), -np.cos(0.5)])
    for k in range(LINKS):
        model.node(f"n{k}", k * along)
        model.rigid_body(f"b{k}", f"n{k}", 0.1, 1e-4, centre=(k + 0.5) * along)
        if k:
            model.attach(f"t{k}", k * along, f"n{k - 1}")
        model.revolute(f"n{k}", to=f"t{k}" if k else None, explicit=True, name=f"j{k}")
        if friction:
            model.friction(f"j{k}", friction, radius=0.005)
    model.gravity((0.0, -9.81))
    return model


def main() -> None:
    """Print medians of ratios, and the counts."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--pairs", type=int, default=20)
    parser.add_argument("--json", type=Path)
    given = parser.parse_args()
    ratios, counts = [], {}
    for _ in range(given.pairs):
        seconds = []
        for friction in (0.0, 0.3):
            run = Simulation(chain(friction), H).run_to(T_END)
            seconds.append(run.seconds)
            control = run.state.control
            counts[f"friction {friction}"] = {
                "rejected": int(control.cuts), "steps": int(control.steps),
                "iterations": int(control.iterations), "matrices": int(control.matrices)}
        ratios.append(seconds[1] / seconds[0])
    found = {"time with friction, relative": float(np.median(ratios)), **counts}
    print(json.dumps(found, indent=1))
    if given.json:
        given.json.write_text(json.dumps(found, indent=1) + "\n")


if __name__ == "__main__":
    main()
