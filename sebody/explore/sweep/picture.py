"""The picture of a sweep: every output against every parameter."""

from pathlib import Path

import numpy as np

from sebody.basics.files import replacing
from sebody.explore.sweep.table import Table
from sebody.pictures.plots import ACCENT, PALE, STYLE

MOST = 4                # rows and columns of the picture
DOTS = 4000             # runs from which dots are small


def draw(table: Table, path: Path) -> None:
    """Scatter plots of the first outputs and parameters that vary; PNG."""
    from matplotlib import rc_context
    from matplotlib.figure import Figure

    columns = table.columns()
    outputs = [n for n in columns if n.partition("[")[0] in table.outputs
               and np.ptp(columns[n][table.good].astype(float)) > table.rounding(n)][:MOST] \
        if table.good.any() else []
    varied = [n for n, v in table.parameters.items() if len(set(v)) > 1][:MOST]
    rows, across = max(1, len(outputs)), max(1, len(varied) + 1)
    with rc_context(STYLE):
        figure = Figure(figsize=(3.2 * across, 2.4 * rows), layout="constrained")
        axes = figure.subplots(rows, across, squeeze=False)
        for row, output in zip(axes, outputs, strict=False):
            values = columns[output][table.good].astype(float)
            for axis, name in zip(row, varied, strict=False):
                _scatter(axis, table.parameters[name][table.good], values)
                axis.set_xlabel(name, fontsize=8)
            row[0].set_ylabel(output, fontsize=8)
            row[-1].hist(values, bins=min(40, max(5, int(np.sqrt(len(values))))),
                         orientation="horizontal", color=PALE)
            row[-1].set_xlabel("runs", fontsize=8)
            row[-1].xaxis.get_major_locator().set_params(integer=True)
        for axis in axes.flat:
            axis.tick_params(labelsize=7)
        with replacing(path, "picture") as file:
            figure.savefig(file, format="png", dpi=120)


def _scatter(axis, x, values) -> None:
    if x.dtype == object and any(isinstance(v, str) for v in x):
        kinds = list(dict.fromkeys(x))
        axis.set_xticks(range(len(kinds)), kinds)
        x = np.array([kinds.index(v) for v in x])
    else:
        axis.locator_params(axis="x", nbins=5, integer=all(isinstance(v, int) for v in x))
    axis.plot(np.asarray(x, dtype=float), values, ".", markersize=1 if len(x) > DOTS else 4,
              color=ACCENT, alpha=0.6)
