"""Picture of a body: its surface with the interfaces, and its free vibrations."""

from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from sebody.basics.units import parsed_units
from sebody.explore.inspection.measures import Matrices, free_modes
from sebody.io.body_file import BodyFile
from sebody.pictures.palette import BODIES, CURVES, rgb
from sebody.pictures.plots import ACCENT, INK, PALE, write_picture
from sebody.pictures.rendering import (
    Eye,
    Painter,
    Solid,
    add_axes_of_space,
    add_legend,
    colours_of,
    ribbon,
)
from sebody.pictures.surface import spatial, surface_of
from sebody.pictures.surface_parts import Surface
from sebody.pictures.wireframe import neighbours

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

SHOWN = 6               # free vibrations
COLUMNS = 3
WIDTH, ABOVE, BELOW = 11.0, 4.6, 2.5        # inch: of the picture, of the body, of a row of modes
TITLE = 0.4             # inch
ROOM = 1.08             # of a view, over what is seen
MARGIN = 0.04           # around the body, of its size
LARGEST = 0.12          # displacement of a mode, of the size of the body
LINE = 0.006            # half the width of a line between interfaces, of the size
DOTS = 130              # an inch


class _Shape(NamedTuple):
    """A body that can be drawn in any of its motions."""

    surface: Surface | None
    points: NDArray         # (interfaces, 3)
    motions: NDArray        # (n, interfaces, 3) displacements of unit reduced coordinates
    lines: list[tuple[int, int]]        # between interfaces, of a body without a surface


class _View(NamedTuple):
    """The viewpoint, and what is visible of the undeformed body from there."""

    eye: Eye
    low: NDArray            # (2,) corners of what is seen
    high: NDArray


def draw(file: BodyFile, body: Matrices, centre: NDArray, path: Path) -> None:
    """The surface, boundary nodes with their names, centre of mass, free vibrations."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    shape, units = _shape(file, body), parsed_units(file.units)
    hertz, modes = free_modes(body, SHOWN)
    view = _view(shape, body.dimension == 2)
    rows = -(-len(hertz) // COLUMNS)
    height = ABOVE + BELOW * rows + 0.5 * (rows > 0)
    figure = Figure(figsize=(WIDTH, height), dpi=DOTS)
    FigureCanvasAgg(figure)
    axes = _axes(figure, (0.0, 1 - ABOVE / height, 1.0, (ABOVE - TITLE) / height), view, MARGIN)
    _draw_body(axes, view, shape, file, centre)
    add_axes_of_space(figure, view.eye, (0.9, 1 - 1.1 / height, 0.09, 0.99 / height),
                      planar=body.dimension == 2)
    figure.text(0.02, 1 - 0.8 * TITLE / height, _title(shape, body.dimension, file.units),
                color=INK, fontsize=11)
    unit = units.of("1/time") if units else "/time"
    for k, (frequency, mode) in enumerate(zip(hertz, modes.T, strict=True)):
        row, column = divmod(k, COLUMNS)
        low = 1 - (ABOVE + BELOW * (row + 1)) / height
        axes = _axes(figure, (column / COLUMNS, low, 1 / COLUMNS, (BELOW - 0.3) / height), view,
                     0.8 * LARGEST)
        _draw_mode(axes, view, shape, mode)
        figure.text((column + 0.06) / COLUMNS, low + (BELOW - 0.25) / height,
                    f"free vibration {k + 1}: {frequency:.5g} {unit}", color=INK,
                    fontsize=10)
    if rows and shape.surface is not None:
        add_legend(figure, "displacement of a mode, relative", 0.0, 1.0,
                   (0.02, 0.27 / height, 0.25, 0.1 / height))
    write_picture(figure, path, DOTS)


def _shape(file: BodyFile, body: Matrices) -> _Shape:
    recovery, n = file.parts.get("recovery"), len(body.stiffness)
    surface = None
    if recovery is not None and recovery.cells:
        surface = surface_of(recovery, recovery.shapes.shape[1])
    dimension, points = body.dimension, spatial(body.coordinates)
    motions = np.zeros((n, len(points), 3))
    kept = [k for k, keep in enumerate(body.keeps) if keep != "rotation"]
    for row, node in enumerate(kept):
        for axis in range(dimension):
            motions[dimension * row + axis, node, axis] = 1.0
    return _Shape(surface, points, motions, neighbours(points[kept]) if surface is None else [])


def _view(shape: _Shape, planar: bool) -> _View:
    """A view at the broad side of the body, its longest axis to the right."""
    places = shape.points if shape.surface is None else np.vstack(
        [shape.surface.vertices, shape.points])
    middle = (places.min(axis=0) + places.max(axis=0)) / 2
    size = float(np.linalg.norm(np.ptp(places, axis=0))) or 1.0
    if planar:
        eye = Eye(np.eye(3)[2], np.eye(3)[1], middle, size)
    else:
        away = places - places.mean(axis=0)
        axes = np.linalg.eigh(away.T @ away)[1].T       # from the shortest to the longest
        axes *= np.sign(axes[range(3), np.argmax(np.abs(axes), axis=1)])[:, None]
        flat, broad, long = axes
        flat = flat * np.sign(np.cross(long, broad) @ flat)     # the longest axis to the right
        eye = Eye(flat + 0.5 * broad + 0.35 * long, broad, middle, size)
    seen = eye.seen(places)[:, :2]
    return _View(eye, seen.min(axis=0), seen.max(axis=0))


def _axes(figure: "Figure", box: tuple[float, float, float, float], view: _View, margin: float
          ) -> "Axes":
    """Axes in which what is seen has its shape, in the middle."""
    axes = figure.add_axes(box)
    axes.set_axis_off()
    wide, high = box[2] * figure.get_figwidth(), box[3] * figure.get_figheight()
    middle, reach = (view.low + view.high) / 2, (view.high - view.low) / 2 + margin
    half = ROOM * max(reach[1], reach[0] * high / wide)
    axes.set_xlim(middle[0] - half * wide / high, middle[0] + half * wide / high)
    axes.set_ylim(middle[1] - half, middle[1] + half)
    return axes


def _draw_body(axes: "Axes", view: _View, shape: _Shape, file: BodyFile, centre: NDArray) -> None:
    colour = np.array(rgb(BODIES[0]))
    if shape.surface is not None:
        Painter(axes).draw(view.eye, [_facing(view.eye, shape.surface, shape.surface.vertices,
                                              colour)])
    else:
        _draw_lines(axes, view, shape, shape.points, BODIES[0])
    seen = view.eye.seen(shape.points)
    axes.plot(*seen[:, :2].T, "o", color=ACCENT, markersize=7, markeredgecolor="white", zorder=5,
              label="interfaces")
    axes.plot(*view.eye.seen(spatial(np.asarray(centre)[None]))[0, :2], "P", color=CURVES[3],
              markersize=9, markeredgecolor="white", zorder=5, label="centre of mass")
    middle = (view.low + view.high) / 2
    for name, keep, place in zip(file.names, file.parts["keeps"], seen, strict=True):
        above = place[1] >= middle[1]
        axes.annotate(name if keep == "full" else f"{name} ({keep})", place[:2],
                      (0, 16 if above else -16), textcoords="offset points", ha="center",
                      va="bottom" if above else "top", fontsize=10, color=INK, zorder=6,
                      bbox={"boxstyle": "round,pad=0.2", "facecolor": "white", "alpha": 0.85,
                            "edgecolor": PALE},
                      arrowprops={"arrowstyle": "-", "color": INK, "linewidth": 0.8})
    axes.legend(frameon=False, fontsize=9, loc="lower right", labelcolor=INK)


def _draw_mode(axes: "Axes", view: _View, shape: _Shape, mode: NDArray) -> None:
    """The body in a motion, coloured by its displacement, over its edges at rest."""
    if shape.surface is None:
        moved = np.tensordot(mode, shape.motions, 1)
        _draw_lines(axes, view, shape, shape.points, PALE)
        scale = _scale(view, moved)
        _draw_lines(axes, view, shape, shape.points + scale * moved, BODIES[0])
        return
    surface, n = shape.surface, len(mode)
    moved, turned = (np.tensordot(mode, part[:n], 1) for part in (surface.moves, surface.turns))
    still, local = surface.vertices, surface.weights @ turned
    whole = surface.weights @ moved + np.cross(local, surface.offsets)
    scale, sizes = _scale(view, whole), np.linalg.norm(whole, axis=1)
    vertices = surface.weights @ (surface.points + scale * moved) + Rotation.from_rotvec(
        scale * local).apply(surface.offsets)
    _plot_lines(axes, view.eye.seen(still)[surface.features][..., :2])
    colours = colours_of(sizes[surface.triangles].mean(axis=1), 0.0, float(sizes.max()))
    Painter(axes).draw(view.eye, [_facing(view.eye, surface, vertices, colours)])


def _scale(view: _View, moved: NDArray) -> float:
    largest = np.linalg.norm(moved, axis=1).max()
    return LARGEST * view.eye.size / largest if largest > 0 else 0.0


def _facing(eye: Eye, surface: Surface, vertices: NDArray, colours: NDArray) -> Solid:
    """The triangles that face the eye; edges that are seen from behind alone are left out."""
    corners = eye.seen(vertices)[surface.triangles]
    facing = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[:, 2] > 0
    triangles = surface.triangles[facing]
    seen = np.zeros(len(vertices), dtype=bool)
    seen[triangles] = True
    features = surface.features[seen[surface.features].all(axis=1)]
    return Solid(vertices, triangles, colours if colours.ndim == 1 else colours[facing], features)


def _draw_lines(axes: "Axes", view: _View, shape: _Shape, points: NDArray, colour: str) -> None:
    """Lines between the interfaces of a body without a surface."""
    seen = view.eye.seen(points)
    for i, j in shape.lines:
        axes.fill(*ribbon(seen[[i, j]], LINE).T, color=colour, linewidth=0, zorder=2)


def _plot_lines(axes: "Axes", lines: NDArray) -> None:
    """Pale lines (n, 2, 2)."""
    from matplotlib.collections import LineCollection

    axes.add_collection(LineCollection(list(lines), colors=PALE, linewidths=0.6, zorder=1))


def _title(shape: _Shape, dimension: int, units: str) -> str:
    """The size of the box around the body, in words."""
    places = shape.points if shape.surface is None else np.vstack(
        [shape.surface.vertices, shape.points])
    sizes = " x ".join(f"{size:.5g}" for size in np.ptp(places, axis=0)[:dimension])
    what = "" if shape.surface is not None else ", no mesh: lines between the interfaces"
    return f"{sizes} {units.split()[0] if units else ''}".rstrip() + what
