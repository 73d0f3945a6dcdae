"""The picture of a sweep: curves of one parameter, maps of two, else clouds with histograms."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sebody.basics.files import replacing
from sebody.explore.sweep.table import Table
from sebody.pictures.plots import ACCENT, PALE, STYLE

MOST = 4                # rows and columns of the picture
DOTS = 4000             # runs from which dots are small


def draw(table: Table, path: Path) -> None:
    """Every output over the one parameter that varies, or over the two; of samples scatter plots.

    PNG, of the first outputs and parameters.
    """
    from matplotlib import rc_context
    from matplotlib.figure import Figure

    columns = table.columns()
    outputs = [n for n in columns if n.partition("[")[0] in table.outputs
               and np.ptp(columns[n][table.good].astype(float)) > table.rounding(n)][:MOST] \
        if table.good.any() else []
    varied = [n for n, v in table.parameters.items() if len(set(v)) > 1][:MOST]
    rows, over = max(1, len(outputs)), table.axes()
    mapped = len(over) == 2 and all(_numbers(table.parameters[name]) for name in over)
    across = 1 if mapped or len(over) == 1 else max(1, len(varied) + 1)
    with rc_context(STYLE):
        width = 5.0 if across == 1 else 3.2 * across
        figure = Figure(figsize=(width, 2.4 * rows), layout="constrained")
        axes = figure.subplots(rows, across, squeeze=False)
        for row, output in zip(axes, outputs, strict=False):
            values = columns[output][table.good].astype(float)
            if mapped:
                _map(figure, row[0], table, over, output)
                continue
            for axis, name in zip(row, varied, strict=False):
                _scatter(axis, table.parameters[name][table.good], values,
                         line=len(over) == 1)
                axis.set_xlabel(name, fontsize=8)
            row[0].set_ylabel(table.label(output), fontsize=8)
            if len(over) == 1:
                continue
            row[-1].hist(values, bins=min(40, max(5, int(np.sqrt(len(values))))),
                         orientation="horizontal", color=PALE)
            row[-1].set_xlabel("runs", fontsize=8)
            row[-1].xaxis.get_major_locator().set_params(integer=True)
        for axis in axes.flat:
            axis.tick_params(labelsize=7)
        with replacing(path, "picture") as file:
            figure.savefig(file, format="png", dpi=120)


def _numbers(x: NDArray) -> bool:
    return x.dtype != object or not any(isinstance(v, str) for v in x)


def _map(figure, axis, table: Table, over: list[str], output: str) -> None:
    """An output over two parameters, in colours; runs that failed stay blank."""
    columns = table.columns()
    x, y = (columns[name].astype(float) for name in over)
    across, up = np.unique(x), np.unique(y)
    values = np.full((len(up), len(across)), np.nan)
    values[np.searchsorted(up, y), np.searchsorted(across, x)] = np.where(
        table.good, columns[output].astype(float), np.nan)
    shown = axis.pcolormesh(across, up, values, shading="nearest")
    for name, own in zip("xy", (x, y), strict=True):
        axis.locator_params(axis=name, nbins=5, integer=bool((own == np.round(own)).all()))
    axis.set_xlabel(over[0], fontsize=8)
    axis.set_ylabel(over[1], fontsize=8)
    bar = figure.colorbar(shown, ax=axis)
    bar.set_label(table.label(output), fontsize=8)
    bar.ax.tick_params(labelsize=7)


def _scatter(axis, x, values, line: bool = False) -> None:
    if not _numbers(x):
        kinds = list(dict.fromkeys(x))
        axis.set_xticks(range(len(kinds)), kinds)
        x = np.array([kinds.index(v) for v in x])
    else:
        axis.locator_params(axis="x", nbins=5, integer=all(isinstance(v, int) for v in x))
    x = np.asarray(x, dtype=float)
    if line:
        order = np.argsort(x, kind="stable")
        axis.plot(x[order], values[order], "o-", markersize=3, linewidth=1, color=ACCENT)
        return
    axis.plot(x, values, ".", markersize=1 if len(x) > DOTS else 4, color=ACCENT, alpha=0.6)
