"""Write the kernels of the manifest, some of them, or one of a layout; or check what is there.

    python -m sebody.derive                         write all shipped kernels
    python -m sebody.derive --check                 compare, writing nothing
    python -m sebody.derive distance [spring ...]   kernels of the catalogue: joints, bodies, loads
    python -m sebody.derive f2t1 [f3:mean:a ...]    add kernels: LAYOUT[:FRAME[:INERTIA]]
    python -m sebody.derive products:spring         products with the derivatives of one of these
"""

import argparse
import difflib
import os
import sys
from collections.abc import Iterable
from concurrent.futures import ProcessPoolExecutor, as_completed
from functools import partial
from pathlib import Path

import sebody.generated
from sebody.basics.files import replacing
from sebody.basics.progress import Progress
from sebody.contract.names import PREFIXES, PRODUCTS as OF_PRODUCTS, motion_name
from sebody.derive.compiler import Products, Variant, compile_kernel, file_name
from sebody.derive.kernels.layouts import Layout, LayoutError
from sebody.derive.kernels.manifest import ELEMENTS, PRODUCTS, SUPERELEMENTS
from sebody.derive.kernels.options import frame_conditions, frame_traits, inertia_traits
from sebody.derive.names import kernel_of
from sebody.derive.printing.numba.options import options_text
from sebody.kernels.loader import find, user_directory

SECONDS = {Variant: 2.5, str: 0.4, Products: 2.5}       # to derive a kernel


def shipped() -> dict[str, str]:
    """File name and text of every kernel of the manifest, and of the options' traits."""
    products = (Products(one if isinstance(one, str) else Variant(*one)) for one in PRODUCTS)
    return _traits() | files([*(Variant(*row) for row in SUPERELEMENTS), *ELEMENTS, *products])


def _traits() -> dict[str, str]:
    """The file of the traits of frames and inertia options."""
    return {"options.py": options_text(frame_traits(), inertia_traits(), frame_conditions())}


def files(kernels: Iterable[Variant | Products | str], shipped: bool = True) -> dict[str, str]:
    """File name and text of some kernels, derived in as many processes as there are processors.

    Raises
    ------
    LayoutError
        A layout that cannot carry its frame.
    """
    kernels, processors = list(kernels), os.cpu_count() or 1
    names, compiled = list(map(file_name, kernels)), partial(compile_kernel, shipped=shipped)
    processes = min(processors, len(kernels))
    if processes < 2:
        return dict(zip(names, map(compiled, kernels), strict=True))
    seconds = sum(SECONDS[type(kernel)] for kernel in kernels) / processes
    print(f"deriving {len(kernels)} kernels in {processes} processes, about {seconds:.0f} s",
          file=sys.stderr, flush=True)
    done: dict[str, str] = {}
    bar = Progress()
    with ProcessPoolExecutor(processes) as pool:
        tasks = {pool.submit(compiled, kernel): name for name, kernel in sorted(
            zip(names, kernels, strict=True), key=lambda one: _length(one[0]), reverse=True)}
        for task in as_completed(tasks):
            done[tasks[task]] = task.result()
            bar(len(done) / len(kernels))
    bar.close()
    return {name: done[name] for name in names}


def _length(name: str) -> float:
    """Letters of a kernel that is there: the longest ones are derived first."""
    path = Path(sebody.generated.__file__).with_name(name)
    return path.stat().st_size if path.exists() else float("inf")


def _with_motions(kernels: Iterable[Variant | str]) -> list[Variant | str]:
    """Kernels, and those of the motions in their frames where there are none yet."""
    names = list(kernels)
    named = [motion_name(k.frame, Layout.parse(k.layout).planar) for k in names
             if isinstance(k, Variant)]
    return list(dict.fromkeys((*names, *(name for name in named if not find(name)))))


def write(directory: Path, files: dict[str, str]) -> list[str]:
    """Write the files whose text changed; the others keep their compiled cache."""
    directory.mkdir(parents=True, exist_ok=True)
    changed = []
    for name, text in files.items():
        path = directory / name
        if not path.exists() or path.read_text() != text:
            with replacing(path, "kernel") as file:
                file.write(text.encode())
            changed.append(name)
    return changed


def differences(directory: Path, files: dict[str, str], orphans: bool = True) -> list[str]:
    """The output of `--check`: diffs of stale files, names of missing and orphaned ones."""
    out = []
    for name, text in files.items():
        path = directory / name
        if not path.exists():
            out.append(f"missing: {name} (run python -m sebody.derive)")
        elif path.read_text() != text:
            out.append(f"stale: {name} (run python -m sebody.derive)")
            out += difflib.unified_diff(path.read_text().splitlines(), text.splitlines(),
                                        f"generated/{name}", f"derived/{name}", lineterm="", n=1)
    for path in sorted(directory.glob("*.py")) if orphans else ():
        if path.name.startswith((*PREFIXES, OF_PRODUCTS)) and path.name not in files:
            out.append(f"orphaned: {path.name} is not in derive/kernels/manifest.py: "
                       "add it or delete it")
    return out


def main(arguments: list[str] | None = None) -> int:
    """Run the command; returns the exit code."""
    parser = argparse.ArgumentParser(prog="python -m sebody.derive", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("kernels", nargs="*", metavar="NAME | LAYOUT[:FRAME[:INERTIA]]")
    parser.add_argument("--check", action="store_true", help="compare, writing nothing")
    options = parser.parse_args(arguments)
    directory = Path(sebody.generated.__file__).parent
    try:
        if options.kernels:
            own = os.access(directory, os.W_OK) and not os.environ.get("SEBODY_KERNELS")
            directory = directory if own else user_directory()
            texts = (_traits() if own else {}) | files(
                _with_motions(map(kernel_of, options.kernels)), shipped=own)
        else:
            texts = shipped()
    except LayoutError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    count = sum(name.startswith((*PREFIXES, OF_PRODUCTS)) for name in texts)
    kernels, are = ("kernel", "is") if count == 1 else ("kernels", "are")
    if options.check:
        outdated = differences(directory, texts, orphans=not options.kernels)
        print("\n".join(outdated) if outdated else f"{count} {kernels} {are} up to date")
        return 1 if outdated else 0
    changed = write(directory, texts)
    print(f"{count} {kernels} derived, {len(changed)} written to {directory}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
