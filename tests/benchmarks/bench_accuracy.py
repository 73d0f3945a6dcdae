"""Cost of runs within a tolerance, all their attempts included, against the best fixed step.

The best fixed step is the one that gives the error the variable steps turned out to have: errors
and times of fixed steps are measured in the same run and interpolated. Errors are against a run
with steps far shorter than all others.
"""

import numpy as np

from sebody import Simulation, Tolerance, simulate_within
from sebody.runs.accuracy import difference
from sebody.scenes import heavy_top, hinged_beam, spherical_beam_strong, squeezer

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


def main() -> None:
    """Print the table."""
    print(f"{'':26} tolerance  error / tolerance  steps    ms  best fixed step, ms  ratio")
    for name, case in CASES.items():
        for allowed, (error, steps, spent, best) in zip(TOLERANCES, compare(*case), strict=True):
            print(f"{name:26} {allowed:9.0e} {error:18.2f} {steps:6} "
                  f"{1e3 * spent:5.1f} {1e3 * best:20.1f} {spent / best:6.2f}", flush=True)


if __name__ == "__main__":
    main()
