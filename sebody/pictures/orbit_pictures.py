"""Pictures of synchronous responses: half axes and phases over the speed, orbits (extra ``plot``).
"""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sebody.pictures.frequency_pictures import add_legend, curve_styles, new_figure
from sebody.pictures.plots import PALE, STYLE, check_picture, write_picture

POINTS = 200        # of an orbit
GAP = 0.05          # of an orbit, before its end
EDGE = 1.15         # half width of a picture of orbits, of the largest half axis


def save_synchronous(path: str | Path, speeds: NDArray,
                     orbits: Mapping[str, tuple[NDArray, NDArray, NDArray]], rate: str) -> Path:
    """Draw half axes and phases of quantities over the speed.

    Parameters
    ----------
    orbits : mapping of str to three of (m,)
        Longer half axis, shorter one, phase [rad].
    rate : str
        Unit of the speeds.
    """
    check_picture(path)
    from matplotlib import rc_context

    with rc_context(STYLE):
        figure = new_figure(8.0, 6.4)
        upper, lower = figure.subplots(2, sharex=True, height_ratios=(2, 1))
        for (name, (major, minor, phase)), line in zip(orbits.items(), curve_styles(),
                                                       strict=False):
            upper.plot(speeds, major, label=name, **line)
            upper.plot(speeds, minor, **line | {"linewidth": 0.7, "alpha": 0.7})
            jumps = np.flatnonzero(np.abs(np.diff(phase)) > np.pi / 2) + 1     # it is modulo pi
            lower.plot(np.insert(speeds, jumps, np.nan),
                       np.insert(np.degrees(phase), jumps, np.nan), **line)
        upper.axhline(0.0, color=PALE, linewidth=0.8, zorder=1)
        upper.set(title="half axes of orbits; thin: the shorter one, below zero of backward whirls",
                  ylabel="half axis")
        add_legend(upper)
        lower.set(title="phase: the end of the longer axis is reached after this angle",
                  ylabel="phase [degrees]", xlabel=f"speed of rotation [{rate}]", ylim=(-5, 185),
                  yticks=[0, 45, 90, 135, 180])
        for axes in (upper, lower):
            axes.margins(x=0.0)
        write_picture(figure, path, 150)
    return Path(path)


def save_orbits(path: str | Path, title: str, orbits: Mapping[str, NDArray]) -> Path:
    """Draw orbits.

    Parameters
    ----------
    orbits : mapping of str to (2,) complex
        Amplitudes along two directions.
    """
    check_picture(path)
    from matplotlib import rc_context

    turn = np.exp(2j * np.pi * np.linspace(0.0, 1.0 - GAP, POINTS))[:, None]
    with rc_context(STYLE):
        figure = new_figure(6.4, 6.4)
        axes = figure.subplots()
        largest = 0.0
        for (name, amplitude), line in zip(orbits.items(), curve_styles(), strict=False):
            places = np.real(turn * amplitude)
            axes.plot(*places.T, label=name, **line)
            axes.plot(*places[0], "o", color=line["color"], markersize=5)
            largest = max(largest, np.abs(places).max())
        edge = EDGE * (largest or 1.0)
        axes.set(title=title, aspect="equal", xlim=(-edge, edge), ylim=(-edge, edge),
                 xlabel="first direction across the axis", ylabel="second direction")
        for draw in (axes.axhline, axes.axvline):
            draw(0.0, color=PALE, linewidth=0.8, zorder=1)
        figure.legend(loc="outside lower center", ncols=2, fontsize=8)
        write_picture(figure, path, 150)
    return Path(path)
