"""Decks as users write them, and what CalculiX 2.20 makes of them: `decks.tar.xz`.

    python tests/data/calculix/decks.py         (needs ccx; a second)

Millimetres, tonnes, newtons, seconds; every part is turned in space and lies 1e4 off the origin.
"""

import subprocess
import tarfile
import tempfile
from itertools import product
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

TURN = Rotation.from_rotvec([0.3, -0.5, 0.8]).as_matrix()
PLACE = np.array([1e4, -2e3, 500.0])
STEEL = "*MATERIAL, NAME=STEEL\n*ELASTIC\n2.1E5, 0.3\n*DENSITY\n7.85E-9\n"
ALLOY = "*MATERIAL, NAME=Alloy\n*ELASTIC, TYPE=ISO\n7.0D4, 0.33\n*DENSITY\n2.7E-9\n"
STEP = "*STEP\n*FREQUENCY, SOLVER=MATRIXSTORAGE\n*END STEP\n"
EDGES = {4: ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)),
         8: ((0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5),
             (2, 6), (3, 7))}
SPLIT = {4: ((0, 1, 2, 6), (0, 2, 3, 6), (0, 3, 7, 6), (0, 7, 4, 6), (0, 4, 5, 6), (0, 5, 1, 6)),
         6: ((0, 1, 2, 4, 5, 6), (0, 2, 3, 4, 6, 7)), 8: (tuple(range(8)),)}
KINDS = {(4, 4): "C3D4", (4, 10): "C3D10", (6, 6): "C3D6", (8, 8): "C3D8", (8, 20): "C3D20"}


class Mesh:
    """Nodes and elements of a grid of bricks, each cut into solids of so many corners."""

    def __init__(self, grid, corners, quadratic=False, first=1):
        count = np.array(grid.shape[:3])
        index = np.arange(count.prod()).reshape(count)
        offsets = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0),
                   (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
        bricks = np.array([[index[i + a, j + b, k + c] for a, b, c in offsets]
                           for i, j, k in product(*map(range, count - 1))])
        cells = np.concatenate([bricks[:, part] for part in SPLIT[corners]])
        points = grid.reshape(-1, 3).tolist()
        if quadratic:
            middles: dict = {}
            more = []
            for cell in cells:
                for a, b in EDGES[corners]:
                    pair = frozenset((int(cell[a]), int(cell[b])))
                    if pair not in middles:
                        middles[pair] = len(points)
                        points.append(np.mean([points[k] for k in pair], axis=0).tolist())
                more.append([middles[frozenset((int(cell[a]), int(cell[b])))]
                             for a, b in EDGES[corners]])
            cells = np.hstack([cells, more])
        self.points, self.cells, self.first = np.array(points), cells, first
        self.kind = KINDS[corners, cells.shape[1]]
        self.labels = first + np.arange(len(points))
        self.elements = first + np.arange(len(cells))

    def where(self, condition):
        """Labels of the nodes at which a function of x, y, z holds."""
        return self.labels[condition(*self.points.T)]

    def text(self, element_set):
        """*NODE and *ELEMENT."""
        placed = PLACE + self.points @ TURN.T
        return ("*NODE\n" + rows(zip(self.labels, *placed.T, strict=True))
                + f"*ELEMENT, TYPE={self.kind}, ELSET={element_set}\n"
                + "".join(wrapped([label, *self.labels[cell]])
                          for label, cell in zip(self.elements, self.cells, strict=True)))


def box(divisions, lower, upper):
    """A grid of points."""
    lines = [np.linspace(a, b, n + 1) for a, b, n in zip(lower, upper, divisions, strict=True)]
    return np.stack(np.meshgrid(*lines, indexing="ij"), axis=-1)


def rows(found):
    """Lines of numbers."""
    return "".join(", ".join(f"{x:.12g}" if isinstance(x, float) else str(x) for x in row) + "\n"
                   for row in found)


def wrapped(numbers):
    """Numbers of one element or set in lines of ten, as CalculiX takes them."""
    lines = [numbers[k:k + 10] for k in range(0, len(numbers), 10)]
    return ",\n".join(", ".join(map(str, line)) for line in lines) + "\n"


def listed(keyword, labels):
    """A set by its labels."""
    lines = [labels[k:k + 10] for k in range(0, len(labels), 10)]
    return f"*{keyword}\n" + "".join(", ".join(map(str, line)) + ",\n" for line in lines)


def at(*point):
    """A point of the drawing in the deck's axes."""
    return (PLACE + TURN @ np.array(point)).tolist()


def tied():
    """Two parts of different kinds and materials, tied; a mass; sections on sets of sets."""
    one = Mesh(box((3, 1, 2), (0, 0, 0), (30, 8, 10)), 8, True)
    two = Mesh(box((2, 2, 3), (30, 0, 0), (50, 8, 10)), 6, first=1001)
    last = [label for label, cell in zip(one.elements, one.cells, strict=True)
            if (one.points[cell[[1, 2, 6, 5]], 0] == 30).all()]
    faces = "".join(f"{label}, S4\n" for label in last)
    return (one.text("Volume1") + two.text("Volume2")
            + listed("ELSET, ELSET=HALF", one.elements[:3])
            + f"*ELSET, ELSET=REST, GENERATE\n{one.elements[3]}, {one.elements[-1]}\n"
            + "*ELSET, ELSET=Bar\nHalf, REST\n" + "*ELSET, ELSET=Head\nVOLUME2\n"
            + "*SURFACE, NAME=FAR, TYPE=ELEMENT\n" + faces
            + "*SURFACE, NAME=NEAR, TYPE=NODE\n"
            + "".join(f"{label},\n" for label in two.where(lambda x, y, z: x == 30))
            + "*TIE, NAME=GLUE, POSITION TOLERANCE=0.1\nNEAR, FAR\n"
            + listed("NSET, NSET=LEFT", one.where(lambda x, y, z: x == 0))
            + listed("NSET, NSET=RIGHT", two.where(lambda x, y, z: x == 50))
            + f"*ELEMENT, TYPE=MASS, ELSET=LUMP\n5001, {one.where(lambda x, y, z: x == 10)[0]}\n"
            + "*MASS, ELSET=LUMP\n4.0E-6\n" + STEEL + ALLOY
            + "*SOLID SECTION, ELSET=BAR, MATERIAL=Steel\n"
            + "*SOLID SECTION, ELSET=HEAD, MATERIAL=ALLOY\n" + STEP)


def laminate():
    """Quadratic tetrahedra of two orthotropic materials in axes of their own."""
    mesh = Mesh(box((3, 1, 2), (0, 0, 0), (40, 10, 6)), 4, True)
    low = mesh.points[mesh.cells].mean(axis=1)[:, 2] < 3
    along, across = (TURN @ np.array(v) for v in ((1.0, 0.2, 0.0), (0.0, 1.0, 0.0)))
    return (mesh.text("ALL") + listed("ELSET, ELSET=LOW", mesh.elements[low])
            + listed("ELSET, ELSET=HIGH", mesh.elements[~low])
            + listed("NSET, NSET=LEFT", mesh.where(lambda x, y, z: x == 0))
            + listed("NSET, NSET=RIGHT", mesh.where(lambda x, y, z: x == 40))
            + "*MATERIAL, NAME=FIBRE\n*ELASTIC, TYPE=ENGINEERING CONSTANTS\n"
            "1.3E5, 9000., 8000., 0.3, 0.28, 0.4, 5000., 4500.,\n3000.\n*DENSITY\n1.6E-9\n"
            "*MATERIAL, NAME=PLY\n*ELASTIC, TYPE=ORTHO\n"
            "4.0E4, 6000., 3.0E4, 5000., 5500., 2.0E4, 7000., 6000.,\n5000.\n*DENSITY\n1.8E-9\n"
            "*ORIENTATION, NAME=SKEW\n" + rows([[*along.tolist(), *across.tolist()]])
            + "3, 25.\n*ORIENTATION, NAME=PLAIN\n" + rows([[*across.tolist(), *along.tolist()]])
            + "*SOLID SECTION, ELSET=LOW, MATERIAL=FIBRE, ORIENTATION=SKEW\n"
            "*SOLID SECTION, ELSET=HIGH, MATERIAL=PLY, ORIENTATION=PLAIN\n" + STEP)


def loose():
    """Ends tied to reference nodes without nodes for their rotation."""
    mesh = Mesh(box((4, 1, 1), (0, 0, 0), (40, 6, 5)), 8)
    faces = [f"{label}, S6\n" for label, cell in zip(mesh.elements, mesh.cells, strict=True)
             if (mesh.points[cell[[0, 3, 7, 4]], 0] == 0).all()]
    return (mesh.text("ALL") + "*NODE\n" + rows([[900, *at(40, 3, 2.5)], [800, *at(-5, 3, 2.5)]])
            + listed("NSET, NSET=RIGHT", mesh.where(lambda x, y, z: x == 40))
            + "*SURFACE, NAME=LEFT\n" + "".join(faces)
            + "*RIGID BODY, NSET=RIGHT, REF NODE=900\n"
            "*COUPLING, REF NODE=800, SURFACE=LEFT, CONSTRAINT NAME=C\n*KINEMATIC\n1, 3\n"
            + STEEL + "*SOLID SECTION, ELSET=ALL, MATERIAL=STEEL\n" + STEP)


def hole():
    """A plate with a hole whose mesh is fine on one side, and a node that no element has."""
    angles = 2 * np.pi * np.array([0, 0.2, 0.38, 0.54, 0.67, 0.77, 0.85, 0.91, 0.96, 1.0])
    unit = np.stack([np.cos(angles), np.sin(angles)], axis=-1)
    square = unit / np.abs(unit).max(axis=-1, keepdims=True)
    grid = np.empty((len(angles), 3, 2, 3))
    for ring, plane in enumerate((4.0 * unit, 7.0 * unit, 12.0 * square)):
        for layer, height in enumerate((0.0, 5.0)):
            grid[:, ring, layer, :2], grid[:, ring, layer, 2] = plane, height
    mesh = Mesh(grid[:, ::-1], 4, True)         # outwards is inwards: bricks right way round
    _close(mesh)
    bore = mesh.where(lambda x, y, z: np.hypot(x, y) < 4 + 1e-9)
    corner = mesh.cells[:, :4]
    faces = [f"{label}, S{number}\n"
             for label, cell in zip(mesh.elements, corner, strict=True)
             for number, own in enumerate(((0, 1, 2), (0, 3, 1), (1, 3, 2), (2, 3, 0)), 1)
             if np.isin(mesh.labels[cell[list(own)]], bore).all()]
    return (mesh.text("PLATE") + "*NODE\n" + rows([[9001, *at(0, 0, -40)]])
            + listed("NSET, NSET=BORE", [*bore, 9001]) + "*SURFACE, NAME=WALL\n" + "".join(faces)
            + listed("NSET, NSET=EDGE", mesh.where(lambda x, y, z: np.isclose(x, 12)))
            + STEEL + "*SOLID SECTION, ELSET=PLATE, MATERIAL=STEEL\n" + STEP)


def _close(mesh):
    """Join the nodes that coincide, where the grid meets itself."""
    _, first, where = np.unique(mesh.points.round(9), axis=0, return_index=True,
                                return_inverse=True)
    mesh.cells = first[where.ravel()][mesh.cells]
    used = np.unique(mesh.cells)
    place = np.full(len(mesh.points), -1)
    place[used] = np.arange(len(used))
    mesh.points, mesh.cells = mesh.points[used], place[mesh.cells]
    mesh.labels = mesh.first + np.arange(len(used))


def main():
    """Write the archive."""
    with tempfile.TemporaryDirectory() as folder:
        for make in (tied, laminate, loose, hole):
            path = Path(folder) / f"{make.__name__}.inp"
            path.write_text(make())
            done = subprocess.run(["ccx", "-i", path.stem], cwd=folder, capture_output=True,
                                  text=True, check=True)
            assert "ERROR" not in done.stdout, done.stdout
        with tarfile.open(Path(__file__).with_name("decks.tar.xz"), "w:xz", preset=9) as archive:
            for path in sorted(Path(folder).iterdir()):
                if path.suffix in (".inp", ".sti", ".mas", ".dof"):
                    member = archive.gettarinfo(path, f"decks/{path.name}")
                    member.mtime = member.uid = member.gid = 0
                    member.uname = member.gname = ""
                    with path.open("rb") as content:
                        archive.addfile(member, content)


if __name__ == "__main__":
    main()
