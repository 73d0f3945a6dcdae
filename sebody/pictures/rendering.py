"""Pictures of surfaces by matplotlib: shaded, coloured by values, with a legend and axes."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.pictures.palette import AXES, LOAD, MAP, rgb
from sebody.pictures.plots import INK

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

BEHIND = 0.05           # by which faces that face away are put back, of the size of the picture
LIFT = 0.004            # by which edges are put before the faces they belong to
LIGHT = np.array([-0.35, 0.55, 0.75])
TICKS = 4               # about, of a legend


class Eye:
    """Parallel projection: right, up and towards the eye.

    Parameters
    ----------
    towards, up : (3,)
        Directions from the middle to the eye, and up on the picture.
    middle : (3,)
        What is seen in the middle.
    size : float
        Length that is 1 in the picture.
    """

    def __init__(self, towards: NDArray, up: NDArray, middle: NDArray, size: float) -> None:
        towards = towards / np.linalg.norm(towards)
        right = np.cross(up, towards)
        right /= np.linalg.norm(right)
        self.axes = np.array([right, np.cross(towards, right), towards])
        self.middle, self.size = middle, size

    def seen(self, points: NDArray) -> NDArray:
        """Points (n, 3) as right, up, and towards the eye."""
        return (points - self.middle) / self.size @ self.axes.T


class Solid(NamedTuple):
    """A surface to be drawn."""

    vertices: NDArray       # (vertices, 3)
    triangles: NDArray      # (triangles, 3)
    colours: NDArray        # (triangles, 3), or (3,) of all
    edges: NDArray          # (edges, 2) that are drawn
    alpha: float = 1.0
    ink: str = INK          # of the edges


def colours_of(values: NDArray, low: float, high: float) -> NDArray:
    """Colours (n, 3) of values in a range."""
    place = np.clip((values - low) / (high - low if high > low else 1.0), 0.0, 1.0)
    colours = np.array([rgb(colour) for colour in MAP])
    return np.stack([np.interp(place * (len(MAP) - 1), np.arange(len(MAP)), channel)
                     for channel in colours.T], axis=-1)


class Painter:
    """Polygons of a picture, from back to front."""

    def __init__(self, axes: "Axes", zorder: float = 3) -> None:
        from matplotlib.collections import PolyCollection

        self._faces = axes.add_collection(PolyCollection([], zorder=zorder))

    def draw(self, eye: Eye, solids: Sequence[Solid], ribbons: Sequence[tuple] = ()) -> None:
        """Draw surfaces, and ribbons given as flat polygons (4, 2), colour and depth."""
        polygons, faces, edges, depths = [], [], [], []
        for solid in solids:
            seen = eye.seen(solid.vertices)
            corners = seen[solid.triangles]
            away = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[:, 2] < 0
            colours = np.broadcast_to(solid.colours, (len(corners), 3))
            if solid.alpha < 1:                 # faces at the back would show through
                corners, colours, away = corners[~away], colours[~away], away[~away]
            shaded = np.column_stack([_shaded(corners, colours),
                                      np.full(len(corners), solid.alpha)])
            lines = seen[solid.edges]
            # all with four corners: matplotlib takes an array faster than a list
            polygons += [corners[:, [0, 1, 2, 2], :2], lines[:, [0, 1, 1, 0], :2]]
            ink = np.tile([*rgb(solid.ink), 0.75 * solid.alpha], (len(lines), 1))
            faces += [shaded, np.zeros_like(ink)]
            edges += [shaded if solid.alpha == 1 else np.zeros_like(shaded), ink]
            depths += [corners[..., 2].mean(axis=1) - BEHIND * away,
                       lines[..., 2].mean(axis=1) + LIFT]
        for corners, colour, depth in ribbons:
            polygons.append(corners[None])
            faces.append(np.array([[*rgb(colour), 1.0]]))
            edges.append(faces[-1])
            depths.append(np.array([depth]))
        if not polygons:
            return
        order = np.argsort(np.concatenate(depths), kind="stable")
        self._faces.set_verts(np.concatenate(polygons)[order])
        self._faces.set_facecolor(np.concatenate(faces)[order])
        self._faces.set_edgecolor(np.concatenate(edges)[order])
        self._faces.set_linewidth(0.7)


def ribbon(ends: NDArray, half: float) -> NDArray:
    """A line (2, 2) of some width, (4, 2)."""
    way = ends[1, :2] - ends[0, :2]
    aside = half * np.array([-way[1], way[0]]) / max(np.linalg.norm(way), 1e-12)
    return np.array([ends[0, :2] - aside, ends[1, :2] - aside, ends[1, :2] + aside,
                     ends[0, :2] + aside])


def add_legend(figure: "Figure", title: str, low: float, high: float,
               box: tuple[float, float, float, float]) -> "Axes":
    """A bar of colours with ticks; `box` is its left, bottom, width and height in the figure."""
    from matplotlib.ticker import MaxNLocator

    axes = figure.add_axes(box)
    colours = colours_of(np.linspace(0.0, 1.0, 256), 0.0, 1.0)
    axes.imshow(colours[None], aspect="auto", extent=(low, high, 0, 1))
    axes.set_yticks([])
    axes.xaxis.set_major_locator(MaxNLocator(TICKS))
    axes.xaxis.set_major_formatter(lambda value, _: short(value))
    axes.tick_params(labelsize=9, colors=INK, length=3)
    axes.set_title(title, loc="left", fontsize=10, color=INK, pad=4)
    for side in axes.spines.values():
        side.set_visible(False)
    return axes


def short(value: float) -> str:
    """A number with few letters: 4e7, 0.25."""
    size = abs(value)
    if size and (size >= 1e5 or size < 1e-3):
        digits, _, power = f"{value:.3e}".partition("e")
        return f"{float(digits):g}e{int(power)}"
    return f"{value:.4g}"


def add_axes_of_space(figure: "Figure", eye: Eye, box: tuple[float, float, float, float],
                      gravity: NDArray | None = None, planar: bool = False) -> None:
    """Arrows of the axes of space, and of gravity, in a corner of a figure."""
    axes = figure.add_axes(box)
    axes.set_axis_off()
    axes.set_aspect("equal")
    axes.set_xlim(-1.5, 1.5)
    axes.set_ylim(-1.5, 1.5)
    arrows = list(zip(eye.axes.T, "xyz", AXES, strict=True))[:2 if planar else 3]
    if gravity is not None:
        arrows.append((eye.axes @ gravity, "g", LOAD))
    for way, name, colour in sorted(arrows, key=lambda arrow: arrow[0][2]):
        long = np.hypot(*way[:2])
        axes.annotate("", way[:2], (0, 0), arrowprops={
            "arrowstyle": "-|>", "color": colour, "linewidth": 1.5, "shrinkA": 0, "shrinkB": 0,
            "linestyle": (0, (2, 1.5)) if name == "g" else "-"} if long > 0.2 else {
            "arrowstyle": "-", "color": colour})
        beside = way[:2] * (1 + 0.35 / long) if long > 0.2 else np.array([0.3, 0.3])
        axes.text(*beside, name, color=colour, ha="center", va="center", fontsize=10,
                  fontweight="bold")


def _shaded(corners: NDArray, colours: NDArray) -> NDArray:
    """Colours of triangles by their slope against the light."""
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    normals *= np.where(normals[:, 2:] < 0, -1.0, 1.0)
    bright = 0.55 + 0.5 * np.maximum(normals @ LIGHT, 0.0)
    return np.clip(bright[:, None] * colours, 0.0, 1.0)
