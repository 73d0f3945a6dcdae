"""Pictures over frequency and speed (extra ``plot``)."""

from collections.abc import Iterator, Mapping
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody.basics.units import Units, of_rates
from sebody.pictures.palette import CURVES
from sebody.pictures.plots import INK, PALE, STYLE, check_picture, write_picture
from sebody.results.naming import component_names
from sebody.results.units import with_unit

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.collections import LineCollection
    from matplotlib.figure import Figure

DASHES = "-", (0, (5, 2)), (0, (1.5, 1.5)), (0, (6, 2, 1.5, 2))
VANISHES = 1e-9         # amplitude of a component, of the largest, that is not drawn
STILL = 1e-6            # real part, of the highest frequency, up to which there is none
ORDERS = 1, 2, 3        # multiples of the speed in a Campbell diagram
LEGEND_ROWS = 24        # of modes in a column
WHIRLS = {"forward": "^", "backward": "v", "mixed": "D"}    # marks
MARKS = 12              # of a mode
UNDAMPED = 1e-9     # damping ratio that is none
GROWING = "#c0392b"     # colour of what grows


class Diagram(NamedTuple):
    """Contents of a Campbell diagram; see `Campbell`."""

    speeds: NDArray     # (m,)
    omega: NDArray      # (m, count), likewise the next
    growth: NDArray
    damping: NDArray
    whirl: NDArray
    frame: str
    units: Units | None = None


def save_response(path: str | Path, load: str, omega: NDArray, answers: Mapping[str, NDArray],
                  units: Units | None = None) -> Path:
    """Draw amplitudes and phases of quantities over the angular frequency."""
    check_picture(path)
    from matplotlib import rc_context

    with rc_context(STYLE):
        figure = new_figure(7.5, 2.6 * len(answers) + 1.6)
        axes = figure.subplots(len(answers) + 1, sharex=True, squeeze=False)[:, 0]
        lines = curve_styles()
        for axis, (name, values) in zip(axes[:-1], answers.items(), strict=True):
            flat = values.reshape(len(omega), -1)
            size = np.abs(flat).max(initial=0.0)
            for label, part in zip(component_names(values, name), flat.T, strict=True):
                if np.abs(part).max() <= VANISHES * size:
                    continue
                line, full = next(lines), f"{name}.{label}" if label else name
                axis.semilogy(omega, np.abs(part), label=full, **line)
                axes[-1].plot(omega, np.degrees(np.angle(part)), **line)
            axis.set(title=f"{name} under {load!r} of amplitude 1",
                     ylabel=with_unit("amplitude", name, units))
            axis.margins(x=0.0)
            if not axis.lines:
                axis.set_yticks([])
                axis.text(0.5, 0.5, "no response", transform=axis.transAxes, ha="center",
                          color=PALE)
            add_legend(axis)
        axes[-1].set(title="phase", ylabel="phase [degrees]", ylim=(-190, 190),
                     xlabel=f"angular frequency [{of_rates(units)}]",
                     yticks=[-180, -90, 0, 90, 180])
        write_picture(figure, path, 150)
    return Path(path)


def save_campbell(path: str | Path, diagram: Diagram, orders: NDArray,
                  crossings: NDArray) -> Path:
    """Draw frequencies, multiples of the speed, and real parts of eigenvalues over the speed.

    Parameters
    ----------
    crossings : (k, 2)
        Speeds and frequencies that are marked.
    """
    check_picture(path)
    from matplotlib import rc_context

    with rc_context(STYLE):
        figure = new_figure(8.4, 6.4)
        upper, lower = figure.subplots(2, sharex=True, height_ratios=(3, 1))
        top = draw_campbell(upper, diagram, orders, crossings)
        least = STILL * top         # rounding of undamped modes is not drawn
        growth = diagram.growth
        _add_modes(lower, diagram, growth)
        lower.set(title="real parts of the eigenvalues: unstable above zero",
                  ylabel=f"real part [{of_rates(diagram.units, '1/time')}]",
                  xlabel=f"speed of rotation [{of_rates(diagram.units)}]",
                  ylim=(1.1 * min(growth.min(), -least), 1.1 * max(growth.max(), least)))
        lower.axhline(0.0, color=PALE, linewidth=0.8, zorder=1)
        lower.margins(x=0.0)
        write_picture(figure, path, 150)
    return Path(path)


def draw_campbell(axes: "Axes", diagram: Diagram, orders: NDArray, crossings: NDArray) -> float:
    """Draw a Campbell diagram into axes; returns the highest frequency that is seen."""
    top = 1.05 * diagram.omega.max(initial=0.0) or 1.0
    colours = _add_modes(axes, diagram, diagram.omega)
    _draw_orders(axes, diagram.speeds, top, orders)
    axes.plot(*crossings.T, "o", color=INK, markersize=4, zorder=5)
    axes.set(title=f"natural frequencies in {diagram.frame} axes", ylim=(0.0, top),
             ylabel=f"angular frequency [{of_rates(diagram.units)}]")
    axes.margins(x=0.0)
    if np.nanmax(np.abs(diagram.damping), initial=0.0) > UNDAMPED:
        axes.figure.colorbar(colours, ax=axes, label="damping ratio", extend="min", pad=0.02)
    for name, marker in WHIRLS.items():
        if name in diagram.whirl:
            axes.plot([], [], marker, color=INK, markersize=5, label=f"{name} whirl")
    if axes.get_legend_handles_labels()[1]:
        axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=len(WHIRLS), fontsize=8,
                    handletextpad=0.3, columnspacing=1.0)
    return float(top)


def _add_modes(axes: "Axes", diagram: Diagram, values: NDArray) -> "LineCollection":
    """Lines of modes with marks of their whirls, coloured by their damping."""
    from matplotlib import colormaps
    from matplotlib.collections import LineCollection

    speeds, damping = diagram.speeds, np.nan_to_num(diagram.damping)
    largest = damping.max(initial=0.0)
    colours = colormaps["viridis"].with_extremes(under=GROWING)
    largest = largest if largest > UNDAMPED else 1.0
    every = max(1, len(speeds) // MARKS)
    for k, column in enumerate(values.T):
        points = np.column_stack([speeds, column])
        line = LineCollection(np.stack([points[:-1], points[1:]], axis=1), cmap=colours,
                              linewidth=1.4)
        line.set_clim(-UNDAMPED, largest)
        line.set_array((damping[:-1, k] + damping[1:, k]) / 2)
        axes.add_collection(line)
        for name, marker in WHIRLS.items():
            rows = np.arange(k % every, len(speeds), every)
            if len(rows := rows[diagram.whirl[rows, k] == name]):
                axes.scatter(speeds[rows], column[rows], 18, damping[rows, k], marker,
                             cmap=colours, vmin=-UNDAMPED, vmax=largest, zorder=3)
    axes.autoscale_view()
    return line


def new_figure(width: float, height: float) -> "Figure":
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height), layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def curve_styles() -> Iterator[dict]:
    """Colours, each with every kind of dashes: as many lines as anyone tells apart."""
    while True:
        for dashes, color in product(DASHES, CURVES):
            yield {"color": color, "linestyle": dashes, "linewidth": 1.4}


def _draw_orders(axes: "Axes", speeds: NDArray, top: float, orders: NDArray) -> None:
    """Multiples of the speed, with their names where they leave the picture."""
    first, last = speeds[0], speeds[-1]
    for order in orders:
        axes.plot([first, last], [order * first, order * last], color=PALE, linestyle=(0, (4, 3)),
                  linewidth=0.9, zorder=1)
        end = min(last, top / order)
        if end > first:
            axes.annotate(f"{order:g} x speed", (end, order * end), (-4, -3), color=INK, fontsize=8,
                          textcoords="offset points", ha="right", va="top", zorder=4, bbox={
                              "facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 0.5})


def add_legend(axes: "Axes") -> None:
    """Beside the axes, where it covers no curve."""
    count = len(axes.get_legend_handles_labels()[1])
    if not count:
        return
    axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), ncols=-(-count // LEGEND_ROWS),
                fontsize=8, handlelength=2.4)
