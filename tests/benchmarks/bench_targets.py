"""What is made of the form of kernels beside those that are shipped, for all of them.

Products with derivatives, of which half are steps read backwards, against the matrix, both executed
as plain Python: errors relative to its largest entries, and the arithmetic of a transposed product
over that of one column. Elements as C against what Numba compiles, where there is a C compiler.
"""

import argparse
import json
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))      # for the helpers of the tests

from c_kernels import COMPILER, compiled, largest_difference  # noqa: E402
from products_kernels import both, element_error, superelement_error  # noqa: E402

from sebody.derive.compiler import Variant, statements_of  # noqa: E402
from sebody.derive.kernels.catalogue import ELEMENTS, SMOOTH  # noqa: E402
from sebody.derive.kernels.manifest import SUPERELEMENTS  # noqa: E402
from sebody.derive.names import kernel_of  # noqa: E402
from sebody.derive.printing.c.files import file_text  # noqa: E402
from sebody.kernels.loader import element_kernel  # noqa: E402

OTHERS = (("f1r2", "converged_mean", "rigid_part"), ("t4", "positions", "floating_field"),
          ("planar-t3", "positions", "rigid_part"), ("f2t1", "mean", "material"),
          ("f3d", "mean_small", "frame_axes"))
DAMPING = 0.3
WITHOUT = {"a", "b"}        # options whose kernels have no damping unless their layout says so


def of_superelement(variant: Variant) -> dict[str, float]:
    """Error of the products; operations of all of them at once over those of a column."""
    undamped = variant.inertia in WITHOUT and not variant.layout.endswith("d")
    found, column = both(variant)[2], statements_of(variant).column
    return {"transposed": superelement_error(variant, **({} if undamped else {"damping": DAMPING})),
            "operations": sum(found) / sum(column)}


def of_element(kind: str) -> dict[str, float]:
    """Error of the product, and of the C text."""
    found = {"transposed": element_error(kind)} if kind in SMOOTH else {}
    if COMPILER:
        with tempfile.TemporaryDirectory() as folder:
            library = compiled(file_text([statements_of(kind)]), Path(folder))
            found["c"] = largest_difference(library[f"element_{kind}"], element_kernel(kind), 0)
    return found


def main(arguments: list[str] | None = None) -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("kernels", nargs="*", help="LAYOUT:FRAME:INERTIA or an element")
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args(arguments)
    every = [*(Variant(*row) for row in (*SUPERELEMENTS, *OTHERS)), *ELEMENTS]
    found = {}
    for kernel in map(kernel_of, options.kernels) if options.kernels else every:
        name = kernel if isinstance(kernel, str) else ":".join(kernel)
        row = of_element(kernel) if isinstance(kernel, str) else of_superelement(kernel)
        found[name] = row
        if not options.json:
            print(f"{name:34}", *(f"{key} {value:.2g}" for key, value in row.items()), flush=True)
    if options.json:
        print(json.dumps(found))


if __name__ == "__main__":
    main()
