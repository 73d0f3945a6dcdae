"""Heights of the elements of a beam, for least mass within a stress limit in a run."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import minimize

from sebody.basics import inputs
from sebody.engine.state import Scheme
from sebody.explore.sizing.height_stresses import BeamStress
from sebody.fem.section import Section, StiffnessSection
from sebody.model.model import Model

CLEARLY = 1.01      # of the limit: a search that has ended well leaves less above it
FINE = 1e-5         # of the mass: the search ends where it changes less


@dataclass(frozen=True, eq=False)
class Sizing:
    """Heights of least mass.

    Attributes
    ----------
    heights, stresses, times : (elements,)
        Heights [length], and the largest stress in each element [force/length^2] with its time.
    mass, mass_before : float
        Of the beam with these heights, and with those that were given [mass].
    iterations, runs : int
        Of the search, and of the model in it.
    message : str
        How the optimization ended: if it found no heights within the limit, too.
    seconds : float
        Time that it took.
    history : tuple of float
        Mass after each iteration [mass].
    limit : float
        Of the stresses [force/length^2].
    """

    heights: NDArray
    stresses: NDArray
    times: NDArray
    mass: float
    mass_before: float
    iterations: int
    runs: int
    message: str
    seconds: float
    history: tuple[float, ...]
    limit: float

    def save_picture(self, path: str | Path) -> Path:
        """Heights and stresses along the beam; PNG.

        Raises
        ------
        InputError
            A picture that cannot be made.
        """
        from sebody.explore.sizing.picture import draw

        return draw(self, path)

    def __repr__(self) -> str:
        most, ended = self.stresses.max(), ""
        if most > CLEARLY * self.limit:
            ended = f", above the limit {self.limit:.6g}: {self.message}"
        return (f"<Sizing: mass {self.mass:.6g} instead of {self.mass_before:.6g}, largest stress "
                f"{most:.6g}, {self.iterations} iterations{ended}>")


def size_heights(model: Model, h: float, t_end: float, beam: str, heights: ArrayLike,
                 section: Callable[[float], Section | StiffnessSection], limit: float,
                 bounds: tuple[float, float], iterations: int = 50,
                 scheme: Scheme | None = None) -> Sizing:
    """Heights of a beam's elements, of least mass with stresses within a limit in a run.

    `scipy.optimize.minimize` with its method SLSQP and exact derivatives of the largest stress in
    every element at any time: each is one condition. Vibration modes are those of the heights at
    hand, and are held in the derivatives.

    Parameters
    ----------
    model, h, t_end, beam, heights, section, bounds, scheme
        As of `BeamStress`.
    limit : float
        Largest normal stress [force/length^2].
    iterations : int
        At most.

    Returns
    -------
    Sizing
        Where no heights keep to the limit, those that the search ended with: its text says so, as
        does `Sizing.message`.

    Raises
    ------
    InputError
        As of `BeamStress`, or a limit that is not positive.
    SimulationError
        A run fails.

    Examples
    --------
    >>> found = size_heights(model, 1e-4, 0.2, "rod", np.full(200, 0.02),
    ...                      lambda x: rectangle(x, 0.01, 2.1e11, 0.3, 7850.0), limit=150e6,
    ...                      bounds=(0.004, 0.03))
    """
    began = time.perf_counter()
    limit = inputs.number(limit, "limit", above=0)
    iterations = inputs.integer(iterations, "iterations", least=1)
    stress = BeamStress(model, h, t_end, beam, heights, section, bounds, scheme)
    unit, before = float(stress.built.mean()), stress.mass(stress.built)[0]
    masses: list[float] = []
    last: list[NDArray] = []

    def mass(x: NDArray) -> tuple[float, NDArray]:
        value, slope = stress.mass(unit * x)
        return value / before, slope * unit / before

    def at(x: NDArray) -> NDArray:
        """The heights, whose modes are held from here on."""
        if not last or not np.array_equal(last[-1], x):
            stress.hold(unit * x)
            last[:] = [x.copy()]
        return unit * x

    found = minimize(
        mass, stress.built / unit, jac=True, method="SLSQP",
        bounds=[tuple(bound / unit for bound in stress.bounds)] * len(stress.built),
        constraints={"type": "ineq", "fun": lambda x: 1.0 - stress.values(at(x)) / limit,
                     "jac": lambda x: -stress.at(at(x)).slopes * unit / limit},
        callback=lambda x: masses.append(stress.mass(unit * x)[0]),
        options={"maxiter": iterations, "ftol": FINE})
    x = np.clip(found.x, stress.bounds[0] / unit, stress.bounds[1] / unit)
    stresses = stress.at(at(x))
    return Sizing(unit * x, stresses.values, stresses.times, stress.mass(unit * x)[0], before,
                  int(found.nit), stress.runs, str(found.message), time.perf_counter() - began,
                  tuple(masses), limit)
