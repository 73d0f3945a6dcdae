"""Plots of any quantities of one or several results (extra ``plot``)."""

from collections.abc import Mapping, Sequence
from itertools import cycle
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.basics.files import check_target
from sebody.basics.spelling import naming_arguments
from sebody.pictures.curves import Panel, panels, values
from sebody.pictures.notebook import shown
from sebody.pictures.palette import CURVES
from sebody.pictures.plots import (
    PALE,
    STYLE,
    SUFFIXES,
    check_matplotlib,
    write_picture,
)
from sebody.quantities.names import names
from sebody.results.result import Result

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

DASHES = 0, (5, 3)      # of curves that may lie on others
ON_TOP = "external work"            # which is all kinetic energy in many models
DEEPEST = 1e-18         # of the highest density: what is below is rounding
LEGEND = 10             # most curves that are named
SIZE = 4.9, 3.0         # of a panel [inch]


@naming_arguments
def plot(results: Result | Mapping[str, Result] | Sequence[Result], *quantities: str,
         output: str | Path | None = None, spectrum: bool = False) -> "Figure":
    """Draw histories, phase plots or spectra of any quantities, of several results to compare.

    Parameters
    ----------
    results : Result, mapping of results by label, or sequence of them
    *quantities : str
        ``tip.position`` and every other name of `Result`; one component, ``tip.position.x`` or
        ``beam.modes.0``; the length of a vector, ``tip.velocity.norm``; ``energy`` and
        ``constraints``, all of their kind; ``tip.position.x:y`` or ``A:B``, one component over
        another. Rotations are drawn by their rotation vector. Without any, an overview.
    output : str or Path, optional
        File to write: png, pdf or svg.
    spectrum : bool
        Power spectral densities (Welch 1967) in place of histories.

    Returns
    -------
    matplotlib.figure.Figure
        The drawing, which notebooks show.

    Raises
    ------
    InputError
        matplotlib is missing, a quantity there is not, a result of one state, or a file that
        cannot be written.
    WriteError
        Writing fails; an older file is unchanged.
    """
    spectrum = inputs.flag(spectrum, "spectrum")
    check_matplotlib()
    if output is not None:
        check_target(output, "picture", SUFFIXES)
    labelled = _labelled(results)
    first = next(iter(labelled.values()))
    figure = draw(panels(labelled, quantities or overview(first), spectrum), len(labelled) > 1)
    if output is not None:
        write_picture(figure, output, 150)
    return shown(figure)


def overview(result: Result) -> list[str]:
    """Quantities that are drawn when none is named: motion, energies, a force or amplitudes."""
    known = set(names(result))
    moving = _largest(result, "position", known)
    turning = _largest(result, "angular_velocity", known)
    quantities = [f"{moving}.position"] if moving else []
    quantities += [f"{turning}.angular_velocity"] if turning else []
    quantities += ["energy"]
    for quantity in ("force", "reaction", "modes"):
        joints = [joint.name for joint in result.model.joints]
        owners = {"force": joints, "reaction": result.model.nodes, "modes": result.model.bodies}
        named = [f"{owner}.{quantity}" for owner in owners[quantity]]
        if offered := [name for name in named if name in known]:
            return [*quantities, offered[0]]
    return quantities


def _largest(result: Result, quantity: str, known: set[str]) -> str | None:
    """The node whose quantity varies most."""
    ranges = {node: np.linalg.norm(np.ptp(values(result, f"{node}.{quantity}").numbers, axis=0))
              for node in result.model.nodes if f"{node}.{quantity}" in known}
    best = max(ranges, key=ranges.get, default=None)
    return best if best is not None and ranges[best] > 0 else None


def draw(drawn: Sequence[Panel], compared: bool = False) -> "Figure":
    """A figure of some panels, with a common legend if they compare results."""
    from matplotlib import rc_context
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    columns = 1 if len(drawn) == 1 else 2
    rows = -(-len(drawn) // columns)
    single = len(drawn) == 1
    with rc_context(STYLE):
        figure = Figure(figsize=(SIZE[0] * (1.4 if single else columns),
                                 SIZE[1] * (1.3 if single else rows)), layout="constrained")
        FigureCanvasAgg(figure)
        for k, panel in enumerate(drawn):
            _draw_panel(figure.add_subplot(rows, columns, k + 1), panel, not compared)
        if compared:
            handles, labels = figure.axes[0].get_legend_handles_labels()
            figure.legend(handles, labels, loc="outside lower center", ncols=min(4, len(labels)))
    return figure


def _draw_panel(axes: "Axes", panel: Panel, named: bool) -> None:
    axes.set_title(panel.title)
    axes.set_xlabel(panel.x_label)
    axes.set_ylabel(panel.y_label)
    many = len(panel.curves) > LEGEND
    for k, (curve, color) in enumerate(zip(panel.curves, cycle(CURVES), strict=False)):
        above = (k > 0 and not named) or curve.label == ON_TOP
        axes.plot(curve.x, curve.y, color=color, linewidth=0.7 if many else 1.1, zorder=3,
                  linestyle=DASHES if above else "-", label=curve.label or None)
        if panel.kind == "phase":
            axes.plot(curve.x[:1], curve.y[:1], "o", color=color, markersize=4, zorder=4)
    if panel.kind == "spectrum":
        axes.set_yscale("log")
        low, high = axes.get_ylim()
        axes.set_ylim(bottom=max(low, DEEPEST * high))
        axes.margins(x=0.01)
    elif panel.kind == "phase":
        _keep_shape(axes, panel)
    else:
        axes.margins(x=0.01)
        axes.ticklabel_format(axis="y", scilimits=(-3, 5))
    if many:
        axes.text(1.0, 1.02, f"{len(panel.curves)} components", transform=axes.transAxes,
                  ha="right", va="bottom", color=PALE)
    elif named and panel.curves[0].label and panel.kind != "phase":
        axes.legend(loc="lower right", bbox_to_anchor=(1.02, 0.97), ncols=len(panel.curves),
                    handlelength=1.2, columnspacing=0.9, borderpad=0.2, handletextpad=0.5,
                    fontsize=8 if len(panel.curves) > 3 else None)


def _keep_shape(axes: "Axes", panel: Panel) -> None:
    """Equal scales where both sides are components of the same quantity."""
    one, other = (label.rpartition(".")[0] for label in (panel.x_label, panel.y_label))
    if one == other:
        axes.set_aspect("equal", adjustable="datalim")


def _labelled(results: Result | Mapping[str, Result] | Sequence[Result]) -> dict[str, Result]:
    remedy = "give the Result of a run, several by label, or a list of them"
    if isinstance(results, Result):
        labelled = {"the result": results}
    elif isinstance(results, Mapping):
        labelled = {inputs.name(label, "label of a result"): one for label, one in results.items()}
    else:
        labelled = {f"result {k + 1}": one
                    for k, one in enumerate(inputs.items(results, "results", remedy))}
    if not labelled:
        raise InputError(f"results is empty: {remedy}")
    for label, one in labelled.items():
        inputs.instance(one, label, Result, remedy)
    return labelled
