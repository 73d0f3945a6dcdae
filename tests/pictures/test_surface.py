"""Surfaces of bodies against their FE models, and numbers in blocks against those given."""

from dataclasses import replace

import numpy as np
import pytest

from sebody import Model, simulate
from sebody.fem import (
    Section,
    frame,
    hexahedral_block,
    i_profile,
    planar_beam,
    rectangle,
    straight_beam,
    tube,
)
from sebody.fem.cells import EDGES, FACES, faces_of
from sebody.pictures.drawn_bodies import vertices
from sebody.pictures.scene import scenery
from sebody.pictures.skin import lattice, outer_faces, skin
from sebody.pictures.surface import _cap, box, surface_of
from sebody.pictures.surface_parts import folded
from sebody.reduction import RigidFace, craig_bampton

STEEL = 2.1e6, 0.3, 7.8e-3
TURN = np.array([[2.0, -1.0, 2.0], [2.0, 2.0, -1.0], [-1.0, 2.0, 2.0]]) / 3.0


def surface(fe_model, ends, modes=0):
    body = craig_bampton(fe_model, [(end, "full") for end in ends], modes)
    return surface_of(body.recovery, body.recovery.shapes.shape[1]), body


def test_a_line_between_two_nodes_is_the_cubic_of_its_element():
    """One element of Euler and Bernoulli moves as sixteen of them do under the same ends."""
    section = rectangle(2.0, 1.0, *STEEL)
    section = Section(section.area, section.inertia_y, section.inertia_z, section.torsion, *STEEL)
    start, end = np.array([1.0, 2.0, -1.0]), np.array([5.0, 3.0, 4.0])
    coarse, body = surface(straight_beam(start, end, section, 1), (0, 1))
    fine = craig_bampton(straight_beam(start, end, section, 12), [(0, "full"), (12, "full")], 0)
    exact = fine.recovery.shapes.reshape(13, 6, -1)[..., :12]
    assert len(coarse.points) == 13
    np.testing.assert_allclose(coarse.points, fine.recovery.points, rtol=0, atol=1e-12)
    # rounding of the static solution of the fine model
    np.testing.assert_allclose(coarse.moves[:12].transpose(1, 2, 0), exact[:, :3], atol=1e-8)
    np.testing.assert_allclose(coarse.turns[:12].transpose(1, 2, 0), exact[:, 3:], atol=1e-8)


def test_outer_faces_of_a_block():
    block = hexahedral_block((0, 0, 0), (2, 3, 4), (2, 3, 4), 1e6, 0.3, 1.0)
    quads, = outer_faces(block.cells)
    assert len(quads) == 2 * (2 * 3 + 3 * 4 + 4 * 2)
    # outward normals: the divergence theorem gives the volume
    corners = block.coordinates[quads]
    areas = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1]) / 2
    assert np.sum(corners.mean(axis=1) * areas) / 3 == pytest.approx(24.0)


@pytest.mark.parametrize("kind, corners", [("tetra", 4), ("hexahedron", 8), ("wedge", 6),
                                           ("pyramid", 5)])
def test_a_single_cell_is_closed(kind, corners):
    """Every edge belongs to two faces, once in each direction."""
    edges = [(face[k - 1], face[k]) for face in FACES[kind] for k in range(len(face))]
    assert len(set(edges)) == len(edges)
    assert {(b, a) for a, b in edges} == set(edges)
    assert {a for a, _ in edges} == set(range(corners))
    shown = outer_faces(((kind + "10", np.arange(corners)[None]),))
    assert sum(map(len, shown)) == len(FACES[kind])


def test_ends_of_sections_that_are_not_convex():
    section = i_profile(3.0, 2.0, 0.2, 0.3, *STEEL)
    y, z = np.array([1.0, 2.0, 2.0]) / 3, np.array([2.0, 1.0, -2.0]) / 3
    outline = np.array(section.outline) @ np.array([y, z])
    a, b, c = outline[_cap(outline)].transpose(1, 0, 2)
    areas = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2
    assert areas.sum() == pytest.approx(section.area)


def volume(surface):
    """By the divergence theorem: faces that face inwards would take from it."""
    a, b, c = surface.vertices[surface.triangles].transpose(1, 0, 2)
    return np.einsum("ni,ni->", a, np.cross(b, c)) / 6


def test_surfaces_face_outwards():
    section = i_profile(3.0, 2.0, 0.2, 0.3, *STEEL)
    for one in (section, replace(section, outline=section.outline[::-1])):
        found, _ = surface(straight_beam((1, 2, 3), (5, 7, -3), one, 3), (0, 3))
        assert volume(found) == pytest.approx(section.area * np.sqrt(77))
    block = hexahedral_block((0, 1, 2), (2, 3, 4), (2, 3, 4), 1e6, 0.3, 1.0)
    ends = [RigidFace((x, 2.5, 4), np.flatnonzero(block.coordinates[:, 0] == x)) for x in (0, 2)]
    assert volume(surface(block, ends)[0]) == pytest.approx(24.0)
    for axes in (TURN, TURN[:, ::-1]):          # of either hand
        assert volume(box(np.array([1.0, 2.0, 3.0]), np.array([4.0, 5.0, 6.0]), axes)) == (
            pytest.approx(6.0))


def test_sections_turn_with_the_body():
    """A body rotated in general has the rotated surface; so have members of a frame."""
    points = [(0, 0, 0), (3, 1, 0), (3, 1, 4)]
    fe_model = frame(points, [(0, 1), (1, 2)], rectangle(0.5, 0.2, *STEEL), 2, up=(1, 2, 3))
    here, body = surface(fe_model, (0, 2), 2)
    turned = body.rotated(TURN)
    there = surface_of(turned.recovery, turned.recovery.shapes.shape[1])
    for name in ("points", "offsets"):
        np.testing.assert_allclose(getattr(there, name), getattr(here, name) @ TURN.T, atol=1e-12)
    assert np.array_equal(here.triangles, there.triangles)
    elements = here.points.reshape(4, -1, 3)        # places along each of the four elements
    lines = np.repeat(elements[:, -1] - elements[:, 0], elements.shape[1], axis=0)
    across = np.einsum("ni,ni->n", here.offsets, lines[here.weights.indices])
    assert np.abs(across).max() < 1e-12


def middles(body, places):
    """Means of the corners of the outline at each station."""
    of = body.surface.weights
    return (of.T @ places) / np.asarray(of.sum(axis=0))[:, None]


@pytest.mark.parametrize("planar", [False, True])
def test_vertices_are_where_the_field_is(planar):
    section = rectangle(4.0, 2.0, *STEEL)
    D = 2 if planar else 3
    ends = np.array([[10.0, 5.0, 3.0][:D], [70.0, 90.0, 20.0][:D]])
    make = planar_beam if planar else straight_beam
    body = craig_bampton(make(*ends, section, 12), [(0, "full"), (12, "full")], 2)
    model = Model(planar=planar)
    nodes = [model.node(name, point) for name, point in zip(("a", "b"), ends, strict=True)]
    model.superelement("beam", body, nodes)
    model.revolute("a")
    model.gravity([0.0, -9.81, 0.0][:D])
    result = simulate(model, 0.02, 2.0)
    drawn = scenery(result, 40)
    body, = drawn.bodies
    for k in (0, 7, len(drawn.t) - 1):
        found = middles(body, vertices(body, k))
        exact = result.field("beam").position(int(drawn.states[k]))
        used = [found[2 * e] for e in range(12)] + [found[-1]]
        # displacements that are left out, of two amplitudes and all the rest
        assert np.abs(np.array(used)[:, :D] - exact).max() < 1e-5 * np.linalg.norm(ends[1])


def test_stresses_are_those_of_the_field():
    steel = 2.1e11, 0.3, 7800.0
    block = hexahedral_block((0, 0, 0), (4, 1, 1), (4, 1, 1), *steel)
    ends = [RigidFace((x, 0.5, 0.5), np.flatnonzero(block.coordinates[:, 0] == x)) for x in (0, 4)]
    body = craig_bampton(block, [(end, "full") for end in ends], 2)
    bar = craig_bampton(straight_beam((4, 0.5, 0.5), (6, 0.5, 0.5), rectangle(0.2, 0.3, *steel), 4),
                        [(0, "full"), (4, "full")], 2)
    model = Model()
    nodes = [model.node(name, (x, 0.5, 0.5)) for name, x in zip("abc", (0, 4, 6), strict=True)]
    model.superelement("block", body, nodes[:2])
    model.superelement("bar", bar, nodes[1:])
    model.revolute("a", axis=(0, 1, 0))
    model.gravity((0, 0, -9.81))
    result = simulate(model, 0.01, 0.3)
    block, bar = scenery(result, 31, stressed=True).bodies
    exact = [result.field(name).von_mises(17) for name in ("block", "bar")]
    assert exact[0].max() > 1e4     # a weight of 31 t on a section of 1 m^2
    np.testing.assert_allclose(block.stress[17], exact[0][block.surface.nodes[:, 0]])
    ends = np.isin(bar.surface.shares, (0.0, 1.0))
    of_ends = bar.surface.nodes[np.arange(len(ends)), (bar.surface.shares == 1).astype(int)]
    np.testing.assert_allclose(bar.stress[17][ends], exact[1][of_ends[ends]])


def curved_block(kind):
    """A quarter of a ring of two elements of second order, with middle nodes on the circles."""
    corners, edges = 8, EDGES["hexahedron"]
    nodes, cells, number = [], [], {}

    def add(r, angle, z):
        key = tuple(np.round((r, angle, z), 9))
        if key not in number:
            number[key] = len(nodes)
            nodes.append((r * np.cos(angle), r * np.sin(angle), z))
        return number[key]

    for begin in (0.0, np.pi / 4):
        box_of = [(r, begin + a, z) for z in (0.0, 1.0) for r, a in (
            (2.0, 0.0), (3.0, 0.0), (3.0, np.pi / 4), (2.0, np.pi / 4))]
        middles = [np.mean([box_of[i], box_of[j]], axis=0) for i, j in edges]
        cells.append([add(*p) for p in (*box_of, *middles)])
    assert len(cells[0]) == corners + len(edges)
    return np.array(nodes), ((kind, np.array(cells)),)


def test_faces_of_second_order_are_curved():
    """The skin of a ring is nearly as far from its axis as the ring: a parabola is no circle."""
    points, cells = curved_block("hexahedron20")
    faces = outer_faces(cells)
    assert [face.shape for face in faces] == [(10, 8)]
    found = folded(skin(points, np.zeros((0, *points.shape)), faces))
    radii = np.linalg.norm(found.vertices[:, :2], axis=1)
    # the largest distance of a parabola from an arc of 45 degrees, of the radius
    s, half = np.linspace(-1, 1, 201), np.pi / 8
    far = np.abs(np.hypot(1 - s**2 * (1 - np.cos(half)), s * np.sin(half)) - 1).max()
    inside, outside = radii[radii < 2.1], radii[radii > 2.9]
    assert np.abs(inside - 2.0).max() < 2.001 * far
    assert np.abs(outside - 3.0).max() < 3.001 * far < 3e-3
    # chords of at most 8 degrees leave out a part of phi^2 / 6 of a sector
    assert volume(found) == pytest.approx(np.pi / 4 * (9 - 4), rel=np.radians(8)**2 / 6 + far)
    flat = folded(skin(points, np.zeros((0, *points.shape)), [face[:, :4] for face in faces]))
    assert volume(flat) < 0.93 * np.pi / 4 * (9 - 4)
    # the rim of the ends and both circles at both heights; two faces of 45 degrees are one
    places = found.vertices[found.features]
    lengths = np.linalg.norm(np.diff(places, axis=1), axis=2).sum()
    assert lengths == pytest.approx(np.pi / 2 * (2 + 3) * 2 + 4 * (1 + 1), rel=np.radians(8)**2 / 6)


@pytest.mark.parametrize("kind, corners", [("tetra", 4), ("hexahedron", 8), ("wedge", 6),
                                           ("pyramid", 5)])
def test_middles_of_edges_are_between_their_corners(kind, corners):
    """Nodes of second-order cells by their places, straight and in any affine position."""
    rng = np.random.default_rng(3)
    points = rng.normal(size=(corners, 3))
    points = np.concatenate([points, [points[list(edge)].mean(axis=0) for edge in EDGES[kind]]])
    for face in faces_of(kind + "20", len(points)):
        n = len(face) // 2
        own = points[list(face)]
        np.testing.assert_allclose(own[n:], (own[:n] + np.roll(own[:n], -1, axis=0)) / 2)
    assert [face[:len(face) // 2] for face in faces_of(kind, len(points))] == list(FACES[kind])
    assert faces_of(kind, corners) == list(FACES[kind])


@pytest.mark.parametrize("nodes", [3, 4, 6, 8])
def test_lattices(nodes):
    """Shape functions are 1 at their node and reproduce what their polynomials contain."""
    one = lattice(nodes, 6)
    np.testing.assert_allclose(one.values.sum(axis=1), 1.0)
    area = {3: 0.5, 6: 0.5, 4: 4.0, 8: 4.0}[nodes]
    corners = (np.array([(0, 0), (1, 0), (0, 1)]) if nodes in (3, 6) else
               np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]))
    own = corners if nodes < 5 else np.concatenate(
        [corners, (corners + np.roll(corners, -1, axis=0)) / 2])
    at = one.values @ own
    if nodes > 4:
        for f in (lambda x, y: x * y, lambda x, y: x**2 - 3 * y, lambda x, y: y**2 + x):
            np.testing.assert_allclose(one.values @ f(*own.T), f(*at.T), atol=1e-12)
    a, b, c = at[one.triangles].transpose(1, 0, 2)
    areas = ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]) / 2
    assert areas.min() > 0 and areas.sum() == pytest.approx(area)
    rim = at[one.rim]
    assert len(np.unique(one.rim)) == len(one.rim) == (6 if nodes > 4 else 1) * len(corners)
    around = np.roll(rim, -1, axis=0)
    assert np.sum(rim[:, 0] * around[:, 1] - rim[:, 1] * around[:, 0]) / 2 == pytest.approx(area)


def test_features_of_shells_and_beams():
    """A plate has its rim, a plate with a fold this too; a round tube the rims of its ends."""
    points = np.array([(0, 0, 0), (1, 0, 0), (2, 0, 1), (0, 1, 0), (1, 1, 0), (2, 1, 1.0)])
    quads = np.array([(0, 1, 4, 3), (2, 1, 4, 5)])          # the second one faces the other way
    plate = folded(skin(points, np.zeros((0, 6, 3)), [quads]))
    assert len(plate.features) == 7
    flat = folded(skin(points * [1, 1, 0], np.zeros((0, 6, 3)), [quads]))
    assert len(flat.features) == 6
    found, _ = surface(straight_beam((1, 2, 3), (5, 7, -3), tube(0.3, 0.02, *STEEL), 3), (0, 3))
    assert len(found.features) == 2 * 16


def test_vertices_of_a_smooth_part_are_shared():
    """Means of normals are those of a tube's side, not of its side and its end."""
    found, _ = surface(straight_beam((0, 0, 0), (4, 0, 0), tube(0.3, 0.02, *STEEL), 2), (0, 2))
    p = found.vertices
    a, b, c = p[found.triangles].transpose(1, 0, 2)
    normals = np.zeros_like(p)
    for k in range(3):
        np.add.at(normals, found.triangles[:, k], np.cross(b - a, c - a))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    radial = p * [0, 1, 1] / 0.3
    of_side = np.abs(normals[:, 0]) < 0.5
    # triangles of unequal size lean it by less than half of a corner of 22.5 degrees
    assert np.einsum("ni,ni->n", normals, radial)[of_side].min() > np.cos(np.radians(11.25))
    np.testing.assert_allclose(np.abs(normals[~of_side][:, 0]), 1.0)
