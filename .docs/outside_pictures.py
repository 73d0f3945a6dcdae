"""Draws six cases of outside.md, values of sebody beside those of others: outside.png.

    python .docs/outside_pictures.py
"""

from pathlib import Path

import matplotlib
import numpy as np

matplotlib.use("Agg")
from matplotlib import pyplot as plt  # noqa: E402

from sebody import generalized_alpha, simulate  # noqa: E402
from sebody.scenes import spin_up  # noqa: E402
from sebody.verify.outside import (  # noqa: E402
    bricard,
    composite_beam_dynamics,
    flyball_governor,
    misaligned_four_bar,
    rotating_blade,
    slewing_beam,
)


def loop(axes):
    """Fourth joint of Bricard's mechanism."""
    result = bricard.run()
    points = np.linspace(0.0, bricard.END, 41)
    exact = bricard.path(points)
    for k, axis in enumerate("xyz"):
        axes.plot(result.t, result["p2.position"][:, k], f"C{k}", label=f"{axis}")
        axes.plot(points, exact[:, k], f"C{k}o", ms=3)
    axes.set(title="bricard: fourth joint [m]", xlabel="t [s]")


def governor(axes):
    """Height of the slider."""
    result = flyball_governor.run()
    axes.plot(result.t, result["slider.position"][:, 2], label="slider")
    axes.plot(*zip(*flyball_governor.SLIDES.items(), strict=True), "ko", label="reference")
    axes.set(title="flyball-governor: height of the slider [m]", xlabel="t [s]")


def struck(axes):
    """Tip of the composite beam."""
    t = 0.05 * np.arange(1, 21)
    axes.plot(t, composite_beam_dynamics.stepped(32, h=5e-4, rho=0.9), label="fine steps")
    axes.plot(t, composite_beam_dynamics.stepped(16), "C1--", label="the source's steps")
    axes.plot(t, composite_beam_dynamics.BEAMDYN, "ko", label="BeamDyn")
    axes.set(title="composite-beam-dynamics: uz of the tip [m]", xlabel="t [s]")


def tilted(axes):
    """End of the coupler, out of the plane."""
    result = misaligned_four_bar.run()
    u = 1e3 * (result["end 1.position"] - misaligned_four_bar.START)
    axes.plot(result.t, u[:, 2], label="one superelement a bar")
    rows = misaligned_four_bar.ROWS
    axes.plot(list(rows), [1e3 * row[2] for row in rows.values()], "ko", label="stored")
    axes.set(title="misaligned-four-bar: uz of the coupler [mm]", xlabel="t [s]")


def flapping(axes):
    """Frequency of flapping by speed."""
    speeds = list(rotating_blade.ROWS)
    axes.plot(speeds, [rotating_blade.found(float(s), 2) for s in speeds], label="2 superelements")
    axes.plot(speeds, list(rotating_blade.ROWS.values()), "ko", label="Wright et al.")
    axes.set(title="rotating-blade: first flapping [rad/s]", xlabel="speed [rad/s]")


def slewing(axes):
    """Lag of the tip."""
    for label, model in (("planar", slewing_beam.planar(1)), ("spatial", slewing_beam.spatial(1))):
        result = simulate(model, slewing_beam.STEP, 20.0, generalized_alpha(0.9))
        angle = np.array([spin_up.turning(slewing_beam.SPEED)[0](t) for t in result.t])
        tip = result["tip.position"]
        axes.plot(result.t, tip[:, 1] * np.cos(angle) - tip[:, 0] * np.sin(angle),
                  "C1--" if label == "spatial" else "C0", label=label)
    axes.plot(6.77, slewing_beam.LARGEST, "ko", label="nonlinear beam")
    axes.set(title="slewing-beam: lag of the tip [m]", xlabel="t [s]")


def main() -> None:
    """Draw and write."""
    figure, panels = plt.subplots(2, 3, figsize=(13, 7), layout="constrained")
    for draw, axes in zip((loop, governor, struck, tilted, flapping, slewing), panels.flat,
                          strict=True):
        draw(axes)
        axes.margins(y=0.2)             # room for the legend above
        axes.legend(fontsize=8, loc="upper center", ncols=3)
        axes.grid(alpha=0.3)
    figure.savefig(Path(__file__).with_name("outside.png"), dpi=90)


if __name__ == "__main__":
    main()
