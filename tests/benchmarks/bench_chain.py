"""Long chains: links eight at a time beside the same links one by one, pair by pair.

    python tests/benchmarks/bench_chain.py [--arc] [--json] [--pairs N] [--links N ...]
    python tests/benchmarks/bench_chain.py --threads N [--json] [--pairs N] [--links N ...]

The default body and option B, 100 steps. With --arc the chain hangs from an end of a half circle,
so links are oriented differently at the start. A time is that of the processor in the loop; printed
are the least microseconds a step, the median ratio of pairs, and the largest deviation of a
coordinate at the end. With `--threads` instead one thread beside so many, by the clock: every five
steps are timed on their own, and the least time counts, so other programs disturb less; processors
have to be free all the same. The results are compared bit by bit. `sebody bench chain` has the
times of all lengths beside Exudyn.
"""

import argparse
import json
import statistics
import time
import types
import warnings

import numpy as np
from scipy.spatial.transform import Rotation

from sebody import Model, Simulation
from sebody.assembly.equal_bodies import evaluate_alone
from sebody.runs import simulation as runs
from sebody.scenes import chain

PIECE = 5       # steps that are timed
STEP = 0.01
OPTIONS = {"default": {}, "B": {"inertia": "material"}}


def arc(links: int, inertia: str | None = None) -> Model:
    """Links on hinges along a half circle."""
    body, model = chain.link_body(), Model()
    model.gravity(chain.GRAVITY)
    last = model.node("base", np.zeros(3))
    model.revolute(last, axis=chain.AXIS)
    for k in range(links):
        turn = Rotation.from_rotvec([0.0, 0.0, np.pi * ((k + 0.5) / links - 0.5)]).as_matrix()
        end = model.node(f"end {k}", last.point + turn[:, 0])
        model.superelement(f"link {k}", body, [last, end], rotation=turn, inertia=inertia)
        if k < links - 1:
            last = model.node(f"begin {k}", end.point, at=end)
            model.revolute(end, chain.AXIS, to=last)
    return model


def run(links: int, option: str, together: bool, until: float, curved: bool
        ) -> tuple[float, Simulation]:
    """Microseconds a step, and the run."""
    options = OPTIONS[option]
    model = arc(links, **options) if curved else chain.build(links=links, **options).model
    one = Simulation(model, STEP)
    if not together:
        evaluate_alone(model, one.system)
    one.run_to(until)
    return one.seconds / one.result().steps * 1e6, one


def measure(links: int, option: str, pairs: int, until: float = 1.0, curved: bool = False
            ) -> dict[str, float]:
    """One row of the table."""
    spent = []
    for k in range(pairs):
        turns = (True, False) if k % 2 else (False, True)
        both = {how: run(links, option, how, until, curved) for how in turns}
        spent.append((both[True][0], both[False][0]))
    (_, one), (_, other) = both[True], both[False]
    return {"together": min(a for a, _ in spent), "alone": min(b for _, b in spent),
            "ratio": statistics.median(b / a for a, b in spent),
            "iterations": one.result().iterations_per_step,
            "deviation": float(np.abs(one.state.q - other.state.q).max())}


def measure_threads(links: int, option: str, pairs: int, threads: int,
                    until: float = 0.5) -> dict[str, float]:
    """One row of the table of threads."""
    scene = chain.build(links=links, **OPTIONS[option])
    pieces = round(until / scene.h / PIECE)
    least = np.full((2, pieces), np.inf)
    same = True
    for _ in range(pairs):
        both = [Simulation(scene.model, scene.h, threads=count) for count in (1, threads)]
        for k in range(pieces):
            for one, times in zip(both, least, strict=True):
                before = one.seconds
                one.run_to((k + 1) * PIECE * scene.h)
                times[k] = min(times[k], 1e6 / PIECE * (one.seconds - before))
        same &= np.array_equal(*(one.state.now for one in both))
    return {"one": least[0].mean(), "several": least[1].mean(),
            "ratio": float(np.median(least[0] / least[1])), "same": bool(same)}


def main(given=None):
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--arc", action="store_true", help="links oriented differently")
    parser.add_argument("--json", action="store_true", help="for programs")
    parser.add_argument("--pairs", type=int, default=5)
    parser.add_argument("--links", type=int, nargs="*", default=[8, 16, 64, 256, 1024])
    parser.add_argument("--threads", type=int, default=1)
    chosen = parser.parse_args(given)
    if chosen.threads > 1:
        _print_threads(chosen)
        return
    runs.time = types.SimpleNamespace(perf_counter=time.thread_time)
    warnings.simplefilter("ignore")
    rows = {f"{links}, {option}": measure(links, option, chosen.pairs, curved=chosen.arc)
            for links in chosen.links for option in OPTIONS}
    if chosen.json:
        print(json.dumps(rows))
        return
    print("| links | together, us | one by one, us | ratio | iterations | deviation |\n"
          "|---|---|---|---|---|---|")
    for name, row in rows.items():
        print(f"| {name} | {row['together']:.0f} | {row['alone']:.0f} | {row['ratio']:.2f} | "
              f"{row['iterations']:.2f} | {row['deviation']:.0e} |")


def _print_threads(chosen):
    """Print the table of threads."""
    warnings.simplefilter("ignore")
    rows = {f"{links}, {option}": measure_threads(links, option, chosen.pairs, chosen.threads)
            for links in chosen.links if links > 64 for option in OPTIONS}
    if chosen.json:
        print(json.dumps(rows))
        return
    print(f"| links | one thread, us | {chosen.threads} threads, us | ratio | same bits |\n"
          "|---|---|---|---|---|")
    for name, row in rows.items():
        print(f"| {name} | {row['one']:.0f} | {row['several']:.0f} | {row['ratio']:.2f} | "
              f"{row['same']} |")


if __name__ == "__main__":
    main()
