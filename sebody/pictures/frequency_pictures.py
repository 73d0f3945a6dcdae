"""Pictures over frequency and speed (extra ``plot``)."""

from collections.abc import Iterator, Mapping
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from sebody.pictures.palette import CURVES
from sebody.pictures.plots import INK, PALE, STYLE, check_picture, write_picture
from sebody.results.naming import component_names

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

DASHES = "-", (0, (5, 2)), (0, (1.5, 1.5)), (0, (6, 2, 1.5, 2))
VANISHES = 1e-9         # amplitude of a component, of the largest, that is not drawn
STILL = 1e-6            # real part, of the highest frequency, up to which there is none
ORDERS = 1, 2, 3        # multiples of the speed in a Campbell diagram
LEGEND_ROWS = 24        # of modes in a column


def save_response(path: str | Path, load: str, omega: NDArray, answers: Mapping[str, NDArray]
                  ) -> Path:
    """Draw amplitudes and phases of quantities over the angular frequency."""
    check_picture(path)
    from matplotlib import rc_context

    with rc_context(STYLE):
        figure = _figure(7.5, 2.6 * len(answers) + 1.6)
        axes = figure.subplots(len(answers) + 1, sharex=True, squeeze=False)[:, 0]
        lines = _lines()
        for axis, (name, values) in zip(axes[:-1], answers.items(), strict=True):
            flat = values.reshape(len(omega), -1)
            size = np.abs(flat).max(initial=0.0)
            for label, part in zip(component_names(values, name), flat.T, strict=True):
                if np.abs(part).max() <= VANISHES * size:
                    continue
                line, full = next(lines), f"{name}.{label}" if label else name
                axis.semilogy(omega, np.abs(part), label=full, **line)
                axes[-1].plot(omega, np.degrees(np.angle(part)), **line)
            axis.set(title=f"{name} under {load!r} of amplitude 1", ylabel="amplitude")
            axis.margins(x=0.0)
            if not axis.lines:
                axis.set_yticks([])
                axis.text(0.5, 0.5, "no response", transform=axis.transAxes, ha="center",
                          color=PALE)
            _add_legend(axis)
        axes[-1].set(title="phase", ylabel="phase [degrees]", ylim=(-190, 190),
                     xlabel="angular frequency [rad/time]", yticks=[-180, -90, 0, 90, 180])
        write_picture(figure, path, 150)
    return Path(path)


def save_campbell(path: str | Path, speeds: NDArray, omega: NDArray, growth: NDArray) -> Path:
    """Draw frequencies, multiples of the speed, and real parts of eigenvalues over the speed."""
    check_picture(path)
    from matplotlib import rc_context

    with rc_context(STYLE):
        figure = _figure(8.4, 6.4)
        upper, lower = figure.subplots(2, sharex=True, height_ratios=(3, 1))
        for k, line in zip(range(omega.shape[1]), _lines(), strict=False):
            upper.plot(speeds, omega[:, k], label=f"mode {k + 1}", **line)
            lower.plot(speeds, growth[:, k], **line)
        top = 1.05 * omega.max(initial=0.0)
        _draw_orders(upper, speeds, top)
        upper.set(title="natural frequencies in the rotating frame", ylim=(0.0, top or 1.0),
                  ylabel="angular frequency [rad/time]")
        _add_legend(upper)
        least = STILL * (top or 1.0)        # rounding of undamped modes is not drawn
        lower.set(title="real parts of the eigenvalues: unstable above zero",
                  ylabel="real part [1/time]", xlabel="speed of rotation [rad/time]",
                  ylim=(1.1 * min(growth.min(), -least), 1.1 * max(growth.max(), least)))
        lower.axhline(0.0, color=PALE, linewidth=0.8, zorder=1)
        for axes in (upper, lower):
            axes.margins(x=0.0)
        write_picture(figure, path, 150)
    return Path(path)


def _figure(width: float, height: float) -> "Figure":
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height), layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def _lines() -> Iterator[dict]:
    """Colours, each with every kind of dashes: as many lines as anyone tells apart."""
    while True:
        for dashes, color in product(DASHES, CURVES):
            yield {"color": color, "linestyle": dashes, "linewidth": 1.4}


def _draw_orders(axes: "Axes", speeds: NDArray, top: float) -> None:
    """Multiples of the speed, with their names where they leave the picture."""
    first, last = speeds[0], speeds[-1]
    for order in ORDERS:
        axes.plot([first, last], [order * first, order * last], color=PALE, linestyle=(0, (4, 3)),
                  linewidth=0.9, zorder=1)
        end = min(last, top / order)
        if end > first:
            axes.annotate(f"{order} x speed", (end, order * end), (-4, -3), color=INK, fontsize=8,
                          textcoords="offset points", ha="right", va="top", zorder=4, bbox={
                              "facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 0.5})


def _add_legend(axes: "Axes") -> None:
    """Beside the axes, where it covers no curve."""
    count = len(axes.get_legend_handles_labels()[1])
    if not count:
        return
    axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), ncols=-(-count // LEGEND_ROWS),
                fontsize=8, handlelength=2.4)
