"""Contacts of points inside reduced bodies, which the recovery of the FE model places.

An FE node that is also a boundary node has both kinds of contact; full FE models are solved by
NumPy and SciPy; energy and momentum are kept.
"""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from sebody import InputError, Model, Result, Simulation, cylinder, plane, simulate, sphere
from sebody.analysis import Ensemble, equilibrium, linearize, maximum, resume, save_state
from sebody.fem import hexahedral_block, planar_beam, rectangle, straight_beam
from sebody.model.impacts import damping_of
from sebody.model.profiles import rest_to_rest
from sebody.model.variants import planar as planar_variant, rigid as rigid_variant
from sebody.reduction import craig_bampton

TURN = Rotation.from_rotvec((0.4, -0.9, 0.3)).as_matrix()
SHIFT = np.array([3.0, -1.0, 2.0])
STEEL = rectangle(0.02, 0.03, 2.1e11, 0.3, 7800.0)
IN_ALL_FRAMES = [("c", "converged_mean"), ("c", "positions"), ("c", "mean_axes"),
                 ("b", "converged_mean"), ("b", "node"), ("a", "converged_mean"),
                 ("d", "positions")]
CORNERS = (0, 0, 0), (0.4, 0.1, 0.0), (0.2, 0.0, 0.3), (0, 0.1, 0.3)


def beam(modes, middle=()):
    fe = straight_beam(SHIFT, SHIFT + TURN[:, 0], STEEL, 8)
    return craig_bampton(fe, [(0, "full"), *middle, (8, "full")], modes)


def block(modes, labels=None):
    """A block of hexahedra held at four nodes on no plane, turned; and the numbers of these."""
    fe = hexahedral_block((0, 0, 0), (0.4, 0.1, 0.3), (4, 1, 3), 2e8, 0.3, 1000.0)
    kept = [int(np.argmin(np.linalg.norm(fe.coordinates - p, axis=1))) for p in CORNERS]
    body = craig_bampton(replace(fe, labels=labels), [(k, "translation") for k in kept], modes)
    return body.rotated(TURN), kept


def hit_by_a_ball(body, touching, surface=sphere, stiffness=1e5, **options):
    """A free body that a ball hits beside the middle of a point, with friction."""
    model, planar = Model(planar=body.planar), body.planar
    nodes = [model.node(f"n{k}", point, keep) for k, (point, keep) in enumerate(
        zip(body.coordinates, body.keeps, strict=True))]
    made = model.superelement("body", body, nodes, **options)
    at = (made.nodes[int(touching[1:])].point if touching.startswith("n") else
          body.recovery.points[int(touching.removeprefix("body.node"))])
    way = np.array([0.1, -0.3]) if planar else np.array([0.1, 0.25, -0.4])
    way /= np.linalg.norm(way)
    ball = model.node("ball", at - 0.12 * way)
    model.rigid_body("mass", ball, 0.5, 0.002 if planar else (0.002, 0.003, 0.004))
    model.initial_velocity(ball, 3.0 * way, 2.0 if planar else (1.0, -2.0, 3.0))
    on = {"sphere": lambda: sphere(0.1, node=ball),
          "plane": lambda: plane(way, at - 0.02 * way, node=ball),
          "cylinder": lambda: cylinder(np.cross(way, TURN[0]), 0.1, node=ball)}
    model.contact(touching, on=on[surface.__name__](), stiffness=stiffness, friction=0.3,
                  name="hit")
    return model


@pytest.mark.parametrize("inertia, frame", IN_ALL_FRAMES)
def test_a_boundary_node_touches_the_same_both_ways(inertia, frame):
    """The recovery of a boundary node is its own place: both contacts run to the same states."""
    if inertia == "a":          # has kernels of two nodes
        body, node, number = beam(5), "n1", 8
    elif frame in ("converged_mean", "node"):
        body, node, number = beam(5, ((3, "translation"),)), "n1", 3
    else:
        body, kept = block(5)
        node, number = "n2", kept[2]
    surface = {"a": plane, "b": cylinder}.get(inertia, sphere)
    other, ours = (simulate(hit_by_a_ball(body, touching, surface, inertia=inertia, frame=frame),
                            2e-4, 0.03) for touching in (node, f"body.node{number}"))
    assert 0 < np.count_nonzero(other["hit.normal_force"]) < 150
    for name in ("hit.force", "hit.normal_force", "hit.gap", "hit.dissipation", "n0.velocity",
                 "ball.velocity", "ball.angular_velocity"):
        scale = np.abs(other[name]).max()
        np.testing.assert_allclose(ours[name], other[name], atol=1e-6 * scale)


def test_a_planar_boundary_node_touches_the_same_both_ways():
    turn = TURN[:2, :2] / np.sqrt(np.linalg.det(TURN[:2, :2]))
    fe = planar_beam((1.0, 2.0), (1.0 + turn[0, 0], 2.0 + turn[1, 0]), STEEL, 6)
    body = craig_bampton(fe, [(0, "full"), (2, "translation"), (6, "full")], 4)
    for surface, frame in ((sphere, "converged_mean"), (plane, "mean_axes")):
        other, ours = (simulate(hit_by_a_ball(body, touching, surface, frame=frame), 2e-4, 0.03)
                       for touching in ("n1", "body.node2"))
        assert other["hit.normal_force"].max() > 10.0
        for name in ("hit.force", "ball.velocity", "n0.velocity"):
            np.testing.assert_allclose(ours[name], other[name],
                                       atol=1e-6 * np.abs(other[name]).max())


def cantilever(elements, gap, force, stiffness, exponent, restitution, node, course=None):
    """A clamped beam in a plane whose end a force presses down; a point of it meets the ground."""
    fe = planar_beam((0, 0), (1, 0), STEEL, elements)
    body = craig_bampton(fe, [(0, "full"), (elements, "full")], 3 * (elements - 1))
    model = Model(planar=True)
    root, tip = (model.node(name, (x, 0.0)) for name, x in (("root", 0.0), ("tip", 1.0)))
    model.superelement("beam", body, (root, tip))
    model.fix(root)
    model.force(tip, (0.0, -force), course, name="press")
    model.contact(f"beam.node{node}", on=plane((0, 1), (0, -gap)), stiffness=stiffness,
                  exponent=exponent, restitution=restitution, at_speed=1e-4, name="stop")
    free = slice(3, None)
    K, M = (np.asarray(A.todense() if hasattr(A, "todense") else A)[free, free]
            for A in (fe.stiffness, fe.mass))
    load = np.zeros(len(K))
    load[-2] = -force
    return model, K, M, load, 3 * (node - 1) + 1


@pytest.mark.parametrize("flat", [True, False])
def test_points_of_bent_bodies_are_where_fields_show_them(flat):
    """In second order, by the shortening of a clamped beam with a force at its tip.

    This is the integral of half of the slope's square, and four times as large for twice the force;
    the contact counts its gap along the beam.
    """
    F, found = 0.5 * 3 * 2.1e11 * 0.03 * 0.02**3 / 12 * 0.02, []     # the tip gives way by 0.01 L
    for force in (F, 2 * F):
        model, turn = Model(planar=flat), np.eye(3) if flat else TURN
        at = (lambda x: np.array([x, 0.0])) if flat else (lambda x: SHIFT + x * TURN[:, 0])
        ends = model.node("root", at(0.0)), model.node("tip", at(1.0))
        section = rectangle(0.02, 0.03, 2.1e11, 0.0, 7800.0)
        model.beam("beam", ends, section, elements=16, bodies=1, modes=6,
                   **({} if flat else {"up": TURN[:, 1]}))
        model.fix(ends[0])
        along = turn[:2, 0] if flat else turn[:, 0]
        model.force(ends[1], -force * (turn[:2, 1] if flat else turn[:, 1]))
        model.contact("beam.node12", on=plane(along, at(-1.0)), stiffness=1e3, name="ruler")
        result = equilibrium(model)
        gap, place = result["ruler.gap"][-1], result["beam.node12.position"][-1]
        assert gap == pytest.approx((place - at(-1.0)) @ along, abs=1e-12)
        found.append(1.75 - gap)
    EI = 2.1e11 * 0.03 * 0.02**3 / 12
    x = np.linspace(0.0, 0.75, 2001)
    shortened = np.trapezoid((F / EI * (x - x * x / 2))**2 / 2, x)
    assert found[0] == pytest.approx(shortened, rel=1e-2)
    assert found[1] == pytest.approx(4 * found[0], rel=1e-2)


def test_equilibrium_of_a_full_finite_element_model():
    """With all modes a linear contact presses as in the full model, solved by NumPy."""
    model, K, _, load, at = cantilever(6, 1e-6, 0.05, 2e4, 1.0, 1.0, 3)
    e = np.eye(len(K))[at]
    u = np.linalg.solve(K + 2e4 * np.outer(e, e), load - 2e4 * 1e-6 * e)
    found = equilibrium(model)
    assert found["stop.gap"][-1] == pytest.approx(u[at] + 1e-6, rel=1e-6)
    assert found["stop.normal_force"][-1] == pytest.approx(-2e4 * (u[at] + 1e-6), rel=1e-6)
    assert found["tip.position"][-1, 1] == pytest.approx(u[-2], rel=1e-6)
    assert linearize(found).contacts == {"stop": "presses"}


def test_motion_of_a_full_finite_element_model():
    """An impact of a point inside against SciPy's integration of the full model: second order."""
    model, K, M, load, at = cantilever(3, 2e-7, 0.05, 1e9, 1.5, 0.8, 2,
                                         rest_to_rest(1.0, 0.02))
    e, c = np.eye(len(K))[at], damping_of(0.8, 1e-4, "law")
    inverse = np.linalg.inv(M)

    def motion(t, y):
        u, v = np.split(y, 2)
        depth = max(-2e-7 - u[at], 0.0)
        x = min(t / 0.02, 1.0)
        course = x**3 * (10.0 - 15.0 * x + 6.0 * x**2)
        push = max(1e9 * depth**1.5 * (1.0 - c * v[at]), 0.0)
        return np.r_[v, inverse @ (course * load + push * e - K @ u)]
    exact = solve_ivp(motion, (0, 0.05), np.zeros(2 * len(K)), method="DOP853", rtol=1e-9,
                      atol=1e-15, max_step=1e-5, t_eval=np.linspace(0, 0.05, 101))
    errors = []
    for h in (1e-4, 5e-5):
        result = simulate(model, h, 0.05)
        gap = result["stop.gap"][::round(5e-4 / h)] - 2e-7
        errors.append(np.abs(gap - exact.y[at]).max() / np.abs(exact.y[at]).max())
    assert result["stop.normal_force"].max() > 0.05
    assert errors[1] < 3e-4 and errors[1] < 0.3 * errors[0]


def test_energy_and_momentum_of_an_impact_in_space():
    """A ball hits two points of a turned block: errors of second order, dissipation never falls."""
    body, _ = block(6)
    errors = []
    for h in (1e-4, 5e-5):
        model = hit_by_a_ball(body, "body.node22", stiffness=1e6, frame="positions")
        model.contact("body.node23", on=sphere(0.1, node="ball"), stiffness=1e6, friction=0.2,
                      name="beside")
        result = simulate(model, h, 0.03)
        energy = sum(result[f"energy.{part}"] for part in ("kinetic", "strain", "potential"))
        energy = energy - result["energy.external_work"]
        momentum = result["momentum"], result["angular_momentum"]
        errors.append([np.ptp(energy) / result["energy.kinetic"][0], *(
            np.abs(p - p[0]).max() / np.abs(p).max() for p in momentum)])
        assert np.diff(result["hit.dissipation"]).min() >= -1e-12
    assert result["hit.dissipation"][-1] > 1e-3
    assert max(errors[1]) < 2e-4 and errors[1][0] < 0.4 * errors[0][0]


FEET = (501, 503, 506, 508)


def standing(**law):
    """A soft block that stands on labelled nodes of its lower face."""
    body, _ = block(8, labels=range(500, 540))
    model = Model()
    nodes = [model.node(f"n{k}", point, "translation") for k, point in enumerate(body.coordinates)]
    model.superelement("block", body, nodes, frame="positions")
    model.gravity(-9.81 * TURN[:, 2])
    for label in FEET:
        model.contact(f"block.node{label}", on=plane(TURN[:, 2], 2e-4 * TURN[:, 2]),
                      name=f"c{label}",
                      **{"stiffness": 1e5, "friction": 0.4, "exponent": 1.0} | law)
    return model


def test_a_pinned_block_leans_on_nodes_of_its_face():
    """The feet balance the weight about the pin, linear springs as they are; a run stays there."""
    model = standing(friction=0.0)
    model.fix("n0", "position")
    wall = model.node("wall", placed_from(model, "n1", TURN[:, 1]), "translation")
    model.fix(wall, "position")
    model.spring(wall, "n1", 1e3)
    body = model.bodies["block"].reduced
    weight = -9.81 * body.total_mass * TURN[:, 2]
    found = equilibrium(model)
    force = np.array([found[f"c{label}.force"][-1] for label in FEET])
    pressing = np.array([found[f"c{label}.normal_force"][-1] for label in FEET])
    np.testing.assert_allclose(force, pressing[:, None] * TURN[:, 2], atol=1e-6)
    feet = np.array([found.field("block").at(label - 500).position[-1] for label in FEET])
    pin = found["n0.position"][-1]
    moment = np.cross(feet - pin, force).sum(axis=0) + np.cross(
        body.centre_of_mass - pin, weight)
    assert pressing.sum() > 0.4 * np.linalg.norm(weight)
    assert np.abs(moment).max() < 1e-2 * np.abs(np.cross(body.centre_of_mass - pin, weight)).max()
    for place, push in zip(feet, pressing, strict=True):
        depth = max(2e-4 - place @ TURN[:, 2], 0.0)
        assert push == pytest.approx(1e5 * depth, abs=1.0)
    result = simulate(model, 1e-3, 0.05, start=found)
    assert np.ptp(result["n1.position"], axis=0).max() < 1e-7
    taken = linearize(found).contacts
    assert set(taken) == {f"c{label}" for label in FEET} and "presses" in taken.values()


def placed_from(model, node, arm):
    return model.nodes[node].point + arm


def test_saved_resumed_and_varied(tmp_path):
    model = standing(stiffness=1e6, exponent=1.5)
    whole = Simulation(model, 5e-4).run_to(0.04)
    begun = Simulation(model, 5e-4).run_to(0.02)
    save_state(begun, tmp_path / "state.npz")
    again = resume(model, tmp_path / "state.npz").run_to(0.04).result()
    assert np.array_equal(again["c501.force"][-1], whole.result()["c501.force"][-1])
    whole.result().save(tmp_path / "run.npz")
    loaded = Result.load(tmp_path / "run.npz")
    for name in ("c506.force", "c506.gap", "c506.work", "n2.velocity"):
        assert np.array_equal(loaded[name], whole.result()[name])
    varied = Ensemble(model, 5e-4).run({"c501.stiffness": [5e5, 1e6]}, t_end=0.04, outputs={
        "f": maximum("c501.normal_force")})
    alone = standing(stiffness=1e6, exponent=1.5)
    alone.loads[0].constants["stiffness"] = 5e5
    largest = [simulate(one, 5e-4, 0.04)["c501.normal_force"].max() for one in (alone, model)]
    np.testing.assert_allclose(varied["f"], largest, rtol=1e-12)


def falling():
    """A beam on a hinge that falls on three points of a floor, in the x-z plane."""
    fe = straight_beam((0, 0, 0), (1, 0, 0), STEEL, 10)
    model = Model()
    root, tip = model.node("root", (0, 0, 0)), model.node("tip", (1, 0, 0))
    model.superelement("beam", craig_bampton(fe, [(0, "full"), (10, "full")], 6), (root, tip))
    model.revolute(root, axis=(0, 1, 0), name="hinge")
    model.gravity((0, 0, -9.81))
    for node in (3, 5, 8):
        model.contact(f"beam.node{node}", on=plane((0, 0, 1), (0, 0, -0.002 * node)), friction=0.3,
                      stiffness=1e6, restitution=0.8, name=f"c{node}")
    return model


def test_planar_and_rigid_models_touch_too():
    result = simulate(falling(), 2e-4, 0.08)
    flat = simulate(planar_variant(falling()).model, 2e-4, 0.08)
    assert result["c8.normal_force"].max() > 100.0
    np.testing.assert_allclose(flat["c8.normal_force"], result["c8.normal_force"], atol=1e-4)
    np.testing.assert_allclose(flat["tip.position"][:, 0], result["tip.position"][:, 0], atol=1e-9)
    stiff = simulate(rigid_variant(falling(), "beam").model, 2e-4, 0.08)
    assert stiff["c8.normal_force"].max() == pytest.approx(result["c8.normal_force"].max(), rel=0.1)


@pytest.mark.parametrize("touching, options, said", [
    ("body.node9", {}, r"body 'body' has no FE node '9': its 9 nodes are body.node0 to body.node8"),
    ("body.nodetip", {}, "has no FE node 'tip'"),
    ("bodi.node3", {}, "superelement 'bodi' is unknown: did you mean 'body'"),
    ("body.node3", {"radius": 0.1}, "radius is 0.1, but an FE node is a point: leave radius out"),
    ("body.node3", {"on": sphere(0.1, node="n0")}, "on node 'n0' of the same body"),
    ("body.node3", {"on": plane(TURN[2], SHIFT + 2 * TURN[2])}, "deep in the plane: start it outs"),
    ("body.node3", {"friction": -0.1}, "friction")])
def test_points_that_cannot_touch(touching, options, said):
    body, model = beam(2), Model()
    model.superelement("body", body, [model.node(f"n{k}", p) for k, p in enumerate(
        body.coordinates)])
    with pytest.raises(InputError, match=said):
        model.contact(touching, **{"on": plane(TURN[2], SHIFT - TURN[2]), "stiffness": 1e5}
                      | options)
    assert not model.loads


def test_bodies_without_places_of_points():
    body = beam(2)
    for made, frame, said in ((replace(body, recovery=None), None, "has reduced matrices only"),
                              (body, "mean", "averages the rotations of a step")):
        model = Model()
        model.superelement("body", made, [model.node(f"n{k}", p) for k, p in enumerate(
            body.coordinates)], frame=frame, inertia="b")
        with pytest.raises(InputError, match=said):
            model.contact("body.node3", on=plane(TURN[2], SHIFT - TURN[2]), stiffness=1e5)
