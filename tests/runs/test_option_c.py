"""Every analysis of bodies with exact inertia: plain and stiffened, in a plane and in space.

The body is oblique and away from the origin. That it is right is tested in `test_exact_inertia`;
here, that it obeys conservation laws, does not depend on units, axes and stops, and that gravity,
damping, rigid links and small motion fit together.
"""

from dataclasses import replace

import numpy as np
import pytest
from helpers import order
from scipy.spatial.transform import Rotation

from sebody import Model, Simulation, generalized_alpha, simulate
from sebody.analysis import equilibrium, linearize, modes, resume, save_state, vibrations
from sebody.contract.layout import RESIDUAL
from sebody.engine.evaluate import assemble, to_body_axes
from sebody.fem import StiffnessSection, frame, planar_beam, straight_beam
from sebody.reduction import craig_bampton

EXACT = generalized_alpha(1.0, 1e-11)       # undamped
TURN = Rotation.from_rotvec([0.7, -0.4, 0.9]).as_matrix()
FLAT = np.array([[0.6, -0.8], [0.8, 0.6]])
START = np.array([3.0, -1.0, 2.0])
GRAVITY = np.array([0.03, -0.98, 0.11])
KINDS = [(False, "converged_mean"), (False, "node"), (False, "positions"),
         (True, "converged_mean"), (True, "node")]
kinds = pytest.mark.parametrize(("planar", "kind"), KINDS)
stiffenings = pytest.mark.parametrize("stiffened", [True, False])


def section(length=1.0, mass=1.0, time=1.0):
    """A blade of unit length and mass in other units."""
    force = mass * length / time**2
    bending, inertia = force * length**2, mass * length
    return StiffnessSection(axial=1e4 * force, bending_y=bending, bending_z=1.3 * bending,
                            torsion=0.8 * bending, mass=mass / length, inertia_x=2e-4 * inertia,
                            inertia_y=1e-4 * inertia, inertia_z=1e-4 * inertia)


def blade(planar=False, kind="converged_mean", stiffened=True, units=(1.0, 1.0, 1.0), turn=None,
          damping=0.0, start=START):
    """A free body; with the frame 'positions' an elbow, whose third node keeps no rotation."""
    if turn is None:
        turn = FLAT if planar else TURN
    d = 2 if planar else 3
    points = np.array([[0.0, 0, 0], [1, 0, 0], [1, 0.7, 0.2]])[:, :d] @ turn.T + start[:d]
    points = points * units[0]
    ends = [(0, "full"), (12, "full")]
    if kind == "positions":
        model = frame(points, [(0, 1), (1, 2)], section(*units), 6, up=turn[:, 2])
        ends = [(0, "full"), (1, "full"), (2, "translation")]
    elif planar:
        model = planar_beam(*points[:2], section(*units), 12)
    else:
        model = straight_beam(*points[:2], section(*units), 12, up=turn[:, 2])
    if not stiffened:
        model = replace(model, geometric_stiffness=None)
    body = craig_bampton(model, ends, 4)
    body = body.damped(damping) if damping else body
    scene = Model(planar=planar)
    nodes = [scene.node(name, x, keep) for name, x, keep in zip(
        "abc", body.coordinates, body.keeps, strict=False)]
    part = scene.superelement("blade", body, nodes, frame=kind, inertia="floating_field")
    assert part.kernel.endswith("_floating_field") and bool(body.invariants.resultants) == stiffened
    return scene


def thrown(planar=False, *arguments, units=(1.0, 1.0, 1.0), **options):
    """It turns, flies and is struck at an end."""
    length, mass, time = units
    turn = options.get("turn")
    turn = (FLAT if planar else TURN) if turn is None else turn
    d = 2 if planar else 3
    scene = blade(planar, *arguments, units=units, **options)
    spin = 1.5 / time if planar else turn @ [0.6, -0.5, 1.0] / time
    velocity = turn @ np.array([1.0, 2.0, -1.0])[:d] * length / time
    scene.rigid_velocity(velocity, spin, about=START[:d] * length)
    strike = turn @ np.array([0.5, 1.0, -2.0])[:d] * mass * length / time**2
    scene.force("b", strike, [(0, 0), (0.2 * time, 1.0), (0.4 * time, 0)])
    return scene


@kinds
@stiffenings
def test_energy_and_momenta_are_kept(planar, kind, stiffened):
    """After the blow, up to errors of second order in the step; the balance with it."""
    errors, steps = [], (0.01, 0.005)
    for h in steps:
        result = simulate(thrown(planar, kind, stiffened), h, 1.2, EXACT)
        free = result.t > 0.41
        energy = (result["energy.kinetic"] + result["energy.strain"])[free]
        row = [np.ptp(energy) / energy[0], result.energy_balance()]
        for name in ("momentum", "angular_momentum"):
            kept = result[name][free]
            row.append(np.abs(kept - kept[0]).max() / np.abs(kept).max())
        errors.append(row)
    first, second = np.array(errors)
    # of periods of ten steps and less; the elbow is stiffer
    assert second.max() < 3e-4
    assert all(order(steps, pair) > 1.7 for pair in zip(first, second, strict=True)), errors


@pytest.mark.parametrize("kind", ["converged_mean", "node", "positions"])
def test_units_and_axes_change_nothing(kind):
    """In millimetres, tonnes and seconds, and turned as a whole about the origin."""
    paths = []
    for units, turn in (((1.0, 1.0, 1.0), TURN), ((1e3, 1e-3, 1.0), TURN),
                        ((1.0, 1.0, 1.0), np.eye(3))):
        scene = thrown(False, kind, units=units, turn=turn)
        tip = simulate(scene, 0.01, 0.6, generalized_alpha(tolerance=1e-13))["b.position"]
        paths.append((tip - tip[0]) @ turn / units[0])
    size = np.abs(paths[0]).max()
    for path in paths[1:]:
        # rounding of some hundred steps on bodies with a condition of 1e4
        assert np.abs(path - paths[0]).max() < 1e-9 * size


@pytest.mark.parametrize(("planar", "kind"), [KINDS[0], KINDS[2], KINDS[3]])
def test_stopped_runs_go_on_bit_for_bit(planar, kind, tmp_path):
    def scene():
        found = thrown(planar, kind, damping=0.02)
        found.gravity(GRAVITY[:2 if planar else 3])
        return found
    whole = Simulation(scene(), 0.01).run_to(0.5).run_to(1.0).result()
    path = save_state(Simulation(scene(), 0.01).run_to(0.5), tmp_path / "half.npz")
    result = resume(scene(), path).run_to(1.0).result()
    assert np.array_equal(result.rows, whole.rows)
    # of the damping, which alone takes energy out
    assert result["damping of blade.work"][-1] < 0.0
    assert result.energy_balance() < 1e-3


@kinds
def test_gravity(planar, kind):
    """A free body falls without strain; a held one rests with its weight on the support."""
    d = 2 if planar else 3
    g = GRAVITY[:d]
    scene = blade(planar, kind)
    scene.gravity(g)
    result = simulate(scene, 0.01, 0.5)
    fall = result["b.position"] - result["b.position"][0]
    assert np.abs(fall - 0.5 * g * result.t[:, None]**2).max() < 1e-12
    assert result["energy.strain"].max() < 1e-20 * result["energy.kinetic"].max()
    scene.fix("a")
    held = equilibrium(scene, 2)
    mass = scene.bodies["blade"].reduced.total_mass
    # the condensed stiffness has the rounding of its condition, 1e4
    assert held["a.reaction"][-1] == pytest.approx(-mass * g, rel=1e-9)
    assert np.linalg.norm(held["b.position"][-1] - held["b.position"][0]) > 0.01


@pytest.mark.parametrize(("planar", "kind"), [KINDS[0], KINDS[1], KINDS[3]])
def test_a_mass_on_a_rigid_link_is_one_beside_the_node(planar, kind):
    """Link and centre of mass: the same equilibrium, small motion, and run."""
    d, turn = (2, FLAT) if planar else (3, TURN)
    spin = 1.0 if planar else turn[:, 2]
    found = []
    for linked in (True, False):
        scene = blade(planar, kind)
        scene.fix("a")
        place = scene.nodes["b"].point + turn @ np.array([0.2, 0.3, -0.1])[:d]
        if linked:
            scene.attach("side", place, "b")
            scene.point_mass("mass", "side", 0.5)
        else:
            scene.rigid_body("mass", "b", 0.5, 0.0 if planar else np.zeros(3), place)
        scene.gravity(GRAVITY[:d])
        turning = equilibrium(scene, 2, spin=spin)
        run = simulate(scene, 0.01, 0.5, generalized_alpha(tolerance=1e-12))
        found.append((turning["b.position"][-1], modes(turning, spin).values, run["b.position"]))
    for one, other in zip(*found, strict=True):
        assert np.abs(one - other).max() < 1e-7 * np.abs(other).max()


@stiffenings
@pytest.mark.parametrize("planar", [False, True])
def test_damping_of_small_motion(planar, stiffened):
    """Free vibrations decay with their ratio, rigid motion not at all."""
    found = modes(Simulation(blade(planar, stiffened=stiffened, damping=0.02), 0.01))
    elastic = found.omega > 1.0
    assert np.abs(found.values[elastic].real / np.abs(found.values[elastic]) + 0.02).max() < 1e-6
    # zero squares of frequencies with the rounding of the largest
    assert np.abs(found.values[~elastic]).max() < 1e-5 * np.abs(found.values).max()
    still = vibrations(Simulation(blade(planar, stiffened=stiffened), 0.01)).omega
    assert np.abs(found.values[elastic]) == pytest.approx(still[still > 1.0], rel=1e-6)


@kinds
@stiffenings
def test_matrices_are_derivatives_of_the_forces(planar, kind, stiffened):
    """About a moving, deformed state: stiffness, damping and mass of its instant by differences."""
    run = Simulation(thrown(planar, kind, stiffened, damping=0.02), 0.01).run_to(0.3)
    found = linearize(run)
    state, n = run.state, run.numbering.free
    kept = state.now.copy()

    def force():
        assert assemble(RESIDUAL, RESIDUAL, run.system, state, state.residual) == 0
        residual = state.residual.copy()
        to_body_axes(run.system, state.frames, residual, False)
        return residual[:n]
    for k in range(0, found.free.shape[1], 4):
        direction = np.zeros(run.numbering.total)
        direction[:n] = found.free[:, k]
        to_body_axes(run.system, state.frames, direction, True)
        frames = state.frames.copy()
        for part, matrix in ((state.v, found.damping), (state.a, found.mass)):
            difference = 0.0
            for step, weight in ((1e-3, 0.75), (2e-3, -0.15), (3e-3, 1 / 60)):
                for sign in (1.0, -1.0):
                    part[:] += sign * step * direction
                    state.frames[:] = frames
                    difference = difference + sign * weight * force() / 1e-3
                    state.now[:] = kept
            # of sixth order in steps of 1e-3
            assert np.abs(found.free.T @ difference - matrix[:, k]).max() < (
                1e-9 * np.abs(matrix).max())


@pytest.mark.parametrize("stiffened", [True, False])
def test_a_hinged_arm_finds_its_place_across_the_spin(stiffened):
    """At 45 degrees to the spin it starts without stiffness; across it, it stretches by a^2 / 3.

    ``a = W L sqrt(m / E A)``, ``tan(a) / a - 1`` of a rod at the deformed radius.
    """
    spin = 2.0
    scene = blade(stiffened=stiffened, start=np.zeros(3))
    scene.fix("a", "position")
    scene.revolute("a", TURN[:, 2])
    place = equilibrium(scene, 1, spin=spin * (TURN[:, 0] + TURN[:, 1]) / 2**0.5)["b.position"][-1]
    across = (TURN[:, 0] - TURN[:, 1]) / 2**0.5
    a = spin / 1e2
    # without axial modes the stretch misses a part a^2 of itself
    assert place @ across - 1.0 == pytest.approx(np.tan(a) / a - 1.0, rel=2e-3)
    assert np.abs(place - (place @ across) * across).max() < 1e-9
