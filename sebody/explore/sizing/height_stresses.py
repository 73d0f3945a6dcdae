"""Largest stresses in a beam as functions of the heights of its elements."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import NamedTuple, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.engine.state import Scheme
from sebody.explore.sizing.beam_stresses import ConstantRows, StressedBeam
from sebody.explore.sizing.held_beams import Elements, Held, HeldBeam
from sebody.fem.beam import section_axes
from sebody.fem.section import Section, StiffnessSection
from sebody.gradients.gradient import Differentiated, fitting
from sebody.gradients.support import refuse_laws, refuse_model, refuse_scheme
from sebody.model.model import Model
from sebody.model.parts import Beam, Superelement
from sebody.model.variants.copying import copied
from sebody.parameters.changes import whole_body
from sebody.runs.steps import whole_steps

OVERSTEPPED = 1e-3  # of the range of heights: how far beyond a bound a search may go
LINEAR = "frame_axes", "material"       # inertia with forces that are linear in the matrices


class Stresses(NamedTuple):
    """Stresses of a run, and their derivatives."""

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
        inputs.instance(model, "model", Model, "give a sebody.Model")
        model = self.model = cast(Model, copied(model))     # which has other heights for moments
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
                refuse_laws(one.run, "sizing")
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
    if one.options["axis"] is not None:
        raise InputError(f"sizing: beam {name!r} has an axis of its own, whose elements have no "
                         "heights: sizing is of straight beams")
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
