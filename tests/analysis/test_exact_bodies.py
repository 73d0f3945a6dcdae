"""One body with exact inertia and stiffening beyond the beam of two nodes (option C).

Bodies with many boundary nodes, bodies divided in four, frames, couplers between ball joints,
blocks known at their corners, thin beams that buckle sideways. References: closed solutions,
laws of motion, and the same structures divided into many linear bodies.
"""

from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.spatial.transform import Rotation
from scipy.special import jv
from spinning_body import with_torsion

from sebody import Model, Simulation, simulate, trapezoidal
from sebody.analysis import equilibrium, linearize, modes, vibrations
from sebody.assembly.numbering import coordinates
from sebody.engine.evaluate import assemble, to_body_axes
from sebody.fem import StiffnessSection, frame, hexahedral_block, straight_beam
from sebody.kernels.layout import RESIDUAL
from sebody.reduction import craig_bampton

# So stiff along its axis that the tables' beams, which do not stretch, are met to their digits.
SLENDER = StiffnessSection(axial=1e7, bending_y=1.0, bending_z=1.0, torsion=1.0, mass=1.0,
                           inertia_x=2e-7, inertia_y=1e-7, inertia_z=1e-7)
FLAP, LAG = 7.360373019, 4.263225420        # first frequencies of a cantilever at eta = 6
SPIN = (0.0, 0.0, 6.0)


def nearest(found, value):
    return found.omega[np.argmin(np.abs(found.omega - value))]


@pytest.mark.parametrize(("nodes", "internal", "error"), [(3, 0, 7e-3), (3, 4, 4e-4), (5, 8, 5e-5)])
def test_cantilevers_with_more_boundary_nodes(nodes, internal, error):
    """Inner nodes that nothing is attached to: as many modes of a shorter beam."""
    elements = 12 * (nodes - 1)
    fe_model = straight_beam((0, 0, 0), (1, 0, 0), SLENDER, elements)
    boundary = [(12 * k, "full") for k in range(nodes)]
    model = Model()
    ends = [model.node(f"n{k}", (k / (nodes - 1), 0, 0)) for k in range(nodes)]
    model.superelement("arm", craig_bampton(fe_model, boundary, internal), ends, inertia="c")
    model.fix("n0")
    found = modes(equilibrium(model, 2, spin=SPIN), SPIN)
    assert (nearest(found, FLAP), nearest(found, LAG)) == pytest.approx((FLAP, LAG), rel=error)
    assert found.growth.max() < 1e-8 * found.omega.max()


def test_four_bodies_with_two_modes():
    """Division and stiffening together: the tables' digits."""
    model = Model()
    ends = model.node("root", (0, 0, 0)), model.node("tip", (1, 0, 0))
    model.beam("arm", ends, SLENDER, 24, 4, 2, inertia="c")
    model.fix("root")
    found = modes(equilibrium(model, 2, spin=SPIN), SPIN)
    # 7.3604 and 4.2632; six elements and two modes a body leave 2e-5
    assert (nearest(found, FLAP), nearest(found, LAG)) == pytest.approx((FLAP, LAG), rel=4e-5)


ARMS = StiffnessSection(axial=1e5, bending_y=1.0, bending_z=1.0, torsion=0.8, mass=1.0,
                        inertia_x=2e-6, inertia_y=1e-6, inertia_z=1e-6)
TURN = Rotation.from_rotvec([0.7, -0.4, 0.9]).as_matrix()
ELBOW = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 0.5, 0.0]]) @ TURN.T


def elbow():
    """Two arms as one body on three nodes, clamped at the long one."""
    fe_model = frame(ELBOW, [(0, 1), (1, 2)], ARMS, 8, up=TURN[:, 2])
    body = craig_bampton(fe_model, [(k, "full") for k in range(3)], 6)
    model = Model()
    nodes = [model.node(f"n{k}", x) for k, x in enumerate(ELBOW)]
    model.superelement("elbow", body, nodes, inertia="c")
    model.fix("n0")
    return model


def divided_elbow(count):
    """The same of elements that are bodies of their own, without any option of interest here."""
    model = Model()
    a, b, c = (model.node(f"n{k}", x) for k, x in enumerate(ELBOW))
    for name, ends, part in (("long", (a, b), 2 * count), ("short", (b, c), count)):
        model.beam(name, ends, ARMS, part, part, 0, inertia="b", up=TURN[:, 2])
    model.fix("n0")
    return model


def test_an_elbow_that_spins():
    """Four frequencies at 0.21 and 0.63 of the first one; without stiffening 1.6 and 14 % off."""
    first = vibrations(equilibrium(elbow(), 1)).omega[0]
    for share, error in ((0.21, 6e-4), (0.63, 5.5e-3)):
        spin = share * first * TURN[:, 2]
        coarse, fine = (modes(equilibrium(divided_elbow(n), 2, spin=spin), spin).omega[:4]
                        for n in (4, 8))
        reference = (4 * fine - coarse) / 3     # of second order in the bodies
        assert np.abs(fine / reference - 1).max() < 0.1 * error
        found = modes(equilibrium(elbow(), 2, spin=spin), spin)
        assert found.omega[:4] == pytest.approx(reference, rel=error)


def test_lateral_buckling():
    """A thin cantilever under a dead tip load, 4.0126; eight modes, four of them in torsion."""
    thin = replace(SLENDER, axial=1e6, bending_y=1e3, inertia_x=2e-6, inertia_y=1e-6,
                   inertia_z=1e-6)
    body = with_torsion(thin, 24, 4, 4)

    def lowest(load):
        model = Model()
        ends = model.node("root", (0, 0, 0)), model.node("tip", (1, 0, 0))
        model.superelement("arm", body, ends, inertia="c")
        model.fix("root")
        model.force("tip", (0.0, 0.0, -load))
        return np.linalg.eigvals(linearize(equilibrium(model, 1)).stiffness).real.min()
    exact = 2 * brentq(lambda x: jv(-1 / 4, x), 1.8, 2.4)
    assert brentq(lowest, 3.5, 5.0, xtol=1e-3) == pytest.approx(exact, rel=3e-3)


def linkage(bodies, internal, inertia):
    """A driven crank, a slender coupler between two ball joints, a rocker, in space."""
    soft = StiffnessSection(axial=1e5, bending_y=12.0, bending_z=12.0, torsion=10.0, mass=1.0,
                            inertia_x=2e-5, inertia_y=1e-5, inertia_z=1e-5)
    model, x = Model(), np.eye(3)
    hub, pin = model.node("hub", (0, 0, 0)), model.node("pin", (0.9, 0.3, 0))
    for name, node, axis, centre, end in (
            ("crank", hub, x[0], (0, 0.1, 0), (0, 0.2, 0)),
            ("rocker", pin, x[1], (0.9, 0.3, 0.25), (0.9, 0.3, 0.5))):
        model.rigid_body(name, node, 0.5, (0.02, 0.02, 0.02), centre)
        model.revolute(node, axis)
        model.attach(f"{name} end", end, node)
    model.drive_angle(hub, trapezoidal(24.0, 8.0, 16.0), x[0])
    ends = [model.node(name, at.point, at=at) for name, at in (
        ("first", model.nodes["crank end"]), ("second", model.nodes["rocker end"]))]
    model.beam("coupler", ends, soft, 16, bodies, internal, inertia=inertia)
    return simulate(model, 1e-3, 1.0)


def idle_spin(result):
    """Largest rate of either end about the line between them."""
    line = result["second.position"] - result["first.position"]
    line = line / np.linalg.norm(line, axis=1)[:, None]
    return max(np.abs((result[f"{end}.angular_velocity"] * line).sum(axis=1)).max()
               for end in ("first", "second"))


def test_a_coupler_between_ball_joints_does_not_spin_idly():
    """As eight bodies of it, which also have its strain; B spins at 13 rad/s."""
    divided, one = linkage(8, 0, "b"), linkage(1, 6, "c")
    assert 0.005 < idle_spin(divided) < 0.02
    assert idle_spin(one) < 1.2 * idle_spin(divided)
    # the divided one is of second order in its bodies
    assert one["energy.strain"].max() == pytest.approx(divided["energy.strain"].max(), rel=1e-2)


def block(push=(0.0, 0.0, 0.0), spin=(0.0, 0.0, 0.0)):
    """A solid known by the positions of its eight corners, turned, in free flight."""
    fe_model = hexahedral_block((-6, -1, -1), (12, 2, 2), (12, 2, 2), 2.1e6, 0.3, 7.8e-3)
    points = np.array(list(product((-6, 6), (-1, 1), (-1, 1))))
    corners = [int(np.argmin(np.abs(fe_model.coordinates - p).sum(axis=1))) for p in points]
    body = craig_bampton(fe_model, [(k, "translation") for k in corners], 8)
    model = Model()
    nodes = [model.node(f"n{k}", TURN @ p, "translation") for k, p in enumerate(points)]
    model.superelement("block", body, nodes, frame="positions", inertia="c", rotation=TURN)
    model.rigid_velocity(push, spin)
    return model


def accelerations(run):
    """Of the corners, from mass and forces of the state, (8, 3)."""
    mass = linearize(run).mass
    state, n = run.state, run.numbering.free
    kept = state.a.copy()
    state.a[:] = 0.0
    assert assemble(RESIDUAL, RESIDUAL, run.system, state, state.residual) == 0
    residual = state.residual.copy()
    state.a[:] = kept
    to_body_axes(run.system, state.frames, residual, False)
    found = np.zeros(run.numbering.total)
    found[:n] = np.linalg.solve(mass, -residual[:n])
    to_body_axes(run.system, state.frames, found, True)
    return np.array([found[at] for at in places(run)])


def places(run):
    return [coordinates(run.numbering, node.position) for node in run.model.nodes.values()]


def test_a_block_by_its_corners_turns_as_it_should():
    """From the centrifugal equilibrium all corners have the centripetal acceleration.

    B gives them 62 times that. A constant velocity changes nothing.
    """
    spin = 10.0 * TURN[:, 2]
    run = equilibrium(block(), 1, spin=spin)
    x = np.array([run.state.q[at] for at in places(run)])
    found = accelerations(run)
    centripetal = np.cross(spin, np.cross(spin, x))
    assert np.abs(found - centripetal).max() < 5e-7 * np.abs(centripetal).max()
    for at in places(run):
        run.state.v[at] += (30.0, 4.0, -5.0)
    assert np.abs(accelerations(run) - found).max() < 1e-8 * np.abs(found).max()


def test_a_block_by_its_corners_keeps_energy_and_momenta():
    """Spinning about no principal axis, flying; B loses half its energy in a few longer steps."""
    for push in ((0.0, 0.0, 0.0), (30.0, 4.0, -5.0)):
        result = Simulation(block(push, (6.0, -5.0, 10.0)), 1e-4).run_to(0.02).result()
        energy = result["energy.kinetic"] + result["energy.strain"]
        moment, momentum = result["angular_momentum"], result["momentum"]
        # of second order: a hundredth of these with a tenth of the step
        assert np.ptp(energy) < 6e-6 * energy[0]
        assert np.abs(moment - moment[0]).max() < 3e-6 * np.abs(moment).max()
        size = np.linalg.norm(push) * result.model.bodies["block"].body.total_mass + 1.0
        assert np.abs(momentum - momentum[0]).max() < 1e-11 * size
