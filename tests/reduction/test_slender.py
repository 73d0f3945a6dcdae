"""Thin wires in any direction: a turn of one end is rounding beside the axial stiffness."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sebody import InputError, Model
from sebody.fem import circle, straight_beam
from sebody.model import beams
from sebody.reduction import ReducedBody, craig_bampton

RADIUS, LENGTH, ELEMENTS = 2e-4, 3.4, 64
WIRE = circle(RADIUS, 2e11, 0.3, 7800.0)
BENDING = 4 * 2e11 * np.pi * RADIUS**4 / 4 / LENGTH         # of one end, the other one held
TWIST = 2e11 / 2.6 * np.pi * RADIUS**4 / 2 / LENGTH


def direction(seed):
    return Rotation.random(random_state=seed).apply([LENGTH, 0.0, 0.0])


@pytest.mark.parametrize("seed", range(4))
def test_wires_of_the_package(seed):
    """Moments of one turned end against closed forms; shear takes (radius / length)^2 of them.

    In a model the reduction is made along the wire, which leaves rounding of the moments. Of a
    turned FE model that of the axial stiffness is left, EA l^2 / EI = 1e9 times that of bending.
    """
    model = Model()
    ends = [model.node(name, point) for name, point in (("a", np.ones(3)),
                                                        ("b", 1.0 + direction(seed)))]
    model.beam("wire", ends, WIRE, ELEMENTS, bodies=1, modes=4)
    turned = craig_bampton(straight_beam(np.zeros(3), direction(seed), WIRE, ELEMENTS),
                           [(0, "full"), (ELEMENTS, "full")], 4)
    along = direction(seed) / LENGTH
    exact = BENDING * np.eye(3) + (TWIST - BENDING) * np.outer(along, along)
    for body, within in ((model.bodies["wire"].reduced, 5e-8), (turned, 1e-6)):
        assert np.abs(body.stiffness[6:9, 6:9] - exact).max() < within * BENDING


def condensed(seed):
    """Static condensation as other programs do it, without making the result symmetric."""
    wire = straight_beam(np.zeros(3), direction(seed), WIRE, ELEMENTS)
    stiffness, mass = wire.stiffness.toarray(), wire.mass.toarray()
    ends = [wire.dofs(k, what)[i] for what in ("translation", "rotation")
            for k in (0, ELEMENTS) for i in range(3)]
    inner = np.setdiff1d(np.arange(len(stiffness)), ends)
    shapes = np.zeros((len(stiffness), 12))
    shapes[ends, np.arange(12)] = 1.0
    shapes[inner] = -np.linalg.solve(stiffness[np.ix_(inner, inner)],
                                     stiffness[np.ix_(inner, ends)])
    return (shapes.T @ stiffness @ shapes, shapes.T @ mass @ shapes, [np.zeros(3), direction(seed)],
            ("full", "full"))


@pytest.mark.parametrize("seed", range(4))
def test_reduced_matrices_of_wires_are_symmetric_but_for_rounding(seed):
    stiffness, *others = condensed(seed)
    ReducedBody(stiffness, *others)
    changed = stiffness.copy()
    changed[7, 10] += 1e-4 * np.abs(stiffness[6:, 6:]).max()
    for wrong in (np.triu(stiffness), changed):
        with pytest.raises(InputError, match=r"stiffness is not symmetric: stiffness\["):
            ReducedBody(wrong, *others)


def test_equal_beams_are_reduced_once(monkeypatch):
    """Wherever they are; and nothing is computed of one that lies like another."""
    reduced, turned = [], []
    monkeypatch.setattr(beams, "craig_bampton", lambda *given: reduced.append(given) or
                        craig_bampton(*given))
    monkeypatch.setattr(ReducedBody, "rotated", lambda body, R, own=ReducedBody.rotated:
                        turned.append(R) or own(body, R))
    section = circle(0.012345, 2e11, 0.3, 7800.0)
    model = Model()
    for k, direction in enumerate(((0, 0, 2.0), (0, 2.0, 0), (0, 0, 2.0), (0, 2.0, 0))):
        start = np.array([k, -1.0, 0.5 * k])
        ends = [model.node(f"{name} {k}", x) for name, x in (("a", start),
                                                             ("b", start + direction))]
        model.beam(f"beam {k}", ends, section, 4, bodies=1, modes=3, damping=0.01)
    assert len(reduced) == 1 and len(turned) == 2
    assert model.bodies["beam 0"].reduced is model.bodies["beam 2"].reduced
