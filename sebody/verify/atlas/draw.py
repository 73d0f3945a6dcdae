"""The page of pictures of the atlas."""

from itertools import cycle
from pathlib import Path

from sebody.pictures.plots import write_picture
from sebody.verify.atlas.finding import Finding

COLORS = ("#c8452d", "#3c6fb6", "#2a7f62", "#b58a1b", "#8a4fa3", "#1f2a44", "#d98a6a")
THEORY = "#6b7485"      # theory is dashed in grey, what is measured in colours
DASHES = ((0, (5, 2)), (0, (1.5, 1.5)), (0, (6, 2, 1.5, 2)))
COLUMNS = 3
MOST_TICKS = 7          # that are written one by one
FEW_DECADES = 200.0     # ends of a logarithmic axis whose powers of ten alone say little
CROSS = {"marker": "x", "markersize": 7.0, "markeredgewidth": 1.6}
ALONE = {"markersize": 7.0, "markerfacecolor": "none"}      # a single point, over a curve


def draw(findings: list[Finding], path: str | Path) -> None:
    """One panel a case."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    columns = min(COLUMNS, len(findings))
    lines = -(-len(findings) // columns)
    figure = Figure(figsize=(4.6 * columns, 3.7 * lines), layout="constrained")
    FigureCanvasAgg(figure)
    figure.get_layout_engine().set(w_pad=0.08, h_pad=0.1)
    for k, finding in enumerate(findings, 1):
        _panel(figure.add_subplot(lines, columns, k), finding)
    write_picture(figure, path, 110)


def _panel(axes, finding: Finding) -> None:
    colors, dashes = cycle(COLORS), cycle(DASHES)
    for label, (x, y) in finding.curves.items():
        if label in finding.predicted:
            axes.plot(x, y, linestyle=next(dashes), color=THEORY, label=label, linewidth=1.4,
                      zorder=3, **(CROSS if len(x) == 1 else {}))
        else:
            axes.plot(x, y, "o-" if len(x) < 12 else "-", color=next(colors), label=label,
                      linewidth=1.0, **(ALONE if len(x) == 1 else {"markersize": 3.5}))
    for axis in finding.logarithmic:
        getattr(axes, f"set_{axis}scale")("log")
    points = max((x for x, _ in finding.curves.values()), key=len)
    if "x" in finding.logarithmic and len(points) < MOST_TICKS:
        axes.set_xticks(points, [f"{x:g}" for x in points], minor=False)
        axes.minorticks_off()
    if "y" in finding.logarithmic:
        _label_few_decades(axes)
    axes.set_title(finding.title, loc="left", fontsize=10, pad=16)
    axes.annotate(finding.line, (0.0, 1.0), (0, 5), xycoords="axes fraction", color="#6b7485",
                  textcoords="offset points", fontsize=7.5)
    axes.set_xlabel(finding.xlabel, fontsize=8)
    axes.set_ylabel(finding.ylabel, fontsize=8)
    axes.tick_params(labelsize=7, which="both")
    axes.grid(color="#e6e9ef", linewidth=0.5)
    if len(finding.curves) > 1:
        axes.legend(frameon=False, fontsize=7)


def _label_few_decades(axes) -> None:
    """An axis with hardly a power of ten on it gets other numbers, too."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator

    low, high = axes.get_ylim()
    if high < FEW_DECADES * low:
        axes.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axes.yaxis.set_minor_locator(NullLocator())
