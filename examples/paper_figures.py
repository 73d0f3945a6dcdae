"""The content of the paper's figures 4-7 and 9-11, on one page with one table of errors.

    python examples/paper_figures.py [FILE.png]

Angular velocity about z at the base of the beam: node-attached frames and mean frames with inertia
options A and B, each against nonlinear beams. The paper does not print the torque of its hinged
beam; ours rises to 1.2e4 in 2.5 s, stays until 5 and is gone at 7.5. Errors are of the path of the
tip, relative L2 norm over 30 s, against 32 nonlinear beams at a quarter of the step; the paper
compares with five.
"""

import sys
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sebody import simulate
from sebody.pictures.plots import write_picture
from sebody.scenes import hinged_beam, spherical_beam
from sebody.scenes.scene import Scene

VARIANTS = {    # of one superelement: arguments of the scenes
    "node at the base": {"frame": "node", "inertia": "material"},
    "node at the tip": {"frame": "node", "frame_node": 1, "inertia": "material"},
    "mean frame, A": {"inertia": "frame_axes"},
    "mean frame, B": {"inertia": "material"},
}
BEAMS, REFERENCE = "5 nonlinear beams", "32 nonlinear beams"
HINGED = {
    "4: frame at the base and at the tip": ("node at the base", "node at the tip"),
    "5: frame at the base": ("node at the base", BEAMS),
    "6: mean frame, option A": ("mean frame, A", BEAMS),
    "7: mean frame, option B": ("mean frame, B", BEAMS),
}
SPHERICAL = {
    "9: frame at the base": ("node at the base", BEAMS),
    "10: mean frame, option A": ("mean frame, A", BEAMS),
    "11: mean frame, option B": ("mean frame, B", BEAMS),
}
COLORS = "#c8452d", "#1f2a44"


class Run(NamedTuple):
    """What is drawn and compared of a run."""

    t: NDArray
    rate: NDArray       # about z, at the base
    tip: NDArray


def run(scene: Scene, finer: int = 1) -> Run:
    """Base rate and tip of a run, on the scene's own steps."""
    result = simulate(scene.model, scene.h / finer, scene.t_end, output_every=finer)
    return Run(result.t, result["base.angular_velocity"][:, 2], result["tip.position"])


def runs(build) -> dict[str, Run]:
    """All variants of a scene, five nonlinear beams, and the reference."""
    found = {name: run(build(**arguments)) for name, arguments in VARIANTS.items()}
    found[BEAMS] = run(build(bodies=5, elements=5, modes=0, inertia="material"))
    found[REFERENCE] = run(build(bodies=32, elements=32, modes=0, inertia="material"), finer=4)
    return found


def error(found: dict[str, Run], name: str) -> float:
    """Relative L2 error of the tip's path."""
    exact = found[REFERENCE].tip
    return float(np.linalg.norm(found[name].tip - exact) / np.linalg.norm(exact))


def table(hinged: dict[str, Run], spherical: dict[str, Run]) -> str:
    """Errors of all variants in both scenes."""
    lines = [f"{'error of the tip':20} {'hinged':>9} {'spherical':>10}"]
    for name in (*VARIANTS, BEAMS):
        lines.append(f"{name:20} {error(hinged, name):9.1e} {error(spherical, name):10.1e}")
    return "\n".join(lines)


def draw(hinged: dict[str, Run], spherical: dict[str, Run], path: Path) -> None:
    """One page: a panel for each figure, the table in the last one."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(11, 14), layout="constrained")
    FigureCanvasAgg(figure)
    panels = figure.subplots(4, 2).ravel()
    drawn = [(found, title, names) for found, group in ((hinged, HINGED), (spherical, SPHERICAL))
             for title, names in group.items()]
    for axes, (found, title, names) in zip(panels, drawn, strict=False):
        for name, color, width in zip(names, COLORS, (1.0, 1.4), strict=True):
            axes.plot(found[name].t, found[name].rate, color=color, linewidth=width, label=name,
                      zorder=3 - width)
        axes.set_title(f"Figure {title}", loc="left", fontsize=10)
        axes.set_xlabel("time")
        axes.set_ylabel("angular velocity about z")
        axes.grid(color="#e6e9ef")
        axes.legend(frameon=False, fontsize=9)
    panels[-1].axis("off")
    panels[-1].text(0.0, 0.9, table(hinged, spherical), family="monospace", fontsize=10, va="top")
    write_picture(figure, path, 120)


def main() -> None:
    """Compute, print the table, draw the page."""
    path = Path(sys.argv[1] if len(sys.argv) > 1 else "paper_figures.png")
    hinged, spherical = runs(hinged_beam.build), runs(spherical_beam.build)
    print(table(hinged, spherical))
    draw(hinged, spherical, path)
    print(f"picture: {path}")


if __name__ == "__main__":
    main()
