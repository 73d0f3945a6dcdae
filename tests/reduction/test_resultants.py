"""Which stress resultants a body keeps, and what leaving the others out changes."""

import numpy as np
import pytest
from many_interfaces import TURN, cases, errors, patched_block, star, with_all, without_any
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation
from spinning_body import turned_resultants

from sebody.fem import Section, straight_beam
from sebody.reduction import craig_bampton


def section(unit):
    """Square, in any unit of length."""
    return Section(9.0 * unit**2, 6.75 * unit**4, 6.75 * unit**4, 11.387 * unit**4,
                   2.1e6 / unit**2, 0.3, 7.8e-3 / unit**3)


@pytest.mark.parametrize("modes", [0, 20, 52])
def test_a_straight_beam_has_one_resultant_whatever_its_modes(modes):
    """Its tension; of 52 modes some of bending have nearly the frequency of one of twist."""
    for unit, turn in ((1.0, np.eye(3)), (1.0, TURN), (1e3, TURN.T)):
        ends = unit * np.array([[3.0, 1.0, 2.0], [148.0, 1.0, 2.0]]) @ turn.T
        body = craig_bampton(straight_beam(*ends, section(unit), 20),
                             [(0, "full"), (20, "full")], modes)
        assert (body.invariants.resultants, body.invariants.slaved) == (1, 2)
        assert "1 of 6 resultants of second order; the others change little" in body.summary()


def test_up_to_eighteen_resultants_stay():
    """Of a frame with four interfaces, beside those of internal modes."""
    body = star(6, np.array([[0, 0, 0], [1.0, 0.1, 0], [1.3, 0.6, 0.3], [0.9, -0.7, 0.2]]))
    assert body.invariants.resultants == 18 + 2
    assert body.summary().endswith("12 load modes, 18 of 18 resultants of second order, "
                                   "2 of internal modes that stretch")


def test_which_of_many_resultants_stay_is_no_matter_of_axes_units_and_order():
    """Twelve of 24 of a frame with five interfaces; their prestresses, by strain energy.

    And three of internal modes, by the energy of fourth order of boundary motions.
    """
    reference = star(20)
    assert reference.invariants.resultants == 12 + 3
    assert ("12 of 24 resultants of second order, 3 of internal modes that stretch; the others "
            "change little") in reference.summary()
    turn = Rotation.from_rotvec([-1.1, 0.3, 2.0]).as_matrix()
    order = [3, 0, 4, 2, 1]
    other = star(20, turn=turn, unit=1e3, order=order)
    ours = reference.rotated(turn @ TURN.T)

    def stiffness(body):
        return (body.invariants.E * body.invariants.lam) @ body.invariants.E.T
    places = np.arange(30).reshape(2, 5, 3)[:, order].ravel()
    expected = stiffness(ours)[np.ix_(places, places)]
    # forces stay, lengths are a thousand times as large
    found = stiffness(other)[:30, :30] * np.outer(*[np.repeat([1e3, 1.0], 15)] * 2) / 1e3
    # arms stretch 1e5 times as hard as they bend: rounding of FE solutions is 1e-9 of the largest
    assert_allclose(found, expected, atol=1e-8 * np.abs(expected).max())

    def energies(body, motions):
        i = body.invariants
        internal = ~i.E[:30].any(axis=0)
        squares = np.einsum("ma,eab,mb->em", motions, i.Ghat[internal, :30, :30], motions)
        return (squares**2 / (8 * i.lam[internal, None])).sum(axis=0)
    motions = np.random.default_rng(4).normal(size=(5, 30))
    assert_allclose(energies(other, motions[:, places] * np.repeat([1e3, 1.0], 15)),
                    1e3 * energies(ours, motions), rtol=1e-6)


@pytest.mark.parametrize(("make", "arguments", "count"), [
    (star, (16,), (12, 3)), (patched_block, (16, 0.02, 1), (14, 1))])
def test_bodies_with_many_interfaces_stiffen_as_with_all_resultants(make, arguments, count):
    """Within two per cent of frequencies and three of motions of a tenth of the body's size.

    The page on reductions has the errors of more bodies and loads, up to 3.5 per cent.
    """
    whole, body = with_all(make, *arguments), make(*arguments)
    own, internal = count
    assert (body.invariants.resultants, whole.invariants.resultants) == (
        own + internal, 24 + internal)
    # those that stay vanish where the body turns as a whole, to rounding of its static solutions
    assert turned_resultants(body).max() < 1e-11
    given = cases(whole, 7, spins=1, loads=1)
    assert (errors(body, whole, given).max(axis=0) < (0.02, 0.03)).all()
    assert errors(without_any(body), whole, given)[:, 0].max() > 0.1
