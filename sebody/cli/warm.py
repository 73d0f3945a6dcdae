"""``sebody warm``: compile all that single runs of shipped kernels need, for images."""

import argparse
import time


def add(commands: argparse._SubParsersAction) -> argparse.ArgumentParser:
    """The parser of the command."""
    return commands.add_parser(
        "warm", help="compile all shipped kernels, also for eight equal bodies, and the time loop",
        description="Compile the time loop and all shipped kernels, those of bodies also for eight "
        "equal bodies at a time. Ensembles, sweeps, gradients and runs that threads share compile "
        "what they need beyond that when they are first run.")


def run(options: argparse.Namespace) -> int:
    """Compile, and print how long it takes."""
    from sebody.basics.tabular import counted
    from sebody.catalogue import kernel_files
    from sebody.kernels.loader import load
    from sebody.runs.first_run import (
        PARTS,
        compile_missing,
        compile_of_eight,
        compile_part,
        of_bodies,
    )

    began, names = time.perf_counter(), list(kernel_files())
    together = of_bodies(names)
    compile_missing(names, PARTS,
                    lambda name, seconds: print(f"  {name:60} {seconds:6.1f} s", flush=True),
                    together)
    for name in names:          # what was not worth a process, or failed in one
        load(name)
    compile_of_eight(together)
    for name in PARTS:
        compile_part(name)
    print(f"{len(names)} kernels and the time loop are compiled, "
          f"{counted(len(together), 'kernel')} also for eight equal bodies: "
          f"{time.perf_counter() - began:.1f} s")
    return 0
