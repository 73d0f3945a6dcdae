"""The picture of a chart."""

import re
from collections.abc import Iterable, Sequence
from itertools import cycle
from pathlib import Path
from typing import NamedTuple

import numpy as np

from sebody.pictures.plots import write_picture
from sebody.verify.chart import labels
from sebody.verify.chart.points import Point

COLORS = {"frames and inertia": "#c8452d", "modes": "#2a7f62", "modes, B": "#7fc8a9",
          "bodies": "#3c6fb6", "steps": "#b58a1b", "nonlinear beams": "#1f2a44",
          "schemes": "#8a4fa3", "Exudyn": "#9aa5b8", "advised": "#c8452d"}
# families by what is varied in them
NAMES = {"frames and inertia": "frame, inertia option", "modes": "number of modes",
         "modes, B": "number of modes, option b", "bodies": "number of bodies",
         "steps": "time step", "nonlinear beams": "nonlinear beam elements",
         "schemes": "integration scheme", "advised": "advised model",
         "inertia": "inertia option", "rigid": "rigid parts"}
MARKERS = "osDvPX<>"      # of families, as well as their colours
# what of a name tells one run of a method from the others: its step or its tolerance
STEP = re.compile(r"[;,]? ?(step|h|tolerance|variable steps, local tolerance) ?[0-9.e+-]+")
OTHERS = ("#c8452d", "#3c6fb6", "#2a7f62", "#8a4fa3", "#b58a1b", "#d98a6a", "#7fc8a9", "#1f2a44")
INK, PALE, CHOSEN = "#1f2a44", "#9aa5b8", "#c8452d"
MOST_NAMES = 7      # of the front that are written beside their points
APART = 0.8         # of the error of the named point before: nearer names would cover one another
DIFFER = 1.1        # cost of the slowest run over that of the quickest from which both are shown
SLOWEST = {"linestyle": "-", "marker": "|", "linewidth": 0.8, "markersize": 4, "markevery": [-1],
           "alpha": 0.6, "zorder": 1}
MARGIN = 0.1        # of the axes beside the points, of their extent
COLUMNS = 5         # of the legend
TITLE, FAMILY, NOTE = 60, 30, 110   # characters of a line of the title, of a family, of a note


class Panel(NamedTuple):
    """Contents of one pair of axes, see `draw`."""

    name: str
    points: list[Point]
    line: list[Point]
    limit: float
    choice: Point | None = None
    tolerance: float | None = None


def draw(name: str, points: Iterable[Point], line: Iterable[Point], limit: float,
         path: str | Path, choice: Point | None = None, tolerance: float | None = None,
         notes: Iterable[str] = ()) -> None:
    """Error against computing time, one colour a family, the front as a line with its names.

    Parameters
    ----------
    name : str
        What is compared, for the title.
    points : iterable of Point
        Those without a finite error and a positive cost are left out.
    line : iterable of Point
        The front, see `front`.
    limit : float
        Error of the reference; not drawn if it is zero.
    path : str or Path
        File to write: png, pdf or svg.
    choice : Point, optional
        The point that was chosen, which gets a ring and its name.
    tolerance : float, optional
        Allowed error.
    notes : iterable of str
        What errors, bars and peers are, in sentences below the title.

    Raises
    ------
    InputError
        A picture that cannot be made, see `sebody.pictures.plots.check_picture`.
    """
    draw_panels(f"{name}: error and computing time", [Panel(
        "", list(points), list(line), limit, choice, tolerance)], path, notes)


def draw_panels(name: str, panels: Sequence[Panel], path: str | Path,
                notes: Iterable[str] = ()) -> None:
    """Several charts beside each other, of one quantity each, with one legend; see `draw`."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9.6 if len(panels) == 1 else 7.2 * len(panels), 6.8),
                    layout="constrained")
    FigureCanvasAgg(figure)
    width = TITLE * len(panels)
    figure.suptitle(labels.wrapped(name, width), x=0.01, ha="left", fontsize=10)
    every = figure.subplots(1, len(panels), squeeze=False)[0]
    told = "\n".join(labels.wrapped(note, NOTE) for note in notes)
    names = [_panel(axes, panel) for axes, panel in zip(every, panels, strict=True)]
    for k, (axes, panel) in enumerate(zip(every, panels, strict=True)):
        text = "\n".join(filter(None, [panel.name, told if k == 0 else ""]))
        axes.set_title(text, loc="left", fontsize=7.5, color="#6b7485")
    _legend(figure, every)
    for axes, panel, own in zip(every, panels, names, strict=True):
        points = [(p.cost, p.error) for p in panel.points if _drawn(p)]
        labels.make_room(figure, axes, own)
        labels.place(figure, axes, own, np.array(points).reshape(-1, 2))
    write_picture(figure, path, 130)


def _panel(axes, panel: Panel) -> list:
    """Draw a panel; the names of its points, which are placed later."""
    points, line = ([p for p in one if _drawn(p)] for one in (panel.points, panel.line))
    choice = panel.choice if panel.choice is not None and _drawn(panel.choice) else None
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlim(_around([c for p in points for c in (p.cost, max(p.cost, p.slowest))]))
    axes.set_ylim(_around([*(p.error for p in points),
                           *filter(None, (panel.limit, panel.tolerance))]))
    _families(axes, points)
    axes.step([p.cost for p in line], [p.error for p in line], where="post", color=INK,
              linewidth=0.8, zorder=1, label="lowest error for the time")
    named = _named(line)
    if choice:
        axes.plot([choice.cost], [choice.error], "o", markersize=13, markerfacecolor="none",
                  markeredgecolor=CHOSEN, markeredgewidth=1.8, zorder=3, linestyle="none",
                  label="advised model")
        named = [choice, *(p for p in named if p.cost != choice.cost)]
    if panel.limit:
        _level(axes, panel.limit, "error of the reference", below=True)
    if panel.tolerance:
        _level(axes, panel.tolerance, f"tolerance {panel.tolerance:g}")
    axes.set_xlabel("computing time per simulated second [s]")
    axes.set_ylabel("relative error")
    axes.grid(color="#e6e9ef", which="both", linewidth=0.5)
    axes.set_axisbelow(True)
    return [_annotation(axes, point, CHOSEN if point is choice else INK) for point in named]


def _drawn(point: Point) -> bool:
    return bool(0.0 < point.error < np.inf and 0.0 < point.cost < np.inf)


def _around(values: list[float]) -> tuple[float, float]:
    """Ends of a logarithmic axis with some room at both sides of the values."""
    low, high = (np.log10(f(values)) for f in (min, max)) if values else (-3.0, 0.0)
    room = MARGIN * max(high - low, 1.0)
    return 10.0**(low - room), 10.0**(high + room)


def _families(axes, points: list[Point]) -> None:
    """Points of each family in its colour and shape, runs of one method joined by a line.

    Slower runs of the same are a bar to the right.
    """
    taken = {COLORS[p.family] for p in points if p.family in COLORS}
    others = cycle([color for color in OTHERS if color not in taken] or OTHERS)
    for place, family in enumerate(dict.fromkeys([*COLORS, *(p.family for p in points)])):
        group = [p for p in points if p.family == family]
        if not group:
            continue
        color = COLORS[family] if family in COLORS else next(others)
        marker = "^" if family == "Exudyn" else MARKERS[place % len(MARKERS)]
        axes.plot([p.cost for p in group], [p.error for p in group], marker, color=color,
                  markersize=5, label=labels.wrapped(NAMES.get(family, family), FAMILY, 2))
        for method in _methods(group):
            axes.plot([p.cost for p in method], [p.error for p in method], color=color,
                      linewidth=0.9, alpha=0.7, zorder=1)
        for p in group:
            if p.slowest > DIFFER * p.cost:
                axes.plot([p.cost, p.slowest], [p.error, p.error], color=color, **SLOWEST)
    if any(p.slowest > DIFFER * p.cost for p in points):
        axes.plot([], [], color=PALE, label="slowest of several runs", **SLOWEST)


def _methods(group: list[Point]) -> list[list[Point]]:
    """Runs of one method with several steps or tolerances, from the longest step down."""
    methods: dict[str, list[Point]] = {}
    for point in group:
        methods.setdefault(STEP.sub("", point.label), []).append(point)
    return [sorted(one, key=lambda p: -p.h) for one in methods.values() if len(one) > 1]


def _named(line: list[Point]) -> list[Point]:
    """Points of the front that are named: none that is hardly better than a cheaper one."""
    points: list[Point] = []
    for point in line:
        if not points or point.error < APART * points[-1].error:
            points.append(point)
    last = len(points) - 1
    return [points[round(k)] for k in np.linspace(0, last, min(MOST_NAMES, len(points)))]


def _annotation(axes, point: Point, color: str):
    return axes.annotate(labels.wrapped(point.label), (point.cost, point.error), (-3, -4),
                         fontsize=8, ha="right", va="top", textcoords="offset points", color=color,
                         zorder=4, bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.8,
                                         "pad": 0.5})


def _level(axes, level: float, what: str, below: bool = False) -> None:
    axes.axhline(level, color=PALE, linewidth=0.8, linestyle="--")
    axes.annotate(what, (1.0, level), (-4, -3 if below else 3), ha="right",
                  va="top" if below else "bottom", fontsize=7, color="#6b7485",
                  xycoords=("axes fraction", "data"), textcoords="offset points")


def _legend(figure, every) -> None:
    """Legend of all axes, below them, in as many columns as fit."""
    entries = {}
    for axes in every:
        for handle, name in zip(*axes.get_legend_handles_labels(), strict=True):
            entries.setdefault(name, handle)
    handles, names = list(entries.values()), list(entries)
    for columns in range(min(COLUMNS, len(names)), 0, -1):
        legend = figure.legend(handles, names, loc="outside lower center", ncols=columns,
                               frameon=False, fontsize=8)
        box = legend.get_window_extent(figure.canvas.get_renderer())
        if columns == 1 or box.width <= figure.bbox.width:
            break
        legend.remove()
