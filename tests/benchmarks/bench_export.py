"""Exported libraries against the same runs in Python: bits, sizes, times.

    python tests/benchmarks/bench_export.py [SCENE ...] [--json] [--pairs N] [--t-end T]

Every scene is exported, run by a C program without Python, and by `Simulation` where Numba compiles
for the same processor. Speeds are ratios of runs in one process that take turns: time in the time
loop of the JIT over that in the library. Exports are measured warm: what is compiled once for a
processor was compiled before.
"""

import argparse
import ctypes
import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

PROCESSOR = "x86-64-v3"
LONGEST, MOST_PAIRS = 3.0, 200      # seconds of pairs beyond those asked for, and pairs


def compiled_example(folder: Path, name: str, platform: str) -> Path:
    """The example of a library, compiled."""
    from sebody.export import toolchain

    program = folder / "example"
    toolchain.call(folder / "example.c", f"-I{folder}", f"-L{folder / platform}", f"-l{name}",
                   f"-Wl,-rpath,{folder / platform}", "-o", program, folder=folder)
    return program


def rows_of(program: Path, steps: int, columns: int):
    """What the program records, in a process without Python."""
    import numpy as np

    subprocess.run([program, str(steps), program.parent / "rows"], check=True, env={})
    return np.fromfile(program.parent / "rows").reshape(steps, columns)


def needed(library: Path) -> list[str]:
    """Libraries that a library needs."""
    said = subprocess.run(["ldd", library], capture_output=True, text=True, check=True).stdout
    return sorted(line.split()[0].split("/")[-1].split(".")[0] for line in said.splitlines()
                  if "vdso" not in line and "ld-linux" not in line)


def speed(library: Path, name: str, scene, steps: int, pairs: int) -> float:
    """Time of the JIT over that of the library, the best of both."""
    import numpy as np

    from sebody import Simulation

    loaded = ctypes.CDLL(str(library))
    new, run = getattr(loaded, f"{name}_new"), getattr(loaded, f"{name}_run")
    new.restype = ctypes.c_void_p
    run.argtypes = ctypes.c_void_p, ctypes.c_int64, ctypes.c_void_p
    free = getattr(loaded, f"{name}_free")
    free.argtypes = (ctypes.c_void_p,)
    columns = Simulation(scene.model, scene.h).state.now.size
    rows, best = np.zeros((steps, columns)), [np.inf, np.inf]
    end = time.perf_counter() + LONGEST
    for k in range(MOST_PAIRS):
        if k >= pairs and time.perf_counter() > end:
            break
        simulation = Simulation(scene.model, scene.h)
        simulation.run_to(steps * scene.h)
        model = new()
        began = time.perf_counter()
        run(model, steps, rows.ctypes.data)
        took = time.perf_counter() - began
        free(model)
        best = [min(best[0], simulation.seconds), min(best[1], took)]
    return best[0] / best[1]


def measure(scene_name: str, pairs: int, t_end: float | None) -> dict:
    """Everything about one scene."""
    import numpy as np

    from sebody import Simulation
    from sebody.basics.errors import SebodyError
    from sebody.catalogue import builder
    from sebody.export import export
    from sebody.export.platforms import host

    scene = builder(scene_name)()
    steps = round(min(t_end or scene.t_end, scene.t_end) / scene.h)
    with tempfile.TemporaryDirectory() as place:
        folder, name = Path(place) / "library", scene_name.replace("-", "_")
        try:
            began = time.perf_counter()
            export(scene.model, scene.h, library=folder, name=scene_name, processor=PROCESSOR)
            seconds = time.perf_counter() - began
            library = next((folder / host()).glob("lib*"))
            own = Simulation(scene.model, scene.h).run_to(steps * scene.h).result().rows[1:]
            program = compiled_example(folder, name, host())
            rows = rows_of(program, steps, own.shape[1])
        except (SebodyError, subprocess.CalledProcessError) as error:
            return {"failure": str(error)[:200]}
        return {"steps": steps, "bitwise": bool(rows.tobytes() == own.tobytes()),
                "largest difference": float(np.abs(rows - own).max()),
                "library kB": library.stat().st_size / 1000, "export s": seconds,
                "needs": needed(library),
                "speed": speed(library, name, scene, steps, pairs) if pairs else None}


def main(arguments: list[str] | None = None) -> None:
    """Measure and print."""
    from sebody.catalogue import scenes

    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scenes", nargs="*", metavar="SCENE", help="all by default")
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--pairs", type=int, default=3)
    parser.add_argument("--t-end", type=float, help="of scenes that take longer")
    options = parser.parse_args(arguments)
    found = {}
    if not options.json:
        print("| scene | steps | bitwise | library kB | export s | speed | needs |\n"
              "|---|---|---|---|---|---|---|")
    for name in options.scenes or scenes():
        found[name] = measure(name, options.pairs, options.t_end)
        if not options.json:
            print(_line(name, found[name]), flush=True)
    if options.json:
        print(json.dumps(found))


def _line(name: str, row: dict) -> str:
    if "failure" in row:
        return f"| {name} | {row['failure']} | | | | | |"
    ratio = "" if row["speed"] is None else f"{row['speed']:.2f}"
    return (f"| {name} | {row['steps']} | {'yes' if row['bitwise'] else 'no'} | "
            f"{row['library kB']:.0f} | {row['export s']:.1f} | {ratio} | "
            f"{', '.join(row['needs'])} |")


def in_its_own_process() -> None:
    """Start this script again where Numba compiles for the processor."""
    from sebody.export.platforms import environment

    variables = environment(PROCESSOR)
    if os.environ.get("NUMBA_CPU_NAME") != PROCESSOR:
        os.execve(sys.executable, [sys.executable, *sys.argv], {**os.environ, **variables})


if __name__ == "__main__":
    in_its_own_process()
    main()
