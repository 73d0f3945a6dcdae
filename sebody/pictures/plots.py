"""Pictures of results (extra ``plot``)."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.basics.files import check_target, replacing
from sebody.pictures.palette import AXES, CONTACT
from sebody.pictures.wireframe import lines_of
from sebody.results.result import Result
from sebody.results.units import with_unit

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SUFFIXES = (".png", ".pdf", ".svg")
INSTANTS = 9            # at which the bodies are drawn
STATES = 200            # at most, by which the size of contact surfaces is chosen
MOST_TICKS = 5          # of the longest axis of a path
THIN = 0.35     # least side of a picture in space, relative to the longest: room for axes of a mast
FLAT = 0.03             # share of the motion below which motion out of the plane is not drawn
INK, ACCENT, PALE = "#1f2a44", "#c8452d", "#9aa5b8"
COMPONENTS = tuple(zip(AXES, "xyz", strict=True))
STYLE: dict[Any, Any] = {       # as matplotlib has it
    "font.size": 9, "axes.spines.top": False, "axes.spines.right": False, "axes.edgecolor": PALE,
    "axes.labelcolor": INK, "axes.titlecolor": INK, "axes.titlesize": 10,
    "axes.titlelocation": "left", "xtick.color": INK, "ytick.color": INK, "axes.grid": True,
    "grid.color": "#e6e9ef", "grid.linewidth": 0.8, "legend.frameon": False,
    "axes.axisbelow": True}


def check_picture(path: str | Path) -> None:
    """Refuse a picture that cannot be made.

    Raises
    ------
    InputError
        matplotlib is missing, the folder does not exist, or the file type is unknown.
    """
    check_matplotlib()
    check_target(path, "picture", SUFFIXES)


def check_matplotlib() -> None:
    """Refuse a picture where there is nothing to draw it with.

    Raises
    ------
    InputError
        matplotlib is missing.
    """
    if find_spec("matplotlib") is None:
        raise InputError('pictures need matplotlib: pip install "sebody[plot]"')


def save_picture(result: Result, path: str | Path, base: str, tip: str) -> Path:
    """Draw the angular velocity of one node, and the path of another with the bodies on their way.

    A base without a rotation has no angular velocity: the velocity of the tip is drawn instead.

    Parameters
    ----------
    result : Result
    path : str or Path
        File to write: png, pdf or svg.
    base : str
        Node whose angular velocity is drawn.
    tip : str
        Node whose path is drawn.

    Returns
    -------
    Path
        The file written.

    Raises
    ------
    InputError
        See `check_picture`; unknown nodes.
    """
    inputs.instance(result, "result", Result, "give the Result of a run")
    check_picture(path)
    for node in (base, tip):
        if not isinstance(node, str) or node not in result.model.nodes:
            node = node if isinstance(node, str) else inputs.shown(node)
            raise InputError(f"'{node}.position' is unknown: nodes are "
                             f"{', '.join(result.model.nodes)}")
    title, rates = _rates(result, base, tip)

    from matplotlib import rc_context
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    with rc_context(STYLE):
        figure = Figure(figsize=(9.6, 4.2), layout="constrained")
        FigureCanvasAgg(figure)
        _draw_rates(figure.add_subplot(1, 2, 1), result, rates, title)
        _draw_path(figure, result, tip)
        write_picture(figure, path, 150, bbox_inches="tight", pad_inches=0.1)
    return Path(path)


def write_picture(figure: Figure, path: str | Path, dpi: int, **options: object) -> None:
    """Write a figure of matplotlib in the format of the file's ending.

    Raises
    ------
    WriteError
        Writing fails; an older file is unchanged.
    """
    with replacing(path, "picture") as file:
        figure.savefig(file, dpi=dpi, format=Path(path).suffix[1:], **options)


def _rates(result: Result, base: str, tip: str) -> tuple[str, NDArray]:
    """Title and values of the left picture."""
    if result.model.nodes[base].rotation is None:
        name, title = f"{tip}.velocity", f"velocity of the {tip}"
    else:
        name, title = f"{base}.angular_velocity", f"angular velocity of the {base}"
    return with_unit(title, name, result.units), result[name]


def _spatial(points: NDArray) -> NDArray:
    """Positions (n, 3), with z = 0 for a planar model."""
    return points if points.shape[1] == 3 else np.column_stack([points, np.zeros(len(points))])


def _draw_rates(axes, result: Result, rates: NDArray, title: str) -> None:
    t = result.t
    axes.set_title(title)
    axes.set_xlabel(with_unit("time", "t", result.units))
    axes.margins(x=0.01)
    about = "about " if title.startswith("angular") else "along "
    if about == "about " and (rates.ndim == 1 or
                              np.abs(rates[:, :2]).max() <= FLAT * np.abs(rates).max()):
        axes.plot(t, rates if rates.ndim == 1 else rates[:, 2], color=INK, linewidth=1.2)
        axes.set_ylabel("about z")
        return
    for values, (color, label) in zip(rates.T, COMPONENTS, strict=False):
        axes.plot(t, values, color=color, linewidth=1.0, label=about + label)
    axes.set_ylabel("component, global axes")
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.12), ncols=3)


def _draw_path(figure, result: Result, tip: str) -> None:
    path = _spatial(result[f"{tip}.position"])
    chosen = _instants(path)
    bodies, touched = _bodies(result, chosen), _contacts(result)
    everything = np.concatenate([path, bodies.reshape(-1, 3)])
    extent = np.nanmax(everything, axis=0) - np.nanmin(everything, axis=0)
    flat = extent[2] <= FLAT * extent[:2].max()
    axes = figure.add_subplot(1, 2, 2, projection=None if flat else "3d")
    axes.set_title(f"path of the {tip}, and the bodies")
    size = 2 if flat else 3
    if not flat:
        axes.computed_zorder = False        # the path would be behind bodies that are nearer
    axes.plot(*path[:, :size].T, color=ACCENT, linewidth=1.4, zorder=4, label=f"path of the {tip}")
    for number, lines in enumerate(bodies):
        axes.plot(*lines[:, :size].T, color=PALE if number else INK, zorder=2 if number else 3,
                  linewidth=1.0 if number else 2.0, solid_capstyle="round",
                  label={0: "bodies at the start", 1: "and later"}.get(number))
    if len(touched):
        axes.plot(*touched[:, :size].T, color=CONTACT, linewidth=0.8, zorder=1,
                  label="contact surfaces")
    axes.plot(*path[:1, :size].T, "o", color=ACCENT, markersize=3, zorder=5)
    for name in () if flat else "xyz":
        low, high = getattr(axes, f"get_{name}lim")()
        half = max(high - low, THIN * extent.max()) / 2
        getattr(axes, f"set_{name}lim")((low + high) / 2 - half, (low + high) / 2 + half)
    axes.set_aspect("equal", adjustable="datalim" if flat else "box")
    for name in "xyz"[:size]:
        getattr(axes, f"set_{name}label")(with_unit(name, f"{tip}.position", result.units))
        _thin_ticks(axes, name, extent[:size].max())
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.12), ncols=3)


def _thin_ticks(axes, name: str, largest: float) -> None:
    """As many ticks on an axis as its labels have room for beside each other."""
    low, high = getattr(axes, f"get_{name}lim")()
    room = MOST_TICKS if axes.name == "rectilinear" else MOST_TICKS * (high - low) / largest
    axes.locator_params(axis=name, nbins=max(1, min(round(room), MOST_TICKS)))


def _bodies(result: Result, chosen: list[int]) -> NDArray:
    """The bodies at some samples, (samples, points, 3): lines, with NaN between them."""
    lines = lines_of(result.model)
    points = {name: _spatial(result[f"{name}.position"][chosen])
              for name in dict.fromkeys(name for line in lines for name in line)}
    gap = np.full((len(chosen), 3), np.nan)
    rows = [points_of for one, other in lines for points_of in (points[one], points[other], gap)]
    return np.stack([gap, *rows], axis=1)


def _contacts(result: Result) -> NDArray:
    """Lines of contact surfaces and stops at the start, (points, 3), with NaN between them."""
    # here: runs start faster without scipy.spatial
    from sebody.pictures.contact_surfaces import contact_lines
    from sebody.pictures.drawn_nodes import drawn_nodes, extent

    nodes = drawn_nodes(result, np.unique(np.linspace(0, len(result.rows) - 1, STATES).astype(int)))
    return contact_lines(result.model, nodes, extent(nodes))


def _instants(path: NDArray) -> list[int]:
    """Samples at about equal distances along the first turn of a path, the first one included."""
    travelled = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(path, axis=0), axis=1))])
    away = np.linalg.norm(path - path[0], axis=1)
    back = np.flatnonzero((away < 0.1 * away.max()) & (travelled > 2 * away.max()))
    length = travelled[back[0]] if back.size else travelled[-1]
    wanted = np.linspace(0.0, length, INSTANTS, endpoint=not back.size)
    return sorted(set(np.searchsorted(travelled, wanted).clip(max=len(path) - 1).tolist()))
