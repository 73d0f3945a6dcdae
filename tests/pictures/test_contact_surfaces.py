"""Contact surfaces and stops of pictures: on what they touch, and moving with what carries them."""

import json

import browser
import numpy as np
import pytest
from matplotlib.figure import Figure
from page_data import PageData
from scipy.ndimage import binary_erosion
from scipy.spatial.transform import Rotation

from sebody import Model, Result, cylinder, plane, simulate, sphere
from sebody.pictures import film, film_marks
from sebody.pictures.contact_surfaces import vertices_of
from sebody.pictures.scene import scenery
from sebody.results import animate, save_picture

STATES = 21
LAW = {"stiffness": 2e4, "restitution": 0.6, "friction": 0.3}
NORMAL = np.array([0.2, -0.3, 1.0]) / np.sqrt(1.13)
LIMITS = {"pin": (-0.3, 0.5), "way": (-0.05, 0.15), "rope": (None, 0.6)}
PIN = np.array([2.0, 1.0, -0.5])


def model_in_space():
    """Surfaces of all kinds, on the ground and on turning bodies, none along the axes of space."""
    model = Model()
    model.gravity((0.5, 0.0, -9.0))
    for name, place in (("ball", (0.1, 0.2, 0.4)), ("drop", (0.0, 1.0, 0.6)),
                        ("roller", (2.1, 0.9, -0.6)), ("toe", (1.0, 2.0, 0.4)),
                        ("board", (1.1, 2.0, 0.3)), ("cart", (-1.0, 0.5, 0.2))):
        model.rigid_body(f"body of {name}", model.node(name, place), 0.7, (0.01, 0.012, 0.015))
    model.rigid_body("cradle body", model.node("cradle", PIN), 3.0, (0.1, 0.2, 0.15))
    model.attach("handle", PIN + (0.4, 0.0, 0.3), "cradle")
    model.contact("ball", on=plane(NORMAL, (0.0, 0.0, 0.1)), radius=0.1, name="slope", **LAW)
    model.contact("toe", on=plane(NORMAL, (1.0, 2.0, 0.3), node="board"), name="lid", **LAW)
    model.contact("drop", on=sphere(0.2, (0.0, 1.0, 0.2)), radius=0.05, name="dome", **LAW)
    model.contact("roller", on=cylinder((1.0, 0.5, 0.0), 0.4, node="cradle", inside=True),
                  radius=0.05, name="trough", **LAW)
    model.revolute("cradle", axis=(1.0, 0.5, 0.2), name="pin")
    model.prismatic("cart", (1.0, 0.3, 0.2), name="way")
    for of in ("pin", "way"):
        lower, upper = LIMITS[of]
        model.stop(of, lower, upper, stiffness=1e3, name=f"stop of {of}")
    model.stop(("ball", "toe"), upper=3.0, stiffness=1e3, name="rope")
    for name in ("board", "toe"):
        model.initial_velocity(name, (0.1, 0.0, 0.6), (1.0, 2.0, -1.0))
    model.initial_velocity("cradle", angular=3.0 * np.array([1.0, 0.5, 0.2]) / np.sqrt(1.29))
    model.initial_velocity("cart", -0.8 * np.array([1.0, 0.3, 0.2]) / np.sqrt(1.13))
    return model


@pytest.fixture(scope="module")
def result(tmp_path_factory):
    """Loaded from a file, as pages are made of."""
    path = tmp_path_factory.mktemp("contacts") / "run.npz"
    simulate(model_in_space(), 2e-3, 0.4).save(path)
    return Result.load(path)


@pytest.fixture(scope="module")
def drawn(result):
    return scenery(result, STATES)


def of(drawn, name, kind):
    one, = (one for one in drawn.contacts if (one.name, one.kind) == (name, kind))
    return one


def rotations(result, node):
    return Rotation.from_matrix(result[f"{node}.rotation"])


def test_every_surface_is_drawn_once(drawn):
    assert sorted((one.name, one.kind, one.node) for one in drawn.contacts if one.node) == [
        ("dome", "ball", "drop"), ("lid", "plane", "board"), ("rope", "limits", "ball"),
        ("slope", "ball", "ball"), ("stop of pin", "pointer", "cradle"),
        ("stop of way", "limits", "cart"), ("trough", "ball", "roller"),
        ("trough", "cylinder", "cradle")]
    assert sorted((one.name, one.kind) for one in drawn.contacts if one.node is None) == [
        ("dome", "sphere"), ("slope", "plane"), ("stop of pin", "limits"),
        ("stop of way", "pointer")]


@pytest.mark.parametrize("name, node, radius", [("slope", "ball", 0.1), ("lid", "toe", 0.0)])
def test_patches_are_where_the_gap_says(name, node, radius, result, drawn):
    """The plane through the corners is as far from the node as the gap; it is over the patch."""
    one = of(drawn, name, "plane")
    for frame, state in enumerate(drawn.states):
        corners = vertices_of(one, drawn.nodes, frame)
        sides = corners[1] - corners[0], corners[3] - corners[0]
        normal = np.cross(*sides) / np.linalg.norm(np.cross(*sides))
        away = result[f"{node}.position"][state] - corners[0]
        assert abs(normal @ away) == pytest.approx(abs(result[f"{name}.gap"][state] + radius),
                                                   abs=1e-12)
        for side in sides:
            assert radius <= away @ side / np.linalg.norm(side) <= np.linalg.norm(side) - radius
        np.testing.assert_allclose(np.dot(*sides), 0.0, atol=1e-12)


@pytest.mark.parametrize("name, kind, node, radius, side", [
    ("dome", "sphere", "drop", 0.05, 1.0), ("trough", "cylinder", "roller", 0.05, -1.0)])
def test_round_surfaces_are_where_the_gap_says(name, kind, node, radius, side, result, drawn):
    """Distances from the axis, or the middle, less the radius of the surface."""
    one = of(drawn, name, kind)
    for frame, state in enumerate(drawn.states):
        points = vertices_of(one, drawn.nodes, frame)
        away = result[f"{node}.position"][state] - points.mean(axis=0)
        if kind == "cylinder":
            half = len(points) // 2
            axis = points[half:].mean(axis=0) - points[:half].mean(axis=0)
            long, axis = np.linalg.norm(axis), axis / np.linalg.norm(axis)
            assert abs(away @ axis) + radius < long / 2
            away = away - axis * (axis @ away)
            size = np.linalg.norm(points[0] - points[:half].mean(axis=0))
        else:
            size = np.linalg.norm(points - points.mean(axis=0), axis=1)
        np.testing.assert_allclose(side * (np.linalg.norm(away) - size) - radius,
                                   result[f"{name}.gap"][state], atol=1e-12)


def test_balls_turn_with_their_bodies(result, drawn):
    one = of(drawn, "slope", "ball")
    for frame in (0, len(drawn.t) - 1):
        state = drawn.states[frame]
        turned = vertices_of(one, drawn.nodes, frame) - result["ball.position"][state]
        np.testing.assert_allclose(np.linalg.norm(turned, axis=1), 0.1, rtol=1e-12)
        np.testing.assert_allclose(rotations(result, "ball")[state].inv().apply(turned),
                                   one.shape.points, atol=1e-12)


def test_the_pointer_of_an_angle_meets_its_limits(result, drawn):
    """Angles from the limits' rays to the pointer, about the axis, are those from the gaps."""
    fan, pointer = of(drawn, "stop of pin", "limits"), of(drawn, "stop of pin", "pointer")
    axis = np.array([1.0, 0.5, 0.2]) / np.sqrt(1.29)
    points = vertices_of(fan, drawn.nodes, 0)
    rays = [points[k] - PIN for _, k in fan.shape.lines[-2:]]
    np.testing.assert_allclose(points[-1], PIN, atol=1e-12)
    angles = result["pin.angle"]
    assert np.ptp(angles) > 0.3         # it moves, to a stop
    for frame, state in enumerate(drawn.states):
        start, end = vertices_of(pointer, drawn.nodes, frame)
        np.testing.assert_allclose(start, PIN, atol=1e-9)
        for ray, limit in zip(rays, LIMITS["pin"], strict=True):
            found = np.arctan2(axis @ np.cross(ray, end - PIN), ray @ (end - PIN))
            assert found == pytest.approx(angles[state] - limit, abs=1e-9)


def test_plates_are_at_the_limits_of_a_way(result, drawn):
    plates, mark = of(drawn, "stop of way", "limits"), of(drawn, "stop of way", "pointer")
    axis = -np.array([1.0, 0.3, 0.2]) / np.sqrt(1.13)       # of the ground, seen from the cart
    for frame, state in enumerate(drawn.states):
        corners = vertices_of(plates, drawn.nodes, frame).reshape(2, 4, 3)
        at = vertices_of(mark, drawn.nodes, frame).mean(axis=0)
        away = (corners - at) @ axis
        np.testing.assert_allclose(np.ptp(away, axis=1), 0.0, atol=1e-9)
        gap = min(-away[0, 0], away[1, 0])
        assert gap == pytest.approx(result["stop of way.gap"][state], abs=1e-9)


def model_in_a_plane():
    """Two feet on one slope of the ground, a disc in a bore, a hinge with a stop."""
    model = Model(planar=True)
    model.gravity((0.0, -9.81))
    n = np.array([-0.3, 1.0]) / np.sqrt(1.09)
    t = np.array([n[1], -n[0]])
    model.rigid_body("block body", model.node("block", 0.2 * n), 0.5, 2e-3)
    for k, name in enumerate(("left", "right")):
        model.attach(name, (k - 0.5) * 0.2 * t + 0.1 * n, "block")
        model.contact(name, on=plane(n, 5.0 * k * t), name=f"{name} foot", **LAW)
    model.rigid_body("disc body", model.node("disc", (1.0, 0.25)), 0.2, 1e-3)
    model.rigid_body("bore body", model.node("bore", (1.0, 0.3)), 4.0, 1e-1)
    model.contact("disc", on=sphere(0.2, node="bore", inside=True), radius=0.1, name="journal",
                  **LAW)
    model.revolute("bore", name="hinge")
    model.stop("hinge", upper=0.4, stiffness=1e3, name="end")
    model.initial_velocity("bore", angular=3.0)
    return model


def test_surfaces_in_a_plane():
    """Lines with hatches on the side that is not touched, discs, a bore, and a range."""
    result = simulate(model_in_a_plane(), 2e-3, 0.3)
    drawn = scenery(result, STATES)
    assert sorted((one.name, one.kind, one.node) for one in drawn.contacts) == sorted([
        ("left foot", "plane", None), ("journal", "sphere", "bore"), ("journal", "ball", "disc"),
        ("end", "limits", None), ("end", "pointer", "bore")], key=str)
    ground = of(drawn, "left foot", "plane").shape.points
    assert not np.any(ground[:, 2])
    way = ground[1] - ground[0]
    normal = np.array([-way[1], way[0], 0.0]) / np.linalg.norm(way)
    normal *= np.sign(normal[1])
    for name in ("left", "right"):
        away = np.pad(result[f"{name}.position"], ((0, 0), (0, 1))) - ground[0]
        np.testing.assert_allclose(away @ normal, result[f"{name} foot.gap"], atol=1e-12)
        assert np.all((away @ way > 0) & (away @ way < way @ way))
    depth = (ground - ground[0]) @ normal
    assert depth.max() < 1e-12 and depth.min() < -1e-3
    for frame, state in enumerate(drawn.states):
        bore, disc = (vertices_of(of(drawn, "journal", kind), drawn.nodes, frame)
                      for kind in ("sphere", "ball"))
        middles = bore.mean(axis=0), disc[-1]
        sizes = (np.linalg.norm(points[0] - middle)
                 for points, middle in zip((bore, disc), middles, strict=True))
        apart = np.linalg.norm(middles[0] - middles[1])
        np.testing.assert_allclose(next(sizes) - next(sizes) - apart,
                                   result["journal.gap"][state], atol=1e-12)
        _, end = vertices_of(of(drawn, "end", "pointer"), drawn.nodes, frame) - [1.0, 0.3, 0.0]
        limit = of(drawn, "end", "limits")
        ray = limit.shape.points[limit.shape.lines[-1, 1]] - [1.0, 0.3, 0.0]
        found = np.arctan2(np.cross(ray, end)[2], ray @ end)
        assert found == pytest.approx(-result["end.gap"][state], abs=1e-9)


def test_the_page_holds_them(result, drawn, tmp_path):
    page = PageData(animate(result, tmp_path / "run.html").read_text())
    size, middle = page.header["size"], np.array(page.header["middle"])
    names = [node["name"] for node in page.header["nodes"]]
    assert len(page.header["contacts"]) == len(drawn.contacts)
    full = scenery(result, 1801)
    for found, exact in zip(page.header["contacts"], full.contacts, strict=True):
        points = page.values(found["points"]) * size
        if exact.node is None:
            assert found["node"] is None
            points = points + middle
        else:
            assert names[found["node"]] == exact.node
        np.testing.assert_allclose(points, exact.shape.points, atol=2e-6 * size)
        for kind in ("lines", "triangles"):
            np.testing.assert_array_equal(page.indices(found[kind]),
                                          getattr(exact.shape, kind).ravel())


PLACES = """(() => {
    const { scene, motion } = page;
    motion.seek(motion.t[%d] + 1e-9);
    scene.update();
    return JSON.stringify(scene.contacts.all.map((one) => {
        const { axes, origin } = scene.contacts.placeOf(one), found = [];
        for (let k = 0; k < one.points.length; k += 3) {
            found.push(add(origin, combine(axes, one.points.subarray(k, k + 3))));
        }
        return found;
    }));
})()"""


@pytest.mark.skipif(browser.COMMAND is None, reason="no Chromium is installed")
def test_the_page_moves_and_hides_them(result, tmp_path):
    chrome = browser.Browser(tmp_path / "profile", 900, 640)
    try:
        chrome.open(animate(result, tmp_path / "run.html"))
        size, middle = chrome.value("page.header.size"), chrome.value("page.header.middle")
        full = scenery(result, 1801)
        for frame in (0, 150):
            for found, one in zip(json.loads(chrome.value(PLACES % frame)), full.contacts,
                                  strict=True):
                # four numbers of a quaternion are off by half of 2 / 65535 each
                np.testing.assert_allclose(
                    np.array(found) * size + middle, vertices_of(one, full.nodes, frame),
                    atol=8e-5 * max(size, np.abs(one.shape.points).max()), err_msg=one.name)
        pictures = []
        for _ in range(3):
            chrome.value("new Promise(done => requestAnimationFrame(() => "
                         "requestAnimationFrame(done)))")
            pictures.append(chrome.picture()[60:480, :620])
            chrome.value("(() => { page.pause(); document.getElementById('contacts').click(); })()")
        assert np.mean(np.abs(pictures[1] - pictures[2]).max(axis=2) > 8) > 0.01
        assert chrome.errors == []
    finally:
        chrome.close()


def test_films_show_them_behind_bodies(drawn, monkeypatch):
    """Much of the picture changes with them, but nothing within an opaque body."""
    def picture():
        return next(film.pictures(drawn, "", [3], None)).astype(int)

    def differ(one, other):
        return np.abs(one - other).max(axis=2) > 3

    monkeypatch.setattr(film, "CLEAR", 1.0)
    whole = picture()
    monkeypatch.setattr(film_marks.Marks, "_draw_contacts", lambda self, frame: None)
    bare = picture()
    monkeypatch.setattr(film._Bodies, "solids", lambda self, frame: [])
    seen, bodies = differ(whole, bare), binary_erosion(differ(picture(), bare), iterations=2)
    assert seen.mean() > 0.05 and bodies.mean() > 0.02
    # single pixels of seams between faces, which matplotlib smooths, let through what is behind
    assert (seen & bodies).sum() < 1e-3 * bodies.sum()


def test_pictures_of_paths_show_them(result, tmp_path, monkeypatch):
    figures = []
    monkeypatch.setattr(Figure, "savefig", lambda figure, file, **_: figures.append(figure))
    save_picture(result, tmp_path / "run.png", "cradle", "ball")
    lines = {one.get_label(): one for one in figures[0].axes[1].lines}
    x, y, z = (np.asarray(values, float) for values in lines["contact surfaces"].get_data_3d())
    known = scenery(result, STATES)
    balls = [one for one in known.contacts if one.kind == "ball"]
    assert len(balls) == 3
    seen = np.column_stack([x, y, z])[np.isfinite(x)]
    for one in balls:
        drawn = vertices_of(one, known.nodes, 0)[np.unique(one.shape.lines)]
        assert np.linalg.norm(seen[:, None] - drawn, axis=2).min(axis=0).max() < 1e-9
