"""Beams with held modes, and stresses in them by heights: against differences and reductions."""

from dataclasses import replace
from math import cos, sin

import numpy as np
import pytest

from sebody import InputError, Model, simulate
from sebody.analysis import BeamStress, size_heights
from sebody.explore.sizing.held_beams import Elements, HeldBeam
from sebody.fem import planar_beam, rectangle, straight_beam
from sebody.reduction import craig_bampton
from sebody.runs.schemes import generalized_alpha

COUNT, LENGTH, BOUNDS = 6, 0.5, (0.006, 0.04)
STEPS, WEIGHTS = (1, -1, 2, -2), np.array([8, -8, -1, 1]) / 12      # of differences
HEIGHTS = 0.012 + 0.006 * np.array([0.3, 0.9, 0.1, 0.7, 0.5, 0.2])


def section(height):
    """A rectangle whose torsion is smooth where it is square, too."""
    return replace(rectangle(height, 0.012, 2.1e11, 0.3, 7850.0), torsion=0.3 * height * 0.012**3)


def held(planar, heights):
    elements = Elements(section, LENGTH / COUNT, *BOUNDS, planar)
    return HeldBeam(planar, LENGTH, COUNT, 3, elements, heights)


def piecewise(heights):
    return lambda s: section(heights[min(int(s * COUNT), COUNT - 1)])


def slider_crank(planar=True, heights=HEIGHTS, modes=3, **options):
    """A crank that turns freely, a rod on a rigid link and a piston, turned and shifted."""
    c, s, r = cos(0.4), sin(0.4), 0.15
    R, at = np.array([[c, -s], [s, c]]), np.array([1.0, -2.0])

    def place(x):
        return at + R @ [x, 0.0] if planar else np.r_[at + R @ [x, 0.0], 0.5]
    m = Model(planar=planar)
    hub = m.node("hub", place(0.0))
    pin = m.attach("crank pin", place(r), hub)
    turn = (lambda w: w) if planar else (lambda w: (0.0, 0.0, w))
    m.rigid_body("crank", hub, 1.0, 0.01 if planar else (0.01, 0.01, 0.01))
    a, b = m.node("pin", place(r), at=pin), m.node("piston pin", place(r + LENGTH))
    m.beam("rod", (a, b), piecewise(heights), COUNT, 1, modes, **{"inertia": "material"} | options)
    m.point_mass("piston", b, 0.5)
    if planar:
        m.revolute(hub, name="bearing")
    else:
        m.revolute(hub, axis=(0, 0, 1), name="bearing")
    axis = R @ [1.0, 0.0]
    m.slider(b, axis=axis if planar else (*axis, 0.0))
    m.initial_velocity(hub, angular=turn(60.0))
    m.initial_velocity(a, angular=turn(-60.0 * r / LENGTH))
    m.initial_velocity(b, angular=turn(-60.0 * r / LENGTH))
    return m


@pytest.mark.parametrize("planar", [True, False])
def test_reduction_is_that_of_craig_and_bampton(planar):
    """At the heights as built, but for signs of modes."""
    found = held(planar, HEIGHTS).at(HEIGHTS)
    ends = np.zeros((2, 2 if planar else 3))
    ends[1, 0] = LENGTH
    fe = (planar_beam(*ends, piecewise(HEIGHTS), COUNT) if planar else
          straight_beam(*ends, piecewise(HEIGHTS), COUNT, (0, 1, 0)))
    own = craig_bampton(fe, [(0, "full"), (COUNT, "full")], 3)
    assert np.allclose(np.abs(found.stiffness), np.abs(own.stiffness),
                       atol=1e-9 * own.stiffness.max())     # conditioning of the clamped stiffness
    assert np.allclose(np.abs(found.mass), np.abs(own.mass), atol=1e-9 * own.mass.max())


@pytest.mark.parametrize("heights", [HEIGHTS, np.full(COUNT, 0.012)], ids=["uneven", "square"])
@pytest.mark.parametrize("planar", [True, False])
def test_slopes_of_the_reduction(planar, heights):
    """Of a square section, too, whose frequencies in both planes are equal."""
    beam = held(planar, heights)
    slopes = beam.at(heights).slopes()
    for e in (0, 3):
        for k, name in enumerate(("stiffness", "mass")):
            own = 0
            for at, weight in zip(STEPS, WEIGHTS, strict=True):
                moved = heights.copy()
                moved[e] += at * 2e-5
                own = own + weight / 2e-5 * getattr(beam.at(moved), name)
            assert np.allclose(slopes[k][e], own, atol=1e-7 * np.abs(own).max())


@pytest.mark.parametrize("planar", [True, False])
def test_stresses_are_those_of_the_result(planar):
    """Of a run of the model as built, from the section forces that it recovers at FE nodes.

    These take the modes that are kept from their motion, so with what the spin adds inside the
    body, and only others from static equilibrium: a few percent apart in so stiff a motion.
    """
    stress = BeamStress(slider_crank(planar), 5e-4, 0.04, "rod", HEIGHTS, section, BOUNDS)
    found = stress.at(HEIGHTS)
    run = simulate(slider_crank(planar), 5e-4, 0.04, scheme=generalized_alpha(tolerance=1e-10))
    at = [run[f"rod.node{k}.section_forces"] for k in range(COUNT + 1)]     # of elements there
    for e, height in enumerate(HEIGHTS):
        fibres = np.array([fibre.stress[0] for fibre in section(height).fibres])
        ends = np.stack([at[e][:, -1], at[e + 1][:, 0]], axis=1) @ fibres.T
        largest = np.abs(ends).max(axis=(1, 2))
        assert np.isclose(found.values[e], largest.max(), rtol=0.08)
        assert largest[np.searchsorted(run["t"], found.times[e] - 1e-9)] > 0.9 * largest.max()


@pytest.mark.parametrize("planar", [True, False])
def test_slopes_of_stresses(planar):
    """Against differences of runs with the same held modes."""
    heights = HEIGHTS * 1.1
    stress = BeamStress(slider_crank(planar), 5e-4, 0.03, "rod", HEIGHTS, section, BOUNDS)
    slopes = stress.at(heights).slopes
    for e in (1, 4):
        own = 0
        for at, weight in zip(STEPS, WEIGHTS, strict=True):
            moved = heights.copy()
            moved[e] += at * 5e-5
            own = own + weight / 5e-5 * stress.at(moved).values
        assert np.allclose(slopes[:, e], own, atol=1e-6 * np.abs(own).max())    # noise of the runs


def test_least_mass():
    limit = 60e6
    model = slider_crank()
    found = size_heights(model, 5e-4, 0.04, "rod", HEIGHTS, section, limit, BOUNDS, 30)
    assert found.mass < found.mass_before and found.stresses.max() < 1.001 * limit
    assert ((found.stresses > 0.99 * limit) | (found.heights < 1.01 * BOUNDS[0])).sum() >= 4
    assert model.bodies["rod"].reduced is model.beams[0].bodies[0]      # put back
    again = slider_crank(heights=found.heights)                        # modes anew
    stress = BeamStress(again, 5e-4, 0.04, "rod", found.heights, section, BOUNDS)
    assert np.isclose(stress.at(found.heights).values.max(), limit, rtol=0.02)


@pytest.mark.parametrize("change, words", [
    ({"beam": "rode"}, "there is no beam 'rode'; the model has 'rod'"),
    ({"heights": [0.01] * 4}, "heights"),
    ({"heights": [0.05] * 6}, "give heights between two bounds"),
    ({"bounds": (0.03, 0.01)}, "give heights between two bounds"),
    ({"bounds": (0.01,)}, "give the least and the largest height"),
    ({"limit": -1.0}, "limit"),
    ({"section": 0.01}, "give a function of a height"),
    ({"section": lambda x: x}, "return one, such as rectangle"),
    ({"section": lambda x: replace(section(x), fibres=())}, "it has no fibres"),
    ({"section": lambda x: section(x if x < 0.02 else 2 * x)}, "not smooth between the heights"),
    ({"scheme": generalized_alpha(index=2)}, "by heights with constraints of index 2"),
    ({"model": slider_crank(inertia="floating_field")}, "build it with inertia='material'")],
    ids=["name", "count", "outside", "bounds", "a bound", "limit", "no function", "no section",
         "fibres", "jump", "index", "inertia"])
def test_refused(change, words):
    given = {"model": slider_crank(), "h": 5e-4, "t_end": 0.005, "beam": "rod", "heights": HEIGHTS,
             "section": section, "limit": 1e8, "bounds": BOUNDS} | change
    with pytest.raises(InputError) as caught:
        size_heights(**given)
    assert words in str(caught.value)


@pytest.mark.parametrize("heights, words", [
    (HEIGHTS[:4], "give 6 heights, one for each element"),
    (HEIGHTS * np.nan, "give 6 heights, one for each element"),
    (3 * HEIGHTS, "give heights within the bounds, 0.006 to 0.04")], ids=["count", "nan", "beyond"])
def test_heights_are_refused(heights, words):
    stress = BeamStress(slider_crank(), 5e-4, 0.005, "rod", HEIGHTS, section, BOUNDS)
    for ask in (stress.at, stress.values, stress.mass, stress.hold):
        with pytest.raises(InputError, match=words):
            ask(heights)


def test_a_limit_that_no_heights_keep_to_is_said():
    found = size_heights(slider_crank(), 1e-3, 0.01, "rod", HEIGHTS, section, 1e-3, BOUNDS, 2)
    assert found.message and repr(found).endswith(f"above the limit 0.001: {found.message}>")
