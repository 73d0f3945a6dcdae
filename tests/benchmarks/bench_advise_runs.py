"""Which runs `advise` makes: how many an exact estimate of single parts could save.

    python tests/benchmarks/bench_advise_runs.py [--json] [--keep FILE] [SCENE ...]

Runs by what they are for: the reference model with several steps and its guards, forms of parts
alone, choices of all together, confirmations with half the step. With estimates without any error
there would be no runs alone and one choice: what is left is the least that any estimate can reach.
"""

import argparse
import json
import statistics
import sys
import warnings
from collections import Counter
from pathlib import Path

from sebody import LimitWarning
from sebody.basics.errors import SebodyError
from sebody.basics.files import replacing
from sebody.explore.advice import Unreached, advise

sys.path.insert(0, str(Path(__file__).parent))
from advice_general import GENERAL
from advice_scenes import SCENES, AdviceScene

TOLERANCES = (1e-2, 1e-3)
KINDS = "reference", "guard", "alone", "together", "confirmation", "given"


def counted(scene: AdviceScene, tolerance: float) -> dict:
    """Runs, and their seconds in the loop, by what they were for."""
    try:
        found = advise(scene.build(), scene.h, scene.t_end, scene.quantities, tolerance,
                       start=scene.start)
    except Unreached as reason:
        found = reason.advice
    except SebodyError as reason:
        return {"refused": str(reason)}
    runs: Counter[str] = Counter()
    seconds: Counter[str] = Counter()
    for one in found.table:
        runs[one.kind] += 1
        seconds[one.kind] += one.seconds
    return {"runs": runs, "seconds": seconds}


def shares(found: dict) -> tuple[float, float]:
    """What is left of runs, and of their seconds, with exact estimates: one choice, none alone."""
    left = []
    for own, choices in ((found["runs"], 1), (found["seconds"], None)):
        together = own.get("together", 0)
        if choices is None:     # as long as one of those that ran
            choices = together / max(found["runs"].get("together", 0), 1)
        kept = sum(own.values()) - own.get("alone", 0) - together + min(choices, together)
        left.append(kept / sum(own.values()))
    return left[0], left[1]


def table(found: dict[str, dict]) -> list[str]:
    """Lines of a table in Markdown, and what they come to."""
    lines = ["| scene | tolerance | " + " | ".join(KINDS) + " | left: runs | left: time |",
             "|---|---|" + "---|" * (len(KINDS) + 2)]
    left = []
    for name, each in found.items():
        for tolerance, one in each.items():
            if "refused" in one:
                continue
            own = shares(one)
            left.append(own)
            counts = " | ".join(str(one["runs"].get(kind, 0)) for kind in KINDS)
            lines.append(f"| {name} | {tolerance} | {counts} | {own[0]:.2f} | {own[1]:.2f} |")
    for k, what in enumerate(("runs", "time")):
        values = sorted(one[k] for one in left)
        lines.append(f"* {what} left, least, median, most: {values[0]:.2f}, "
                     f"{statistics.median(values):.2f}, {values[-1]:.2f}; at most half in "
                     f"{sum(value <= 0.5 for value in values)} of {len(values)} cases")
    return lines


def main(given: list[str] | None = None) -> None:
    """Count and print."""
    warnings.simplefilter("ignore", LimitWarning)
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scenes", nargs="*", metavar="SCENE")
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--keep", type=Path, metavar="FILE")
    options = parser.parse_args(given)
    found = json.loads(options.keep.read_text()) if options.keep and options.keep.exists() else {}
    for scene in (*SCENES, *GENERAL):
        if scene.name in found or (options.scenes and scene.name not in options.scenes):
            continue
        found[scene.name] = {f"{tolerance:g}": counted(scene, tolerance)
                             for tolerance in TOLERANCES}
        if options.keep:
            with replacing(options.keep, "numbers") as file:
                file.write(json.dumps(found).encode())
    print(json.dumps(found) if options.json else "\n".join(table(found)))


if __name__ == "__main__":
    main()
