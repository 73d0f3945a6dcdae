"""Internal modes that stretch: which do, their energy, and what is left of it with fewer modes."""

import numpy as np
import pytest
from bowed import MEMBERS, SECTION, bowed, whole
from struck_frames import TURN

from sebody.fem import frame, straight_beam
from sebody.reduction import craig_bampton
from sebody.reduction.internal_stresses import divide
from sebody.reduction.truncation import truncated


def internal(body):
    """Which resultants are of internal modes."""
    held = len(body.mass) - body.modes
    return ~body.invariants.E[:held].any(axis=0)


@pytest.mark.parametrize("modes", [2, 12, 24, 40])
def test_straight_beams_have_none_and_bows_one(modes):
    """Of 24 and more modes some are axial; a bow of 0.02 radii of gyration is none."""
    straight = straight_beam(TURN @ (-1, 0, 0), TURN @ (1, 0, 0), SECTION, 40)
    assert not internal(craig_bampton(straight, {0: "full", 40: "full"}, modes)).any()
    assert [internal(whole(bowed(rise), modes)).sum() for rise in (3e-5, 1e-3, 1e-2)] == [0, 1, 1]


def test_every_mode_is_orthogonal_to_load_modes_but_those_that_only_loads_stress():
    """Shapes of unit energy: one that stretches, one without stress, one whose stress is axial."""
    own = np.array([[1.0, 0.2], [0.2, 1.0]])
    G = np.array([10 * own, 3 * own, 1e-4 * own[::-1], np.diag([2.0, -2.0])])
    amplitudes = np.array([[1.0, 0.5], [1.0, 2.0], [1e-3, 1e-4]])
    shapes = np.eye(4, 3)
    stretching, clear = divide(G, amplitudes, shapes)
    assert np.abs(stretching[:, 0]) == pytest.approx([1, 0, 0], abs=1e-4)
    assert clear.shape == (3, 2) and np.abs(clear[2]).max() < 1e-4
    # where nothing stretches load modes stay as they are
    assert [turn.shape for turn in divide(G, 0.1 * amplitudes, shapes)] == [(3, 0), (3, 0)]


@pytest.mark.parametrize("rise", [1e-3, 1e-2])
def test_energy_of_third_order_is_that_of_the_fe_model(rise):
    """Of bending modes alone; without the resultant there is none. Moments leave 1 %."""
    points = bowed(rise)
    model = frame(points, [(k, k + 1) for k in range(MEMBERS)], SECTION, 2)
    body = craig_bampton(model, {0: "full", MEMBERS: "full"}, 8)
    i, shapes = body.invariants, body.recovery.shapes[:, :len(body.mass)]
    at = internal(body)
    for y in np.random.default_rng(1).normal(size=(4, 8)) / np.sqrt(np.diag(body.stiffness)[12:]):
        y = np.concatenate([np.zeros(12), y])
        u = shapes @ y
        exact = u @ model.geometric_stiffness(u) @ u / 2
        found = (i.E.T @ y) @ (i.Ghat @ y @ y) / 2
        assert found == pytest.approx(exact, rel=0.01)
        assert abs((i.E.T @ y)[~at] @ (i.Ghat @ y @ y)[~at]) < 1e-6 * abs(exact)


def test_fewer_modes_have_the_energy_of_a_reduction_with_fewer():
    """Bent by boundary motions: what omitted modes have of a stretch, 0.99 of it, gives way.

    A reduction with fewer modes lacks the rest of it altogether.
    """
    points = bowed(0.03)
    many, few = whole(points, 20), whole(points, 3)
    cut = truncated(many, 3)
    y = np.random.default_rng(3).normal(size=(6, 15)) * np.repeat([0.0, 0.02, 0.001], [6, 6, 3])

    def second_order(body):
        i = body.invariants
        q = np.einsum("ka,eab,kb->ke", y, i.Ghat, y) / 2
        return (q * (y @ i.E + q / (2 * i.lam))).sum(axis=1)
    assert second_order(cut) == pytest.approx(second_order(few), rel=0.04)
