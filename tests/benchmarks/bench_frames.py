"""Energy of struck frames of slender members, by frame and inertia of the body and by step.

    python tests/benchmarks/bench_frames.py [--json] [--random N] [--within] [NAME ...]

Four frames that spin at 15 and 20 rad/s and are struck, and N random ones of 3 to 8 interfaces and
0 to 16 modes, which the blow bends by 0.05 to 0.3 rad; see `tests/struck_frames.py`. One body each,
rho 0.9, to t = 1: the default; the frame on the rotations of the nodes, which was the default; of
the four it without stiffening, options D and B; nonlinear beams of as many unknowns. Numbers are
the largest gain after the blow and the loss at the end, over the energy of vibrations; the last
column is the gain that `energy_gain` predicts of the default. With --within: steps that
`simulate_within` takes for 1e-3 of the positions.
"""

import argparse
import json
import sys
import warnings
from pathlib import Path

from sebody import LimitWarning, SimulationError, Tolerance, simulate_within
from sebody.analysis import energy_gain

sys.path.insert(0, str(Path(__file__).parents[1]))
from struck_frames import NAMED, OVER, at_random, energies, vibration

STEPS = (1e-3, 5e-4, 2e-4)
OPTIONS = {"default": {}, "on rotations": {"frame": "converged_mean"}}
OTHERS = {"on rotations, no stiffening": {"frame": "converged_mean", "stiffening": False},
          "D": {"inertia": "rigid_part"}, "B": {"inertia": "material"}}
RANDOM = 24
T_END = 1.0


def measure(struck, options, steps=STEPS, t_end=T_END):
    """Energies by option and step."""
    size, body = vibration(struck), struck.body()
    models = {label: struck.model(body, **chosen) for label, chosen in options.items()}
    models["beams"] = struck.beams()
    return {label: {step: energies(model, step, size, t_end) for step in steps}
            for label, model in models.items()}


def steps_within(model, t_end=T_END):
    """Steps of the last run of `simulate_within`, or why there is none."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", LimitWarning)
        try:
            return simulate_within(model, 1e-2, t_end, Tolerance(1e-3)).steps
        except SimulationError as error:
            return f"{error.result.steps}, no end"


def cell(found):
    """A cell of the table."""
    if found.end < T_END - 1e-9:
        return f"stops at {found.end:.2g}"
    return f"{found.gain:.1e} / {found.loss:.1e}" + " w" * found.warned


def main(given=None):
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", help="of frames; all by default")
    parser.add_argument("--random", type=int, default=RANDOM, help="number of random frames")
    parser.add_argument("--within", action="store_true", help="steps of runs within 1e-3")
    parser.add_argument("--json", action="store_true", help="for programs")
    chosen = parser.parse_args(given)
    frames = {name: make() for name, make in NAMED.items()}
    frames |= {f"random {k}": at_random(k) for k in range(chosen.random)}
    frames = {name: frame for name, frame in frames.items()
              if not chosen.names or name in chosen.names}
    found = {}
    for name, struck in frames.items():
        if chosen.within:
            found[name] = {"default": steps_within(struck.model()),
                           "beams": steps_within(struck.beams())}
            if not chosen.json:
                print(f"| {name} | " + " | ".join(map(str, found[name].values())) + " |",
                      flush=True)
            continue
        rows = measure(struck, OPTIONS | OTHERS if name in NAMED else OPTIONS)
        found[name] = {label: {f"{step:g}": row._asdict() for step, row in of_steps.items()}
                       for label, of_steps in rows.items()}
        predicted = energy_gain(struck.model(), OVER)
        found[name]["predicted"] = {f"{step:g}": predicted.at(step) for step in STEPS}
        if not chosen.json:
            for step in STEPS:
                print(f"| {name}, {len(struck.kept)} interfaces, {struck.modes} modes | {step:g} | "
                      + " | ".join(cell(row[step]) for row in rows.values())
                      + f" | {predicted.at(step):.1e} |", flush=True)
    if chosen.json:
        print(json.dumps(found))


if __name__ == "__main__":
    main()
