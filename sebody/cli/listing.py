"""``sebody list``: scenes and kernels there are."""

import argparse

from sebody.kernels.names import ELEMENT
from sebody.studies.catalogue import kernels, scenes


def add(commands: argparse._SubParsersAction) -> argparse.ArgumentParser:
    """The parser of the command."""
    return commands.add_parser("list", help="list scenes and kernels")


def run(options: argparse.Namespace) -> int:
    """Print the lists."""
    print("scenes")
    for name, summary in scenes().items():
        print(f"  {name:24} {summary}")
    found = kernels()
    print("\nsuperelement kernels\n  layout         frame            inertia")
    for kernel in found:
        if kernel.layout:
            print(f"  {kernel.layout:14} {kernel.frame:16} {kernel.inertia}")
    print("  frame 'node' is the converged_mean kernel with all weight on one node\n"
          "  inertia a: angular velocities in frame axes, b: material\n"
          "  layout any: every other one; faster or damped: python -m sebody.derive LAYOUT")
    print("\njoints and loads")
    print("  " + ", ".join(k.name.removeprefix(ELEMENT) for k in found if not k.layout))
    return 0
