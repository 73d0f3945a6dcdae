"""Curves by words: components, rotations, phase plots, spectra, comparisons."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sebody import InputError, Model, simulate
from sebody.pictures.curves import panels
from sebody.quantities.names import names
from sebody.quantities.table import OF_MODEL
from sebody.results.naming import rotation_vectors, values
from sebody.scenes import heavy_top, hinged_beam, squeezer

MASS, STIFFNESS, AMPLITUDE = 0.5, 800.0, 0.03


@pytest.fixture(scope="module")
def beam():
    return simulate(hinged_beam.build(modes=2, elements=4).model, 0.01, 1.0)


@pytest.fixture(scope="module")
def oscillator():
    """A mass on a linear spring, moved along it."""
    model = Model(planar=True)
    anchor = model.node("anchor", (2.0, 1.0), keeps="translation")
    model.fix(anchor, "position")
    ball = model.node("ball", (2.8, 1.6), keeps="translation")
    model.point_mass("ball", ball, MASS)
    model.spring(anchor, ball, STIFFNESS)
    omega = np.sqrt(STIFFNESS / MASS)
    model.initial_velocity(ball, (0.8 * AMPLITUDE * omega, 0.6 * AMPLITUDE * omega))
    return simulate(model, 1e-3, 4.0)


def test_components(beam):
    tip = beam["tip.velocity"]
    assert np.array_equal(values(beam, "tip.velocity").numbers, tip)
    assert values(beam, "tip.velocity").labels == ("x", "y", "z")
    assert np.array_equal(values(beam, "tip.velocity.y").numbers[:, 0], tip[:, 1])
    assert np.array_equal(values(beam, "tip.velocity.norm").numbers[:, 0],
                          np.sqrt((tip**2).sum(axis=1)))
    assert np.array_equal(values(beam, "beam.modes.1").numbers[:, 0], beam["beam.modes"][:, 1])
    energy = values(beam, "energy")
    assert energy.labels == ("kinetic", "strain", "potential", "external work")
    assert np.array_equal(energy.numbers[:, 1], beam["energy.strain"])


@pytest.mark.parametrize("start", [0.0, 0.3])
def test_rotation_vectors_continue_through_full_turns(start):
    angles = np.linspace(start, -15.0, 200)     # exactly zero at the start, then through two turns
    axis = np.array([2.0, -1.0, 2.0]) / 3.0
    found = rotation_vectors(Rotation.from_rotvec(angles[:, None] * axis).as_matrix())
    # rounding of a matrix, which a logarithm near half a turn takes the root of
    np.testing.assert_allclose(found, angles[:, None] * axis, rtol=0, atol=1e-7)


def test_no_rotation_at_all():
    assert not rotation_vectors(np.broadcast_to(np.eye(3), (5, 3, 3))).any()


def test_phase_plots(beam):
    short, = panels({"run": beam}, ["tip.position.x:y"])
    assert (short.x_label, short.y_label) == ("tip.position.x", "tip.position.y")
    assert np.array_equal(short.curves[0].x, beam["tip.position"][:, 0])
    assert np.array_equal(short.curves[0].y, beam["tip.position"][:, 1])
    both, = panels({"run": beam}, ["base.angular_velocity.z:energy.kinetic"])
    assert np.array_equal(both.curves[0].y, beam["energy.kinetic"])


def test_names_with_colons_and_dots():
    model = Model(planar=True)
    model.point_mass("ball", model.node("a:b.x", (1.0, 0.0), keeps="translation"), 1.0)
    model.gravity((0.0, -1.0))
    result = simulate(model, 0.1, 0.5)
    assert panels({"run": result}, ["a:b.x.position"])[0].kind == "history"
    phase, = panels({"run": result}, ["a:b.x.position.y:a:b.x.velocity.y"])
    assert np.array_equal(phase.curves[0].y, result["a:b.x.velocity"][:, 1])


def test_the_spectrum_of_an_oscillation(oscillator):
    """A line at its frequency, and below it half the square of its amplitude (Parseval)."""
    panel, = panels({"run": oscillator}, ["ball.position.x"], spectrum=True)
    frequency, density = panel.curves[0].x, panel.curves[0].y
    exact = np.sqrt(STIFFNESS / MASS) / (2 * np.pi)
    assert abs(frequency[np.argmax(density)] - exact) <= frequency[1] - frequency[0]
    # the window spreads the line over a few frequencies, all kept; the periods are not whole
    assert np.trapezoid(density, frequency) == pytest.approx((0.8 * AMPLITUDE)**2 / 2, rel=0.02)


def test_results_are_compared_component_by_component(beam):
    other = simulate(hinged_beam.build(modes=2, elements=4).model, 0.02, 0.5)
    found = panels({"fine": beam, "coarse": other}, ["tip.position", "energy.kinetic"])
    assert [panel.title for panel in found] == [
        "tip.position.x", "tip.position.y", "tip.position.z", "energy.kinetic"]
    assert [curve.label for curve in found[0].curves] == ["fine", "coarse"]
    assert np.array_equal(found[1].curves[1].x, other.t)
    assert np.array_equal(found[1].curves[1].y, other["tip.position"][:, 1])


@pytest.mark.parametrize("word, said", [
    ("tip.positon", "did you mean 'tip.position'"),
    ("tip.position.xx", "tip.position has the components x, y, z, norm"),
    ("tip.position.3", "tip.position has the components x, y, z, norm"),
    ("beam.modes.2", "beam.modes has the components 0, 1, norm"),
    ("energy.strain.x", "energy.strain is one number"),
    ("tip.position.x.y", "tip.position.x is one number"),
    ("tip.position:y", "tip.position has the components x, y, z: a phase plot takes one of them"),
    ("tip.position.x:energy.kinetc", "did you mean 'energy.kinetic'"), ("", "not empty"),
    ("a:b:c", "'a:b:c' is unknown")])
def test_unknown_words(word, said, beam):
    with pytest.raises(InputError, match=said):
        panels({"run": beam}, [word])


def test_results_that_make_no_curve(beam):
    short = simulate(hinged_beam.build(modes=2, elements=4).model, 0.01, 0.0)
    with pytest.raises(InputError, match="run holds the state at t = 0 alone"):
        panels({"run": short}, ["tip.position"])
    few = simulate(hinged_beam.build(modes=2, elements=4).model, 0.01, 0.1)
    with pytest.raises(InputError, match="has 11 samples: a spectrum takes at least 16"):
        panels({"run": few}, ["energy.kinetic"], spectrum=True)
    with pytest.raises(InputError, match="is a phase plot, which has no spectrum"):
        panels({"run": beam}, ["tip.position.x:y"], spectrum=True)


@pytest.mark.parametrize("build, h", [
    (lambda: hinged_beam.build(modes=2, elements=4), 0.01), (squeezer.build, 1e-5),
    (lambda: heavy_top.build(explicit=True), 1e-3)])
def test_every_name_can_be_asked_for_and_drawn(build, h):
    result = simulate(build().model, h, 20 * h)
    known = names(result)
    assert set(OF_MODEL) <= set(known) and len(set(known)) == len(known)
    for name in known:
        assert len(values(result, name).numbers) == len(result.t)
    for node in result.model.nodes:     # what is not listed is refused
        for quantity in ("reaction", "reaction_moment", "angular_velocity"):
            if f"{node}.{quantity}" not in known:
                with pytest.raises(InputError):
                    result[f"{node}.{quantity}"]


def test_of_compared_results_the_one_without_the_quantity_is_named(beam):
    other = simulate(hinged_beam.build(modes=1, elements=4).model, 0.02, 0.1)
    for word in ("beam.modes.1", "energy.strain:beam.modes.1"):
        with pytest.raises(InputError, match="^coarse: beam.modes"):
            panels({"fine": beam, "coarse": other}, [word])
