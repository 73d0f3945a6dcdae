"""Constants and FE data that contradict one another are named, with the remedy."""

from dataclasses import replace

import numpy as np
import pytest

from sebody.basics.errors import InputError
from sebody.fem import Section, straight_beam
from sebody.reduction import craig_bampton

THICK = Section(9.0, 4.75, 6.75, 8.0, 2.1e6, 0.3, 7.8e-3)
START, END, UP = (2.0, 4.0, -1.0), (14.0, 12.0, 8.0), (0.3, -0.5, 1.0)


def changed(body, **arrays):
    return replace(body, invariants=replace(body.invariants, **arrays))


@pytest.mark.parametrize(
    ("change", "text"),
    [
        (lambda i: {"K": i.K[:, :-1]}, r"invariants.K has shape .*; 16 coordinates and"),
        (lambda i: {"g": np.nan * i.g}, "invariants.g is not finite; compute it again"),
        (lambda i: {"Mbar": 1.01 * i.Mbar}, "Mbar contradicts the reduced mass: .* compute both"),
        (lambda i: {"S1": i.S1[[1, 0, 2]]}, "S1 contradicts the reduced mass"),
        (lambda i: {"J0": 1.1 * i.J0}, "J0 contradicts the reduced mass"),
        (lambda i: {"c0": i.c0 + 1}, "c0 contradicts the reduced mass"),
        (lambda i: {"mass": 2 * i.mass}, "mass contradicts the reduced mass"),
        (lambda i: {"K": i.K.transpose(0, 2, 1)}, "K contradicts S1"),
        (lambda i: {"J2": 2 * i.J2}, "J2 contradicts S1: .* with the same modes in the same order"),
        (lambda i: {"J2": "much"}, "invariants.J2 .*: give an array of real numbers"),
        (lambda i: {"Q": np.triu(i.Q)}, "invariants.Q is not symmetric; use a geometric"),
        (lambda i: {"Ghat": np.triu(i.Ghat)}, "invariants.Ghat is not symmetric"),
        (lambda i: {"lam": 2 * i.lam}, "lam and E give more stiffness than the body has"),
        (lambda i: {"lam": -i.lam}, "lam has -.*; give positive stiffnesses"),
        (lambda i: {"origin": i.origin + 1}, "contradicts"),
    ],
)
def test_contradictions_are_named(change, text):
    body = craig_bampton(straight_beam(START, END, THICK, 6, up=UP), {0: "full", 6: "full"}, 4)
    with pytest.raises(InputError, match=text):
        changed(body, **change(body.invariants))


def test_constants_of_other_modes_and_other_bodies_are_named():
    """As many modes, but others; another material; something else."""
    def beam(select, section=THICK):
        model = straight_beam(START, END, section, 6, up=UP)
        return craig_bampton(model, {0: "full", 6: "full"}, 4, select)
    body = beam([0, 1])
    for other, text in (
            (beam([2, 3]).invariants, "Mbar contradicts the reduced mass: .*; compute both from "
                                      "one FE model, with the same modes in the same order"),
            (beam([0, 1, 2]).invariants, "invariants.S1 has shape .*; 14 coordinates and 2 slaved"),
            (beam([0, 1], replace(THICK, youngs_modulus=3e6)).invariants, "more stiffness than the "
                                                                          "body has"),
            (5, "invariants is 5: give InertiaInvariants, as a reduction makes them")):
        with pytest.raises(InputError, match=text):
            replace(body, invariants=other)


def test_what_an_fe_model_gives_is_checked():
    model = straight_beam(START, END, THICK, 4, up=UP)
    ends = {0: "full", 4: "full"}
    other = straight_beam(START, END, replace(THICK, density=1.0), 4, up=UP)
    for fault, text in (
            ({"mass_field": other.mass_field}, "mass_field contradicts the FE mass"),
            ({"geometric_stiffness": lambda u: model.stiffness[:6, :6]}, "has shape .6, 6.; the m"),
            ({"geometric_stiffness": lambda u: model.stiffness * u[:, None]}, "not symmetric; gi"),
            ({"geometric_stiffness": 5}, "geometric_stiffness is 5: give a function of a displace"),
            ({"geometric_stiffness": lambda u: None}, "value of geometric_stiffness is None: ret"),
            ({"geometric_stiffness": lambda u: np.nan * model.stiffness}, "is not finite; compute"),
            ({"geometric_stiffness": lambda u: model.stiffness}, "does not double with the displ"),
            ({"mass_field": 5}, "mass_field is 5: give a MassField")
    ):
        with pytest.raises(InputError, match=text):
            craig_bampton(replace(model, **fault), ends, 2)
    with pytest.raises(InputError, match="mass_field.translation has shape"):
        replace(model, mass_field=straight_beam(START, END, THICK, 3, up=UP).mass_field)
