"""Warnings name the line of the user's file, however many calls lie between."""

import warnings

import pytest

from sebody import Model, Simulation, generalized_alpha, simulate, spline
from sebody.analysis import equilibrium, modes
from sebody.fem import circle


def column():
    """A slender cantilever under an axial load above its buckling load."""
    model = Model(planar=True)
    a, b = model.node("a", (0.0, 0.0)), model.node("b", (0.6, 0.8))
    model.beam("bar", (a, b), circle(0.005, 7e10, 0.3, 2700.0), 8, 4, 2)
    model.fix(a)
    model.force(b, (-0.6, -0.8), 140.0)
    return model


def spinning():
    model = Model()
    body = model.node("body", (0.1, 0.2, 0.3))
    model.rigid_body("top", body, 1.0, (1.0, 2.0, 3.0))
    model.initial_velocity(body, angular=(0.0, 0.0, 5.0))
    return model


def hinged(explicit=False):
    model = Model(planar=True)
    arm = model.node("arm", (0.2, -0.1))
    model.rigid_body("bar", arm, 1.0, 0.5)
    model.revolute(arm, explicit=explicit, name="hinge")
    model.gravity((0.3, -9.0))
    return model


def degrees():
    hinged().stop("hinge", upper=90.0, stiffness=1e3)


def slope():
    spline([(0.0, 0.0), (1.0, 0.0), (1.01, 1.0), (2.0, 1.0)])


@pytest.mark.parametrize(("said", "do"), [
    ("unstable", lambda: equilibrium(column(), unstable="keep")),
    ("without spin=", lambda: modes(Simulation(spinning(), 1e-3))),
    ("not a multiple", lambda: simulate(hinged(), 0.01, 0.0253)),
    ("not a multiple", lambda: Simulation(hinged(), 0.01).run_to(0.0253)),
    ("without numerical damping", lambda: Simulation(hinged(True), 0.01, generalized_alpha(1.0))),
    ("in radians", degrees),
    ("leaves their range", slope)])
def test_a_warning_names_the_line_of_the_caller(said, do):
    with warnings.catch_warnings(record=True) as found:
        warnings.simplefilter("always")
        do()
    lines = [one.filename for one in found if said in str(one.message)]
    assert lines == [__file__], [str(one.message) for one in found]
