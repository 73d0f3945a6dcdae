"""Planned steps of conservative motions beside as many fixed ones.

    python tests/benchmarks/bench_planned.py [--json] [--tolerance T ...] [NAME ...]

A double pendulum, a flexible dumb-bell that tumbles, the spatial slider-crank and the N four-bar
mechanism of the IFToMM library; errors of a path and of the energy over those of fixed steps.
Paths are compared with a run of sixteen times as many steps as the finest plan.
"""

import argparse
import json
import warnings
from collections.abc import Callable, Iterator

import numpy as np
from scipy.interpolate import CubicSpline

from sebody import Model, Tolerance, generalized_alpha, simulate
from sebody.fem import circle
from sebody.scenes import four_bar

SCHEME = generalized_alpha(index=2)
TOLERANCES = tuple(10.0**-np.arange(3.0, 9.0))
FINER = 16


def double_pendulum() -> Model:
    """Two uniform rods, let go with the first one level."""
    model = Model(planar=True)
    model.gravity((0.0, -9.81))
    first = model.node("first", (0.0, 0.0))
    model.fix(first, "position")
    model.rigid_body("upper", first, 1.0, 1.0 / 12.0, centre=(0.5, 0.0))
    second = model.node("second", (1.0, 0.0), at=model.attach("elbow", (1.0, 0.0), first))
    model.rigid_body("lower", second, 1.0, 1.0 / 12.0, centre=(1.3, 0.4))
    model.attach("tip", (1.6, 0.8), second)
    return model


def dumb_bell() -> Model:
    """A rod that bends, with unequal masses at its ends, tumbling freely."""
    model = Model()
    a, b = model.node("a", (0.0, 0.0, 0.0)), model.node("tip", (1.0, 0.0, 0.0))
    model.beam("rod", (a, b), circle(0.01, 7e10, 0.3, 2700.0), 8, 1, 2)
    model.rigid_body("small", a, 0.5, np.diag([2e-3, 3e-3, 4e-3]))
    model.rigid_body("large", b, 1.5, np.diag([6e-3, 4e-3, 3e-3]))
    model.rigid_velocity((0.1, 0.0, 0.2), (0.5, 3.0, 1.0), (0.6, 0.0, 0.0))
    return model


def slider_crank() -> Model:
    """The spatial one, whose crank turns about x and whose slider moves along x."""
    model = Model()
    model.gravity((0.0, 0.0, -9.81))
    foot, pin, end = (0.0, 0.1, 0.12), np.array([0.0, 0.1, 0.2]), np.array([0.2, 0.0, 0.0])
    crank = model.node("crank", foot)
    model.revolute(crank, "x")
    model.rigid_body("crank", crank, 0.12, np.diag([1e-4, 1e-4, 1e-5]), centre=(0.0, 0.1, 0.16))
    along = (end - pin) / 0.3
    across = np.cross(along, (0.0, 0.0, 1.0))
    across /= np.linalg.norm(across)
    axes = np.column_stack([along, across, np.cross(along, across)])
    rod = model.node("rod", pin, at=model.attach("pin", pin, crank))
    model.rigid_body("rod", rod, 0.5, axes @ np.diag([4e-4, 4e-3, 4e-3]) @ axes.T,
                     centre=(pin + end) / 2.0)
    slider = model.node("tip", end)
    model.prismatic(slider, "x")
    model.rigid_body("slider", slider, 2.0, 1e-4 * np.eye(3))
    cross = np.cross(across, (1.0, 0.0, 0.0))
    model.universal(model.attach("rod end", end, rod), across, cross / np.linalg.norm(cross),
                    to=slider, explicit=True)
    model.initial_velocity(crank, angular=(6.0, 0.0, 0.0))
    return model


MODELS: dict[str, tuple[Callable[[], Model], str, float]] = {      # a path, and the end
    "double pendulum": (double_pendulum, "tip.position", 4.0),
    "dumb-bell": (dumb_bell, "tip.position", 5.0),
    "slider-crank": (slider_crank, "tip.position", 5.0),
    "four-bar": (lambda: four_bar.build().model, "B0.position", 10.0),
}
GRID = 0.01


def beside_fixed(name: str, tolerances=TOLERANCES, t_end: float | None = None) -> Iterator[dict]:
    """Steps, largest error of the path, and ratios to fixed steps of the same number."""
    build, path, end = MODELS[name]
    end = t_end or end
    planned = [simulate(build(), GRID, end, SCHEME, tolerance=Tolerance(tolerance))
               for tolerance in tolerances]
    finest = FINER * max(run.steps for run in planned)
    every = max(1, finest // 20000)
    count = -(-finest // every) * every
    exact = simulate(build(), end / count, end, SCHEME, output_every=every)
    curve = CubicSpline(exact.t, exact[path])

    def error(run) -> float:
        return float(np.abs(run[path] - curve(run.t)).max())

    for tolerance, run in zip(tolerances, planned, strict=True):
        fixed = simulate(build(), end / run.steps, end, SCHEME)
        yield {"model": name, "tolerance": tolerance, "steps": int(run.steps), "error": error(run),
               "over fixed": error(run) / error(fixed),
               "energy over fixed": run.energy_balance() / fixed.energy_balance()}


def main(given: list[str] | None = None) -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--tolerance", type=float, nargs="+", default=TOLERANCES)
    parser.add_argument("names", nargs="*", metavar="NAME", help=", ".join(MODELS))
    options = parser.parse_args(given)
    for name in options.names or MODELS:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            rows = list(beside_fixed(name, options.tolerance))
        if options.json:
            print(json.dumps(rows), flush=True)
            continue
        cells = [f"{row['steps']}, {row['error']:.1e}, {row['over fixed']:.2f}, "
                 f"{row['energy over fixed']:.2f}" for row in rows]
        print(f"| {name} | {' | '.join(cells)} |", flush=True)


if __name__ == "__main__":
    main()
