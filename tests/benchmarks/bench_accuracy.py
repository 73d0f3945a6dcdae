"""Cost and truth of runs within a tolerance.

Without options: time of all attempts against the best fixed step. The best fixed step is the one
that gives the error the variable steps turned out to have: errors and times of fixed steps are
measured in the same run and interpolated. Errors are against a run with steps far shorter than all
others.

``--random [NUMBER,...]``: claimed and true errors of sixty random models, with the steps of all
runs. ``--pendulum``: planned steps beside fixed ones of the same number. ``--json`` prints rows.
"""

import argparse
import json
import sys
import warnings
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
from scipy.integrate import solve_ivp

from sebody import (
    Model,
    Simulation,
    SimulationError,
    Tolerance,
    generalized_alpha,
    simulate,
    simulate_within,
)
from sebody.runs import accuracy
from sebody.runs.accuracy import difference
from sebody.scenes import heavy_top, hinged_beam, spherical_beam_strong, squeezer

sys.path.insert(0, str(Path(__file__).parent))
import random_motions

RUNS = 3
CASES = {   # scene, end, output grid, steps of the reference in it
    "hinged beam": (hinged_beam.build, 30.0, 0.05, 40),
    "strong scene to t = 16": (spherical_beam_strong.build, 16.0, 0.05, 640),
    "strong scene, no modes": (lambda: spherical_beam_strong.build(modes=0), 30.0, 0.05, 320),
    "strong scene, two bodies": (lambda: spherical_beam_strong.build(modes=0, bodies=2), 30.0,
                                 0.05, 640),
    "squeezer": (squeezer.build, 0.03, 1e-4, 80),
    "heavy top": (heavy_top.build, 2.0, 0.01, 2000),
}


TOLERANCES = (1e-2, 1e-3, 1e-4)


def fixed(build, t_end: float, grid: float, parts: int, repeats: int = RUNS):
    """A run with `parts` steps in every interval of the grid, the fastest of several."""
    runs = [Simulation(build().model, grid / parts, output_every=parts).run_to(t_end).result()
            for _ in range(repeats)]
    return min(runs, key=lambda run: run.seconds)


def compare(build, t_end: float, grid: float, finest: int, tolerances=TOLERANCES,
            repeats: int = RUNS):
    """For every tolerance: error over it, steps, seconds of all attempts and of the best
    fixed step.
    """
    exact = fixed(build, t_end, grid, finest, repeats)
    coarse = [fixed(build, t_end, grid, 2**k, repeats) for k in range(int(np.log2(finest)))]
    errors = np.array([difference(run, exact, Tolerance(1.0)) for run in coarse])
    seconds = np.array([run.seconds for run in coarse])
    order = np.argsort(errors)
    for allowed in tolerances:
        runs = [simulate_within(build().model, grid, t_end, Tolerance(allowed))
                for _ in range(repeats)]
        error = difference(runs[0], exact, Tolerance(1.0))
        best = np.exp(np.interp(np.log(error), np.log(errors[order]), np.log(seconds[order])))
        yield error / allowed, runs[0].steps, min(run.all_seconds for run in runs), best


GRID = 100              # output intervals of a random model
FIRST, LAST = 32, 4096  # steps in an interval of the coarsest and finest reference
KNOWN = 0.02            # of the tolerance, up to which references are refined


def promised(seed: int, tolerance: float) -> dict:
    """Claimed and true error of a random model, over the tolerance, and steps of all its runs.

    The reference has fixed steps, halved until that changes it little; friction sticks the more
    stiffly in it the shorter they are.
    """
    kind, model, t_end = random_motions.build(seed)
    counted: list[Simulation] = []

    class Counted(Simulation):
        def run_to(self, *arguments, **options):
            counted.append(self)
            return super().run_to(*arguments, **options)

    plain, accuracy.Simulation = accuracy.Simulation, Counted
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            result = simulate_within(model, t_end / GRID, t_end, Tolerance(tolerance))
            claimed = float(result.error)
    except SimulationError as error:
        result, claimed = error.result, np.inf
    finally:
        accuracy.Simulation = plain
    row = {"seed": seed, "kind": kind, "tolerance": tolerance, "claimed": claimed,
           "steps": int(result.steps), "runs": len(counted),
           "all steps": sum(int(run.state.control.steps) for run in counted)}
    rows, doubt = reference(seed, tolerance)
    return row | {"true": difference(result, replace(result, rows=rows), Tolerance(tolerance)),
                  "reference": doubt}


def reference(seed: int, tolerance: float):
    """Recorded states of a run with fixed steps, and its change by halving the step, over 3."""
    def fine(parts: int):
        _, model, t_end = random_motions.build(seed)
        return simulate(model, t_end / GRID / parts, t_end, generalized_alpha(
            0.9, tolerance=1e-10, index=2), output_every=parts)

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        parts, coarse = FIRST, fine(FIRST)
        while True:
            parts *= 2
            finer = fine(parts)
            doubt = difference(coarse, finer, Tolerance(tolerance)) / 3.0
            if doubt < KNOWN or parts >= LAST:
                return finer.rows, doubt
            coarse = finer


def swung(angle: float, tolerances, t_end: float = 20.0) -> Iterator[dict]:
    """Largest error and energy balance of a pendulum's planned steps, over those of fixed ones.

    The fixed run has the same number of steps. The pendulum is a uniform rod of 2 m, let go.
    """
    gravity, inertia = 9.81, 4.0 / 3.0
    exact = solve_ivp(lambda t, y: [y[1], -gravity / inertia * np.sin(y[0])], (0.0, t_end),
                      [angle, 0.0], method="DOP853", rtol=1e-12, atol=1e-13,
                      dense_output=True).sol
    scheme = generalized_alpha(index=2)

    def model() -> Model:
        made = Model(planar=True)
        made.gravity((0.0, -gravity))
        made.rigid_body("rod", made.node("pin", (0.0, 0.0)), 1.0, 1.0 / 3.0,
                        centre=(np.sin(angle), -np.cos(angle)))
        made.fix("pin", "position")
        return made

    def error(run) -> float:
        return float(np.abs(np.unwrap(run["pin.rotation"]) + angle - exact(run.t)[0]).max())

    for tolerance in tolerances:
        planned = simulate(model(), 0.01, t_end, scheme, tolerance=Tolerance(tolerance))
        fixed = simulate(model(), t_end / planned.steps, t_end, scheme)
        yield {"angle": angle, "tolerance": tolerance, "steps": int(planned.steps),
               "error": error(planned), "over fixed": error(planned) / error(fixed),
               "energy over fixed": planned.energy_balance() / fixed.energy_balance()}


def main(argv: list[str] | None = None) -> None:
    """Print a table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--random", nargs="?", metavar="NUMBER,...",
                        const=",".join(map(str, range(random_motions.COUNT))))
    parser.add_argument("--tolerance", type=float, default=1e-3)
    parser.add_argument("--pendulum", action="store_true")
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args(argv)
    if options.random:
        numbers = map(int, options.random.split(","))
        show((promised(number, options.tolerance) for number in numbers), options.json)
    elif options.pendulum:
        show((row for angle in (2.0, 3.0) for row in swung(angle, 10.0**-np.arange(3.0, 9.0))),
             options.json)
    else:
        compare_all()


def show(rows, as_json: bool) -> None:
    """Print rows as they come."""
    for row in rows:
        print(json.dumps(row) if as_json else "  ".join(
            f"{name} {value:.4g}" if isinstance(value, float) else f"{name} {value}"
            for name, value in row.items()), flush=True)


def compare_all() -> None:
    """Print the table."""
    print(f"{'':26} tolerance  error / tolerance  steps    ms  best fixed step, ms  ratio")
    for name, case in CASES.items():
        for allowed, (error, steps, spent, best) in zip(TOLERANCES, compare(*case), strict=True):
            print(f"{name:26} {allowed:9.0e} {error:18.2f} {steps:6} "
                  f"{1e3 * spent:5.1f} {1e3 * best:20.1f} {spent / best:6.2f}", flush=True)


if __name__ == "__main__":
    main()
