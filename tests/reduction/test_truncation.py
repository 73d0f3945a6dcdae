"""Fewer modes of a reduced body: it is the reduction with fewer modes."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sebody import InputError
from sebody.fem import FEModel, Section, StiffnessSection, frame, planar_beam, straight_beam
from sebody.fem.stress import StressModes
from sebody.reduction import ReducedBody, craig_bampton
from sebody.reduction.truncation import truncated

TURN = Rotation.from_rotvec((0.4, -0.7, 0.5)).as_matrix()
PLACED = Rotation.from_rotvec((-0.3, 1.1, 0.8)).as_matrix()
START = np.array([3.0, -2.0, 1.0])
SECTION = Section(area=9.0, inertia_y=6.75, inertia_z=5.1, torsion=11.387, youngs_modulus=2.1e6,
                  poisson_ratio=0.3, density=7.8e-3)
ARMS = StiffnessSection(axial=1e5, bending_y=1.0, bending_z=1.0, torsion=0.8, mass=1.0,
                        inertia_x=2e-6, inertia_y=1e-6, inertia_z=1e-6)
ELBOW = START + np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 0.5, 0.0]]) @ TURN.T
# products of some hundred numbers in another order: rounding
ROUNDING = 1e-11


def beam() -> tuple[FEModel, list]:
    fe_model = straight_beam(START, START + TURN @ (100.0, 0, 0), SECTION, elements=8)
    return fe_model, [(8, "full"), (0, "translation")]


def elbow() -> tuple[FEModel, list]:
    fe_model = frame(ELBOW, [(0, 1), (1, 2)], ARMS, 4, up=TURN[:, 2])
    return fe_model, [(k, "full") for k in range(3)]


def in_plane() -> tuple[FEModel, list]:
    return planar_beam((1.0, 2.0), (5.0, 4.0), SECTION, 6), [(0, "full"), (6, "full")]


def close(found: np.ndarray, expected: np.ndarray) -> bool:
    return found.shape == expected.shape and np.abs(found - expected).max(initial=0.0) <= (
        ROUNDING * np.abs(expected).max(initial=0.0))


def second_order(body: ReducedBody) -> tuple[np.ndarray, np.ndarray]:
    """What load modes and resultants do, however they are turned among one another."""
    i, n = body.invariants, len(body.mass)
    return (np.einsum("pb,bij->pij", body.recovery.shapes[:, n:], i.Q),
            np.einsum("me,eij->mij", i.E, i.Ghat))


@pytest.mark.parametrize("placed", [False, True], ids=["in FE axes", "turned"])
@pytest.mark.parametrize(("made", "rich", "few"), [(beam, 6, 2), (elbow, 7, 3), (in_plane, 5, 0)])
def test_modes_are_nested(made, rich, few, placed):
    fe_model, boundary = made()
    load = np.random.default_rng(1).normal(size=fe_model.stiffness.shape[0])
    many, expected = (craig_bampton(fe_model, boundary, count, loads={"load": load})
                      for count in (rich, few))
    if placed:
        size = many.coordinates.shape[1]
        turn = PLACED if size == 3 else Rotation.from_rotvec((0, 0, 0.7)).as_matrix()[:2, :2]
        many, expected = many.rotated(turn), expected.rotated(turn)
    found, n = truncated(many, few), len(expected.mass)
    assert found.modes == few
    for name in ("stiffness", "mass", "coordinates"):
        assert close(getattr(found, name), getattr(expected, name))
    assert close(found.loads["load"], expected.loads["load"])
    for name in ("S1", "g", "h", "K", "J2", "Mbar"):
        own = (..., slice(n)) if name in ("S1", "g", "h") else (..., slice(n), slice(n))
        assert close(getattr(found.invariants, name)[own], getattr(expected.invariants, name)[own])
    for one, other in zip(second_order(found), second_order(expected), strict=True):
        assert close(one, other)
    assert close(found.recovery.shapes[:, :n], expected.recovery.shapes[:, :n])
    assert close(found.recovery.static, expected.recovery.static)
    # the static response of the omitted modes is a part that is not small
    assert not close(many.recovery.static, expected.recovery.static)
    y = np.linspace(-1e-3, 2e-3, n)
    assert close(found.displacements(y), expected.displacements(y))


def test_damping_stress_modes_and_notes_follow():
    body = craig_bampton(*elbow(), 5).damped(0.02)
    stresses = np.random.default_rng(2).normal(size=(2, 6, len(body.mass)))
    shapes = replace(body.recovery, static=None, stress=(
        StressModes(np.zeros((2, 3)), stresses, np.array([0, 1])),))
    body = replace(body, recovery=shapes)
    found = truncated(body, 1)
    n = len(found.mass)
    # damping forces of a motion without the omitted modes, on the coordinates that stay
    assert np.array_equal(found.damping, body.damping[:n, :n])
    assert np.array_equal(found.recovery.stress[0].modes, stresses[..., :n])
    assert found.summary().splitlines()[-1] == "1 of 5 internal modes kept"
    assert truncated(body, 5) is body


def test_bodies_of_matrices_alone():
    rich = craig_bampton(*beam(), 3)
    alone = ReducedBody(rich.stiffness, rich.mass, rich.coordinates, rich.keeps, 3)
    found = truncated(alone, 2)
    assert (found.modes, found.invariants, found.recovery) == (2, None, None)
    assert np.array_equal(found.mass, rich.mass[:-1, :-1])
    with pytest.raises(InputError, match="modes is 4, but the body has 3 internal modes: keep 0"):
        truncated(alone, 4)
