"""Slack cables and chains come to rest where their loads stretch them, against catenaries."""

import numpy as np
import pytest
from scipy.integrate import solve_bvp
from scipy.optimize import root
from scipy.spatial.transform import Rotation

from sebody import Model, SimulationError
from sebody.analysis import equilibrium, vibrations
from sebody.fem import StiffnessSection, circle, rectangle

WEIGHT = 9.81


def links(count, seed=None):
    """Lengths and masses that add up to one, equal or at random."""
    if seed is None:
        return np.full((2, count), 1.0 / count)
    own = 1.0 + 0.6 * np.random.default_rng(seed).uniform(-1.0, 1.0, (2, count))
    return own / own.sum(axis=1, keepdims=True)


def catenary(lengths, masses, span, drop):
    """Ends of rigid links that hang between (0, 0) and (span, -drop), (n + 1, 2).

    Moments about its ends turn a link into the direction (H, V - w / 2) of its forces.
    """
    weights = WEIGHT * masses

    def ends(forces):
        vertical = forces[1] - np.cumsum(weights) + weights / 2.0
        along = np.stack([np.full(len(weights), forces[0]), -vertical], axis=1)
        along *= (lengths / np.linalg.norm(along, axis=1))[:, None]
        return np.vstack([np.zeros(2), np.cumsum(along, axis=0)])
    found = root(lambda f: ends(f)[-1] - (span, -drop), (0.3 * WEIGHT, 0.5 * WEIGHT), tol=1e-13)
    assert np.abs(ends(found.x)[-1] - (span, -drop)).max() < 1e-12
    return ends(found.x)


def polygon(lengths, span, drop, plane):
    """A start that closes: two straight halves, in the plane or turned out of it."""
    half = np.searchsorted(np.cumsum(lengths), 0.5) + 1
    a, b = lengths[:half].sum(), lengths[half:].sum()
    end = np.array([span, 0.0, -drop])
    away = np.linalg.norm(end)
    e = end / away
    along = (a**2 - b**2 + away**2) / (2.0 * away)
    up = np.array([drop, 0.0, span]) / away
    side = np.cos(plane) * up + np.sin(plane) * np.cross(e, up)
    top = along * e + np.sqrt(a**2 - along**2) * side
    points = [np.zeros(3)]
    for k, length in enumerate(lengths):
        to = top / a if k < half else (end - top) / b
        points.append(points[-1] + length * to)
    return np.array(points)


def chain(lengths, masses, span=0.7, drop=0.2, plane=0.4, shared=False, planar=False):
    """Rigid links on ball joints, in general position; in a plane on hinges."""
    turn = np.eye(3) if planar else Rotation.random(random_state=3).as_matrix()
    place = np.zeros(3) if planar else np.array([4.0, -3.0, 7.0])
    start = polygon(lengths, span, drop, plane)
    points = (start @ turn.T + place)[:, [0, 2]] if planar else start @ turn.T + place
    model = Model(planar=planar)
    model.gravity(-WEIGHT * (turn[:, 2] if not planar else np.array([0.0, 1.0])))
    for k, (length, mass) in enumerate(zip(lengths, masses, strict=True)):
        at = {"at": f"end {k - 1}"} if shared and k else {}
        node = model.node(f"link {k}", points[k], **at)
        e = (points[k + 1] - points[k]) / length
        J = mass * length**2 / 12.0
        model.rigid_body(f"link {k}", node, mass, J if planar else
                         J * (np.eye(3) - 0.98 * np.outer(e, e)), points[k] + length / 2.0 * e)
        model.attach(f"end {k}", points[k + 1], node)
        if k and not shared:
            model.spherical(f"end {k - 1}", to=node)
    model.fix("link 0", "position")
    model.spherical(f"end {len(lengths) - 1}")
    return model, turn, place


def hanging(result, count, turn, place):
    """Places of the ends of the links in the plane they hang in, and the part out of it."""
    ends = np.array([result[f"end {k}.position"][-1] for k in range(count)])
    if ends.shape[1] == 2:
        return ends, 0.0
    own = (ends - place) @ turn
    return own[:, [0, 2]], np.abs(own[:, 1]).max()


@pytest.mark.parametrize("count, seed, options", [
    (100, None, {}), (30, 5, {"shared": True}), (40, 2, {"plane": 0.0}),
    (25, 7, {"planar": True, "plane": 0.0})])
def test_chains_hang_in_catenaries(count, seed, options):
    """Of links that are equal or not, from a start that leans upwards: to Newton's tolerance."""
    lengths, masses = links(count, seed)
    model, turn, place = chain(lengths, masses, **options)
    result = equilibrium(model, 4)
    found, aside = hanging(result, count, turn, place)
    exact = catenary(lengths, masses, 0.7, 0.2)[1:]
    assert np.abs(found - exact).max() < 1e-9 and aside < 1e-9


def test_a_chain_of_soft_rods_hangs_straight_down():
    """Rods that spin freely, from an inclined line in ten load steps: each stretches by its load.

    Softer springs of the search only let the rods spin farther by rounding.
    """
    n, rod, section = 10, 0.45, circle(0.004, 2e8, 0.3, 7800.0)
    turn = Rotation.random(random_state=4).as_matrix()
    place, way = np.array([1.0, 2.0, 3.0]), turn @ [np.sin(0.7), 0.0, -np.cos(0.7)]
    model = Model()
    model.gravity(-WEIGHT * turn[:, 2])
    last = model.node("p0", place)
    model.fix(last, "position")
    for k in range(n):
        begin = last if k == 0 else model.node(f"q{k}", place + rod * k * way, at=last)
        last = model.node(f"p{k + 1}", place + rod * (k + 1) * way)
        model.beam(f"rod {k}", (begin, last), section, 2, 1, 0)
    result = equilibrium(model)
    ends = np.array([result[f"p{k}.position"][-1] for k in range(n + 1)])
    weight = WEIGHT * section.density * section.area * rod
    pulls = weight * (n - np.arange(n) - 0.5)
    stretched = np.append(0.0, np.cumsum(rod * (1.0 + pulls / (2e8 * section.area))))
    assert np.abs((ends - place) @ turn - np.outer(stretched, [0.0, 0.0, -1.0])).max() < 1e-7
    assert result.stability == "stable"


AXIAL = 2e3


def taut(bending):
    """Middle of a straight cable of length one that sags between its ends, (along, down).

    Heavy, with bending and axial stiffness: the forces (H, V) at the section s give its normal
    force T, the strain T / EA, and the moment ``M' = (1 + T / EA) (H sin - V cos)`` of EI th'.
    """
    def rates(s, y, p, stiffness):
        H, V = p[0], p[1] - WEIGHT * s
        _, _, angle, moment = y
        c, z = np.cos(angle), np.sin(angle)
        stretch = 1.0 + (H * c + V * z) / AXIAL
        return np.array([stretch * c, stretch * z, moment / stiffness, stretch * (H * z - V * c)])

    def ends(a, b, p):
        return np.array([a[0], a[1], a[3], b[0] - 1.0, b[1], b[3]])
    s = np.linspace(0.0, 1.0, 401)
    y = np.array([s, 0.05 * np.sin(np.pi * s), 0.15 * np.cos(np.pi * s), 0.0 * s])
    forces = [20.0, WEIGHT / 2.0]
    for stiffness in (0.1, 0.03, 0.01, bending):       # the softer, the narrower is the bend
        found = solve_bvp(lambda s, y, p, k=stiffness: rates(s, y, p, k), ends, s, y, p=forces,
                          tol=1e-8, max_nodes=50000)
        assert found.status == 0
        s, y, forces = found.x, found.y, found.p
    return found.sol(0.5)[:2]


@pytest.mark.parametrize("bending", [3e-2, 5e-3])
def test_cables_sag_between_their_ends(bending):
    """From straight to where they stretch: errors of second order in the elements.

    The force along the cable is some 30 and must stay below 12 EI / l^2 of the elements.
    """
    turn = Rotation.random(random_state=8).as_matrix()
    exact, errors, counts = taut(bending), [], (32, 64)
    for n in counts:
        model = Model()
        ends = [model.node(name, turn[:, 0] * x) for name, x in (("a", 0.0), ("b", 1.0))]
        section = StiffnessSection(axial=AXIAL, bending_y=bending, bending_z=bending,
                                   torsion=bending, mass=1.0, inertia_x=2e-6, inertia_y=1e-6,
                                   inertia_z=1e-6)
        model.beam("cable", ends, section, n, up=turn[:, 2])
        for end in ends:
            model.fix(end, "position")
        model.gravity(-WEIGHT * turn[:, 2])
        middle = equilibrium(model)[f"cable {n // 2}.position"][-1] @ turn
        assert abs(middle[1]) < 1e-9
        errors.append(np.abs(middle[[0, 2]] - exact * (1.0, -1.0)).max())
    assert errors[-1] < 5e-5 and 1.8 < np.log2(errors[0] / errors[1]) < 2.3


def test_a_mechanism_turns_into_its_load():
    """A dead force across a hinged beam pulls it along; small motion about that is a pendulum's."""
    model = Model()
    turn = Rotation.random(random_state=1).as_matrix()
    base, tip = (model.node(name, turn[:, 0] * x + 2.0) for name, x in (("base", 0.0),
                                                                          ("tip", 1.0)))
    model.beam("arm", [base, tip], StiffnessSection(
        axial=1e4, bending_y=5.0, bending_z=5.0, torsion=5.0, mass=1e-3, inertia_x=2e-9,
        inertia_y=1e-9, inertia_z=1e-9), 4, up=turn[:, 2])
    model.point_mass("bob", tip, 2.0)
    model.fix(base, "position")
    model.force(tip, 3.0 * turn[:, 1])
    result = equilibrium(model)
    end = turn.T @ (result["tip.position"][-1] - 2.0)
    assert end == pytest.approx([0.0, 1.0 + 3.0 / 1e4, 0.0], abs=1e-9)
    slow = vibrations(result).omega
    assert slow[0] < 0.05               # about its own axis nothing but rounding holds the arm
    assert slow[1:3] == pytest.approx(np.sqrt(3.0 / 2.0) * np.ones(2), rel=2e-3)


def test_what_nothing_stops_is_no_structure():
    """Two masses on a spring that fall."""
    model = Model()
    for name, x in (("a", 0.0), ("b", 1.0)):
        model.point_mass(name, model.node(name, (x, 2.0, 3.0), "translation"), 1.0)
    model.spring("a", "b", 50.0)
    model.gravity((0.0, -1.0, 0.5))
    with pytest.raises(SimulationError, match="no equilibrium was found above 0 of the load: a "
                                              r"load moves [ab]\.position, which is free to move"):
        equilibrium(model)


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_a_flat_rod_on_a_ball_joint_rolls_until_it_lies(seed):
    """Only its sag keeps it from rolling, so a small part of the load holds it a hundredth as much.

    In steps of a tenth no equilibrium was found. The force of gravity is along `up` of the section
    or across it; at rest the rod has rolled until it sags about its weak axis.
    """
    turn = Rotation.random(random_state=seed).as_matrix()
    model = Model()
    root, tip = (model.node(name, turn[:, 0] * x) for name, x in (("root", 0.0), ("tip", 1.0)))
    up = turn @ (0.0, np.cos(0.5), np.sin(0.5))
    model.beam("rod", (root, tip), rectangle(0.02, 0.012, 7e10, 0.3, 2700.0), 4, bodies=1, modes=2,
               up=up)
    model.spherical(root)
    for k, place in enumerate([(1.3, 0.4, 0.1), (1.2, -0.3, 0.2), (0.9, 0.1, 0.5)]):
        wall = model.node(f"wall {k}", turn @ place)
        model.fix(wall)
        model.spring(tip, wall, 800.0, length=0.3)
    model.gravity(-9.81 * turn[:, 2])
    found = equilibrium(model)
    rolled = found["tip.rotation"][-1] @ up
    along = found["tip.position"][-1] / np.linalg.norm(found["tip.position"][-1])
    vertical = turn[:, 2] - along * (along @ turn[:, 2])
    assert abs(rolled @ vertical) < 1e-3 or abs(np.linalg.norm(np.cross(rolled, vertical))) < 1e-3
    assert vibrations(found).omega[0] > 1.0         # rolling swings about the sag
