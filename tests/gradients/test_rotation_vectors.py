"""Derivatives of rotation vectors, which are followed through turns."""

import differentiated as scenes
import numpy as np
import pytest

from sebody import InputError, Model
from sebody.analysis import at_time, final, gradient, integral
from sebody.model import profiles
from sebody.runs.schemes import generalized_alpha

EXACT = generalized_alpha(tolerance=1e-13)


def turned(angle):
    """A beam whose base is turned about an axis in general position, and shaken."""
    m = Model()
    base, tip = m.node("base", scenes.place(0, 0, 0)), m.node("tip", scenes.place(1, 0, 0))
    m.superelement("beam", scenes.slender(), [base, tip])
    m.move(base, scenes.Z + 0.3 * scenes.X, profiles.rest_to_rest(angle, 0.5), what="rotation",
           name="swing")
    m.move(base, 0.1 * scenes.Y, profiles.harmonic(0.4, 5.0), name="shake")
    m.gravity((0.5, -9.0, 1.0))
    return m


def test_a_velocity_that_was_solved_for_is_refused():
    """The base starts with a speed: from a tip that is given at rest the run is another one."""
    with pytest.raises(InputError, match=r"tip.velocity\[0\]: this velocity is not given.*"
                                         r"initial_velocity"):
        gradient(turned(1.0), 0.01, 0.02, {"tip": final("tip.position")}, ["tip.velocity"])


def apart(model, *run):
    """Largest differences of both recursions from differences of runs, and from each other."""
    one, other = (gradient(model, *run, mode, scheme=EXACT).matrix
                  for mode in ("adjoint", "forward"))
    expected = scenes.differences(model, *run)
    rows = np.abs(expected).max(axis=1, keepdims=True)
    return (np.abs(one - expected) / rows).max(), (np.abs(one - other) / rows).max()


def test_a_free_body_that_tumbles_beyond_half_a_turn():
    """At 2.0, 4.0 and 5.9 rad about axes that turn, and on the way back from a turn, 4.5 rad."""
    objectives = {f"{what} at {t}": at_time(f"a.rotation.{what}", t)
                  for t in (0.3, 0.6, 0.9, 1.2) for what in ("x", "y", "z", "norm")}
    off, unequal = apart(scenes.thrown(), 0.02, 1.2, objectives, ["a.angular_velocity"])
    assert off < 1e-8
    assert unequal < 1e-11


def test_a_base_that_is_turned_beyond_half_a_turn():
    """The prescribed rotation vector, and the tip's, by the drive and by the body's mass."""
    off, unequal = apart(turned(4.5), 0.01, 0.45, {
        "base": final("base.rotation.z"), "tip": final("tip.rotation.x"),
        "length": final("tip.rotation.norm"), "before": at_time("tip.rotation.y", 0.333)}, [
        "swing.amplitude", "shake.amplitude", "beam.mass"])
    assert off < 1e-6
    assert unequal < 1e-9       # residuals by a drive are large beside what is left of them


def test_whole_turns_and_zero_lengths_are_refused():
    with pytest.raises(InputError, match=r"'base.rotation.z' has no derivative.*1 whole turn:"):
        gradient(turned(2 * np.pi / np.linalg.norm(scenes.Z + 0.3 * scenes.X)), 0.02, 0.5,
                 {"z": final("base.rotation.z")}, ["shake.amplitude"])
    with pytest.raises(InputError, match=r"'base.rotation.norm' is zero in a state.*components"):
        gradient(turned(1.0), 0.01, 0.02, {"n": integral("base.rotation.norm")},
                 ["shake.amplitude"])
