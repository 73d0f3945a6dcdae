"""The scenes with controllers on one page.

    python examples/control_figures.py [FILE.png]

A flexible arm under its hub's controller and under a regulator; a flexible pole on a cart after
three kicks; errors of a two-link arm with and without a load its controller does not know; the body
of half a car on a bump with passive and with active suspension.
"""

import sys
from collections.abc import Callable

import numpy as np

from sebody import Result, simulate
from sebody.pictures.palette import CURVES
from sebody.pictures.plots import STYLE, write_picture
from sebody.scenes import flexible_arm, half_car, pole_on_cart, two_link_arm
from sebody.scenes.scene import Scene


def run(scene: Scene) -> Result:
    """The whole scene."""
    return simulate(scene.model, scene.h, scene.t_end)


def vibration(result: Result) -> tuple[np.ndarray, np.ndarray]:
    """Rotation of the tip against the hub."""
    return result["t"], 1e3 * (result["tip.rotation"] - result["hinge.angle"])


def cart(result: Result) -> tuple[np.ndarray, np.ndarray]:
    """Place of the cart."""
    return result["t"], result["cart.position.x"]


def error(result: Result) -> tuple[np.ndarray, np.ndarray]:
    """Error of the shoulder's angle."""
    t, wanted = result["t"], np.zeros((2, len(result["t"])))
    two_link_arm.trajectory(t, wanted, np.zeros_like(wanted), np.zeros_like(wanted))
    return t, 1e3 * (result["shoulder.angle"] - wanted[0])


def acceleration(result: Result) -> tuple[np.ndarray, np.ndarray]:
    """Vertical acceleration of the body."""
    return result["t"], result["base.acceleration.y"]


Curve = tuple[str, Scene]
PANELS: tuple[tuple[str, str, Callable, Callable[[], tuple[Curve, ...]]], ...] = (
    ("Flexible arm, turned by 0.3 rad", "tip against hub [mrad]", vibration, lambda: (
        ("PD at the hub", flexible_arm.build("pd")),
        ("regulator from state_space", flexible_arm.build("regulator")))),
    ("Flexible pole on a cart, kicked", "cart [m]", cart, lambda: tuple(
        (f"{kick:g} rad/s", pole_on_cart.build(kick)) for kick in (0.5, 1.0, 1.5))),
    ("Two-link arm, computed torque at 1 kHz", "error of the shoulder [mrad]", error, lambda: (
        ("load of 0.2 kg, unknown", two_link_arm.build(0.2)),
        ("no load", two_link_arm.build(0.0)))),
    ("Half of a car on a bump of 6 cm", "body [m/s$^2$]", acceleration, lambda: (
        ("passive", half_car.build("passive")), ("skyhook", half_car.build("active")))))


def main(path: str = "control.png") -> None:
    """Run the scenes and draw them."""
    from matplotlib import rc_context
    from matplotlib.figure import Figure

    with rc_context(STYLE):
        figure = Figure(figsize=(11.0, 6.4), layout="constrained")
        for axis, (title, label, read, curves) in zip(figure.subplots(2, 2).flat, PANELS,
                                                      strict=True):
            for color, (name, scene) in zip(CURVES, curves(), strict=False):
                axis.plot(*read(run(scene)), label=name, color=color, linewidth=1.2)
            axis.set(title=title, ylabel=label, xlabel="t [s]")
            axis.margins(x=0.0)
            axis.legend()
        write_picture(figure, path, 130)
    print("picture:", path)


if __name__ == "__main__":
    main(*sys.argv[1:])
