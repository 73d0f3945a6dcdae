"""The picture of a chart."""

from pathlib import Path

import numpy as np

from sebody.results.plots import write_picture
from sebody.studies.chart.cases import Point

COLORS = {"frames and inertia": "#c8452d", "modes": "#2a7f62", "modes, B": "#7fc8a9",
          "bodies": "#3c6fb6", "steps": "#b58a1b", "nonlinear beams": "#1f2a44",
          "schemes": "#8a4fa3", "Exudyn": "#9aa5b8"}
MOST_NAMES = 7      # of the front that are written beside their points
APART = 0.8         # of the error of the named point before: nearer names would cover one another
EDGE = 6.0          # dots between the axis and a name


def draw(scene: str, points: list[Point], line: list[Point], limit: float,
         path: str | Path) -> None:
    """Error against computing time, one colour a family, the front as a line with its names."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9.6, 6.4), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.add_subplot()
    for family, color in COLORS.items():
        group = [p for p in points if p.family == family]
        if group:
            axes.plot([p.cost for p in group], [p.error for p in group],
                      "^" if family == "Exudyn" else "o", color=color, markersize=5, label=family)
    axes.step([p.cost for p in line], [p.error for p in line], where="post", color="#1f2a44",
              linewidth=0.8, zorder=1)
    line = _apart(line)
    every = max(1, -(-len(line) // MOST_NAMES))
    names = [axes.annotate(point.label, (point.cost, point.error), (-3, -4), fontsize=8, ha="right",
                           va="top", textcoords="offset points", color="#1f2a44", zorder=4,
                           bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.8,
                                 "pad": 0.5}) for point in line[::every]]
    axes.axhline(limit, color="#9aa5b8", linewidth=0.8, linestyle="--")
    axes.annotate("error of the reference", (1.0, limit), (-4, 3), ha="right", fontsize=7,
                  xycoords=("axes fraction", "data"), textcoords="offset points", color="#6b7485")
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlabel("computing time a simulated second [s]")
    axes.set_ylabel("relative L2 error")
    axes.set_title(f"{scene}: error against time", loc="left")
    axes.grid(color="#e6e9ef", which="both", linewidth=0.5)
    axes.set_axisbelow(True)
    axes.legend(frameon=False, fontsize=8, loc="lower left", bbox_to_anchor=(0.0, 0.08))
    axes.margins(x=0.1)
    _make_room(figure, axes, names)
    write_picture(figure, path, 130)


def _apart(line: list[Point]) -> list[Point]:
    """Points of the front that are named: none that is hardly better than a cheaper one."""
    found: list[Point] = []
    for point in line:
        if not found or point.error < APART * found[-1].error:
            found.append(point)
    return found


def _make_room(figure, axes, names: list) -> None:
    """Begin the axis of times so far to the left that names end on it, not across it."""
    figure.draw_without_rendering()
    frame = axes.get_window_extent()
    low, high = np.log10(axes.get_xlim())
    for name in names:
        # of the axis, at the left of the point; in logarithms the rest of it keeps its length
        taken = (axes.transData.transform(name.xy)[0] - name.get_window_extent().x0
                 + EDGE) / frame.width
        low = min(low, (np.log10(name.xy[0]) - taken * high) / (1.0 - taken))
    axes.set_xlim(10.0**low, 10.0**high)
