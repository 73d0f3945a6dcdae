"""Transposed products of all shipped kernels, and of some others, against their matrices.

Steps read backwards are executed as plain Python, as is the matrix: errors relative to its largest
entries, and the arithmetic of a product over that of one column.
"""

import argparse
import json
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))      # for tests/transposed_kernels.py

from transposed_kernels import both, element_error, superelement_error  # noqa: E402

from sebody.derive.compiler import Variant, statements_of  # noqa: E402
from sebody.derive.kernels.catalogue import ELEMENTS  # noqa: E402
from sebody.derive.kernels.manifest import SUPERELEMENTS  # noqa: E402

OTHERS = (("f1r2", "converged_mean", "d"), ("t4", "positions", "c"),
          ("planar-t3", "positions", "d"), ("f2t1", "mean", "b"), ("f3d", "mean_small", "a"))


def superelements() -> list[Variant]:
    """Every shipped frame and inertia option, of specialised and general layouts."""
    return [Variant(*row) for row in (*SUPERELEMENTS, *OTHERS)]


def row(kernel: Variant | str) -> dict[str, float]:
    """Error of the products; operations of all of them at once over those of a column."""
    if isinstance(kernel, str):
        return {"error": element_error(kernel)}
    free = {} if kernel.inertia in "ab" and not kernel.layout.endswith("d") else {"damping": 0.3}
    found, column = both(kernel)[2], statements_of(kernel).column
    return {"error": superelement_error(kernel, **free),
            "operations": sum(found) / sum(column)}


def main(arguments: list[str] | None = None) -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("kernels", nargs="*", help="LAYOUT:FRAME:INERTIA or an element")
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args(arguments)
    given = [Variant(*name.split(":")) if ":" in name else name for name in options.kernels]
    found = {}
    for kernel in given or [*superelements(), *ELEMENTS]:
        name = kernel if isinstance(kernel, str) else ":".join(kernel)
        found[name] = row(kernel)
        if not options.json:
            print(f"{name:34} {found[name]['error']:9.1e} "
                  f"{found[name].get('operations', 0.0):6.2f}", flush=True)
    if options.json:
        print(json.dumps(found))


if __name__ == "__main__":
    main()
