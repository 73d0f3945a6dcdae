"""Constants and FE data that contradict one another are named, with the remedy."""

from dataclasses import replace

import numpy as np
import pytest

from sebody.errors import InputError
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
        (lambda i: {"Q": np.triu(i.Q)}, "invariants.Q is not symmetric; use a geometric"),
        (lambda i: {"Ghat": np.triu(i.Ghat)}, "invariants.Ghat is not symmetric"),
        (lambda i: {"lam": 2 * i.lam}, "lam and E make more stiffness than the body has"),
        (lambda i: {"lam": -i.lam}, "lam has -.*; give positive stiffnesses"),
        (lambda i: {"origin": i.origin + 1}, "contradicts"),
    ],
)
def test_contradictions_are_named(change, text):
    body = craig_bampton(straight_beam(START, END, THICK, 6, up=UP), {0: "full", 6: "full"}, 4)
    with pytest.raises(InputError, match=text):
        changed(body, **change(body.invariants))


def test_what_an_fe_model_gives_is_checked():
    model = straight_beam(START, END, THICK, 4, up=UP)
    ends = {0: "full", 4: "full"}
    other = straight_beam(START, END, replace(THICK, density=1.0), 4, up=UP)
    for fault, text in (
            ({"mass_field": other.mass_field}, "mass_field makes another mass than the FE mass"),
            ({"geometric_stiffness": lambda u: model.stiffness[:6, :6]}, "has shape .6, 6.; the m"),
            ({"geometric_stiffness": lambda u: model.stiffness * u[:, None]}, "not symmetric; give")
    ):
        with pytest.raises(InputError, match=text):
            craig_bampton(replace(model, **fault), ends, 2)
    with pytest.raises(InputError, match="mass_field.translation has shape"):
        replace(model, mass_field=straight_beam(START, END, THICK, 3, up=UP).mass_field)
