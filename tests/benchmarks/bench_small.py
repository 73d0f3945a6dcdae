"""Steps of mechanisms of few flexible bodies: time, corrections, matrices, deviations.

    python tests/benchmarks/bench_small.py [--json] [--before PYTHON] [--pairs N] [NAME ...]
    python tests/benchmarks/bench_small.py --many [--json] [--before PYTHON] [--steps N]

Printed are least microseconds a step, corrections and matrices a step, halved steps, and the
largest deviations of coordinates and velocities from a run with tolerance 1e-12, over their
largest. PYTHON is the interpreter of an environment with another version of sebody: then the same
of that version, and the median of the ratios of interleaved pairs. A time is that of the processor
in the loop, the least of three runs.

A single run may happen to take a halved step more or less; `--many` takes chains of two to seven
links, default and inertia b, with several steps from 0.004 to 0.012 (N of them): geometric means.
"""

import argparse
import json
import statistics
import subprocess
import sys
from pathlib import Path

import numpy as np

STEPS = 13
LOOSE, TIGHT = 1e-8, 1e-12
WORKER = """
import json, sys, time, types, warnings
sys.path.insert(0, sys.argv[1])
warnings.simplefilter("ignore")
import numpy as np
from sebody import Simulation, generalized_alpha
from small_mechanisms import MECHANISMS, links
sys.modules[Simulation.__module__].time = types.SimpleNamespace(perf_counter=time.thread_time)
known = {}

def of(name):
    if name in MECHANISMS:
        return MECHANISMS[name]()
    count, inertia, h = name.split()
    model = links(int(count), None if inertia == "default" else inertia)
    return model, float(h), round(1 / float(h))

for line in sys.stdin:
    name, tolerance, times = json.loads(line)
    if name not in known:
        known[name] = of(name)
    model, h, steps = known[name]
    spent = []
    for _ in range(times):
        one = Simulation(model, h, generalized_alpha(tolerance=tolerance))
        try:
            one.run_to(steps * h)
        except Exception:
            pass
        spent.append(one.seconds / max(one.state.control.grid, 1) * 1e6)
    control, parts = one.state.control, one.state.recorded_parts
    moving = one.system.is_multiplier[:one.state.q.size] == 0.0
    rows = one.rows.all()
    print(json.dumps({"us": min(spent), "corrections": control.iterations / steps,
                      "matrices": control.matrices / steps, "cuts": int(control.cuts),
                      "failed": bool(control.grid < steps),
                      **{k: rows[:, parts[k]][:, moving].ravel().tolist() if times == 1 else []
                         for k in "qv"}}), flush=True)
"""


class Version:
    """A process that runs mechanisms when asked to."""

    def __init__(self, python: str = sys.executable):
        self.process = subprocess.Popen(
            [python, "-P", "-c", WORKER, str(Path(__file__).resolve().parents[1])], text=True,
            stdin=subprocess.PIPE, stdout=subprocess.PIPE)

    def run(self, name: str, times: int = 3, tolerance: float = LOOSE) -> dict:
        """Microseconds a step and counts; of one run also its states."""
        print(json.dumps((name, tolerance, times)), file=self.process.stdin, flush=True)
        return json.loads(self.process.stdout.readline())

    def deviations(self, name: str) -> list[float]:
        """Of coordinates and velocities from the run with a tight tolerance."""
        own, exact = (self.run(name, 1, tolerance) for tolerance in (LOOSE, TIGHT))
        if own["failed"] or exact["failed"] or own["cuts"] or exact["cuts"]:
            return [float("nan")] * 2
        return [float(np.abs(np.subtract(own[k], exact[k])).max() / np.abs(exact[k]).max())
                for k in "qv"]


def measure(name: str, versions: list[Version], pairs: int, deviations: bool = True) -> dict:
    """Rows of all versions, the first one is this; median of the ratios to the last."""
    spent = []
    rows = [version.run(name, 1) for version in versions]        # compiles what is missing
    for k in range(pairs):
        turn = 1 if k % 2 else -1
        spent.append([version.run(name)["us"] for version in versions[::turn]][::turn])
    for version, row, times in zip(versions, rows, zip(*spent, strict=True), strict=True):
        del row["q"], row["v"]
        row["us"] = min(times)
        if deviations:
            row["deviations"] = version.deviations(name)
    return {"rows": rows, "ratio": statistics.median(own[0] / own[-1] for own in spent)}


def many(versions: list[Version], steps: int) -> dict:
    """Geometric means over chains of few links with several steps; halved steps."""
    found = [measure(f"{count} {inertia} {h}", versions, 1) for count in range(2, 8)
             for inertia in ("default", "b") for h in np.linspace(0.004, 0.012, steps).tolist()]
    fair = [one for one in found if np.isfinite([r["deviations"] for r in one["rows"]]).all()]
    return {"runs": len(found), "ratio": statistics.geometric_mean(one["ratio"] for one in found),
            "largest ratio": max(one["ratio"] for one in found),
            "compared": len(fair), "rows": [{
                "runs with halved steps": sum(one["rows"][k]["cuts"] > 0 for one in found),
                "failed": sum(one["rows"][k]["failed"] for one in found),
                "corrections": statistics.mean(one["rows"][k]["corrections"] for one in found),
                "matrices": statistics.mean(one["rows"][k]["matrices"] for one in found),
                "deviations": [statistics.geometric_mean(
                    max(one["rows"][k]["deviations"][i], 1e-16) for one in fair)
                    for i in range(2)] if fair else [],
                "largest": [max(one["rows"][k]["deviations"][i] for one in fair)
                            for i in range(2)] if fair else []} for k in range(len(versions))]}


def main(given=None):
    """Print the table."""
    from small_mechanisms import MECHANISMS

    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", metavar="NAME")
    parser.add_argument("--before", metavar="PYTHON", help="interpreter of another version")
    parser.add_argument("--pairs", type=int, default=9)
    parser.add_argument("--many", action="store_true", help="many chains in place of a table")
    parser.add_argument("--steps", type=int, default=STEPS)
    parser.add_argument("--json", action="store_true", help="for programs")
    chosen = parser.parse_intermixed_args(given)
    versions = [Version(), *([Version(chosen.before)] if chosen.before else [])]
    if chosen.many:
        print(json.dumps(many(versions, chosen.steps), indent=None if chosen.json else 1))
        return
    names = chosen.names or list(MECHANISMS)
    if chosen.json:
        print(json.dumps({name: measure(name, versions, chosen.pairs) for name in names}))
        return
    print("| mechanism | us a step | ratio | corrections | matrices | halved | deviations q, v |\n"
          "|---|---|---|---|---|---|---|")
    for name in names:
        row = measure(name, versions, chosen.pairs)
        parts = [[f"{r['us']:.2f}", f"{r['corrections']:.2f}", f"{r['matrices']:.2f}",
                  str(r["cuts"]), " ".join(f"{d:.0e}" for d in r["deviations"])]
                 for r in row["rows"]]
        us, *others = ("; ".join(own) for own in zip(*parts, strict=True))
        print(f"| {name} | {us} | {row['ratio']:.2f} | " + " | ".join(others) + " |", flush=True)


if __name__ == "__main__":
    sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
    main()
