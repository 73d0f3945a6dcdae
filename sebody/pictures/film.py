"""Films of a moving model: gif (extra ``plot``) and mp4 (extra ``film``)."""

from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sebody.basics.errors import InputError
from sebody.pictures.colouring import colourings, values_of
from sebody.pictures.drawn_bodies import DrawnBody, vertices
from sebody.pictures.drawn_nodes import extent
from sebody.pictures.film_marks import Marks
from sebody.pictures.palette import WITHOUT_VALUE, rgb
from sebody.pictures.plots import INK, check_matplotlib
from sebody.pictures.rendering import (
    Eye,
    Painter,
    Solid,
    add_axes_of_space,
    add_legend,
    colours_of,
    short,
)
from sebody.pictures.scene import Scenery, seen_places

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from matplotlib.text import Text
    from PIL import Image

RATES = {".gif": 15, ".mp4": 30}        # frames a second
MOST_FRAMES = 901       # of a film
SIZE, DPI = (9.6, 5.4), 100     # inch, pixels an inch
COLOURS = 96, 256       # of a picture of a gif; of one with values
BELOW = 40              # rows of the legend's colours that are put below a picture to choose them
CLEAR = 0.6             # of rigid bodies, so that joints show through them
ROOM = 1.12             # of the picture, over what moves
LEGEND = 0.03, 0.155, 0.26, 0.028      # left, bottom, width and height of the bar, of the picture
LOW = 0.09              # bottom of a bar without lines below it, in a single picture,
FREE = 0.28             # and what is kept free for it below the model, of half of the height


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


def write_film(drawn: Scenery, title: str, path: Path, count: int, file: BinaryIO,
               colour: str | None = None) -> None:
    """Write a film of `count` frames, with a legend if bodies are coloured by a quantity."""
    times = np.linspace(drawn.t[0], drawn.t[-1], count)
    frames = np.abs(drawn.t[:, None] - times).argmin(axis=0)
    rate = RATES[path.suffix]
    drawings = pictures(drawn, title, frames, colour)
    if path.suffix == ".gif":
        made = _indexed(drawings, colour is not None)
        next(made).save(file, format="GIF", save_all=True, append_images=made, loop=0,
                        duration=round(1000 / rate))
        return
    import imageio.v2 as imageio

    with imageio.get_writer("<bytes>", format=".mp4", mode="I", fps=rate,
                            macro_block_size=4) as writer:
        for picture in drawings:
            writer.append_data(picture)
    file.write(writer.request.get_result())


def _indexed(pictures: Iterator[NDArray], valued: bool) -> "Iterator[Image.Image]":
    """Pictures of few colours, those of the legend among them if there is one."""
    from PIL import Image  # matplotlib needs it

    for picture in pictures:
        height, width, _ = picture.shape
        legend = np.rint(255 * colours_of(np.linspace(0.0, 1.0, width), 0.0, 1.0)).astype(np.uint8)
        rows = np.tile(legend, (BELOW if valued else 0, 1, 1))
        whole = Image.fromarray(np.concatenate([picture, rows]))
        yield whole.quantize(COLOURS[valued], dither=Image.Dither.NONE).crop((0, 0, width, height))


def pictures(drawn: Scenery, title: str, frames: ArrayLike, colour: str | None,
             letters: float = 1.0) -> Iterator[NDArray]:
    """Pictures (height, width, 3) of some frames.

    Parameters
    ----------
    letters : float
        Size of letters and lines over that of a film, for pictures that are shown small.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(SIZE[0] / letters, SIZE[1] / letters), dpi=DPI * letters)
    canvas = FigureCanvasAgg(figure)
    axes = figure.add_axes((0, 0, 1, 1))
    axes.set_axis_off()
    eye, half = _eye(drawn)
    moves = np.size(frames) > 1
    free = 0.0 if moves or colour is None else FREE * half
    wide = (half + free / 2) * SIZE[0] / SIZE[1]
    axes.set_xlim(-wide, wide)
    axes.set_ylim(-half - free, half)
    axes.text(0.015, 0.95, title, transform=axes.transAxes, color=INK, fontsize=13)
    weight = np.linalg.norm(drawn.gravity)
    side = 0.1 * letters
    add_axes_of_space(figure, eye, (0.99 - side, 0.06 * letters, side, side * SIZE[0] / SIZE[1]),
                      drawn.gravity / weight if weight > 0 else None, drawn.planar)
    bodies = _Bodies(drawn, colour)
    values = bodies.add_legend(figure, letters, moves)
    clock = axes.text(0.985, 0.03, "", transform=axes.transAxes, ha="right", color=INK)
    painter, marks = Painter(axes), Marks(axes, drawn, eye)
    for k in frames:
        painter.draw(eye, bodies.solids(k), marks.links(k))
        clock.set_text(f"t = {drawn.t[k]:.4g} {drawn.units.time if drawn.units else ''}".rstrip())
        if values:
            values.set_text(f"maximum now {short(bodies.most)}")
        marks.draw(k)
        canvas.draw()
        yield np.asarray(canvas.buffer_rgba())[..., :3].copy()


def _eye(drawn: Scenery) -> tuple[Eye, float]:
    """The eye, and half of the height of what it sees."""
    places = seen_places(drawn)
    eye = Eye(drawn.towards, drawn.up, (places.min(axis=0) + places.max(axis=0)) / 2,
              extent(drawn.nodes))
    seen = eye.seen(places)
    middle = (seen.min(axis=0) + seen.max(axis=0)) / 2
    eye.middle = eye.middle + eye.size * middle @ eye.axes
    reach = np.abs(seen - middle).max(axis=0)
    return eye, ROOM * max(reach[1], reach[0] * SIZE[1] / SIZE[0], 0.3)


class _Bodies:
    """Bodies with their colours: those of their entries, or of the values of a quantity."""

    def __init__(self, drawn: Scenery, colour: str | None) -> None:
        self._drawn = drawn
        self._colours = {k: rgb(entry.colour) for entry in drawn.entries for k in entry.bodies}
        fields = colourings(drawn.bodies, drawn.units)
        self._field = next((one for one in fields if one.name == colour), None)
        self.most = 0.0         # the largest value of the last picture

    def add_legend(self, figure: "Figure", letters: float, moves: bool) -> "Text | None":
        """The legend; of a film also its largest value, and a text for that of a picture."""
        field = self._field
        if field is None:
            return None
        title = f"{field.title} [{field.unit}]" if field.unit else field.title
        left, bottom, width, height = LEGEND
        box = (left, bottom if moves else LOW, width * letters, height * letters)
        axes = add_legend(figure, title, 0.0, field.largest, box)
        if not moves:
            return None
        axes.text(0.0, -2.6, f"largest {short(field.largest)} at t = "
                  f"{short(self._drawn.t[field.frame])}, "
                  f"{self._drawn.bodies[field.body].name}", transform=axes.transAxes, fontsize=9,
                  color=INK)
        return axes.text(0.0, -3.7, "", transform=axes.transAxes, fontsize=9, color=INK)

    def solids(self, frame: int) -> list[Solid]:
        """The bodies in a frame."""
        self.most = 0.0
        return [self._solid(k, body, frame) for k, body in enumerate(self._drawn.bodies)]

    def _solid(self, k: int, body: DrawnBody, frame: int) -> Solid:
        triangles, colours = body.surface.triangles, np.array(self._colours[k])
        if self._field is not None:
            values = values_of(body, self._field.name, frame)
            if values is None:
                colours = np.array(rgb(WITHOUT_VALUE))
            else:
                self.most = max(self.most, float(values.max()))
                colours = colours_of(values[triangles].mean(axis=1), 0.0, self._field.largest)
        return Solid(vertices(body, frame), triangles, colours, body.surface.features,
                     CLEAR if body.rigid else 1.0)
