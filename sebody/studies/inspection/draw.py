"""Picture of a body's mesh and interfaces."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sebody.io.body_file import BodyFile
from sebody.results.plots import ACCENT, INK, PALE, write_picture

MOST_EDGES = 20000      # that are drawn: beyond, every so many
# pairs of corners that edges join, by meshio's name of the cell without its number of nodes
_QUAD = [(0, 1), (1, 2), (2, 3), (3, 0)]
_TRIANGLE = [(0, 1), (1, 2), (2, 0)]
EDGES = {
    "line": [(0, 1)], "triangle": _TRIANGLE, "quad": _QUAD,
    "tetra": [*_TRIANGLE, (0, 3), (1, 3), (2, 3)],
    "wedge": [*_TRIANGLE, (3, 4), (4, 5), (5, 3), (0, 3), (1, 4), (2, 5)],
    "hexahedron": [*_QUAD, (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)],
}


def draw(file: BodyFile, centre: NDArray, path: Path) -> None:
    """Edges of the cells, boundary nodes with their names, centre of mass."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    points = np.asarray(file.parts["coordinates"], dtype=float)
    planar = points.shape[1] == 2
    figure = Figure(figsize=(8, 5), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.add_subplot(projection=None if planar else "3d")
    _draw_edges(axes, file, planar)
    axes.plot(*points.T, "o", color=ACCENT, markersize=6, label="interfaces")
    axes.plot(*[[x] for x in centre], "+", color=INK, markersize=10, label="centre of mass")
    for name, keep, point in zip(file.names, file.parts["keeps"], points, strict=True):
        axes.text(*point, f"  {name} ({keep})", color=INK, fontsize=8)
    axes.set_aspect("equal")
    everything = points if file.mesh is None else np.vstack([points, file.mesh[0]])
    axes.set_title(" x ".join(f"{size:.5g}" for size in np.ptp(everything, axis=0)), loc="left",
                   fontsize=9)
    axes.legend(frameon=False, fontsize=8, loc="upper right")
    if not planar:
        axes.set_axis_off()
        axes.set_box_aspect(np.maximum(np.ptp(everything, axis=0), 1e-300), zoom=1.15)
    write_picture(figure, path, 130)


def _draw_edges(axes, file: BodyFile, planar: bool) -> None:
    if file.mesh is None:
        return
    nodes, cells = file.mesh
    edges = np.array(list(_edges(cells)), dtype=int).reshape(-1, 2)
    edges = np.unique(np.sort(edges, axis=1), axis=0)
    lines = nodes[edges[::len(edges) // MOST_EDGES + 1]]
    if planar:
        from matplotlib.collections import LineCollection as Lines
    else:
        from mpl_toolkits.mplot3d.art3d import Line3DCollection as Lines
    axes.add_collection(Lines(list(lines), colors=PALE, linewidths=0.4))


def _edges(cells: tuple[tuple[str, NDArray], ...]) -> Iterator[tuple[int, int]]:
    for kind, nodes in cells:
        for a, b in EDGES.get(kind.rstrip("0123456789"), []):
            yield from zip(nodes[:, a].tolist(), nodes[:, b].tolist(), strict=True)
