"""Option D: bodies of which nothing but the reduced stiffness and mass is known."""

import warnings
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import eigh
from scipy.spatial.transform import Rotation

from sebody import InputError, LimitWarning, Model, Simulation, generalized_alpha, simulate
from sebody.analysis import equilibrium, modes, vibrations
from sebody.fem import StiffnessSection, hexahedral_block, planar_beam, straight_beam
from sebody.reduction import craig_bampton
from sebody.scenes import hinged_beam, planar_hinged_beam
from sebody.verify import references

TURN = Rotation.from_rotvec([0.7, -0.4, 0.9]).as_matrix()
IDENTITY, SHIFT = np.eye(3), np.array([30.0, -20.0, 50.0])
EXACT = generalized_alpha(1.0, tolerance=1e-13)      # without numerical damping


def alone(body):
    """What another program may have handed over: matrices, and no more."""
    return replace(body, invariants=None, recovery=None)


def block():
    """12 x 2 x 2, kept by the translations of its eight corners, with eight modes."""
    bricks = hexahedral_block([3, -1, 0], [12, 2, 2], (6, 1, 1), 1e6, 0.3, 1.0)
    points = bricks.coordinates
    ends = (points == points.min(axis=0)) | (points == points.max(axis=0))
    return alone(craig_bampton(bricks, [(int(i), "translation")
                                        for i in np.flatnonzero(ends.all(axis=1))], 8))


def thrown(spin, velocity=(0.0, 0.0, 0.0), rates=0.0):
    """A free block, turned and shifted, that turns about its centre of mass and moves."""
    body, model = block(), Model()
    points = (body.coordinates - body.centre_of_mass) @ TURN.T
    nodes = [model.node(f"n{k}", SHIFT + x, "translation") for k, x in enumerate(points)]
    for node, x in zip(nodes, points, strict=True):
        model.initial_velocity(node, velocity + np.cross(spin, x))
    placed = model.superelement("block", body, nodes, "positions", "rigid_part", rotation=TURN)
    placed.mode_rates[:] = rates
    return model, points


def corners(result):
    return np.stack([result[f"n{k}.position"] for k in range(8)], axis=1)


@pytest.mark.parametrize("spin", [(0.0, 0.0, 5.0), (2.0, -3.0, 4.0)])
def test_an_unstrained_block_tumbles_as_a_rigid_body(spin):
    """Euler's equations. Option B starts with a hundred times the centripetal acceleration."""
    spin = TURN @ spin
    model, points = thrown(spin, (30.0, 4.0, -5.0))
    result = simulate(model, 1e-3, 0.5, EXACT)
    body = block()
    about = body.rigid_modes_about(body.centre_of_mass)[:, 3:]
    J = about.T @ body.mass @ about

    def rates(t, state):
        R, w = state[:9].reshape(3, 3), state[9:]
        return np.r_[(R @ np.cross(np.eye(3), w)).ravel(), np.linalg.solve(J, -np.cross(w, J @ w))]
    exact = solve_ivp(rates, (0, 0.5), np.r_[np.eye(3).ravel(), TURN.T @ spin], "DOP853",
                      result.t, rtol=1e-11, atol=1e-12).y[:9].T.reshape(-1, 3, 3)
    expected = (SHIFT + np.outer(result.t, (30.0, 4.0, -5.0))[:, None]
                + points @ TURN @ exact.transpose(0, 2, 1) @ TURN.T)
    # second order in the step: angles of (5 h)^2 / 12 a radian, over 2.5 radians and 6 long
    assert np.abs(corners(result) - expected).max() < 5e-5


def test_accelerations_of_an_unstrained_block():
    """About an axis of inertia they are centripetal, whatever the body's velocity."""
    spin = TURN @ (0.0, 0.0, 5.0)
    for velocity in ((0.0, 0.0, 0.0), (30.0, 4.0, -5.0)):
        model, points = thrown(spin, velocity)
        run = Simulation(model, 1e-3)
        at = [run.numbering.dof_blocks[node.position] for node in model.nodes.values()]
        found = np.array([run.state.a[k:k + 3] for k in at])
        expected = np.cross(spin, np.cross(spin, points))
        # stiffness 1e6 times rounding of positions of 60, for masses of ten: 1e-9 of 150
        assert np.abs(found - expected).max() < 1e-8 * np.abs(expected).max()


def test_a_superposed_velocity_changes_nothing():
    """A block that also vibrates; it keeps energy and moment of momentum."""
    spin, push = TURN @ (2.0, -3.0, 4.0), np.array([30.0, 4.0, -5.0])
    still, moving = (simulate(thrown(spin, v, rates=5.0)[0], 1e-4, 0.02, EXACT)
                     for v in (0 * push, push))
    assert np.ptp(still["block.modes"]) > 0.01
    carried = corners(moving) - np.outer(moving.t, push)[:, None]
    assert np.abs(carried - corners(still)).max() < 1e-11       # rounding of places of 60
    # of second order in the step, a hundredth of it at a tenth of the step
    energy, H = still["energy.kinetic"] + still["energy.strain"], still["angular_momentum"]
    assert np.ptp(energy) < 1e-6 * energy[0]
    assert np.ptp(H, axis=0).max() < 2e-5 * np.abs(H).max()


def blade(torsion=1.0, turn=IDENTITY, body_modes=6, planar=False, damping=0.0, inertia="rigid_part",
          shift=0.0):
    """A cantilever of unit length, mass and bending stiffness."""
    section = StiffnessSection(axial=1e5, bending_y=1.0, bending_z=1.0, torsion=torsion, mass=1.0,
                               inertia_x=2e-6, inertia_y=1e-6, inertia_z=1e-6)
    d = 2 if planar else 3
    beam = (planar_beam if planar else straight_beam)(np.zeros(d), np.eye(d)[0], section, 16)
    body = craig_bampton(beam, [(0, "full"), (16, "full")], body_modes)
    body = body.damped(damping) if damping else body
    model = Model(planar=planar)
    ends = [model.node(name, turn[:d, :d] @ x + shift)
            for name, x in zip(("root", "tip"), body.coordinates, strict=True)]
    model.superelement("arm", alone(body), ends, inertia=inertia, rotation=turn[:d, :d])
    model.fix("root")
    return model


@pytest.mark.parametrize("torsion", [1e3, 1e-3])
def test_blade_with_soft_torsion(torsion):
    """It does not diverge, where option B does. Frequencies of an independent code, to its digits.

    Without geometric stiffness they are 6 and 4 % below 3.7435 and 4.7973.
    """
    spin = TURN @ (0.0, 0.0, 3.0)
    found = modes(equilibrium(blade(torsion, TURN), 2, spin=spin), spin)
    assert found.omega[np.abs(found.omega - 4.6).argmin()] == pytest.approx(4.602, abs=1e-3)
    assert found.omega[np.abs(found.omega - 3.5).argmin()] == pytest.approx(3.50, abs=2e-3)
    assert found.growth.max() < 1e-8 * found.omega.max()


@pytest.mark.parametrize("count, expected", [(0, 4.7e-4), (4, 5.7e-4)])
def test_hinged_beam_against_the_reference(count, expected):
    """Errors of an independent code with this option; option B has 8.4e-4 and 9.0e-4."""
    exact = references.reference("hinged_beam")["tip_position"]
    scene = hinged_beam.build(inertia="rigid_part", modes=count)
    tip = simulate(scene.model, 0.01, 30.0)["tip.position"]
    assert np.linalg.norm(tip - exact) / np.linalg.norm(exact) == pytest.approx(expected, rel=0.03)


@pytest.mark.parametrize("planar", [False, True])
def test_vibrations_at_rest_and_their_damping(planar):
    """Those of the reduced matrices with the root held, each with its damping."""
    turn = Rotation.from_rotvec([0, 0, 0.7]).as_matrix() if planar else TURN
    d = 2 if planar else 3
    model = blade(turn=turn, planar=planar, damping=0.01, body_modes=2, shift=SHIFT[:d])
    body = model.bodies["arm"].reduced
    held = np.r_[0:d, 2 * d:2 * d + (1 if planar else 3)]
    free = np.setdiff1d(np.arange(len(body.mass)), held)
    squares = eigh(body.stiffness[np.ix_(free, free)], body.mass[np.ix_(free, free)],
                   eigvals_only=True)
    found = equilibrium(model, 1)
    assert vibrations(found).omega == pytest.approx(np.sqrt(squares), rel=1e-9)
    first = modes(found)
    grid = np.ix_(free, free)
    values = np.linalg.eigvals(np.block([
        [np.zeros(body.mass[grid].shape), np.eye(len(free))],
        [-np.linalg.solve(body.mass[grid], body.stiffness[grid]),
         -np.linalg.solve(body.mass[grid], body.damping[grid])]]))
    exact = values[values.imag > 0]
    for value in first.values:
        assert np.abs(exact - value).min() < 1e-8 * np.abs(value)
        assert value.real < 0


def test_static_equilibrium_under_weight_is_that_of_the_other_options():
    def sagging(inertia):
        model = blade(turn=TURN, shift=SHIFT, inertia=inertia)
        model.gravity((0.3, -1.0, 0.5))
        return equilibrium(model, 2)["tip.position"][-1] - SHIFT
    assert np.linalg.norm(sagging("d") - TURN[:, 0]) > 0.1
    assert sagging("d") == pytest.approx(sagging("b"), rel=1e-10)


def test_rigid_links_gravity_and_energy():
    """A pendulum with a mass on an arm; energy to second order of the step."""
    def drift(h):
        model, section = Model(), replace(hinged_beam.SECTION, shear_factor=None)
        body = alone(craig_bampton(straight_beam(np.zeros(3), [1.0, 0, 0], section, 6),
                                   [(0, "full"), (6, "full")], 2))
        ends = model.node("root", SHIFT), model.node("tip", SHIFT + TURN[:, 0])
        model.superelement("arm", body, ends, inertia="rigid_part", rotation=TURN)
        model.attach("end", SHIFT + TURN @ (1.2, 0.1, 0.3), "tip")
        model.point_mass("load", "end", 0.1)
        model.fix("root", "position")
        model.gravity((0.0, -9.81, 0.0))
        result = simulate(model, h, 0.5, EXACT)
        kinetic, strain, potential = (result[f"energy.{name}"]
                                      for name in ("kinetic", "strain", "potential"))
        return np.ptp(kinetic + strain + potential) / np.ptp(kinetic)
    coarse, fine = drift(4e-3), drift(2e-3)
    assert fine < 1e-4 and 3.0 < coarse / fine < 5.0


def test_a_plane_and_space_agree():
    planar, spatial = (simulate(build(inertia="rigid_part", modes=m).model, 0.01,
                                6.0)["tip.position"]
                       for build, m in ((planar_hinged_beam.build, 2), (hinged_beam.build, 4)))
    # Newton's tolerance
    assert np.abs(planar - spatial[:, :2]).max() < 1e-5 * np.abs(planar).max()


@pytest.mark.parametrize("frame", ["mean", "mean_small"])
def test_frames_that_depend_on_the_last_step_are_refused(frame):
    with pytest.raises(InputError, match="inertia 'rigid_part' needs the exact rates of a frame .* "
                                         f"which '{frame}' does not: use one of converged_mean, "
                                         f"mean"):
        hinged_beam.build(inertia="rigid_part", frame=frame)


def test_a_body_of_reduced_matrices_says_once_how_fast_it_may_spin():
    """From a quarter of 3.516 on, its first frequency with a node held."""
    spin = TURN @ (0.0, 0.0, 1.2)
    found = equilibrium(blade(turn=TURN, inertia=None), 2, spin=spin)
    assert found.model.bodies["arm"].inertia == "rigid_part"
    said = (r"body 'arm' spins at 1\.2 rad/s, more than a quarter of 3\.52, .*: its stiffness does "
            "not grow with the spin, .*; divide the body in two, or reduce it from an FE model "
            "with its "
            "mass")
    with pytest.warns(LimitWarning, match=said) as caught:
        modes(found, spin)
    assert len(caught) == 1
    slower = 0.7 * spin
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        modes(equilibrium(blade(turn=TURN, inertia=None), 2, spin=slower), slower)
