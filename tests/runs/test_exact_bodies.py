"""One body with exact inertia and stiffening beyond the beam of two nodes (option C).

Bodies with many boundary nodes, bodies divided in four, frames, couplers between ball joints,
blocks known at their corners, thin beams that buckle sideways. References: closed solutions,
laws of motion, and the same structures divided into many linear bodies.
"""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.special import jv
from spinning_body import with_torsion
from stiffened_models import (
    SLENDER,
    TURN,
    accelerations,
    block,
    cantilever,
    divided_elbow,
    elbow,
    idle_spin,
    linkage,
    nearest,
    places,
    plate,
    plate_frequencies,
)

from sebody import Model, Simulation
from sebody.analysis import equilibrium, linearize, modes, vibrations

STIFFENED = {"inertia": "floating_field"}
FLAP, LAG = 7.360373019, 4.263225420        # first frequencies of a cantilever at eta = 6
SPIN = (0.0, 0.0, 6.0)


@pytest.mark.parametrize(("nodes", "internal", "error"), [(3, 0, 7e-3), (3, 4, 4e-4), (5, 8, 5e-5)])
def test_cantilevers_with_more_boundary_nodes(nodes, internal, error):
    """Inner nodes that nothing is attached to: as many modes of a shorter beam."""
    model = cantilever(STIFFENED, nodes, internal, 12)
    found = modes(equilibrium(model, 2, spin=SPIN), SPIN)
    assert (nearest(found, FLAP), nearest(found, LAG)) == pytest.approx((FLAP, LAG), rel=error)
    assert found.growth.max() < 1e-8 * found.omega.max()


def test_four_bodies_with_two_modes():
    """Division and stiffening together: the tables' digits."""
    model = Model()
    ends = model.node("root", (0, 0, 0)), model.node("tip", (1, 0, 0))
    model.beam("arm", ends, SLENDER, 24, 4, 2, **STIFFENED)
    model.fix("root")
    found = modes(equilibrium(model, 2, spin=SPIN), SPIN)
    # 7.3604 and 4.2632; six elements and two modes a body leave 2e-5
    assert (nearest(found, FLAP), nearest(found, LAG)) == pytest.approx((FLAP, LAG), rel=4e-5)


@pytest.mark.parametrize(("frame", "errors"), [("converged_mean", (6e-4, 5.5e-3)),
                                               ("positions", (6e-4, 8e-3))])
def test_an_elbow_that_spins(frame, errors):
    """Four frequencies at 0.21 and 0.63 of the first one; without stiffening 1.6 and 14 % off.

    Frames agree to second order; the elbow bends by 6 % of its size.
    """
    options = STIFFENED | {"frame": frame}
    first = vibrations(equilibrium(elbow(options), 1)).omega[0]
    for share, error in zip((0.21, 0.63), errors, strict=True):
        spin = share * first * TURN[:, 2]
        coarse, fine = (modes(equilibrium(divided_elbow(n), 2, spin=spin), spin).omega[:4]
                        for n in (4, 8))
        reference = (4 * fine - coarse) / 3     # of second order in the bodies
        assert np.abs(fine / reference - 1).max() < 0.1 * error
        found = modes(equilibrium(elbow(options), 2, spin=spin), spin)
        assert found.omega[:4] == pytest.approx(reference, rel=error)


@pytest.mark.parametrize(("frame", "error"), [("converged_mean", 1.2e-3), ("positions", 1.7e-3)])
def test_a_plate_on_four_interfaces(frame, error):
    """Four frequencies of its FE model at half its first one; plain C is 6 % off."""
    speed = 0.5 * plate_frequencies(0.0)[0]
    exact, spin = plate_frequencies(speed)[:4], (0.0, 0.0, speed)
    found = modes(equilibrium(plate(STIFFENED | {"frame": frame}, 8), 2, spin=spin), spin)
    assert found.omega[:4] == pytest.approx(exact, rel=error)


def test_lateral_buckling():
    """A thin cantilever under a fixed-direction tip load, 4.0126; eight modes, four in torsion."""
    thin = replace(SLENDER, axial=1e6, bending_y=1e3, inertia_x=2e-6, inertia_y=1e-6,
                   inertia_z=1e-6)
    body = with_torsion(thin, 24, 4, 4)

    def lowest(load):
        model = Model()
        ends = model.node("root", (0, 0, 0)), model.node("tip", (1, 0, 0))
        model.superelement("arm", body, ends, **STIFFENED)
        model.fix("root")
        model.force("tip", (0.0, 0.0, -load))
        flat = equilibrium(model, 1, unstable="keep")
        return np.linalg.eigvals(linearize(flat).stiffness).real.min()
    exact = 2 * brentq(lambda x: jv(-1 / 4, x), 1.8, 2.4)
    assert brentq(lowest, 3.5, 5.0, xtol=1e-3) == pytest.approx(exact, rel=3e-3)


def test_a_coupler_between_ball_joints_does_not_spin_idly():
    """As eight bodies of it, which also have its strain; B spins at 13 rad/s."""
    divided, one = linkage({"inertia": "material"}, 8, 0), linkage(STIFFENED, 1, 6)
    assert 0.005 < idle_spin(divided) < 0.02
    assert idle_spin(one) < 1.2 * idle_spin(divided)
    # the divided one is of second order in its bodies
    assert one["energy.strain"].max() == pytest.approx(divided["energy.strain"].max(), rel=1e-2)


def test_a_block_by_its_corners_turns_as_it_should():
    """From the centrifugal equilibrium all corners have the centripetal acceleration.

    B gives them 62 times that. A constant velocity changes nothing.
    """
    spin = 10.0 * TURN[:, 2]
    run = equilibrium(block(STIFFENED), 1, spin=spin)
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
        result = Simulation(block(STIFFENED, push, (6.0, -5.0, 10.0)), 1e-4).run_to(0.02).result()
        energy = result["energy.kinetic"] + result["energy.strain"]
        moment, momentum = result["angular_momentum"], result["momentum"]
        # of second order: a hundredth of these with a tenth of the step
        assert np.ptp(energy) < 6e-6 * energy[0]
        assert np.abs(moment - moment[0]).max() < 3e-6 * np.abs(moment).max()
        size = np.linalg.norm(push) * result.model.bodies["block"].reduced.total_mass + 1.0
        assert np.abs(momentum - momentum[0]).max() < 1e-11 * size
