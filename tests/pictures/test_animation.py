"""The page of an animation in a browser without a network: it moves as the model does."""

import json
import re

import numpy as np
import pytest
from animated_pages import changes, choose, chromium, go, model_of, text
from page_data import PageData

from sebody import Model, simulate
from sebody.pictures.drawn_bodies import vertices
from sebody.pictures.scene import scenery
from sebody.results import animate
from sebody.scenes import squeezer

LIMIT = 1.5e6           # bytes of the page of a minute
OPENED = 2.0            # seconds
# of the extent: places and the four numbers of a quaternion are off by half of 2 / 65535 each
NEAR = 8e-5


@chromium
def test_the_page_of_a_minute(beam, folder, chrome):
    path = animate(beam, folder / "beam.html", title="a beam <&> 'hinge'")
    assert path.stat().st_size < LIMIT
    assert chrome.open(path) < OPENED
    one, other = (go(chrome, part) for part in (0.05, 0.11))
    assert changes(one, other) > 0.002
    assert chrome.value("document.querySelector('h1').textContent") == "a beam <&> 'hinge'"
    assert chrome.errors == []


VERTICES = """(() => {
    const { scene, motion } = page, found = {};
    motion.seek(motion.t[%d] + 1e-6);
    scene.shown.scale = %g;
    scene.update();
    scene.bodies.forEach((body, k) => { found[body.name] = Array.from(
        { length: body.size }, (_, v) => scene.vertex(k, v)); });
    return JSON.stringify(found);
})()"""


@chromium
def test_the_page_moves_as_the_model_does(beam, folder, chrome):
    """Vertices that the page computes against those of the result, enlarged and not."""
    path = animate(beam, folder / "beam.html")
    data = PageData(path.read_text()).header
    chrome.open(path)
    drawn = scenery(beam, 1801)
    for k, scale in ((0, 1.0), (777, 1.0), (90, 40.0)):
        found = json.loads(chrome.value(VERTICES % (k, scale)))["beam"]
        exact = vertices(drawn.bodies[0], k, scale)
        found = np.array(found) * data["size"] + data["middle"]
        assert np.abs(found - exact).max() < NEAR * scale * data["size"]


@chromium
def test_the_beam_stays_at_its_hinge(beam, folder, chrome):
    """However much its deformation is enlarged; measured from the frame it leaves the hinge."""
    chrome.open(animate(beam, folder / "beam.html"))
    size = np.hypot(100.0, 100.0)
    ends = {}
    for reference in ("default", "frame"):
        choose(chrome, "reference", reference)
        found = np.array(json.loads(chrome.value(VERTICES % (67, 50.0)))["beam"])
        middle = np.array(chrome.value("page.header.middle")) / size
        # the outline has four corners, the first four vertices of the first end
        ends[reference] = np.linalg.norm(found + middle, axis=1).min()
    half = np.hypot(2.0, 2.0) / size        # half the diagonal of the section
    assert ends["default"] < 2 * half < 0.1 < ends["frame"]


VALUES = """(() => {
    const { scene, motion, legend } = page;
    motion.seek(motion.t[%d] + 1e-9);
    scene.update();
    return JSON.stringify(scene.bodies.map((body) => [body.name, Array.from(body.values),
        Array.from(body.values, (_, v) => body.label(v))]));
})()"""


@chromium
@pytest.mark.parametrize("reference", ["default", "frame", "elbow", "fore 1"])
def test_displacements_of_the_page(reference, arm, folder, chrome):
    """At FE nodes against the fields of the result, also where the reference is another body's."""
    chrome.open(animate(arm, folder / "arm.html"))
    nodes = chrome.value("page.header.nodes.map((node) => node.name)")
    choose(chrome, "reference", nodes.index(reference) if reference in nodes else reference)
    for k in (30, 90):
        for name, found, labels in json.loads(chrome.value(VALUES % k)):
            if name == "bob":
                assert max(found) < -1e29       # rigid: it has no displacement
                continue
            field = arm.field(name)
            has = {"elbow": "upper", "fore 1": "fore"}.get(reference, "")
            given = reference if reference == "frame" or (has and name.startswith(has)) else None
            exact = np.linalg.norm(field.displacement(k, reference=given), axis=1)
            found, labels = np.array(found), np.array(labels)
            seen = labels > 0
            # steps of shapes and amplitudes, which are larger seen from the frame
            near = 3e-4 * max(exact.max(), np.abs(field.displacement(k, reference="frame")).max())
            assert np.abs(found[seen] - exact[labels[seen] - 1]).max() < near, (name, k)
            assert np.unique(labels[seen]).tolist() == list(range(1, field.count + 1))
    peak = text(chrome, "peak")
    assert re.fullmatch(r"largest [\d.e-]+ at t = [\d.]+, node \d of \w+ \d", peak), peak
    assert chrome.errors == []


@chromium
def test_an_enlarged_mechanism_stays_together(arm, folder, chrome):
    """Bodies are drawn at the nodes that they share with others, and these at their bearings."""
    chrome.open(animate(arm, folder / "arm.html"))
    found = json.loads(chrome.value("""(() => {
        const { scene, motion } = page, { bodies, references } = scene;
        motion.seek(motion.t[80]);
        scene.shown.scale = 300;
        scene.update();
        return JSON.stringify({ held: bodies.flatMap((body, k) => body.rigid ? [] : body.held.map(
            (held) => {
                const still = scene.stills[k], { axes, origin } = scene.places[k];
                const { place } = body.at(held, scene.amplitudes[k]);
                const rest = add(combine(still.E, held.point), still.shift);
                const local = add(rest, times(300, subtract(place, rest)));
                return [motion.nodes[held.node].name, add(origin, combine(axes, local)),
                        scene.place(held.node), motion.position(held.node)];
            })), bob: scene.places.at(-1).origin, tip: scene.place(
                motion.nodes.findIndex((node) => node.name === "tip")) });
    })()"""))
    for name, drawn, place, true in found["held"]:
        assert np.linalg.norm(np.subtract(drawn, place)) < 1e-5, name
        moved = np.linalg.norm(np.subtract(drawn, true))
        assert (moved < 1e-5) == (name == "base"), (name, moved)
    assert np.linalg.norm(np.subtract(found["bob"], found["tip"])) < 1e-5


@chromium
def test_both_supports_of_an_enlarged_beam_stay(folder, chrome):
    """Of a beam between two hinges the body leaves one of them, but no sign leaves the ground."""
    from sebody.fem import tube

    model = Model()
    ends = model.node("left", (0, 0, 0)), model.node("right", (3, 0, 1))
    model.beam("beam", ends, tube(0.05, 0.01, 2.1e11, 0.3, 7800.0), elements=6, bodies=3)
    model.revolute("left", axis=(0, 1, 0))
    model.spherical("right")
    model.gravity((0, 0, -9.81))
    chrome.open(animate(simulate(model, 1e-3, 0.02), folder / "beam.html"))
    found = json.loads(chrome.value("""(() => {
        const { scene, motion } = page;
        motion.seek(motion.t[20]);
        scene.shown.scale = 1000;
        scene.update();
        return JSON.stringify(motion.nodes.filter((node) => !node.ground).map(
            (node) => { const k = motion.nodes.indexOf(node);
                        return [node.name, length(subtract(scene.place(k), motion.position(k)))];
                      }));
    })()"""))
    moved = dict(found)
    assert moved["left"] == moved["right"] == 0.0
    assert min(moved["beam 1"], moved["beam 2"]) > 1e-3


def matrices_alone():
    """Two bodies of reduced matrices, one of three nodes, small and far from the origin."""
    from sebody.fem import rectangle, straight_beam
    from sebody.reduction import ReducedBody, craig_bampton

    start = np.array([5e3, -2e3, 1e3])
    section = rectangle(1e-4, 2e-4, 2e11, 0.3, 7800)
    fe_model = straight_beam(start, start + [0.01, 0.0, 0.005], section, 4)
    body = craig_bampton(fe_model, [(0, "full"), (2, "translation"), (4, "full")], 0)
    body = ReducedBody(body.stiffness, body.mass, body.coordinates, body.keeps, body.modes)
    model = Model()
    for k, place in enumerate((0, 2, 4)):
        model.node(f"n{k}", fe_model.coordinates[place], "translation" if k == 1 else "full")
    model.superelement("arm", body, ["n0", "n1", "n2"], inertia="material")
    model.revolute("n0", axis=(0, 1, 0))
    model.gravity((0, 0, -9.81))
    return simulate(model, 1e-4, 0.02)


@chromium
@pytest.mark.parametrize("make", [
    lambda: simulate(squeezer.build().model, 3e-5, 0.015), matrices_alone],
    ids=["mechanism", "matrices alone"])
def test_other_models(make, folder, chrome):
    chrome.open(animate(make(), folder / "other.html"))
    one, other = (model_of(go(chrome, part)) for part in (0.0, 1.0))
    assert np.mean(np.abs(one - other).max(axis=2) > 30) > 0.002
    assert chrome.errors == []


@chromium
@pytest.mark.parametrize("known, said", [
    ('getContext("webgl2"', "this browser offers no WebGL 2, which draws the model"),
    ("window.DecompressionStream", "this browser is too old to unpack the data")])
def test_browsers_that_cannot_show_it(known, said, beam, folder, chrome):
    path = animate(beam, folder / "beam.html")
    text = path.read_text()
    assert known in text
    path.write_text(text.replace(known, known.replace("2", "9").replace("Stream", "River")))
    chrome.call("Page.navigate", url=path.as_uri())
    chrome.wait("document.getElementById('failure')?.hidden === false")
    shown = chrome.value("document.getElementById('failure').textContent")
    assert shown == f"The animation cannot be shown: {said}."
    chrome.errors.clear()


def test_a_page_needs_nothing_else(beam, folder):
    text = animate(beam, folder / "beam.html").read_text()
    assert not re.search(r"(src|href)\s*=|https?://|import\s*\(|fetch\(|{{", text)
