"""Heights of the elements of a beam, for least mass within a stress limit in a run."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import minimize

from sebody import inputs
from sebody.engine.state import Scheme
from sebody.errors import InputError
from sebody.explore.ensembles.changes import whole_body
from sebody.fem.beam import section_axes
from sebody.fem.section import Section, StiffnessSection
from sebody.gradients.beam_stresses import ConstantRows, StressedBeam
from sebody.gradients.gradient import Differentiated, fitting
from sebody.gradients.held_beams import Elements, Held, HeldBeam
from sebody.gradients.support import refuse_model, refuse_scheme
from sebody.model.model import Model
from sebody.model.parts import Beam, Superelement
from sebody.runs.steps import whole_steps

CLEARLY = 1.01      # of the limit: a search that has ended well leaves less above it
FINE = 1e-5         # of the mass: the search ends where it changes less
OVERSTEPPED = 1e-3  # of the range of heights: how far beyond a bound a search may go
LINEAR = "frame_axes", "material"       # inertia with forces that are linear in the matrices


class Stresses(NamedTuple):
    """Of a run, and their derivatives."""

    values: NDArray         # (elements,) largest normal stress of each at any time
    times: NDArray          # (elements,) when
    slopes: NDArray         # (elements, elements) by the heights


class BeamStress:
    """Largest stresses in the elements of a beam as functions of their heights.

    The beam is one superelement in the model. Its clamped vibration modes are those of the heights
    as built; constraint modes are those of the heights at hand.

    Parameters
    ----------
    model : Model
        Is put back after every run.
    h, t_end : float
        Fixed step, and end of every run, a multiple of it [time].
    beam : str
        Name of a beam of `Model.beam` in one superelement, with inertia 'material'.
    heights : (elements,)
        As built [length].
    section : function
        Of a height: the section, with fibres.
    bounds : (float, float)
        Least and largest height [length].
    scheme : Scheme, optional

    Attributes
    ----------
    runs : int
        Runs so far.

    Raises
    ------
    InputError
        Another beam, heights that do not fit, or a model that has no gradient.
    """

    def __init__(self, model: Model, h: float, t_end: float, beam: str, heights: ArrayLike,
                 section: Callable[[float], Section | StiffnessSection],
                 bounds: tuple[float, float], scheme: Scheme | None = None):
        self.model = inputs.instance(model, "model", Model, "give a sebody.Model")
        self.h = inputs.number(h, "h", above=0)
        self.t_end = self.h * whole_steps(inputs.number(t_end, "t_end", above=0), self.h)
        one = _beam(model, beam)
        self.part = one.parts[0]
        two = inputs.array(bounds, "bounds", (2,), remedy="give the least and the largest height")
        low, high = (inputs.number(float(x), "bounds: one", above=0) for x in two)
        inputs.function(section, "section", "give a function of a height that returns a section")
        self.built = inputs.array(heights, "heights", (one.elements,),
                                  remedy=f"give {one.elements} heights, one for each element")
        if not low < high or (self.built < low).any() or (self.built > high).any():
            raise InputError(f"bounds are {low:g} and {high:g}, and heights are "
                             f"{self.built.min():g} to {self.built.max():g}: give heights between "
                             "two bounds")
        self.bounds = low, high
        refuse_model(model)
        ends = one.nodes[-1].point - one.nodes[0].point
        length = float(np.linalg.norm(ends))
        self.beam = HeldBeam(
            model.planar, length, one.elements, self.part.reduced.modes, Elements(
                section, length / one.elements, low, high, model.planar), self.built)
        self.turn, self.constants = _turn(one, model.planar), ConstantRows(self.part)
        self.scheme, self.runs = fitting(scheme), 0
        refuse_scheme(self.scheme, "slopes of stresses by heights")
        self._handle = whole_body(model, self.part, beam)
        self._last: tuple[NDArray, StressedBeam] | None = None

    def hold(self, heights: ArrayLike) -> None:
        """Hold the vibration modes of other heights from here on."""
        self.beam.hold(self._checked(heights))
        self._last = None

    def mass(self, heights: ArrayLike) -> tuple[float, NDArray]:
        """Mass of the beam [mass], and its derivatives by the heights, (elements,)."""
        each, slopes = self.beam.elements.weights(self._checked(heights))
        return float(each.sum()), slopes

    def at(self, heights: ArrayLike) -> Stresses:
        """Stresses with some heights, and their derivatives; the last ones are kept.

        Raises
        ------
        InputError
            Another number of heights, or some that are not within the bounds.
        SimulationError
            The run fails.
        """
        run = self._run(self._checked(heights))
        if run.slopes is None:
            with self._built(run.held):
                run.differentiate()
        assert run.slopes is not None
        return Stresses(run.values, run.times, run.slopes)

    def values(self, heights: ArrayLike) -> NDArray:
        """Stresses alone, (elements,); raises what `at` raises."""
        return self._run(self._checked(heights)).values

    def _checked(self, heights: ArrayLike) -> NDArray:
        """Heights for all elements within the bounds, which a search may overstep a little."""
        count, (low, high) = len(self.built), self.bounds
        found = inputs.array(heights, "heights", (count,),
                             remedy=f"give {count} heights, one for each element")
        little = OVERSTEPPED * (high - low)
        if (found < low - little).any() or (found > high + little).any():
            raise InputError(f"heights are {found.min():g} to {found.max():g}: give heights within "
                             f"the bounds, {low:g} to {high:g}")
        return found

    def _run(self, x: NDArray) -> StressedBeam:
        if self._last is None or not np.array_equal(self._last[0], x):
            held = self.beam.at(x)
            with self._built(held) as part:
                one = Differentiated(self.model, self.h, self.t_end, self.scheme)
                if one.run.start.changed:
                    raise InputError("velocities at the start do not fit the joints, so they would "
                                     "depend on the heights: give velocities that fit")
                self.runs += 1
                self._last = x.copy(), StressedBeam(self.model, held, part, one,
                                                    self.constants, self.turn)
        return self._last[1]

    @contextmanager
    def _built(self, held: Held) -> Iterator[Superelement]:
        """The model with other heights, as long as the context lasts."""
        try:
            self._handle.set(held.body(self.turn, self.part.reduced.units))
            part = self.model.bodies[self.part.name]
            part.alpha, part.alpha_r = self.part.alpha, self.part.alpha_r   # the frame is held
            yield part
        finally:
            self._handle.reset()


def _beam(model: Model, name: str) -> Beam:
    found = [one for one in model.beams if one.name == name]
    if not found:
        known = ", ".join(repr(one.name) for one in model.beams) or "no beams"
        raise InputError(f"sizing: there is no beam {name!r}; the model has {known}: give a beam "
                         "that was built by model.beam")
    one = found[0]
    if len(one.parts) > 1 or one.options["damping"]:
        raise InputError(f"sizing: beam {name!r} has {len(one.parts)} superelements and damping "
                         f"{one.options['damping']!r}: build it with bodies=1 and without damping")
    if one.parts[0].inertia not in LINEAR:
        raise InputError(f"sizing: beam {name!r} has inertia {one.parts[0].inertia!r}: build it "
                         "with inertia='material', whose forces are linear in the reduced matrices")
    return one


def _turn(one: Beam, planar: bool) -> NDArray:
    """From axes of a beam to those of its model."""
    line = np.zeros(3)
    ends = one.nodes[-1].point - one.nodes[0].point
    line[:len(ends)] = ends
    up = one.options["up"]
    return section_axes(line, None if up is None else inputs.vector(up, "up", 3))[
        :len(ends), :len(ends)].T


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
        from sebody.gradients.picture import draw_sizing

        return draw_sizing(self, path)

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
