"""A picture of a sized beam."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from sebody.basics.files import replacing
from sebody.pictures.plots import ACCENT, PALE, STYLE


def draw(found: Any, path: str | Path) -> Path:
    """Draw a `Sizing`: heights along the beam, and the largest stress in each element; PNG."""
    from matplotlib import rc_context
    from matplotlib.figure import Figure

    places = (np.arange(len(found.heights)) + 0.5) / len(found.heights)
    with rc_context(STYLE):
        figure = Figure(figsize=(8, 4.6), layout="constrained")
        upper, lower = figure.subplots(2, 1, sharex=True)
        upper.fill_between(places, -found.heights / 2, found.heights / 2, color=PALE, step="mid")
        upper.set_ylabel("height")
        upper.set_title(f"mass {found.mass:.3g} instead of {found.mass_before:.3g}, "
                        f"{found.iterations} iterations", fontsize=9)
        lower.plot(places, found.stresses / found.limit, color=ACCENT)
        lower.axhline(1.0, color="0.5", linewidth=0.8, linestyle="--")
        lower.set_ylim(0.0, 1.15)
        lower.set_ylabel("largest stress / limit")
        lower.set_xlabel("place along the beam")
        path = Path(path)
        with replacing(path, "picture") as file:
            figure.savefig(file, format="png", dpi=120)
    return path
