"""Time to start, beside the libraries that every run needs: whole processes, quickest of several.

    python tests/benchmarks/bench_start.py [--json]

Compiled code is in the cache before anything is measured. The processes of all rows take turns.
"""

import argparse
import json
import subprocess
import sys
import time

COMMAND = ("from sebody.cli.entry import main\ntry:\n    main({})\n"
           "except SystemExit:\n    pass")
ROWS = {
    "import numba, scipy": "import numba, scipy",
    "import sebody": "import sebody",
    "from sebody import Model, simulate": "from sebody import Model, simulate",
    "sebody --help": COMMAND.format(["--help"]),
    "sebody --version": COMMAND.format(["--version"]),
    "sebody run hinged-beam": COMMAND.format(["run", "hinged-beam"]),
}


def seconds(code: str) -> float:
    """Of a process, from its start to its end."""
    began = time.perf_counter()
    subprocess.run([sys.executable, "-c", code], check=True, stdout=subprocess.DEVNULL)
    return time.perf_counter() - began


def measure(times: int) -> dict[str, float]:
    """Quickest of so many processes of each row, in seconds."""
    for code in ROWS.values():
        seconds(code)
    return {name: min(found) for name, *found in zip(
        ROWS, *([seconds(code) for code in ROWS.values()] for _ in range(times)), strict=True)}


def main(arguments: list[str] | None = None) -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--times", type=int, default=7)
    options = parser.parse_args(arguments)
    found = measure(options.times)
    if options.json:
        print(json.dumps(found))
        return
    for name, value in found.items():
        print(f"{name:36} {value:6.2f} s {value / found['import numba, scipy']:6.1f} times")


if __name__ == "__main__":
    main()
