"""The spin-up of Kane, Ryan and Banerjee with rounded data and few elements (Sonneville)."""

from collections.abc import Mapping

import numpy as np

from sebody import Model, generalized_alpha, simulate
from sebody.fem import StiffnessSection
from sebody.scenes import spin_up
from sebody.verify.outside.case import Case, Quantity

LENGTH, SPEED, STEP, END, ELEMENTS = 8.0, 4.0, 2e-3, 16.0, 10
SECTION = StiffnessSection(5.03e6, 566.0, 566.0, 566.0, 0.201, 22.7e-6, 22.7e-6, 22.7e-6, 1.94e6,
                           1.94e6)
STRETCH = 1.065e-4      # m, axial, at the constant speed


def measure(division: int, whole: bool) -> Mapping[str, float]:
    """Values of the quantities."""
    model = Model(planar=True)
    root, tip = model.node("root", (0.0, 0.0)), model.node("tip", (LENGTH, 0.0))
    model.beam("arm", (root, tip), SECTION, ELEMENTS * division)
    model.fix(root, "position")
    model.move(root, 1.0, spin_up.turning(SPEED), "rotation")
    result = simulate(model, STEP, END if whole else 8.0, generalized_alpha(0.0))
    angle = np.array([spin_up.turning(SPEED)[0](t) for t in result.t])
    x, y = result["tip.position"].T
    along, across = x * np.cos(angle) + y * np.sin(angle) - LENGTH, (
        y * np.cos(angle) - x * np.sin(angle))
    found = {"largest lag [m]": across.min(), "its time [s]": result.t[across.argmin()],
             "largest shortening [m]": along.min()}
    return found | ({"stretch after the spin-up [m]": along[result.t > 15.0].mean()} if whole
                    else {})


CASE = Case(
    "Spin-up, ten elements", "V. Sonneville, mb_sef_py, example beam_haug (10 elements, h 2e-3, "
    "rho 0)", measure,
    (Quantity("largest lag [m]", -0.53058, printed=5e-6, source_tolerance=0.1),
     Quantity("its time [s]", 6.764, printed=5e-3),
     Quantity("largest shortening [m]", -0.020222, printed=5e-7, source_tolerance=0.1),
     Quantity("stretch after the spin-up [m]", STRETCH, printed=5e-8)),
    "data rounded by the source; its ten elements are not converged: twice as many lag by 0.532 m")
