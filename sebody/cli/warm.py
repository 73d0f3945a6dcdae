"""``sebody warm``: compile everything that is shipped, for images."""

import argparse
import time


def add(commands: argparse._SubParsersAction) -> argparse.ArgumentParser:
    """The parser of the command."""
    return commands.add_parser("warm", help="compile all shipped kernels and the time loop")


def run(options: argparse.Namespace) -> int:
    """Compile, and print how long it takes."""
    from sebody.catalogue import kernel_files
    from sebody.kernels.loader import load
    from sebody.runs.first_run import PARTS, compile_missing, compile_part

    began, names = time.perf_counter(), list(kernel_files())
    compile_missing(names, PARTS,
                    lambda name, seconds: print(f"  {name:44} {seconds:6.1f} s", flush=True))
    for name in names:          # what was not worth a process, or failed in one
        load(name)
    for name in PARTS:
        compile_part(name)
    print(f"{len(names)} kernels and the time loop are compiled: "
          f"{time.perf_counter() - began:.1f} s")
    return 0
