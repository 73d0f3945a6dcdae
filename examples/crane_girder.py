"""The girder of the scene `crane` as a deck for CalculiX, and the body file that is made of it.

    python examples/crane_girder.py         (needs ccx; a second)

It writes ``crane_girder.npz`` beside itself: a bar of 20 x 0.25 x 0.7 m of elements C3D20, as stiff
as a box girder and of a third of the density of steel, with end faces LEFT and RIGHT and a set RAIL
of the nodes along the middle of its top. A body file is made once: it takes no FE program to run
the scene.
"""

import subprocess
import tempfile
from itertools import product
from pathlib import Path

import numpy as np

from sebody.io import import_body
from sebody.reduction import ReducedBody

LENGTH, WIDTH, HEIGHT, PARTS = 20.0, 0.25, 0.7, 16      # m; elements along
FILE = Path(__file__).with_suffix(".npz")
CORNERS = (0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0), (0, 0, 2), (2, 0, 2), (2, 2, 2), (0, 2, 2)
MIDDLES = ((1, 0, 0), (2, 1, 0), (1, 2, 0), (0, 1, 0), (1, 0, 2), (2, 1, 2), (1, 2, 2), (0, 1, 2),
           (0, 0, 1), (2, 0, 1), (2, 2, 1), (0, 2, 1))


def deck() -> str:
    """Text of the deck, metres and kilograms."""
    grid = [place for place in product(range(2 * PARTS + 1), range(3), range(3))
            if sum(k % 2 for k in place) < 2]       # corners and the middles of edges
    labels = {place: label for label, place in enumerate(grid, 1)}
    steps = np.array([LENGTH / PARTS, WIDTH, HEIGHT]) / 2
    low = np.array([0.0, -WIDTH / 2, -HEIGHT / 2])
    cells = [[labels[2 * k + x, y, z] for x, y, z in (*CORNERS, *MIDDLES)] for k in range(PARTS)]
    sets = {"LEFT": [n for place, n in labels.items() if place[0] == 0],
            "RIGHT": [n for place, n in labels.items() if place[0] == 2 * PARTS],
            "RAIL": [n for place, n in labels.items() if place[1:] == (1, 2)]}
    return ("*NODE\n" + _lines([[label, *(low + steps * place).tolist()]
                                for place, label in labels.items()])
            + "*ELEMENT, TYPE=C3D20, ELSET=GIRDER\n" + "".join(
                _lines([[k, *cell[:10]]]).rstrip() + ",\n" + _lines([cell[10:]])
                for k, cell in enumerate(cells, 1))
            + "".join(f"*NSET, NSET={name}\n" + _lines([[n] for n in own])
                      for name, own in sets.items())
            + "*MATERIAL, NAME=STEEL\n*ELASTIC\n2.1E11, 0.3\n*DENSITY\n2747.5\n"
            "*SOLID SECTION, ELSET=GIRDER, MATERIAL=STEEL\n"
            "*STEP\n*FREQUENCY, SOLVER=MATRIXSTORAGE\n*END STEP\n")


def _lines(rows: list) -> str:
    return "".join(", ".join(map(str, row)) + "\n" for row in rows)


def write_matrices(folder: Path) -> Path:
    """The deck in a folder, and what CalculiX makes of it."""
    path = folder / "girder.inp"
    path.write_text(deck())
    subprocess.run(["ccx", "-i", path.stem], cwd=folder, capture_output=True, check=True)
    return path


def girder(path: Path, output: Path | None = None) -> ReducedBody:
    """The body of a deck: two faces, four vibrations, static modes of loads on the rail."""
    return import_body(path, {"left": "rbe2:LEFT", "right": "rbe2:RIGHT"}, 4, paths=["RAIL:z:3"],
                       units="m kg s N", output=output)


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as place:
        print(girder(write_matrices(Path(place)), FILE).summary())
