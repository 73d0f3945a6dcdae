"""Matrices of small motion, eigenvalues and shapes, against closed solutions and differences."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sebody import InputError, Model, Simulation
from sebody.analysis import equilibrium, linearize, modes, vibrations
from sebody.fem import Section, rectangle
from sebody.scenes import hinged_beam

TURNED = Rotation.from_rotvec([0.6, -0.7, 0.4]).as_matrix().T      # rows: x, y, z of the models
SECTION = Section(area=1.0, inertia_y=1e-7, inertia_z=1e-7, torsion=2e-5, youngs_modulus=1e7,
                  poisson_ratio=0.0, density=1.0)


def test_damped_oscillator():
    """Complex eigenvalues of a mass on a spring and a damper."""
    model = Model(planar=True)
    model.node("anchor", (0, 0))
    model.fix("anchor")
    mass = model.node("mass", (2.0, 0), "translation")
    model.point_mass("ball", mass, 3.0)
    model.spring("anchor", mass, 48.0, 6.0)
    model.slider(mass, (1, 0))
    found = modes(Simulation(model, 0.01))
    assert found.values == pytest.approx([complex(-1.0, np.sqrt(15.0))], rel=1e-9)


def test_matrices_are_derivatives_of_the_forces():
    """About a moving, deformed state: stiffness and damping of its instant by differences."""
    from sebody.contract.layout import RESIDUAL
    from sebody.engine.evaluate import assemble, to_body_axes
    run = Simulation(hinged_beam.build(elements=4).model, 0.01).run_to(3.0)
    found = linearize(run)
    state, n = run.state, run.numbering.free
    kept = state.now.copy()

    def force():
        assert assemble(RESIDUAL, RESIDUAL, run.system, state, state.residual) == 0
        residual = state.residual.copy()
        to_body_axes(run.system, state.frames, residual, False)
        return residual[:n]
    for k in range(0, found.free.shape[1], 3):
        direction = np.zeros(run.numbering.total)
        direction[:n] = found.free[:, k]
        to_body_axes(run.system, state.frames, direction, True)
        frames = state.frames.copy()
        difference = 0.0
        for step, weight in ((1e-3, 0.75), (2e-3, -0.15), (3e-3, 1 / 60)):
            for sign in (1.0, -1.0):
                state.v[:] += sign * step * direction
                state.frames[:] = frames
                difference = difference + sign * weight * force() / 1e-3
                state.now[:] = kept
        damping = found.free.T @ difference
        assert damping == pytest.approx(found.damping[:, k], abs=1e-6 * np.abs(found.damping).max())
    assert found.mass == pytest.approx(found.mass.T, rel=1e-9, abs=1e-9 * np.abs(found.mass).max())


def test_a_run_goes_on_after_it():
    plain = Simulation(hinged_beam.build().model, 0.01).run_to(2.0).result()
    run = Simulation(hinged_beam.build().model, 0.01).run_to(1.0)
    modes(run)
    found = run.run_to(2.0).result()["tip.position"]
    assert found == pytest.approx(plain["tip.position"], abs=1e-6)


def test_refusals():
    model = hinged_beam.build().model
    with pytest.raises(InputError, match=r"spin is \(1, 2\): give three numbers"):
        equilibrium(model, spin=(1, 2))
    with pytest.raises(InputError, match="'tip.speed' has no shape: there are <node>.position and "
                                         "<node>.rotation of base, tip, side, and <super"):
        vibrations(Simulation(clamped(), 0.01)).shape("tip.speed")


def clamped(planar=False, linked=True):
    """A clamped beam in a turned direction with a mass beside its end."""
    d = 2 if planar else 3
    model = Model(planar=planar)
    along, across = TURNED[0][:d] / np.linalg.norm(TURNED[0][:d]), np.zeros(d)
    across[:2] = -along[1], along[0]
    across /= np.linalg.norm(across)
    ends = model.node("base", 0.4 * along), model.node("tip", 1.4 * along)
    model.beam("beam", ends, SECTION, 12, bodies=1, modes=2)
    model.fix("base")
    offset = 0.3 * along + 0.2 * across
    if linked:
        model.attach("side", ends[1].point + offset, "tip")
        model.point_mass("mass", "side", 0.5)
    else:
        model.rigid_body("mass", "tip", 0.5, 0.0 if planar else (0.0, 0.0, 0.0),
                         ends[1].point + offset)
    return model


@pytest.mark.parametrize("planar", [True, False])
def test_masses_on_links_turn_as_masses_beside_a_node(planar):
    """The same body by a rigid link and by its centre of mass: kernel against reduction."""
    spin = 3.0 if planar else 3.0 * TURNED[2]
    found = []
    for linked in (True, False):
        result = equilibrium(clamped(planar, linked), 2, spin=spin)
        found.append((result["tip.position"][-1], modes(result, spin), vibrations(
            Simulation(clamped(planar, linked), 0.01))))
    (place, turning_modes, still), (place2, turning_modes2, still2) = found
    assert place == pytest.approx(place2, abs=1e-9)
    scale = still.omega[-1]     # eigenvalues are exact to EPS of the largest, squared, and a root
    assert turning_modes.omega == pytest.approx(turning_modes2.omega, abs=1e-6 * scale)
    assert np.abs(turning_modes.omega[:2] - still.omega[:2]).max() > 1e-3 * still.omega[0]
    rounding = 10.0 * np.finfo(float).eps * scale**2
    assert still.omega**2 == pytest.approx(still2.omega**2, rel=1e-9, abs=rounding)


@pytest.mark.parametrize("axis", ["z", "y", "planar"])
def test_a_pendulum_on_a_turning_disc(axis):
    """A ball on a link, hinged at the radius a: ``w^2 = W^2 m L a / (J + m L^2)`` in the plane.

    Out of it, hinged across spin and arm, with a + L in place of a.
    """
    planar = axis == "planar"
    x, y, z = np.eye(3)[:, :2] if planar else TURNED
    model, a, L, m, J, W = Model(planar=planar), 0.6, 0.9, 1.4, 0.2, 5.0
    hub = model.node("hub", a * x)
    model.rigid_body("rod", hub, 0.3, J if planar else (J, J, J))
    model.attach("end", (a + L) * x, hub)
    model.point_mass("ball", "end", m)
    model.revolute(hub, {"z": z, "y": y, "planar": 1.0}[axis])
    spin = W if planar else W * z
    result = equilibrium(model, 1, spin=spin)
    found = modes(result, spin)
    radius = a + L if axis == "y" else a
    assert found.omega == pytest.approx([W * np.sqrt(m * L * radius / (J + m * L**2))])
    # the shape in global axes: the ball moves across the link, the hub does not
    shape = found.shape("end.position")[:, 0]
    assert np.abs(shape @ (z if axis == "y" else y)) == pytest.approx(np.linalg.norm(shape))
    assert np.abs(found.shape("hub.position")).max() == 0.0
    turn = found.shape("hub.rotation")[:, 0]
    assert np.linalg.norm(shape) == pytest.approx(L * np.linalg.norm(turn))
    if not planar:
        assert np.cross(turn, L * x) == pytest.approx(shape)


def test_shapes_by_names():
    """A cantilever moves across its axis; its tip turns by 1.3765 of deflection over length."""
    model = clamped()
    model.rigid_bodies.clear()
    found = vibrations(Simulation(model, 0.01), 3)
    along = model.nodes["tip"].point / np.linalg.norm(model.nodes["tip"].point)
    tip, turn = found.shape("tip.position"), found.shape("tip.rotation")
    assert tip.shape == (3, 3) and found.shape("beam.modes").shape == (2, 3)
    assert np.abs(along @ tip[:, :2]).max() < 1e-6 * np.linalg.norm(tip[:, 0])
    expected = 1.3765 * np.cross(along, tip[:, 0])
    assert turn[:, 0] == pytest.approx(expected, abs=1e-3 * np.abs(expected).max())
    offset = model.nodes["side"].point - model.nodes["tip"].point
    side = tip + np.cross(turn, offset, axisa=0).T
    assert found.shape("side.position") == pytest.approx(side)


@pytest.mark.parametrize("planar", [True, False])
def test_stiffness_of_a_force_at_the_end_of_a_link(planar):
    """A force F of space on an arm r, in no equilibrium: its moment ``r x R^T F`` by the turn.

    By a turn theta it changes by ``F (r . theta) - (r . F) theta``; the stiffness is minus that.
    """
    d = 2 if planar else 3
    arm, force = np.array([1.2, -0.5, 0.8])[:d], np.array([3.0, 2.0, -4.0])[:d]
    model = Model(planar=planar)
    hub = model.node("hub", np.zeros(d))
    model.fix(hub, "position")
    model.rigid_body("body", hub, 1.0, 2.0 if planar else (2.0, 2.5, 3.0))
    model.attach("end", arm, hub)
    model.force("end", force)
    found = linearize(Simulation(model, 0.01))
    expected = (np.array([[arm @ force]]) if planar else
                arm @ force * np.eye(3) - np.outer(force, arm))
    assert found.free @ found.stiffness @ found.free.T == pytest.approx(expected, abs=1e-12)


def test_vibrations_under_loads_that_turn_with_the_model():
    """Frequencies of Beck's column are its undamped eigenvalues, until it flutters at 20.05.

    The stiffness of a follower force is not symmetric: with its symmetric part alone the first
    frequency was 6 % off at a fifth of the critical load, and negative squares were reported at
    loads under which the column is stable.
    """
    def column(load):
        model = Model()
        ends = [model.node(name, (x, 0.0, 0.0)) for name, x in (("base", 0.0), ("tip", 1.0))]
        model.beam("column", ends, rectangle(0.02, 0.01, 7e10, 0.3, 2700.0), 8, bodies=4,
                   modes=2, up=(0, 1, 0))
        model.fix("base")
        bending = 7e10 * 0.02 * 0.01**3 / 12.0
        model.force("tip", (-1, 0, 0), load * bending, follower=True)
        return equilibrium(model)

    for load in (2.0, 10.0):
        exact = modes(column(load)).omega
        assert vibrations(column(load)).omega == pytest.approx(exact, rel=1e-9)
    with pytest.raises(InputError, match="not stable: loads that turn .* flutter; modes"):
        vibrations(column(22.0))
