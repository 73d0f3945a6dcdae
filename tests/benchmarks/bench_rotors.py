"""Rotors: modes of blades on a tower against runs and Floquet's multipliers, and times.

    python tests/benchmarks/bench_rotors.py [--json] [--length T]

A hub with three flexible blades on a beam tower that is stiffer one way turns at 6 rad/s. Its modes
in multi-blade coordinates stand beside the exponents of the multipliers of a revolution, and beside
the nearest peak in the spectra of hub and nacelle in a run after a blow (frequencies seen from the
ground; a bin is ``2 pi / T``). Times: modes about a rotation by 60 unknowns, a disc in a bearing
for 200 s with steps of 1 ms, a shaft of one superelement.
"""

import argparse
import json
import sys
import time
import warnings
from collections.abc import Sequence
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))
from rotor_models import AXIS, TURNED, disc, turbine_on_a_tower, two_discs
from scipy.signal import find_peaks

from sebody import LimitWarning, Model, simulate
from sebody.analysis import campbell, equilibrium, modes
from sebody.fem import circle

SPEED, STEP, HIGHEST = 6.0, 2e-3, 40.0      # rad/s, s, rad/s
ZOOM = 8            # of the spectrum by zeros behind the window
SEEN = 1e-2         # of the largest value of a spectrum: the prominence of a peak


def blades(length: float) -> list[dict[str, float]]:
    """Modes of the turbine below `HIGHEST`, and what the other methods give for each."""
    model = turbine_on_a_tower()
    state = equilibrium(model, 2, spin=SPEED * AXIS)
    own, other = (modes(state, SPEED * AXIS, frame, "hub") for frame in ("multiblade", "floquet"))
    low = own.values[(own.omega > 1.0) & (own.omega < HIGHEST)]
    peaks = _peaks(length)
    width = 2.0 * np.pi / length
    rows = []
    for value in low:
        peak = peaks[np.argmin(np.abs(peaks - value.imag))]
        rows.append({"omega": value.imag, "damping": -value.real / abs(value),
                     "floquet": float(np.abs(other.values - value).min() / abs(value)),
                     "bins": float((peak - value.imag) / width)})
    return rows


def _peaks(length: float) -> np.ndarray:
    """Frequencies of the peaks in the spectra of the motions of hub and nacelle."""
    model = turbine_on_a_tower()
    model.rigid_velocity((0, 0, 0), SPEED * AXIS)
    model.force("hub", TURNED @ (0.4, 1.0, 0.3), [(0, 0), (0.02, 3e4), (0.04, 0)], name="blow")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", LimitWarning)       # of the blow, which ends between steps
        result = simulate(model, STEP, length + 2.0)
    count = int(length / STEP)
    motions = np.hstack([(result["hub.velocity"] @ TURNED)[-count:],
                         (result["top.angular_velocity"] @ TURNED)[-count:]])
    window = np.hanning(count)[:, None]
    spectra = np.abs(np.fft.rfft((motions - motions.mean(axis=0)) * window, ZOOM * count, axis=0))
    omega = 2 * np.pi * np.fft.rfftfreq(ZOOM * count, STEP)
    return np.concatenate([omega[find_peaks(one, prominence=SEEN * one.max())[0]]
                           for one in spectra.T])


def times() -> dict[str, float]:
    """Seconds of processor time, the best of three, after a first call that compiles."""
    speeds = np.linspace(0.0, 400.0, 11)
    shaft = Model()
    for name, at in (("a", 0.0), ("b", 1.0)):
        shaft.node(name, at * AXIS)
        ground = shaft.node(f"ground {name}", at * AXIS)
        shaft.fix(ground)
        shaft.bushing(ground, to=name, stiffness=(1e6, 2e6, 1e6), rotation=TURNED)
    shaft.beam("shaft", ("a", "b"), circle(0.02, 2e11, 0.3, 7800.0), 8, 1, 4)
    rigid = disc((1e5, 1e4, 1.44e4))
    rigid.unbalance("d", 2e-4, 0.0, AXIS)
    for model in (shaft, rigid):
        model.rigid_velocity((0, 0, 0), 80.0 * AXIS)
    long = two_discs(np.diag([1e6, 0.8e6]), 200.0, elements=9)      # 60 unknowns
    jobs = {"modes, 60 unknowns, a speed": (lambda: campbell(long, speeds, AXIS, 12, 1), 11),
            "rigid rotor, 200 s": (lambda: simulate(rigid, 1e-3, 200.0), 1),
            "flexible rotor, a step": (lambda: simulate(shaft, 1e-4, 2.0), 20000)}
    return {name: _best(job) / count for name, (job, count) in jobs.items()}


def _best(job) -> float:
    job()
    found = []
    for _ in range(3):
        begun = time.process_time()
        job()
        found.append(time.process_time() - begun)
    return min(found)


def main(arguments: Sequence[str] | None = None) -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--length", type=float, default=240.0, help="of the run [s]")
    given = parser.parse_args(arguments)
    found = {"blades": blades(given.length), "seconds": times()}
    if given.json:
        print(json.dumps(found, indent=1))
        return
    print("| mode [rad/s] | damping ratio | Floquet, relative | peak, bins |\n|---|---|---|---|")
    for row in found["blades"]:
        print(f"| {row['omega']:.4f} | {row['damping']:.2e} | {row['floquet']:.1e} | "
              f"{row['bins']:+.2f} |")
    for name, seconds in found["seconds"].items():
        print(f"{name}: {seconds:.3g} s")


if __name__ == "__main__":
    main()
