"""A mass that moves along a simply supported beam at half the critical speed (L. Frýba, 1972).

Length, bending stiffness, mass per length and weight are one. The reference is Frýba's series of
sine modes with the convective terms of the mass, integrated at run time: 24 and 16 modes differ by
6e-7 of the largest deflection.
"""

from collections.abc import Mapping
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from sebody import Model, simulate
from sebody.fem import Section, rectangle
from sebody.verify.outside.case import Case, Quantity

MASS, SPEED = 0.5, 0.5 * np.pi
SMALL = 1e-4            # of the weight: beams stay straight, as the series has it
SERIES = 24             # sine modes
PLACES = (0.25, 0.5, 0.75, 0.95)        # of the way along the beam
LARGEST = 0.0196        # deflection, by which differences are told


def thin() -> Section:
    """A section with rho A = E I = 1, without shear and rotary inertia to speak of."""
    height = 1e-3
    return rectangle(height, 1.0, youngs_modulus=12 / height**3, poisson_ratio=0.0,
                     density=1 / height)


def bridge(bodies: int = 1, modes: int = 12, elements: int = 24) -> Model:
    """The beam on two hinges, with the mass on a path along it that a drive moves."""
    model = Model(planar=True)
    ends = model.node("a", (0.0, 0.0)), model.node("b", (1.0, 0.0))
    model.beam("beam", ends, thin(), elements=elements, bodies=bodies, modes=modes,
               stiffening=False)
    for end in ends:
        model.fix(end, "position")
    car = model.node("car", (0.0, 0.0), "translation")
    model.point_mass("mass", car, MASS)
    model.force(car, (0.0, -1.0), MASS * SMALL)
    model.path("deck", on="beam")
    model.path_joint(car, "deck", name="runs")
    model.drive_way("runs", (lambda t: 0.5 * np.pi * t, lambda t: 0.5 * np.pi, lambda t: 0.0),
                    name="engine")
    return model


def deflections(times: NDArray, count: int = SERIES) -> tuple[NDArray, NDArray]:
    """Deflections under the mass and at mid-span, (m,) each, by the series."""
    k = np.arange(1, count + 1) * np.pi

    def rate(t: float, z: NDArray) -> NDArray:
        s = SPEED * t
        row, slope, bend = np.sin(k * s), k * np.cos(k * s), -k * k * np.sin(k * s)
        matrix = np.eye(count) / 2 + MASS * np.outer(row, row)
        force = row * MASS - k**4 / 2 * z[:count] - MASS * row * (
            2 * SPEED * slope @ z[count:] + SPEED**2 * bend @ z[:count])
        return np.concatenate([z[count:], np.linalg.solve(matrix, force)])

    found = solve_ivp(rate, (0.0, times[-1]), np.zeros(2 * count), "DOP853", times, rtol=1e-8,
                      atol=1e-10).y[:count].T
    return np.sum(found * np.sin(np.outer(SPEED * times, k)), axis=1), found @ np.sin(k / 2)


@lru_cache(1)
def exact() -> dict[str, float]:
    """References by the names of the quantities."""
    under, middle = deflections(np.array(PLACES) / SPEED)
    return {f"{what} at {place:g} of the way": float(value)
            for what, values in (("under the mass", under), ("mid-span", middle))
            for place, value in zip(PLACES, values, strict=True)}


def measure(division: int, whole: bool) -> Mapping[str, float]:
    """Values of the quantities."""
    times = np.array(PLACES) / SPEED
    result = simulate(bridge(elements=24 * division), times[-1] / (760 * division), times[-1])
    values = {}
    for what, node in (("under the mass", "car"), ("mid-span", f"beam.node{12 * division}")):
        place = np.interp(times, result.t, -result[f"{node}.position"][:, 1] / SMALL)
        values |= {f"{what} at {part:g} of the way": float(one)
                   for part, one in zip(PLACES, place, strict=True)}
    return values


CASE = Case(
    "Moving mass on a beam", "L. Frýba, Vibration of Solids and Structures under Moving Loads, "
    "1972, chapter 2, by its series", measure,
    tuple(Quantity(name, value, LARGEST, group="deflections") for name, value in exact().items()),
    "without separation, with convective terms; a body with 12 internal modes")
