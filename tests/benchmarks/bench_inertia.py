"""Cost of the inertia options over the number of coordinates, measured in one run.

    python tests/benchmarks/bench_inertia.py [--json]

Beams with internal modes, at rest in a generic place: option B, option C without geometric
stiffness, and with it; general kernels where a body has many nodes. Of option C also how many
stress resultants of second order there are.
"""

import argparse
import json
import time
from typing import NamedTuple

import numpy as np

from sebody import Model, Simulation
from sebody.compiler.decorators import compiled
from sebody.contract.layout import RESIDUAL, TANGENT
from sebody.fem import Section
from sebody.kernels.abi import Arguments, call_kernel

SECTION = Section(area=9.0, inertia_y=6.75, inertia_z=6.75, torsion=11.387,
                  youngs_modulus=2.1e6, poisson_ratio=0.3, density=7.8e-3)
SIZES = 16, 32, 64, 112         # coordinates of a beam with two nodes
ROUNDS = 9


class Row(NamedTuple):
    """A body: nanoseconds of a residual and of a matrix, by option."""

    coordinates: int
    resultants: int
    residual: dict[str, float]
    matrix: dict[str, float]


@compiled
def repeat(times, address, task, stride, width, given):
    for _ in range(times):
        call_kernel(address, task, 1, stride, width, given)


def beam(modes, inertia, planar):
    """A simulation of an oblique beam."""
    model = Model(planar=planar)
    ends = [model.node(name, place[:2] if planar else place)
            for name, place in (("a", (0.0, 0.0, 0.0)), ("b", (100.0, 100.0, 30.0)))]
    model.beam("beam", ends, SECTION, 20, 1, modes, inertia=inertia[-1],
               stiffening=inertia == "c")
    return Simulation(model, 0.01)


def arguments(simulation):
    """The arguments of the kernel of its body, and of the call."""
    system, state = simulation.system, simulation.state
    given = Arguments(
        index=system.index, constants=system.constants, q=state.q, R=state.R, v=state.v, a=state.a,
        references=state.frames_old, frames=state.frames, T=state.T, loads=state.loads,
        coefficients=state.coefficients, forces=state.g, matrices=state.J, work=state.work,
        energies=state.energy)
    return system.address[0], system.stride[0], system.width[0], given


def nanoseconds(bodies, task, times):
    """Time of one evaluation of each body, the quietest of rounds in turn."""
    samples = [[] for _ in bodies]
    for _ in range(ROUNDS):
        for (address, stride, width, given), sample in zip(bodies, samples, strict=True):
            began = time.perf_counter()
            repeat(times, address, task, stride, width, given)
            sample.append((time.perf_counter() - began) / times * 1e9)
    return [min(sample) for sample in samples]


def measure(size, planar=False, times=2000):
    """A beam of so many coordinates with all options."""
    options = "b", "plain c", "c"
    runs = [beam(size - (6 if planar else 12), option, planar) for option in options]
    for run in runs:
        random = np.random.default_rng(0)
        for row in (run.state.v, run.state.a):
            row[:size] = random.normal(size=size)
    bodies = [arguments(run) for run in runs]
    times = max(2, times * 16 // size**2 + 1) if size > 40 else times
    found = [dict(zip(options, nanoseconds(bodies, task, count), strict=True))
             for task, count in ((RESIDUAL, 4 * times), (TANGENT, max(times // 10, 1)))]
    reduced = runs[-1].model.bodies["beam"].reduced
    return Row(len(reduced.mass), reduced.invariants.resultants, *found)


def main(given=None, times=2000, sizes=SIZES):
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--json", action="store_true", help="for programs")
    as_json = parser.parse_args(given).json
    rows = {"planar 8": measure(8, True, times)}
    rows |= {f"spatial {size}": measure(size, False, times) for size in sizes}
    if as_json:
        print(json.dumps({name: row._asdict() for name, row in rows.items()}))
        return
    print(f"{'':12} {'resultants':>10}   {'residual ns: B':>14} {'plain C':>9} {'C':>9} "
          f"{'C / B':>6}   {'matrix us: B':>12} {'C':>8} {'C / B':>6}")
    for name, row in rows.items():
        b, plain, c = row.residual.values()
        of_b, _, of_c = row.matrix.values()
        print(f"{name:12} {row.resultants:10d}   {b:14.0f} {plain:9.0f} {c:9.0f} {c / b:6.2f}   "
              f"{of_b / 1e3:12.2f} {of_c / 1e3:8.2f} {of_c / of_b:6.2f}")


if __name__ == "__main__":
    main()
