"""Pictures over frequency and speed (extra ``plot``)."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sebody.files import replacing
from sebody.results.naming import component_names
from sebody.results.plots import ACCENT, INK, PALE, STYLE, check_picture

COLOURS = INK, ACCENT, "#2a7f62", "#8a6fb0", "#b8862f", "#4f8fba"
VANISHES = 1e-9         # amplitude of a component, of the largest, that is not drawn
STILL = 1e-6            # rate of growth, of the highest frequency, up to which there is none
ORDERS = 1, 2, 3        # multiples of the speed in a Campbell diagram


def save_response(path: str | Path, load: str, omega: NDArray, answers: Mapping[str, NDArray]
                  ) -> Path:
    """Draw amplitudes and phases of quantities over the angular frequency."""
    check_picture(path)
    from matplotlib import rc_context
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    with rc_context(STYLE):
        figure = Figure(figsize=(7.5, 2.6 * len(answers) + 1.6), layout="constrained")
        FigureCanvasAgg(figure)
        axes = figure.subplots(len(answers) + 1, sharex=True, squeeze=False)[:, 0]
        colour = 0
        for axis, (name, values) in zip(axes[:-1], answers.items(), strict=True):
            flat = values.reshape(len(omega), -1)
            size = np.abs(flat).max(initial=0.0)
            for label, part in zip(component_names(values, name), flat.T, strict=True):
                if np.abs(part).max() <= VANISHES * size:
                    continue
                full = f"{name}.{label}" if label else name
                axis.semilogy(omega, np.abs(part), color=COLOURS[colour % len(COLOURS)],
                              label=full)
                axes[-1].plot(omega, np.degrees(np.angle(part)),
                              color=COLOURS[colour % len(COLOURS)], label=full)
                colour += 1
            axis.set_title(f"{name} for a unit of {load!r}")
            axis.legend()
        axes[-1].set(title="phase [degrees]", xlabel="angular frequency", ylim=(-190, 190),
                     yticks=[-180, -90, 0, 90, 180])
        return _saved(figure, path)


def save_campbell(path: str | Path, speeds: NDArray, omega: NDArray, growth: NDArray) -> Path:
    """Draw frequencies, multiples of the speed, and rates of growth over the speed."""
    check_picture(path)
    from matplotlib import rc_context
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    with rc_context(STYLE):
        figure = Figure(figsize=(7.5, 6.4), layout="constrained")
        FigureCanvasAgg(figure)
        upper, lower = figure.subplots(2, sharex=True, height_ratios=(3, 1))
        for k in range(omega.shape[1]):
            upper.plot(speeds, omega[:, k], color=COLOURS[k % len(COLOURS)])
            lower.plot(speeds, growth[:, k], color=COLOURS[k % len(COLOURS)])
        top = 1.05 * omega.max(initial=0.0)
        for order in ORDERS:
            upper.plot(speeds, order * speeds, color=PALE, linestyle="--", linewidth=0.9)
            inside = speeds[np.abs(order * speeds) <= top]
            if len(inside):
                upper.annotate(f"{order} x speed", (inside[-1], order * inside[-1]), color=INK,
                               fontsize=8, ha="right", va="bottom")
        upper.set(title="angular frequencies in rotating axes", ylim=(0.0, top or 1.0))
        least = STILL * (top or 1.0)        # rounding of undamped modes is not drawn as growth
        lower.set(title="rates of growth", xlabel="speed",
                  ylim=(1.1 * min(growth.min(), -least), 1.1 * max(growth.max(), least)))
        return _saved(figure, path)


def _saved(figure, path: str | Path) -> Path:
    path = Path(path)
    with replacing(path, "picture") as file:
        figure.savefig(file, format=path.suffix[1:], dpi=150)
    return path
