"""The plain way to compile beside the fast one: first runs, and differences of the numbers.

Both ways run the scenes of ``sebody bench`` for a few steps, or what is named, with a new cache:
the first scene compiles the time loop and its kernels, others the kernels they have beyond those.
"""

import argparse
import json
import os
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))      # for the helpers of the tests

from plain_numbers import compared  # noqa: E402

from sebody.verify.bench import SCENES  # noqa: E402


def measured(name: str, folder: Path) -> dict[str, float]:
    """Largest difference and the seconds of both ways, first and second time."""
    differences, first = compared(folder, name)
    second = compared(folder, name)[1]
    return {"difference": max(differences.values()),
            "fast first": first["0"], "plain first": first["1"],
            "fast again": second["0"], "plain again": second["1"]}


def main(arguments: list[str] | None = None) -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*", default=SCENES, help="scenes or kernels")
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args(arguments)
    found = {}
    with tempfile.TemporaryDirectory() as folder:
        os.environ["NUMBA_CACHE_DIR"] = folder
        for name in options.names:
            found[name] = row = measured(name, Path(folder))
            if not options.json:
                print(f"{name:40} {row['difference']:8.1e} " + "".join(
                    f"  {key} {row[key]:6.1f} s" for key in row if key != "difference"), flush=True)
    if options.json:
        print(json.dumps(found, indent=1))


if __name__ == "__main__":
    main()
