"""Time from a model to a simulation that is ready to run, as every run of a sweep spends it.

    python tests/benchmarks/bench_setup.py [--json]

Kernels and the time loop are compiled before anything is measured, and the model is built: what is
left is a second simulation of it in the same process.
"""

import argparse
import json
import time

from sebody import Simulation
from sebody.scenes import (
    chain,
    four_bar,
    heavy_top,
    hinged_beam,
    planar_hinged_beam,
    slider_crank,
    spherical_beam,
)

TIMES = 200
SCENES = (hinged_beam, planar_hinged_beam, spherical_beam, four_bar, heavy_top, slider_crank,
          chain)


def milliseconds(build, times: int = TIMES) -> float:
    """Quickest of many simulations made of one model."""
    scene = build()
    Simulation(scene.model, scene.h)
    quickest = float("inf")
    for _ in range(times):
        began = time.perf_counter()
        Simulation(scene.model, scene.h)
        quickest = min(quickest, time.perf_counter() - began)
    return 1e3 * quickest


def main(arguments: list[str] | None = None, times: int = TIMES) -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--json", action="store_true", help="milliseconds by scene, to be read")
    as_json = parser.parse_args(arguments).json
    found = {}
    for scene in SCENES:
        name = scene.build().name
        found[name] = milliseconds(scene.build, times)
        if not as_json:
            print(f"{name:24} {found[name]:7.3f} ms", flush=True)
    if as_json:
        print(json.dumps(found))


if __name__ == "__main__":
    main()
