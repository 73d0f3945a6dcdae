"""Import of a connecting rod of C3D10 beside CalculiX's own frequencies: time, memory, accuracy.

    python tests/benchmarks/bench_import.py [--json] [--sizes 4.2 3 2.4] [--before PYTHON]

Needs gmsh and ccx. Each size of element is meshed once; ``ccx`` writes the matrices, then computes
twenty frequencies of the free part, and of that with rigid holes; ``import_body`` makes a body with
two rigid holes and twenty modes, each in a process of its own with one BLAS thread. PYTHON is the
interpreter of another version, which imports the same files in turn. Seconds are those of the
processor, user and system.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

from sebody.io import import_body, load_body, read_fe_model
from sebody.reduction import free_frequencies

SIZES = (4.2, 3.0, 2.4)
MODES = 20
HOLES = {"big": "cylinder:0,0,0;z;22@0,0,0", "small": "cylinder:160,0,0;z;11@160,0,0"}
MATERIAL = ["*MATERIAL, NAME=STEEL", "*ELASTIC", "210000., .3", "*DENSITY", "7.85e-9",
            "*SOLID SECTION, ELSET=ROD, MATERIAL=STEEL", "*STEP"]
ONE = {name: "1" for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")}
IMPORT = """
import json, sys
from sebody.io import import_body
body = import_body(sys.argv[1], json.loads(sys.argv[2]), int(sys.argv[3]), units="mm t N s",
                   output=sys.argv[4])
"""


def mesh(size: float, folder: Path) -> Path:
    """A deck without a step, by gmsh: an I-shaped shaft between two eyes."""
    import gmsh

    gmsh.initialize()
    gmsh.option.setNumber("General.Verbosity", 0)
    occ = gmsh.model.occ
    eyes = [occ.addCylinder(x, 0, -11, 0, 0, 22, r) for x, r in ((0, 30), (160, 18))]
    shaft = occ.addBox(0, -11, -11, 160, 22, 22)
    pockets = [occ.addBox(34, -8, z, 104, 16, 10) for z in (4, -14)]
    rod, _ = occ.fuse([(3, eyes[0])], [(3, eyes[1]), (3, shaft)])
    rod, _ = occ.cut(rod, [(3, one) for one in pockets])
    holes = [occ.addCylinder(x, 0, -11, 0, 0, 22, r) for x, r in ((0, 22), (160, 11))]
    rod, _ = occ.cut(rod, [(3, one) for one in holes])
    occ.synchronize()
    gmsh.option.setNumber("Mesh.MeshSizeMax", size)
    gmsh.option.setNumber("Mesh.MeshSizeMin", size)
    gmsh.model.mesh.generate(3)
    gmsh.model.mesh.setOrder(2)
    labels, places, _ = gmsh.model.mesh.getNodes()
    elements, nodes = gmsh.model.mesh.getElementsByType(11)     # ten-node tetrahedra
    gmsh.finalize()
    nodes = nodes.reshape(-1, 10)[:, [0, 1, 2, 3, 4, 5, 6, 7, 9, 8]]    # order of CalculiX
    used = np.unique(nodes)
    by_label = dict(zip(labels.tolist(), places.reshape(-1, 3).tolist(), strict=True))
    lines = ["*NODE, NSET=ALL", *(f"{k}, " + ", ".join(f"{x:.12g}" for x in by_label[k])
                                  for k in used.tolist()),
             "*ELEMENT, TYPE=C3D10, ELSET=ROD",
             *(f"{k}, " + ", ".join(map(str, own)) for k, own in
               zip(elements.tolist(), nodes.tolist(), strict=True)), *MATERIAL]
    deck = folder / "rod.txt"
    deck.write_text("\n".join(lines) + "\n")
    return deck


def with_rigid_holes(text: str) -> str:
    """The deck with both holes tied to nodes on their axes by ``*RIGID BODY``."""
    rows = [line.split(",") for line in text.partition("*ELEMENT")[0].splitlines()[1:]]
    places = {int(label): [float(x) for x in place] for label, *place in rows}
    cards, last = [], max(places)
    for k, (x, radius) in enumerate(((0, 22), (160, 11))):
        own = [label for label, (a, b, _) in places.items()
               if abs(np.hypot(a - x, b) - radius) < 1e-3]
        place, turn = last + 2 * k + 1, last + 2 * k + 2
        cards += [f"*NODE\n{place}, {x}, 0, 0\n{turn}, {x}, 0, 0", f"*NSET, NSET=HOLE{k}",
                  ",\n".join(map(str, own)),
                  f"*RIGID BODY, NSET=HOLE{k}, REF NODE={place}, ROT NODE={turn}"]
    return text.replace("*STEP", "\n".join([*cards, "*STEP"]))


def measured(command: list[str], folder: Path) -> dict[str, float]:
    """Processor seconds and peak megabytes of a process."""
    child = subprocess.Popen(command, cwd=folder, env={**os.environ, **ONE},
                             stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    _, status, used = os.wait4(child.pid, 0)
    if status:
        raise SystemExit(child.stderr.read().decode()[-2000:])
    return {"seconds": used.ru_utime + used.ru_stime, "megabytes": used.ru_maxrss / 1024}


def frequencies(path: Path) -> list[float]:
    """Elastic frequencies in cycles per second that ccx has printed in a .dat file."""
    rows = [line.split() for line in path.read_text().splitlines() if len(line.split()) == 5]
    found = [float(row[3]) for row in rows if row[0].isdecimal()]
    return found[6:]


def row(size: float, before: Path | None) -> dict:
    """Everything about one size of element."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        text = mesh(size, folder).read_text()
        for job, deck, step in (("se", text, "*FREQUENCY, SOLVER=MATRIXSTORAGE"),
                                ("fr", text, "*FREQUENCY\n26"),
                                ("rb", with_rigid_holes(text), "*FREQUENCY\n26")):
            (folder / f"{job}.inp").write_text(deck + step + "\n*END STEP\n")
        for job in ("se", "rb"):
            measured(["ccx", "-i", job], folder)
        result = {"size": size, "rows": len((folder / "se.dof").read_text().splitlines()),
                  "ccx": measured(["ccx", "-i", "fr"], folder)}
        versions = {"before": str(before)} if before else {}
        versions["import"] = sys.executable
        for version, python in versions.items():
            command = [python, "-c", IMPORT, "se.inp", json.dumps(HOLES), str(MODES),
                       f"{version}.npz"]
            result[version] = measured(command, folder)
        own = frequencies(folder / "fr.dat")
        model = read_fe_model(folder / "se.inp")
        free = free_frequencies(model, 10)
        result["free part off ccx"] = float(np.abs(free / own[:10] - 1).max())
        means = {key: f"rbe3:{value}" for key, value in HOLES.items()}
        rigid = frequencies(folder / "rb.dat")
        for kind, faces, known in (("rbe2", HOLES, rigid), ("rbe3", means, own)):
            for method in ("craig-bampton", "rubin"):
                body = import_body(folder / "se.inp", faces, MODES, method=method)
                squares = np.linalg.eigvals(np.linalg.solve(body.mass, body.stiffness)).real
                hertz = np.sqrt(np.sort(squares)[6:12]) / (2 * np.pi)
                result[f"{kind}, {method}, off ccx"] = [float(x) for x in hertz / known[:6] - 1]
        result["rigid holes stiffen"] = [float(x) for x in np.divide(rigid[:6], own[:6]) - 1]
        if before:
            one, other = (load_body(folder / f"{version}.npz") for version in versions)
            result["differences"] = {
                "frequencies": _off(np.sort(np.diag(one.stiffness)[-MODES:]),
                                    np.sort(np.diag(other.stiffness)[-MODES:])),
                "Q": _off(one.invariants.Q, other.invariants.Q),
                "Ghat": _off(one.invariants.Ghat, other.invariants.Ghat)}
        return result


def _off(one: np.ndarray, other: np.ndarray) -> float:
    """Largest difference, relative to the largest number."""
    return float(np.abs(one - other).max() / np.abs(one).max())


def main() -> None:
    """Print the rows."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--sizes", type=float, nargs="+", default=SIZES)
    parser.add_argument("--before", type=Path)
    options = parser.parse_args()
    rows = [row(size, options.before) for size in options.sizes]
    if options.json:
        print(json.dumps(rows, indent=1))
        return
    for one in rows:
        print(f"{one['rows']} rows: " + ", ".join(
            f"{key} {value['seconds']:.1f} s {value['megabytes']:.0f} MB"
            for key, value in one.items() if isinstance(value, dict) and "seconds" in value))
        for key, value in one.items():
            if "off" in key or key in ("differences", "rigid holes stiffen"):
                print(f"  {key}: {value}")


if __name__ == "__main__":
    main()
