"""The cantilever of the atlas: unit length, mass and bending stiffness, cut into equal bodies."""

from collections.abc import Callable

import numpy as np

from sebody.basics.errors import InputError, SimulationError
from sebody.fem import Section
from sebody.model.model import Model
from sebody.results.result import Result
from sebody.runs.statics import equilibrium
from sebody.small_motion.linearization import modes

AXIAL = 1e8             # stiffness: no stretch worth mentioning
ELEMENTS = 48
FRAMES = {"node": "node", "mean": "converged_mean"}     # of the theory, of the kernels
UNSTABLE = 1e-2         # real part of an eigenvalue that is not a rounding error


def arm(bodies: int, frame: str, internal: int = 0, inertia: str | None = "b",
        stiffening: bool | None = None) -> Model:
    """The cantilever in a plane, along x; with option B it does not stiffen."""
    model = Model(planar=True)
    ends = model.node("root", (0.0, 0.0)), model.node("tip", (1.0, 0.0))
    section = Section(area=1.0, inertia_y=1 / AXIAL, inertia_z=1 / AXIAL, torsion=2 / AXIAL,
                      youngs_modulus=AXIAL, poisson_ratio=0.0, density=1.0)
    model.beam("arm", ends, section, ELEMENTS, bodies, internal, frame=FRAMES[frame],
               inertia=inertia, stiffening=stiffening)
    model.fix("root")
    return model


def spinning(model: Model, spin: float) -> Result:
    """It turns about its root, in equilibrium."""
    return equilibrium(model, 2, spin=spin)


def pressed(model: Model, load: float, follower: bool) -> Result:
    """A load presses its tip along the axis, or along the tip; it stays straight."""
    model.force("tip", (-load, 0.0), follower=follower)
    return equilibrium(model, 1, unstable="keep")


def grows(build: Callable[[], Result], spin: float | None = None) -> bool:
    """Tell whether small motion about an equilibrium grows, or there is none."""
    try:
        return bool(modes(build(), spin).growth.max() > UNSTABLE)
    except (SimulationError, InputError):
        return True


def onset(unstable: Callable[[float], bool], lowest: float, highest: float,
          steps: int = 24) -> float:
    """Smallest value at which something is unstable, infinite where nothing is up to `highest`."""
    values = np.linspace(lowest, highest, steps)
    for below, above in zip(values, values[1:], strict=False):
        if unstable(above):
            while above - below > 2e-4 * above:
                middle = 0.5 * (below + above)
                below, above = (below, middle) if unstable(middle) else (middle, above)
            return float(0.5 * (below + above))
    return np.inf
