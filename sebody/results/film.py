"""Films of a moving model: gif (extra ``plot``) and mp4 (extra ``film``)."""

from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO

import numpy as np
from numpy.typing import NDArray

from sebody.errors import InputError
from sebody.results.plots import ACCENT, INK, PALE, check_matplotlib
from sebody.results.scenery import Scenery, extent, vertices

if TYPE_CHECKING:
    from matplotlib.axes import Axes

RATES = {".gif": 15, ".mp4": 30}        # frames a second
MOST_FRAMES = 901       # of a film
SIZE, DPI = (9.6, 5.4), 100     # inch, pixels an inch
COLORS = ("#4c78a8", "#e4873f", "#5a9e6f", "#b65d7c", "#8a6fb0", "#c8a23c", "#4aa3a8", "#9c755f")
ROD, SPRING = "#8d97aa", "#2a7f62"
LINK = 0.007            # half the width of links, of the model's extent
MARKS = {"ground": ("^", PALE), "drive": ("o", ACCENT), "mass": ("o", INK)}
BEHIND = 0.05           # by which faces that face away are put back, of the model's extent
ROOM = 1.08             # of the picture, over what moves


def check_film(suffix: str) -> None:
    """Refuse a film that cannot be made.

    Raises
    ------
    InputError
        A package is missing.
    """
    check_matplotlib()
    if suffix == ".mp4" and (find_spec("imageio") is None or find_spec("imageio_ffmpeg") is None):
        raise InputError('films of kind mp4 need imageio with ffmpeg: pip install "sebody[film]"; '
                         "gif needs matplotlib alone")


def frames_of(duration: float, speed: float, suffix: str) -> int:
    """Number of the frames of a film.

    Raises
    ------
    InputError
        More than there may be.
    """
    count = round(duration / speed * RATES[suffix]) + 1
    if count > MOST_FRAMES:
        least = duration * RATES[suffix] / (MOST_FRAMES - 1)
        raise InputError(f"at speed {speed:g} the film has {count} frames, more than "
                         f"{MOST_FRAMES}: give a speed of at least {least:.3g}, or make a page "
                         "(.html)")
    return max(count, 2)


def write_film(drawn: Scenery, title: str, path: Path, count: int, file: BinaryIO) -> None:
    """Write a film of `count` frames."""
    times = np.linspace(drawn.t[0], drawn.t[-1], count)
    frames = np.abs(drawn.t[:, None] - times).argmin(axis=0)
    rate = RATES[path.suffix]
    if path.suffix == ".gif":
        from PIL import Image  # matplotlib needs it

        pictures = (Image.fromarray(picture).quantize(64, dither=Image.Dither.NONE)
                    for picture in _pictures(drawn, title, frames))
        first = next(pictures)
        first.save(file, format="GIF", save_all=True, append_images=pictures, loop=0,
                   duration=round(1000 / rate))
        return
    import imageio.v2 as imageio

    with imageio.get_writer("<bytes>", format=".mp4", mode="I", fps=rate,
                            macro_block_size=4) as writer:
        for picture in _pictures(drawn, title, frames):
            writer.append_data(picture)
    file.write(writer.request.get_result())


def _pictures(drawn: Scenery, title: str, frames: NDArray) -> Iterator[NDArray]:
    """Pictures (height, width, 3) of some frames."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.collections import PolyCollection
    from matplotlib.figure import Figure

    figure = Figure(figsize=SIZE, dpi=DPI)
    canvas = FigureCanvasAgg(figure)
    axes = figure.add_axes((0, 0, 1, 1))
    eye = _Eye(drawn)
    _set_up(axes, eye, title)
    faces = axes.add_collection(PolyCollection([], zorder=3))
    clock = axes.text(0.985, 0.03, "", transform=axes.transAxes, ha="right", color=INK)
    path, = axes.plot([], [], color=ACCENT, linewidth=1.4, zorder=2)
    springs, = axes.plot([], [], color=SPRING, linewidth=1.6, zorder=4)
    marks = _marks(axes, drawn)
    trace = eye.seen(drawn.nodes[drawn.farthest].position)
    for k in frames:
        polygons, colors = _faces(drawn, eye, k)
        faces.set_verts(polygons)
        faces.set_facecolor(colors)
        faces.set_edgecolor(colors)
        clock.set_text(f"t = {drawn.t[k]:.4g}")
        path.set_data(*trace[:k + 1, :2].T)
        springs.set_data(*_springs(drawn, eye, k))
        for mark, node in marks:
            mark.set_data(*eye.seen(drawn.nodes[node].position[k:k + 1])[:, :2].T)
        canvas.draw()
        yield np.asarray(canvas.buffer_rgba())[..., :3].copy()


class _Eye:
    """Parallel projection: right, up and towards the eye, in units of the model's extent."""

    def __init__(self, drawn: Scenery) -> None:
        towards = drawn.towards / np.linalg.norm(drawn.towards)
        right = np.cross(drawn.up, towards)
        right /= np.linalg.norm(right)
        self.axes = np.array([right, np.cross(towards, right), towards])
        self.size = extent(drawn.nodes)
        places = np.concatenate([node.position for node in drawn.nodes.values()])
        self.middle = (places.min(axis=0) + places.max(axis=0)) / 2
        reach = np.abs(self.seen(places)).max(axis=0)
        self.half = ROOM * max(reach[1], reach[0] * SIZE[1] / SIZE[0], 0.35)

    def seen(self, points: NDArray) -> NDArray:
        """Points (n, 3) as right, up, and towards the eye."""
        return (points - self.middle) / self.size @ self.axes.T


def _set_up(axes: "Axes", eye: _Eye, title: str) -> None:
    axes.set_axis_off()
    axes.set_xlim(-eye.half * SIZE[0] / SIZE[1], eye.half * SIZE[0] / SIZE[1])
    axes.set_ylim(-eye.half, eye.half)
    axes.text(0.015, 0.95, title, transform=axes.transAxes, color=INK, fontsize=13)


def _marks(axes: "Axes", drawn: Scenery) -> list:
    """Marks of joints and supports, and the nodes that they are at."""
    found = []
    for sign in drawn.signs:
        shape, color = MARKS.get(sign.kind, ("o", INK))
        below = {"^": 1.5}.get(shape, 4)
        mark, = axes.plot([], [], shape, color=color, zorder=below,
                          markersize=10 if shape == "^" else 4.5)
        found.append((mark, sign.node))
    return found


def _faces(drawn: Scenery, eye: _Eye, k: int) -> tuple[list[NDArray], NDArray]:
    """Polygons from back to front, with their colours."""
    polygons, colors, depths = [], [], []
    for number, body in enumerate(drawn.bodies):
        corners = eye.seen(vertices(body, k))[body.surface.triangles]
        away = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[:, 2] < 0
        colors.append(_shaded(corners, COLORS[number % len(COLORS)]))
        polygons += list(corners[..., :2])
        depths.append(corners[..., 2].mean(axis=1) - BEHIND * away)
    for link in drawn.links:
        if link.kind != "spring":
            ends = eye.seen(np.array([drawn.nodes[name].position[k] for name in link.ends]))
            polygons.append(_ribbon(ends))
            colors.append(_rgb(COLORS[0] if link.kind == "body" else ROD)[None])
            depths.append(ends[:, 2].mean(keepdims=True))
    if not polygons:
        return [], np.zeros((0, 3))
    order = np.argsort(np.concatenate(depths))
    return [polygons[i] for i in order], np.concatenate(colors)[order]


def _ribbon(ends: NDArray) -> NDArray:
    """A line of some width, (4, 2)."""
    way = ends[1, :2] - ends[0, :2]
    aside = LINK * np.array([-way[1], way[0]]) / max(np.linalg.norm(way), 1e-12)
    return np.array([ends[0, :2] - aside, ends[1, :2] - aside, ends[1, :2] + aside,
                     ends[0, :2] + aside])


def _springs(drawn: Scenery, eye: _Eye, k: int) -> tuple[NDArray, NDArray]:
    """Zigzags, with gaps between them."""
    part = np.linspace(0.0, 1.0, 17)
    side = np.where((part > 0.1) & (part < 0.9), 2 * LINK * (-1.0)**np.arange(17), 0.0)
    points = [np.zeros((0, 2))]
    for link in drawn.links:
        if link.kind == "spring":
            a, b = eye.seen(np.array([drawn.nodes[name].position[k] for name in link.ends]))[:, :2]
            aside = np.array([a[1] - b[1], b[0] - a[0]]) / max(np.linalg.norm(b - a), 1e-12)
            points += [a + part[:, None] * (b - a) + side[:, None] * aside, [[np.nan, np.nan]]]
    return tuple(np.concatenate(points).T)


def _shaded(corners: NDArray, color: str) -> NDArray:
    """Colours of triangles by their slope against the light."""
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    normals *= np.where(normals[:, 2:] < 0, -1.0, 1.0)
    light = np.array([-0.35, 0.55, 0.75])
    bright = 0.55 + 0.5 * np.maximum(normals @ light, 0.0)
    return np.clip(bright[:, None] * _rgb(color), 0.0, 1.0)


def _rgb(color: str) -> NDArray:
    return np.array([int(color[k:k + 2], 16) for k in (1, 3, 5)]) / 255
