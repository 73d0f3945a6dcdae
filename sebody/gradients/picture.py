"""A picture of contributions."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from sebody.basics.files import replacing
from sebody.pictures.plots import PALE, STYLE

if TYPE_CHECKING:
    from matplotlib.axes import Axes

MOST = 12           # bars of a quantity
LINES = 4           # histories of a quantity
DECADES = 4         # of a history below its largest value, that are shown
LEAST = 1e-6        # of the largest bar: shorter ones are drawn like this


def draw(found: Any, path: str | Path) -> Path:
    """Draw `Contributions`, each quantity in a row: bars of the largest, some histories; PNG."""
    from matplotlib import rc_context
    from matplotlib.figure import Figure

    names = found.quantities
    with rc_context(STYLE):
        bars = min(MOST, len(found.rows))
        figure = Figure(figsize=(10, (1.2 + 0.22 * bars) * len(names)), layout="constrained")
        axes = figure.subplots(len(names), 2, squeeze=False)
        for k, (name, (left, right)) in enumerate(zip(names, axes, strict=True)):
            order = sorted(range(len(found.rows)), key=lambda j: -found.rows[j].sizes[k])[:MOST]
            _bars(left, [(f"{found.rows[j].body}: {found.rows[j].change}", found.rows[j].sizes[k])
                         for j in order], name)
            _histories(right, found, name, order[:LINES])
        path = Path(path)
        with replacing(path, "picture") as file:
            figure.savefig(file, format="png", dpi=120)
    return path


def _bars(axis: Axes, bars: list[tuple[str, float]], name: str) -> None:
    labels, sizes = zip(*reversed(bars), strict=True)
    colors = [f"C{k}" if k < LINES else PALE for k in reversed(range(len(bars)))]
    axis.barh(labels, np.maximum(sizes, LEAST * max(sizes)), color=colors)
    axis.set_xscale("log")
    axis.set_xlabel(f"largest change of {name}, relative to its range", fontsize=8)
    axis.tick_params(labelsize=7)
    axis.grid(False, axis="y")


def _histories(axis: Axes, found: Any, name: str, order: list[int]) -> None:
    """Sizes over time, in the colours of their bars."""
    for k, (width, j) in enumerate(zip(np.linspace(1.8, 0.8, LINES), order, strict=False)):
        size = np.linalg.norm(found.changes[name][..., j].reshape(len(found.t), -1), axis=1)
        axis.plot(found.t, np.where(size > 0, size, np.nan), linewidth=width, color=f"C{k}")
    axis.set_yscale("log")
    highest = axis.get_ylim()[1]
    axis.set_ylim(max(axis.get_ylim()[0], highest / 10**DECADES), highest)
    axis.set_xlabel("t", fontsize=8)
    axis.set_ylabel(f"size of the change of {name}", fontsize=8)
    axis.tick_params(labelsize=7)
