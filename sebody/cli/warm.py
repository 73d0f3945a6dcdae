"""``sebody warm``: compile everything that is shipped, for images."""

import argparse
import time
from concurrent.futures import ProcessPoolExecutor

from sebody.studies.catalogue import kernels

PROCESSES = 2           # that compile at the same time


def add(commands: argparse._SubParsersAction) -> argparse.ArgumentParser:
    """The parser of the command."""
    return commands.add_parser("warm", help="compile everything that is shipped")


def run(options: argparse.Namespace) -> int:
    """Compile, and print how long it takes."""
    began = time.perf_counter()
    names = [kernel.name for kernel in sorted(kernels(), key=lambda kernel: -kernel.size)]
    with ProcessPoolExecutor(PROCESSES) as pool:
        time_loop = pool.submit(_compile_loop)      # what takes longest comes first
        for name, seconds in zip(names, pool.map(_compile, names), strict=True):
            print(f"  {name:44} {seconds:6.1f} s", flush=True)
        print(f"  {'time loop':44} {time_loop.result():6.1f} s")
    print(f"{len(names)} kernels and the time loop are compiled: "
          f"{time.perf_counter() - began:.1f} s")
    return 0


def _compile(name: str) -> float:
    """Import a kernel, which compiles it or reads it from Numba's cache."""
    from sebody.kernels.loader import load

    began = time.perf_counter()
    load(name)
    return time.perf_counter() - began


def _compile_loop() -> float:
    """Run a short spatial and a short planar scene, with what their summaries need."""
    from sebody.analysis.simulation import simulate
    from sebody.kernels.loader import without_collector
    from sebody.scenes import hinged_beam, planar_hinged_beam

    began = time.perf_counter()
    with without_collector():
        for scene in (hinged_beam, planar_hinged_beam):
            simulate(scene.build(elements=4).model, 0.01, 0.02).summary()
    return time.perf_counter() - began
