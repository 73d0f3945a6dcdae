"""Turning equilibria, frequencies about them, damped and gyroscopic eigenvalues.

References: closed solutions and, for beams cut into linear bodies, the theory of
`sebody.verify.atlas`, which is itself compared with tabulated values.
"""

import numpy as np
import pytest
from helpers import order
from scipy.spatial.transform import Rotation

from sebody import InputError, Model, Simulation
from sebody.analysis import equilibrium, linearize, modes, vibrations
from sebody.assembly.numbering import coordinates
from sebody.fem import Section
from sebody.scenes import hinged_beam
from sebody.verify.atlas.theory import beck_load, cantilever, divergence, euler_load, flap

FLAP_6 = 7.360373019            # benchmarks 3.1, eta = 6
STEADY = {                      # benchmarks 2.3: u(L) at the undeformed radius, at the deformed one
    "simo": ((10.0, 2.8e7, 1.4e4, 1.2, 6.0), 5.142857e-4, 5.143175e-4),
    "kane": ((8.0, 5.0311e6, 566.69, 0.20188, 4.0), 1.095700e-4, 1.095718e-4),
    "square": ((0.5, 8e7, 2.667, 3.12, 3000.0), 0.014625, 0.0151572424),
}


def section(axial=1e7, bending=1.0, mass=1.0, torsion=100.0):
    """A section of area one with these stiffnesses and mass a length."""
    return Section(area=1.0, inertia_y=bending / axial, inertia_z=bending / axial,
                   torsion=2 * torsion * bending / axial, youngs_modulus=axial, poisson_ratio=0.0,
                   density=mass)


def turning(bodies, eta, frame="converged_mean", internal=0, elements=48, planar=False,
            inertia=None, **held):
    """A unit cantilever turning about its root, in equilibrium."""
    d = 2 if planar else 3
    model = Model(planar=planar)
    ends = model.node("root", np.zeros(d)), model.node("tip", np.eye(d)[0])
    model.beam("arm", ends, section(**held), elements, bodies, internal, frame=frame,
               inertia=inertia)
    model.fix("root")
    spin = eta if planar else (0.0, 0.0, eta)
    return equilibrium(model, 4, spin=spin), spin


# theory against tables

TABLE = {   # benchmarks 4.1: spin of divergence, Euler and Beck loads
    ("node", 1): (3.51602, np.inf, np.inf), ("node", 2): (5.3793, 3.16515, 39.26),
    ("node", 4): (10.1013, 2.60779, 30.89), ("node", 8): (19.7814, 2.50041, 22.35),
    ("chord", 1): (9.8696, 3.0, np.inf), ("chord", 2): (25.704, 2.59666, 24.00),
    ("chord", 4): (69.161, 2.49927, 22.10), ("chord", 8): (190.5, 2.47534, 20.57)}
FLAP = {("node", 1): -52.2, ("node", 2): -23.2, ("node", 4): -5.53, ("node", 8): -1.25,
        ("chord", 1): -8.09, ("chord", 2): -3.30, ("chord", 4): -1.02, ("chord", 8): -0.27}


@pytest.mark.parametrize("frame, bodies", TABLE)
def test_theory_reproduces_the_tables(frame, bodies):
    beam = cantilever(bodies, frame)
    spin, euler, beck = TABLE[frame, bodies]
    assert divergence(beam) == pytest.approx(spin, rel=2e-3)
    assert euler_load(beam) == pytest.approx(euler, rel=1e-4)
    assert beck_load(beam) == pytest.approx(beck, rel=2e-3)
    assert 100 * (flap(beam, 6.0) / FLAP_6 - 1) == pytest.approx(FLAP[frame, bodies], abs=0.06)


# equilibria

@pytest.mark.parametrize("inertia", [None, "material"])
@pytest.mark.parametrize("case", STEADY)
def test_steady_extension(case, inertia):
    """2.3: bodies without axial modes tend to the value at the deformed radius, order 2.

    The load of a single one is ``rho A W^2 L^2 / 3``, but 0.35 of that with option B, which takes
    the momentum of the tip across the axis with the cubic shapes of bending.
    """
    (length, axial, bending, mass, speed), linear, exact = STEADY[case]
    a = speed * length * np.sqrt(mass / axial)
    assert exact == pytest.approx(length * (np.tan(a) / a - 1.0), rel=2e-5)     # the table's digits
    found, counts = [], (1, 4, 16)
    for n in counts:
        model = Model(planar=True)
        ends = model.node("root", (0, 0)), model.node("tip", (length, 0))
        model.beam("arm", ends, section(axial, bending, mass), n, inertia=inertia)
        model.fix("root")
        found.append(equilibrium(model, 4, spin=speed)["tip.position"][-1, 0] - length)
    rotary = mass * bending / axial
    pull, softening = speed**2 * mass * length**2 / 3, speed**2 * mass * length / 3
    if inertia == "material":
        pull = speed**2 * (0.35 * mass * length**2 + rotary)
        softening = speed**2 * (13 / 35 * mass * length + 1.2 * rotary / length)
    assert found[0] == pytest.approx(pull / (axial / length - softening), rel=1e-6)
    assert found[-1] == pytest.approx(exact, rel=3e-3)
    if case == "square":        # the others differ by less than the error of sixteen bodies
        assert abs(found[-1] - exact) < 0.1 * abs(found[-1] - linear)
    errors = np.abs(np.array(found) - length * (np.tan(a) / a - 1.0))
    assert 1.8 < order(1 / np.array(counts), errors) < 2.2


def test_a_turning_equilibrium_goes_on_turning():
    """Started from it, a simulation keeps its shape: nothing vibrates."""
    run, _ = turning(4, 3.0, planar=True, axial=1e3)
    arm = run.model
    arm.nodes["root"].rotation.fixed = False
    free = Simulation(arm, 0.002)
    for part in ("q", "v", "a"):
        for node in arm.nodes.values():
            for own in (node.position, node.rotation):
                if own in free.numbering.dof_blocks and own in run.numbering.dof_blocks:
                    to, of = free.numbering.dof_blocks[own], run.numbering.dof_blocks[own]
                    getattr(free.state, part)[to:to + own.start.size] = getattr(run.state, part)[
                        of:of + own.start.size]
    free.state.aux[:] = free.state.a
    result = free.run_to(1.0).result()
    radius = np.linalg.norm(result["tip.position"], axis=1)[1:]     # row 0 is the model's own
    assert radius[0] > 1.002
    assert radius == pytest.approx(np.full_like(radius, radius[0]), rel=2e-5)
    angle = np.unwrap(np.arctan2(*result["tip.position"].T[::-1]))
    assert angle == pytest.approx(3.0 * result.t, abs=2e-3)


# turning beams

@pytest.mark.parametrize("frame, theory", [("node", "node"), ("converged_mean", "mean")])
def test_flapping_converges_as_predicted(frame, theory):
    """3.1 at eta = 6: with the bodies, as the theory of linear bodies with option B says."""
    errors = {}
    for n in (2, 4, 8):
        found, spin = turning(n, 6.0, frame, internal=2, inertia="material")
        omega = modes(found, spin).omega
        predicted, exact_inertia = (flap(cantilever(n, theory), 6.0, b) for b in (True, False))
        near = omega[np.argmin(np.abs(omega - predicted))]
        assert near == pytest.approx(predicted, rel=2e-3)
        assert near == pytest.approx(exact_inertia, rel=0.03 if n == 2 else 2e-3)
        errors[n] = abs(near / FLAP_6 - 1)
    assert errors[8] < 0.013 and 1.7 < order((1 / 4, 1 / 8), (errors[4], errors[8])) < 2.3


@pytest.mark.parametrize("frame, theory", [("node", "node"), ("converged_mean", "mean")])
@pytest.mark.parametrize("bodies", [2, 4])
def test_spurious_divergence(frame, theory, bodies):
    """In the plane, with option B, at the spin that theory predicts and not before."""
    limit = divergence(cantilever(bodies, theory), option_b=True)
    for factor, stable in ((0.985, True), (1.015, False)):
        found, spin = turning(bodies, factor * limit, frame, planar=True, axial=1e8,
                              inertia="material")
        assert (modes(found, spin).growth.max() < 1e-3) == stable


def test_hinged_beam_turns():
    """3.3: a beam on a spherical joint flaps with the spin and does not lag, however stiff."""
    model = Model()
    ends = model.node("root", (0, 0, 0)), model.node("tip", (1, 0, 0))
    model.beam("arm", ends, section(axial=1e6, bending=30.0), 8, 2)
    model.fix("root", "position")
    spin = (0.0, 0.0, 2.5)
    found = modes(equilibrium(model, 2, spin=spin), spin)
    low = found.omega[found.omega < 5.0]
    assert np.abs(low - 2.5).min() < 1e-6
    assert (low < 1e-3).sum() >= 2      # lag, and the turn about its axis
    assert found.growth.max() < 1e-3


def test_equations_as_joints_turn_alike():
    """A hinge of multipliers about the spin axis: the same equilibrium and frequencies."""
    spin, found = (0.0, 0.0, 3.0), []
    for explicit in (False, True):
        model = Model()
        ends = model.node("root", (0, 0, 0)), model.node("tip", (1, 0, 0))
        model.beam("arm", ends, section(axial=1e3), 4)
        model.revolute("root", (0, 0, 1), explicit=explicit)
        result = equilibrium(model, 2, spin=spin)
        found.append((result["tip.position"][-1], modes(result, spin).omega[3:8]))
    # Newton's last correction is below 1e-11 of the length, and of second order what it leaves
    assert found[1][0] == pytest.approx(found[0][0], abs=1e-12)
    assert found[1][1] == pytest.approx(found[0][1], rel=1e-8)


# shafts

def shaft(bodies, internal, inertia=None):
    model = Model()
    ends = model.node("a", (0, 0, 0)), model.node("b", (1, 0, 0))
    model.beam("shaft", ends, section(axial=3e7), 48, bodies, internal, inertia=inertia)
    model.fix("a", "position")
    model.fix("b", "position")
    return model


@pytest.mark.parametrize("bodies", [1, 2, 4, 8])
def test_shaft_without_modes(bodies):
    """8.2: in axes that turn with it, omega_n +- W of its own reduced frequencies."""
    still = vibrations(equilibrium(shaft(bodies, 0), 1)).omega
    first = still[still > 1.0][0]
    spin = (0.5 * first, 0.0, 0.0)
    omega = modes(equilibrium(shaft(bodies, 0), 1, spin=spin), spin).omega / first
    for expected in (0.5, 1.5):
        assert np.abs(omega - expected).min() < 1e-6
    exact = (np.pi)**2
    assert abs(first / exact - 1) < 0.12 / bodies**4 + 1e-5     # converges to the exact ones


def test_shaft_of_one_body_with_modes_is_a_limit_of_option_b():
    """Option B drops the velocity the spin gives to the internal deformation."""
    first = vibrations(equilibrium(shaft(1, 4, "b"), 1)).omega
    first = first[first > 1.0][0]
    assert first == pytest.approx(np.pi**2, rel=1e-4)
    spin = (0.5 * first, 0.0, 0.0)
    omega = modes(equilibrium(shaft(1, 4, "b"), 1, spin=spin), spin).omega / first
    for expected in (0.575, 1.385):
        assert np.abs(omega - expected).min() < 1e-3


# damping, matrices, refusals

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
    model.beam("beam", ends, section(), 12, bodies=1, modes=2)
    model.fix("base")
    offset = 0.3 * along + 0.2 * across
    if linked:
        model.attach("side", ends[1].point + offset, "tip")
        model.point_mass("mass", "side", 0.5)
    else:
        model.rigid_body("mass", "tip", 0.5, 0.0 if planar else (0.0, 0.0, 0.0),
                         ends[1].point + offset)
    return model


TURNED = Rotation.from_rotvec([0.6, -0.7, 0.4]).as_matrix().T      # rows: x, y, z of the models


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
    assert still.omega == pytest.approx(still2.omega, rel=1e-9)


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


def test_matrices_do_not_depend_on_where_space_points():
    """A turning state as a whole turned by one radian, its spin axis with it: the same motion.

    Unknowns are in axes of bodies and nodes, so the matrices of small motion are the same, too.
    """
    found, spin = turning(2, 6.0, internal=2, elements=8)
    before = linearize(found, spin)
    Q = Rotation.from_rotvec([0.6, -0.7, 0.4]).as_matrix()
    state, numbering = found.state, found.numbering
    for node in found.model.nodes.values():
        at = coordinates(numbering, node.position)
        for part in (state.q, state.v, state.a):
            part[at] = Q @ part[at]
    for matrices in (state.R, state.frames, state.frames_old):
        matrices[:] = (Q @ matrices.reshape(-1, 3, 3)).ravel()
    after = linearize(found, Q @ spin)
    assert np.abs(before.damping).max() > 1.0       # gyroscopic terms are there
    for name in ("mass", "damping", "stiffness"):
        old, new = getattr(before, name), getattr(after, name)
        # sums of products of rotated and rotated back: some ten EPS
        assert np.abs(new - old).max() < 1e2 * np.finfo(float).eps * np.abs(old).max()


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
