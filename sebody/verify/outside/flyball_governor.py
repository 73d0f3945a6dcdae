"""A05 of the IFToMM library, a stiff flyball governor: two arms on a shaft, springs to a slider."""

from collections.abc import Mapping

import numpy as np

from sebody import Model, generalized_alpha, simulate
from sebody.results.result import Result
from sebody.verify.outside.case import Case, Quantity

GRAVITY, SPIN, ANGLE, HINGE, STEP = 9.81, 2 * np.pi, np.pi / 6, 0.05, 1e-4
SPRING, DAMPER, FREE = 8e5, 4e4, 0.5
BALL, BAR, SLIDER, THICK, SIDE = 5.0, 0.3, 3.0, 0.01, 0.1       # kg, and metres of sections

# place of the slider [m] by time, and of the angle of the shaft [rad], which
# tests/data/flyball_governor.py computes at 1e-12
SLIDES = {0.5: 0.743249424786324, 1.0: 0.501420922379568, 2.0: 0.505909294296704,
          5.0: 0.535563103721644, 10.0: 0.619622917061362}
TURNS = {10.0: 55.935409909102248}


def bar_inertia(along: np.ndarray) -> np.ndarray:
    """Inertia of a square bar of length one about its centre."""
    axial, across = BAR * THICK**2 / 6, BAR * (1.0 + THICK**2) / 12
    return across * np.eye(3) + (axial - across) * np.outer(along, along)


def build() -> Model:
    """Everything turns with the shaft at the start."""
    model = Model()
    model.gravity((0.0, 0.0, -GRAVITY))
    shaft = model.node("shaft", (0.0, 0.0, 0.5))
    model.rigid_body("shaft", shaft, BAR, bar_inertia(np.array([0.0, 0.0, 1.0])))
    model.revolute(shaft, axis="z", name="bearing")
    slider = model.node("slider", (0.0, 0.0, 0.5))
    model.rigid_body("slider", slider, SLIDER, SLIDER * SIDE**2 / 6 * np.ones(3))
    model.prismatic(slider, axis="z", to=shaft)
    for name, side in (("right", 1.0), ("left", -1.0)):
        along = np.array([side * np.cos(ANGLE), 0.0, -np.sin(ANGLE)])
        hinge = np.array([side * HINGE, 0.0, 1.0])
        model.attach(f"{name} hinge", hinge, shaft)
        arm = model.node(f"{name} arm", hinge, at=f"{name} hinge")
        model.rigid_body(f"{name} arm", arm, BAR, bar_inertia(along), hinge + along / 2)
        model.attach(f"{name} ball", hinge + along, arm)
        model.point_mass(f"{name} ball", f"{name} ball", BALL)
        model.attach(f"{name} middle", hinge + along / 2, arm)
        model.attach(f"{name} eye", (side * SIDE / 2, 0.0, 0.5), slider)
        model.revolute(arm, axis="y", to=f"{name} hinge")
        model.spring(f"{name} eye", f"{name} middle", SPRING, DAMPER, FREE)
    model.rigid_velocity((0.0, 0.0, 0.0), (0.0, 0.0, SPIN))
    return model


def run(division: int = 1, end: float = 10.0) -> Result:
    """The scheme's default damping."""
    h = STEP / division
    return simulate(build(), h, end, generalized_alpha(0.9, 1e-10), round(0.01 / h))


def measure(division: int, whole: bool) -> Mapping[str, float]:
    """Values of the quantities."""
    result = run(division)
    place = {t: int(np.argmin(np.abs(result.t - t))) for t in SLIDES}
    return ({f"slider at {t:g} s": result["slider.position"][place[t], 2] for t in SLIDES}
            | {f"turn of the shaft at {t:g} s": result["bearing.angle"][place[t]] for t in TURNS})


CASE = Case(
    "Stiff flyball governor", "IFToMM library A05 (no free reference)", measure,
    (*(Quantity(f"slider at {t:g} s", value, source_tolerance=1e-3, share=1e-3, group="slider")
       for t, value in SLIDES.items()),
     *(Quantity(f"turn of the shaft at {t:g} s", value, source_tolerance=1e-3, share=1e-3)
       for t, value in TURNS.items())),
    "reference: three equations of motion, DOP853 and Radau at 1e-12 (tests/data). EXUDYN's "
    "stiffFlyballGovernor.py has softer springs, and springs in place of joints")
