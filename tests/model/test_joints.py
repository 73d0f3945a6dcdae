"""Joints: shared DOF blocks against explicit constraints, revolute joints against planar motion."""

import numpy as np
import pytest

from sebody import InputError, Model, generalized_alpha, simulate
from sebody.fem import planar_beam, straight_beam
from sebody.reduction import craig_bampton
from sebody.scenes.hinged_beam import SECTION
from sebody.scenes.spherical_beam import build

EXACT = generalized_alpha(tolerance=1e-11)
TORQUE = [(0.0, 0.0), (0.5, 4000.0), (1.0, 0.0)]


def free_base_beam():
    scene = build(modes=4)
    scene.model.nodes["base"].position.fixed = False
    scene.model.loads[1].time_function.__dict__["times"] = (0.0, 0.2, 0.4)
    return scene.model


@pytest.mark.parametrize("t_end", [2.0])
def test_explicit_spherical_joint_equals_a_fixed_position(t_end):
    fixed = build(modes=4).model
    fixed.loads[1].time_function.__dict__["times"] = (0.0, 0.2, 0.4)
    explicit = free_base_beam()
    explicit.spherical("base")
    a, b = simulate(fixed, 0.01, t_end, EXACT), simulate(explicit, 0.01, t_end, EXACT)
    assert b.numbering.free == a.numbering.free + 6
    assert np.abs(a["tip.position"] - b["tip.position"]).max() < 1e-7
    assert np.abs(b["base.position"]).max() < 1e-11     # within the tolerance of an increment


def two_links(planar=False, explicit=False, swap=False):
    """Two links, hinged to the ground and to each other, a torque at the base."""
    d = 2 if planar else 3
    points = [np.array(p)[:d] for p in ((0.0, 0.0, 0.0), (50.0, 0.0, 0.0), (80.0, 40.0, 0.0))]
    beam = planar_beam if planar else straight_beam
    model = Model(planar=planar)
    nodes = [model.node("base", points[0]), model.node("elbow", points[1])]
    nodes.append(model.node("elbow2", points[1], at=None if explicit else nodes[1]))
    nodes.append(model.node("tip", points[2]))
    for k, (i, j) in enumerate(((0, 1), (2, 3))):
        body = craig_bampton(beam(nodes[i].point, nodes[j].point, SECTION, 8),
                             [(0, "full"), (8, "full")], 0)
        model.superelement(f"link{k}", body, [nodes[i], nodes[j]])
    z = (0, 0, 1)
    model.revolute("base", z)
    if explicit:
        model.spherical("elbow", "elbow2")
    else:
        model.revolute(*(("elbow2", z, "elbow") if swap else ("elbow", z, "elbow2")))
    model.torque("base", 1.0 if planar else z, TORQUE)
    return model


@pytest.mark.parametrize("swap", [False, True])
def test_revolute_between_bodies_equals_planar_motion(swap):
    """In a plane the joint is a shared position and nothing else: other kernels, no multiplier."""
    spatial = simulate(two_links(swap=swap), 0.005, 3.0, EXACT)
    planar = simulate(two_links(planar=True), 0.005, 3.0, EXACT)
    assert np.abs(planar["tip.position"] - planar["tip.position"][0]).max() > 8.0
    assert np.abs(spatial["tip.position"][:, :2] - planar["tip.position"]).max() < 1e-6
    assert np.abs(spatial["tip.position"][:, 2]).max() < 1e-6


def test_explicit_planar_joint_equals_a_shared_position():
    shared = simulate(two_links(planar=True), 0.005, 3.0, EXACT)
    explicit = simulate(two_links(planar=True, explicit=True), 0.005, 3.0, EXACT)
    assert np.abs(shared["tip.position"] - explicit["tip.position"]).max() < 1e-6


def test_shared_position_is_a_spherical_joint_without_multiplier():
    """Links joined by a position alone keep energy and momentum while they tumble."""
    model = Model()
    points = np.array([[0.0, 0, 0], [60, 0, 0], [60, 50, 0]])
    nodes = [model.node("a", points[0]), model.node("b", points[1])]
    nodes += [model.node("c", points[1], at=nodes[1]), model.node("d", points[2])]
    for k, (i, j) in enumerate(((0, 1), (2, 3))):
        body = craig_bampton(straight_beam(nodes[i].point, nodes[j].point, SECTION, 8),
                             [(0, "full"), (8, "full")], 4)
        model.superelement(f"link{k}", body, [nodes[i], nodes[j]])
    model.rigid_velocity((1.0, -2.0, 0.5), (0.3, -0.2, 0.5))
    spread = {}
    for h in (0.005, 0.0025):
        result = simulate(model, h, 4.0, EXACT)
        # the links start unstretched: the scheme damps the stretching this sets off
        energy = (result["energy.kinetic"] + result["energy.strain"])[result.t > 1.0]
        spread[h] = np.ptp(energy) / energy.mean()
    assert result.system.is_multiplier.sum() == 0
    assert spread[0.005] < 2e-5 and spread[0.0025] < 0.6 * spread[0.005]
    # kept to second order in the step: the momentum of a turning body is not linear in its v
    for name in ("momentum", "angular_momentum"):
        value = result[name]
        assert np.abs(value - value[0]).max() <= 1e-5 * np.linalg.norm(value[0])
    apart = result["c.position"] - result["b.position"]
    assert np.abs(apart).max() == 0.0


def test_joint_inputs():
    model = two_links(planar=True)
    with pytest.raises(InputError, match="share a position|share their position"):
        model.spherical("elbow", "elbow2")
    with pytest.raises(InputError, match="nodes 'base' and 'tip' do not coincide: give both the "
                                         "same"):
        model.revolute("base", to="tip")
    with pytest.raises(InputError, match="do not coincide: give both the same point"):
        model.spherical("base", "tip")
