"""A run-up of a rotor beside its Campbell diagram, and a box on a shaker.

    python examples/vibration_figures.py [FOLDER]

Writes ``rotor.png`` and ``shaker.png``.
"""

import sys
from pathlib import Path

import numpy as np

from sebody import simulate
from sebody.analysis import campbell, equilibrium, random_response, synchronous_response
from sebody.pictures.frequency_pictures import draw_campbell, new_figure
from sebody.pictures.palette import CURVES
from sebody.pictures.plots import STYLE, write_picture
from sebody.scenes import rotor, shaker

DISC = "disc 2.position"


def run_up(path: Path) -> None:
    """Displacements of a disc over the speed of a run, steady ones, and the Campbell diagram."""
    from matplotlib import rc_context

    scene = rotor.build()
    result = simulate(scene.model, scene.h, scene.t_end)
    speed = rotor.ACCELERATION * result.t
    still = rotor.rotor()
    diagram = campbell(still, np.linspace(0.0, speed[-1], 24), count=12, steps=1)
    speeds = np.linspace(20.0, speed[-1], 400)
    steady = synchronous_response(still, speeds, DISC).orbit(DISC)
    with rc_context(STYLE):
        figure = new_figure(8.4, 8.0)
        upper, lower = figure.subplots(2, sharex=True, height_ratios=(3, 2))
        draw_campbell(upper, *diagram.drawn(np.array([1.0, 2.0])))
        upper.set_ylim(0.0, 2.3 * speed[-1])
        place = 1e3 * (result[DISC] - scene.model.nodes["disc 2"].point)
        for axis, label, colour in zip((1, 2), ("y", "z"), CURVES, strict=False):
            lower.plot(speed, place[:, axis], color=colour, linewidth=0.6,
                       label=f"run-up at {rotor.ACCELERATION:g} rad/s², along {label}")
        lower.plot(speeds, 1e3 * steady.major, color=CURVES[4], linewidth=1.2,
                   label="steady, longer half axis")
        lower.set(title="displacement of the first disc [mm]", ylabel="[mm]",
                  xlabel="speed of rotation [rad/s]")
        lower.legend(fontsize=8)
        lower.margins(x=0.0)
        write_picture(figure, path, 120)


def shaken(path: Path) -> None:
    """A piece of the run, and spectral densities of it and of the response to the specification."""
    from matplotlib import rc_context
    from scipy.signal import welch

    scene = shaker.build(length=8.0)
    result = simulate(scene.model, scene.h, scene.t_end)
    found = random_response(equilibrium(scene.model, 1), {"shaker": shaker.SPECIFICATION},
                            "lid.acceleration")
    name = "lid.acceleration.x"
    with rc_context(STYLE):
        figure = new_figure(8.4, 7.0)
        upper, lower = figure.subplots(2)
        part = (result.t > 2.0) & (result.t < 2.4)
        for of, colour in (("lid", CURVES[0]), ("table", CURVES[4])):
            upper.plot(result.t[part], result[f"{of}.acceleration.x"][part], color=colour, label=of,
                       linewidth=1.0)
        upper.set(title="acceleration [m/s²]", xlabel="time [s]")
        upper.legend(fontsize=8)
        density = welch(result[name][5000:], 1.0 / scene.h, nperseg=10000)
        lower.loglog(*density, color=CURVES[0], linewidth=0.8, label="lid, run of 8 s")
        lower.loglog(found.frequency, found.psd[name], color=CURVES[1], linewidth=1.4,
                     label=f"lid, random_response: rms {found.rms[name]:.3g} m/s²")
        lower.loglog(*np.array(shaker.SPECIFICATION).T, color=CURVES[4], label="table")
        lower.set(title="spectral density [(m/s²)²/Hz]", xlabel="frequency [Hz]", xlim=(18, 220),
                  ylim=(1e-3, None))
        lower.legend(fontsize=8)
        write_picture(figure, path, 120)


if __name__ == "__main__":
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else ".")
    run_up(folder / "rotor.png")
    shaken(folder / "shaker.png")
