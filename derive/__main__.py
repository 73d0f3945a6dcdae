"""Write the kernels of the manifest, add the kernel of a layout, or check what is there.

    python -m sebody.derive                         write all shipped kernels
    python -m sebody.derive --check                 compare, writing nothing
    python -m sebody.derive f2t1 [f3:mean:a ...]    add kernels: LAYOUT[:FRAME[:INERTIA]]
"""

import argparse
import difflib
import os
import sys
from collections.abc import Iterable
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import sebody.generated
from sebody.derive.compiler import Variant, compile_kernel, file_name
from sebody.derive.kernels.layouts import Layout, LayoutError, fits
from sebody.derive.kernels.manifest import ELEMENTS, SUPERELEMENTS
from sebody.derive.kernels.options import (
    FRAMES,
    INERTIA_OPTIONS,
    frame_traits,
    inertia_traits,
)
from sebody.derive.printing.options import options_text
from sebody.files import replacing
from sebody.kernels.loader import user_directory
from sebody.kernels.names import PREFIXES

DEFAULT_INERTIA = "b"
SECONDS = {True: 2.5, False: 0.4}       # to derive a superelement, or another element


def shipped() -> dict[str, str]:
    """File name and text of every kernel of the manifest, and of the options' traits."""
    return {"options.py": options_text(frame_traits(), inertia_traits())} | files(
        [*(Variant(*row) for row in SUPERELEMENTS), *ELEMENTS])


def files(kernels: Iterable[Variant | str]) -> dict[str, str]:
    """File name and text of some kernels, derived in as many processes as there are processors.

    Raises
    ------
    LayoutError
        A layout that cannot carry its frame.
    """
    kernels, processors = list(kernels), os.cpu_count() or 1
    names = list(map(file_name, kernels))
    processes = min(processors, len(kernels))
    if processes < 2:
        return dict(zip(names, map(compile_kernel, kernels), strict=True))
    seconds = sum(SECONDS[isinstance(kernel, Variant)] for kernel in kernels) / processes
    print(f"deriving {len(kernels)} kernels in {processes} processes, about {seconds:.0f} s",
          file=sys.stderr, flush=True)
    with ProcessPoolExecutor(processes) as pool:
        return dict(zip(names, pool.map(compile_kernel, kernels), strict=True))


def parse_variant(text: str) -> Variant:
    """``LAYOUT[:FRAME[:INERTIA]]`` with the defaults filled in."""
    parts = text.split(":")
    layout = Layout.parse(parts[0])
    carried = [name for name, frame in frame_traits().items() if fits(layout, frame)]
    frame = parts[1] if len(parts) > 1 else (carried or list(FRAMES))[0]
    inertia = parts[2] if len(parts) > 2 else DEFAULT_INERTIA
    for value, known, what in ((frame, FRAMES, "frame"),
                               (inertia, INERTIA_OPTIONS, "inertia option")):
        if value not in known:
            raise LayoutError(f"{what} {value!r} is unknown: use one of {', '.join(known)}")
    return Variant(layout.name, frame, inertia)


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
    """What `--check` prints: diffs of stale files, names of missing and orphaned ones."""
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
        if path.name.startswith(PREFIXES) and path.name not in files:
            out.append(f"orphaned: {path.name} is not in derive/kernels/manifest.py: "
                       "add it or delete it")
    return out


def main(arguments: list[str] | None = None) -> int:
    """Run the command; returns the exit code."""
    parser = argparse.ArgumentParser(prog="python -m sebody.derive", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("layouts", nargs="*", metavar="LAYOUT[:FRAME[:INERTIA]]")
    parser.add_argument("--check", action="store_true", help="compare, writing nothing")
    options = parser.parse_args(arguments)
    directory = Path(sebody.generated.__file__).parent
    try:
        if options.layouts:
            texts = files(map(parse_variant, options.layouts))
            directory = directory if os.access(directory, os.W_OK) and not os.environ.get(
                "SEBODY_KERNELS") else user_directory()
        else:
            texts = shipped()
    except LayoutError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    count = sum(name.startswith(PREFIXES) for name in texts)
    if options.check:
        found = differences(directory, texts, orphans=not options.layouts)
        print("\n".join(found) if found else f"{count} kernels are up to date")
        return 1 if found else 0
    changed = write(directory, texts)
    print(f"{count} kernels derived, {len(changed)} written to {directory}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
