"""A shaft with two discs in two unequal bearings by its speed (ROSS)."""

from collections.abc import Mapping

import numpy as np

from sebody import Model
from sebody.analysis import modes
from sebody.fem import circle
from sebody.verify.outside.case import Case, Quantity

LENGTH, RADIUS, DENSITY = 1.5, 0.025, 7810.0
SECTION = circle(RADIUS, 211e9, 211e9 / (2 * 81.2e9) - 1, DENSITY)
DISCS, THICKNESS = {2: 0.28, 4: 0.35}, 0.07     # node of six elements, diameter [m]
STIFFNESS = np.diag([1e6, 0.8e6])               # N/m, across
SPEEDS = {      # rad/s, and frequencies [rad/s]
    0: (82.65303734, 86.65811435, 254.52047828, 274.31285391),
    150: (82.60929602, 86.68625235, 251.70037114, 276.87787937),
    300: (82.48132723, 86.76734307, 245.49092844, 282.33294699)}
FASTER = {2000: (77.37957042, 88.98733511566752)}


def build(division: int) -> Model:
    """Along x, free to turn."""
    model = Model()
    names = [f"n{k}" for k in range(7)]
    for k, name in enumerate(names):
        model.node(name, (LENGTH * k / 6, 0.0, 0.0))
    for k in range(6):
        model.beam(f"shaft {k}", names[k:k + 2], SECTION, division, division)
    for k, diameter in DISCS.items():
        squares = diameter**2 + (2 * RADIUS)**2
        mass = np.pi / 4 * (diameter**2 - (2 * RADIUS)**2) * THICKNESS * DENSITY
        across = mass * (3 * squares / 4 + THICKNESS**2) / 12
        model.rigid_body(f"disc {k}", names[k], mass, (mass * squares / 8, across, across))
    for name in (names[0], names[-1]):
        ground = model.node(f"bearing {name}", model.nodes[name].point)
        model.fix(ground)
        model.bushing(ground, to=name, stiffness=STIFFNESS, axis=(1, 0, 0))
    model.bushing("bearing n0", to="n0", stiffness=(1e9, 0, 0), name="thrust")
    return model


def found(speed: float, division: int, count: int) -> list[float]:
    """Lowest frequencies of bending."""
    values = np.abs(modes(build(division), (speed, 0.0, 0.0)).values.imag)
    return list(np.sort(values[values > 1.0])[:count])


def measure(division: int, whole: bool) -> Mapping[str, float]:
    """Values of the quantities."""
    return {f"mode {k + 1} at {speed} rad/s": value for speed, row in (SPEEDS | FASTER).items()
            for k, value in enumerate(found(float(speed), division, len(row)))}


CASE = Case(
    "Rotor with two discs in unequal bearings", "ROSS, ross/tests/test_rotor_assembly.py "
    "(rotor3, rotor4; test_campbell, test_kappa_rotor3)", measure,
    tuple(Quantity(f"mode {k + 1} at {speed} rad/s", value, source_tolerance=1e-3,
                   group=f"mode {k + 1}")
          for speed, row in (SPEEDS | FASTER).items() for k, value in enumerate(row)),
    "frequencies in rad/s; six elements as in ROSS, which accepts 1e-3")
