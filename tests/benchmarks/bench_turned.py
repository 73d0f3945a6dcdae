"""Errors of struck bodies that are not straight, by the rotation between their interfaces.

    python tests/benchmarks/bench_turned.py [--json] [SEED ...]

Twelve frames of three or four slender members in space, `of_three` in `tests/struck_frames.py`, one
body of 12 modes each, spun and struck to turn by 0.1 and 0.2 rad in linear theory; beside nonlinear
beams, four a member, over four periods. Errors of places are relative to the size of the frame, and
compared with the square of the largest rotation between two interfaces.
"""

import argparse
import json
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))
from struck_frames import beside_beams, of_three

SEEDS, TURNS = range(20, 32), (0.1, 0.2)


def main(given=None):
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("seeds", nargs="*", type=int, default=list(SEEDS), help="of frames")
    parser.add_argument("--json", action="store_true", help="for programs")
    chosen = parser.parse_args(given)
    rows = []
    for seed in chosen.seeds:
        for turn in TURNS:
            found = beside_beams(of_three(seed, turn))
            warned = any("against each other" in message for message in found.warnings)
            rows.append({"seed": seed, "turn": found.turn, "error": found.error,
                         "share": found.error / found.turn**2, "warned": warned})
            if not chosen.json:
                print(f"| {seed} | {found.turn:.3f} | {found.error:.4f} | "
                      f"{rows[-1]['share']:.2f} | {'yes' if warned else ''} |", flush=True)
    if chosen.json:
        print(json.dumps(rows))


if __name__ == "__main__":
    main()
