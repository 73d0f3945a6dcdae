"""Steps of two versions of sebody side by side: interleaved pairs of runs in two processes.

    python tests/benchmarks/bench_pairs.py OTHER_PYTHON [--pairs N] [--json] [SCENE ...]

OTHER_PYTHON is the interpreter of an environment in which the other version is installed. Each pair
is a run of a scene here and one there, in turns. Printed are medians of the microseconds a step and
of the ratios of pairs, with quartiles, and the ratio of the least times. A time is that of the
processor in the loop, the least of five runs. Memory is laid out anew in each process, which makes
up to 4 % of a step: repeat the script before believing in less.
"""

import argparse
import json
import statistics
import subprocess
import sys

SCENES = ("hinged-beam", "planar-hinged-beam", "spherical-beam", "chain")
WORKER = """
import sys, time, types, warnings
warnings.simplefilter("ignore")
from importlib import import_module
from sebody import Simulation
sys.modules[Simulation.__module__].time = types.SimpleNamespace(perf_counter=time.thread_time)
scenes = {}
for line in sys.stdin:
    name = line.strip()
    module = "sebody.scenes." + name.replace("-", "_")
    scene = scenes.setdefault(name, import_module(module).build())
    t_end = min(scene.t_end, 2000 * scene.h)
    spent = []
    for _ in range(5):
        run = Simulation(scene.model, scene.h).run_to(t_end).result()
        spent.append(run.seconds / run.steps * 1e6)
    print(min(spent), flush=True)
"""


class Version:
    """A process that runs scenes when asked to."""

    def __init__(self, python: str):
        self.process = subprocess.Popen([python, "-P", "-c", WORKER], text=True,
                                        stdin=subprocess.PIPE, stdout=subprocess.PIPE)

    def run(self, scene: str) -> float:
        """Microseconds a step."""
        print(scene, file=self.process.stdin, flush=True)
        return float(self.process.stdout.readline())


def measure(scene: str, versions: list[Version], pairs: int) -> dict[str, float]:
    """Medians of a scene."""
    for version in versions:
        version.run(scene)      # compiles what is missing
    spent = []
    for k in range(pairs):
        turn = 1 if k % 2 else -1
        spent.append([version.run(scene) for version in versions[::turn]][::turn])
    ratios = [here / there for here, there in spent]
    quartiles = statistics.quantiles(ratios, n=4)
    return {"here": statistics.median(here for here, _ in spent),
            "there": statistics.median(there for _, there in spent),
            "least": min(here for here, _ in spent) / min(there for _, there in spent),
            "ratio": quartiles[1], "quartiles": [quartiles[0], quartiles[2]]}


def main(given=None):
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("python", help="interpreter of the other version")
    parser.add_argument("scenes", nargs="*", default=SCENES)
    parser.add_argument("--pairs", type=int, default=40)
    parser.add_argument("--json", action="store_true", help="for programs")
    chosen = parser.parse_intermixed_args(given)
    versions = [Version(sys.executable), Version(chosen.python)]
    rows = {scene: measure(scene, versions, chosen.pairs) for scene in chosen.scenes}
    if chosen.json:
        print(json.dumps(rows))
        return
    print("| scene | here, us | there, us | ratio | quartiles | of the least |\n"
          "|---|---|---|---|---|---|")
    for scene, row in rows.items():
        print(f"| {scene} | {row['here']:.3f} | {row['there']:.3f} | {row['ratio']:.3f} | "
              f"{row['quartiles'][0]:.3f} to {row['quartiles'][1]:.3f} | {row['least']:.3f} |")


if __name__ == "__main__":
    main()
