"""Constants of option D, and what its kernels make of them with real bodies."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sebody import Model
from sebody.assembly import contracts
from sebody.assembly.body_constants import superelement_constants
from sebody.assembly.rigid_part_constants import rigid_part_constants
from sebody.contract.layout import ENERGY, KINETIC, STRAIN
from sebody.fem import StiffnessSection, frame, planar_beam, straight_beam
from sebody.kernels.loader import load
from sebody.reduction import craig_bampton
from sebody.verify.check import states

TURN = Rotation.from_rotvec([0.4, -0.7, 1.1]).as_matrix()
SHIFT = np.array([3.0, -1.0, 2.0])


def section(inertia=1e-3):
    return StiffnessSection(axial=1e3, bending_y=1.0, bending_z=2.0, torsion=1.0, mass=1.0,
                            inertia_x=2 * inertia, inertia_y=inertia, inertia_z=inertia)


def bent(keeps=("full", "full", "translation")):
    """Two arms at an angle, three nodes."""
    points = SHIFT + np.array([[0.0, 0, 0], [1, 0.2, 0], [0.7, 1, 0.4]]) @ TURN.T
    return craig_bampton(frame(points, [(0, 1), (1, 2)], section(), 3),
                         list(zip((0, 1, 2), keeps, strict=True)), 3)


def planar():
    return craig_bampton(planar_beam([1, 2], [2, 1.5], section(), 4), [(0, "full"), (4, "full")], 2)


@pytest.mark.parametrize("body", [bent(), bent(("translation",) * 3), planar()],
                         ids=["mixed", "positions", "planar"])
def test_rigid_modes_are_recognised(body):
    """Translations have all the mass and no mean rotation, unit rotations are their own."""
    d = body.coordinates.shape[1]
    constants = rigid_part_constants(body)
    rigid = body.rigid_modes_about(body.centre_of_mass)
    found = constants["rigid_rows"] @ rigid
    expected = np.diag([body.total_mass] * d + [1.0] * (rigid.shape[1] - d))
    assert np.abs(found - expected).max() < 1e-12       # of masses and lengths of one
    assert np.array_equal(constants["rigid_columns"], constants["rigid_rows"].T)


@pytest.mark.parametrize("inertia", [1e-3, 0.0])
def test_the_rest_has_a_mass_that_is_not_negative(inertia):
    """A body without inertia about its axis, too, of which it turns nothing with the body."""
    body = craig_bampton(straight_beam(SHIFT, SHIFT + TURN[:, 0], section(inertia), 4),
                         [(0, "full"), (4, "full")], 3)
    rows = rigid_part_constants(body)["rigid_rows"]
    first, angle = rows[:3], rows[3:]
    rigid = body.rigid_modes_about(body.centre_of_mass)[:, 3:]
    J = rigid.T @ body.mass @ rigid
    rest = body.mass - first.T @ first / body.total_mass - angle.T @ J @ angle
    least = np.linalg.eigvalsh(rest)
    assert least[0] > -1e-14 * least[-1]        # rounding
    about = TURN[:, 0] @ angle @ rigid @ TURN[:, 0]
    assert about == pytest.approx(1.0 if inertia else 0.0, abs=1e-9)


def case(body, option_frame, q, v, turn):
    """A placed body in a state; positions, rotations and modes of q and v."""
    model = Model(planar=body.planar)
    nodes = [model.node(f"n{k}", x, keep)
             for k, (x, keep) in enumerate(zip(body.coordinates, body.keeps, strict=True))]
    placed = model.superelement("body", body, nodes, option_frame, "d")
    kernel, n = load(placed.kernel), len(body.mass)
    counts = len(body.position_nodes), len(body.rotation_nodes)
    row = contracts.constants_row("body", kernel, contracts.counts_of(placed),
                                  superelement_constants(placed))
    at = turn.ravel()
    return states.Case(kernel, n, states.index_row(n, *counts), row, q, np.tile(at, counts[1]), v,
                       np.zeros(n), at, at)


@pytest.mark.parametrize("option_frame", ["converged_mean", "node", "positions"])
def test_energy_at_rest_is_that_of_the_reduced_mass(option_frame):
    body = bent()
    n, d = len(body.mass), 3 * len(body.position_nodes)
    q, v = np.zeros(n), np.random.default_rng(3).normal(size=n)
    q[:d] = body.coordinates.ravel()
    energy = states.evaluate(case(body, option_frame, q, v, np.eye(3)), ENERGY)[2]
    assert energy[KINETIC] == pytest.approx(v @ body.mass @ v / 2, rel=1e-12)


@pytest.mark.parametrize("option_frame", ["converged_mean", "node", "positions"])
def test_a_rigidly_moving_body_is_a_rigid_body(option_frame):
    """T, momentum and its moment of a body that turns and moves."""
    body = bent()
    turn, spin, push = TURN @ TURN, np.array([0.7, -0.2, 0.5]), np.array([3.0, 1.0, -2.0])
    x = body.coordinates @ turn.T
    q, v = np.zeros((2, len(body.mass)))
    q[:9], v[:9] = x.ravel(), (push + np.cross(spin, x)).ravel()
    v[9:15] = np.tile(turn.T @ spin, 2)
    energy = states.evaluate(case(body, option_frame, q, v, turn), ENERGY)[2]
    rigid = body.rigid_modes[:, 3:]
    J = turn @ rigid.T @ body.mass @ rigid @ turn.T
    c = body.total_mass * turn @ body.centre_of_mass
    p, H = body.total_mass * push + np.cross(spin, c), np.cross(c, push) + J @ spin
    assert energy[KINETIC] == pytest.approx((push @ p + spin @ H) / 2, rel=1e-12)
    assert np.abs(energy[2:8] - np.r_[p, H]).max() < 1e-12 * np.abs(H).max()
    assert abs(energy[STRAIN]) < 1e-12 * energy[KINETIC]    # stiffness of 1e3 and rounding
