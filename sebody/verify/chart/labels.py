"""Names beside points: inside the frame wherever the points lie, and not across one another."""

import textwrap
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

WIDEST = 48         # characters of a line of a name
MOST_LINES = 3      # of a name
EDGE = 4.0          # dots between the frame and a name
MOST_ROOM = 0.35    # of the width of the frame that the axis begins earlier for names
# where a name may be: dots to the right of its point and above it, and the sides it begins at;
# the first is best, as no point of a chart lies at the left of its front and below
SIDES = ((-3, -4, "right", "top"), (3, 4, "left", "bottom"), (-3, 4, "right", "bottom"),
         (3, -4, "left", "top"), (0, -7, "center", "top"), (0, 7, "center", "bottom"),
         (-3, -14, "right", "top"), (3, 14, "left", "bottom"), (-3, 14, "right", "bottom"),
         (3, -14, "left", "top"), (-3, -24, "right", "top"), (3, 24, "left", "bottom"))


def wrapped(text: str, width: int = WIDEST, lines: int = MOST_LINES) -> str:
    """A text in lines of a width, what is more than some lines left out."""
    return "\n".join(textwrap.wrap(text, width, max_lines=lines, placeholder=" ..."))


def make_room(figure, axes, names: Sequence) -> None:
    """Begin a logarithmic axis so far to the left that names end on it, as far as sensible."""
    figure.draw_without_rendering()
    frame = axes.get_window_extent()
    low, high = np.log10(axes.get_xlim())
    for name in names:
        # of the axis, at the left of the point; in logarithms the rest of it keeps its length
        taken = min((axes.transData.transform(name.xy)[0] - name.get_window_extent().x0
                     + EDGE) / frame.width, MOST_ROOM)
        low = min(low, (np.log10(name.xy[0]) - taken * high) / (1.0 - taken))
    axes.set_xlim(10.0**low, 10.0**high)


def place(figure, axes, names: Sequence, others: NDArray) -> None:
    """Put each name on the side of its point where it is inside the frame and covers least.

    Parameters
    ----------
    names : sequence of Annotation
        At their points, offsets in dots.
    others : (n, 2)
        Points of the axes that had better not be covered.
    """
    figure.draw_without_rendering()
    frame, taken = axes.get_window_extent(), []
    dots = axes.transData.transform(others)
    for name in names:
        least, best = np.inf, SIDES[0]
        for side in SIDES:
            covered = _covered(_box(figure, name, side), frame, taken, dots)
            if covered < least:
                least, best = covered, side
        _push_inside(figure, name, best, frame)
        taken.append(_box(figure, name, None))


def _box(figure, name, side: tuple | None) -> NDArray:
    """Lower left and upper right corner of a name on a side, (2, 2) in dots."""
    if side is not None:
        _put(name, side)
    box = name.get_window_extent(figure.canvas.get_renderer())
    return np.array([[box.x0, box.y0], [box.x1, box.y1]])


def _put(name, side: tuple) -> None:
    right, up, horizontal, vertical = side
    name.set_position((right, up))
    name.set_horizontalalignment(horizontal)
    name.set_verticalalignment(vertical)


def _covered(box: NDArray, frame, taken: list[NDArray], dots: NDArray) -> float:
    """A penalty of a place: outside the frame is worst, across a name is worse than over points."""
    inside = np.array([[frame.x0, frame.y0], [frame.x1, frame.y1]])
    outside = max((inside[0] - box[0]).max(), (box[1] - inside[1]).max(), 0.0)
    across = sum(bool((box[0] < other[1]).all() and (other[0] < box[1]).all()) for other in taken)
    over = ((dots > box[0]) & (dots < box[1])).all(axis=1).sum()
    return 1e6 * bool(outside) + outside + 1e3 * across + over


def _push_inside(figure, name, side: tuple, frame) -> None:
    """Take a side, and move from there into the frame."""
    box = _box(figure, name, side)
    low = np.array([frame.x0, frame.y0]) + EDGE - box[0]
    high = np.array([frame.x1, frame.y1]) - EDGE - box[1]
    move = np.maximum(low, np.minimum(high, 0.0)) * 72.0 / figure.dpi
    name.set_position((side[0] + move[0], side[1] + move[1]))
