"""The page of pictures of the atlas."""

from pathlib import Path

from sebody.results.plots import write_picture
from sebody.studies.atlas.finding import Finding

COLORS = ("#c8452d", "#3c6fb6", "#2a7f62", "#b58a1b", "#8a4fa3", "#1f2a44", "#9aa5b8")
COLUMNS = 3
MOST_TICKS = 7          # that are written one by one


def draw(findings: list[Finding], path: str | Path) -> None:
    """One panel a case."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    columns = min(COLUMNS, len(findings))
    lines = -(-len(findings) // columns)
    figure = Figure(figsize=(4.6 * columns, 3.5 * lines), layout="constrained")
    FigureCanvasAgg(figure)
    for k, finding in enumerate(findings, 1):
        axes = figure.add_subplot(lines, columns, k)
        for (label, (x, y)), color in zip(finding.curves.items(), COLORS, strict=False):
            axes.plot(x, y, "o-" if len(x) < 12 else "-", color=color, label=label, markersize=3.5,
                      linewidth=1.0)
        for axis in finding.logarithmic:
            getattr(axes, f"set_{axis}scale")("log")
        points = max((x for x, _ in finding.curves.values()), key=len)
        if "x" in finding.logarithmic and len(points) < MOST_TICKS:
            axes.set_xticks(points, [f"{x:g}" for x in points], minor=False)
            axes.minorticks_off()
        axes.set_title(finding.title, loc="left", fontsize=10)
        axes.set_xlabel(finding.xlabel, fontsize=8)
        axes.set_ylabel(finding.ylabel, fontsize=8)
        axes.tick_params(labelsize=7)
        axes.grid(color="#e6e9ef", linewidth=0.5)
        if len(finding.curves) > 1:
            axes.legend(frameon=False, fontsize=7)
    write_picture(figure, path, 110)
