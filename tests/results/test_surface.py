"""Surfaces of bodies against their FE models, and numbers in blocks against those given."""

from dataclasses import replace
from itertools import pairwise

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
)
from sebody.reduction import RigidFace, craig_bampton
from sebody.results.blocks import Blocks
from sebody.results.scenery import scenery, vertices
from sebody.results.surface import FACES, _cap, box, outer_faces, surface_of

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
    vertices = surface.points[surface.stations] + surface.offsets
    a, b, c = vertices[surface.triangles].transpose(1, 0, 2)
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
    lines = np.diff(here.points[here.stations].reshape(-1, 4, 3)[:, 0], axis=0)
    across = here.offsets.reshape(-1, 4, 3)[1:]
    inside = np.linalg.norm(lines, axis=1) > 1e-9       # not from one member to the next
    assert np.abs(np.einsum("nci,ni->nc", across, lines)[inside]).max() < 1e-12


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
        found = vertices(body, k).reshape(-1, 4, 3).mean(axis=1)        # of the outline's corners
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


def read(blocks, block):
    """Numbers of a block, written from its description in blocks.py."""
    kind = {2: "<u2", 4: "<u4"}[block["bytes"]]
    if "count" in block:
        return np.frombuffer(blocks.bytes(), kind, block["count"], block["at"])
    rows, _ = block["shape"]
    found = np.tile(block["low"], (rows, 1))
    varying = block["varying"]
    stored = np.frombuffer(blocks.bytes(), kind, rows * len(varying), block["at"])
    found[:, varying] += np.array(block["step"]) * stored.reshape(rows, -1)
    return found


def test_blocks_hold_what_was_given():
    rng = np.random.default_rng(4)
    values = rng.normal(size=(50, 5)) * [1.0, 1e-9, 1e6, 0.0, 3.0] + [0.0, 7.0, -1e6, 2.5, 1e3]
    blocks = Blocks()
    first = blocks.values(values)
    fine = blocks.values(values, seen=1e-4)
    places = blocks.indices(np.array([3, 1, 70000]))
    small = blocks.indices(np.array([3, 1, 7]))
    again = blocks.values(values)
    assert (first["bytes"], fine["bytes"], places["bytes"], small["bytes"]) == (2, 4, 4, 2)
    assert again["at"] == first["at"]           # stored once
    assert 3 not in first["varying"]            # a constant is not stored
    half = np.ptp(values, axis=0) / 0xFFFF / 2
    rounding = 4e-16 * np.abs(values).max(axis=0)
    assert (np.abs(read(blocks, first) - values).max(axis=0) <= half + rounding).all()
    assert np.abs(read(blocks, fine) - values).max() < 1e-3
    assert read(blocks, places).tolist() == [3, 1, 70000]
    assert read(blocks, small).tolist() == [3, 1, 7]
    ends = sorted(block["at"] for block in (first, fine, places, small))
    assert all(b - a >= 4 and b % 4 == 0 for a, b in pairwise(ends))
