"""Animations: the page in a browser without a network, films, and what is refused."""

import json
import os
import re

import browser
import moving_arm
import numpy as np
import pytest
from page_data import PageData

from sebody import InputError, Model, Result, simulate
from sebody.cli.entry import main
from sebody.pictures import film
from sebody.pictures.curves import values
from sebody.pictures.drawn_bodies import vertices
from sebody.pictures.scene import scenery
from sebody.results import animate
from sebody.scenes import hinged_beam, squeezer

LIMIT = 1.5e6           # bytes of the page of a minute
OPENED = 2.0            # seconds
# of the extent: places and the four numbers of a quaternion are off by half of 2 / 65535 each
NEAR = 8e-5

chromium = pytest.mark.skipif(browser.COMMAND is None, reason="no Chromium is installed")


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("animations")


@pytest.fixture(scope="module")
def beam(folder):
    """A minute, from the file alone."""
    scene = hinged_beam.build()
    simulate(scene.model, 0.01, 60.0).save(folder / "beam.npz")
    return Result.load(folder / "beam.npz")


@pytest.fixture(scope="module")
def chrome(folder):
    one = browser.Browser(folder / "profile", 900, 640)
    yield one
    one.close()


def go(chrome, part):
    """Stop at a part of the duration, and the picture there."""
    chrome.value(f"(() => {{ const time = document.getElementById('time'); time.value = "
                 f"{100000 * part}; time.dispatchEvent(new Event('input')); }})()")
    chrome.value("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))")
    return chrome.picture()


def choose(chrome, control, value):
    """Set a control to a value."""
    chrome.value(f"(() => {{ const one = document.getElementById('{control}'); one.value = "
                 f"{json.dumps(value)}; one.dispatchEvent(new Event('input')); "
                 "one.dispatchEvent(new Event('change')); })()")


def text(chrome, name):
    return chrome.value(f"document.getElementById('{name}').innerText")


def model_of(picture):
    """The part of the picture that shows the model, not the panel, the legend or the plot."""
    return picture[60:300, 290:630]


def changes(one, other):
    return np.mean(np.abs(model_of(one) - model_of(other)).max(axis=2) > 30)


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


@pytest.fixture(scope="module")
def arm():
    return moving_arm.run()


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
def test_controls(beam, folder, chrome):
    chrome.open(animate(beam, folder / "beam.html", "energy", speed=5.0))
    before = go(chrome, 0.06)
    owners = chrome.value("[...document.getElementById('owner').options].map(o => o.text)")
    assert owners[:3] == ["overview", "model", "base"]
    assert chrome.value("document.getElementById('speed').selectedOptions[0].text") == "5 / s"
    for control, value in (("scale", "40"), ("colour", "body"), ("trace", "")):
        choose(chrome, control, value)
        after = go(chrome, 0.06)
        assert np.abs(model_of(after) - model_of(before)).max() > 30, control
        before = after
    for name in ("joints", "nodes", "node-names", "body-names", "frames", "mesh", "grid",
                 "features"):
        chrome.value(f"document.getElementById('{name}').click()")
        after = go(chrome, 0.06)
        assert np.abs(after[:300] - before[:300]).max() > 8, name
        before = after
    for kind, x in (("mousePressed", 250), ("mouseMoved", 320), ("mouseReleased", 320)):
        chrome.call("Input.dispatchMouseEvent", type=kind, x=x, y=200, button="left", buttons=1,
                    clickCount=1)
    assert np.abs(model_of(go(chrome, 0.06)) - model_of(before)).max() > 30
    chrome.value("document.getElementById('play').click()")
    start = text(chrome, "now")
    chrome.wait(f"document.getElementById('now').textContent !== '{start}'")
    assert chrome.errors == []


@chromium
def test_any_quantity_is_plotted(arm, folder, chrome):
    """Chosen by what it is of and by its name; drawn as the values of the result."""
    chrome.open(animate(arm, folder / "arm.html"))
    before = go(chrome, 0.5)
    for owner, quantity, name in (("gust", "force", "gust.force"), ("fore 2", "modes",
                                                                    "fore 2.modes"),
                                  ("model", "energy", "energy")):
        choose(chrome, "owner", owner)
        offered = chrome.value("[...document.getElementById('quantity').options].map(o => o.text)")
        choose(chrome, "quantity", chrome.value(
            f"document.getElementById('quantity').options[{offered.index(quantity)}].value"))
        after = go(chrome, 0.5)
        assert np.abs(after[-130:] - before[-130:]).max() > 30
        before = after
        shown = np.array(chrome.value("Array.from(page.plot.values)")).reshape(101, -1)
        exact = values(arm, name).numbers
        assert np.abs(shown - exact).max() < 1e-4 * np.abs(exact).max(), name


@chromium
def test_the_legend(arm, folder, chrome):
    """Ticks in the range, unit, a range by hand, and the time of the largest value."""
    chrome.open(animate(arm, folder / "arm.html", colour="von_mises"))
    before = go(chrome, 0.7)
    assert text(chrome, "legend-name") == "von Mises stress"
    assert text(chrome, "legend-unit") == "[force/length^2]"
    largest = max(arm.field(name).envelope().largest for name in arm.model.bodies)
    high = float(chrome.value("document.getElementById('high').value"))
    assert high == pytest.approx(largest, rel=1e-3)
    ticks = chrome.value("[...document.querySelectorAll('#legend-ticks span')].map(s => "
                         "[Number(s.textContent), parseFloat(s.style.left) / 100])")
    assert len(ticks) >= 3
    for value, part in ticks:
        assert part == pytest.approx(value / largest, abs=2e-3) and 0 <= part <= 1
    choose(chrome, "high", str(high / 20))
    assert changes(go(chrome, 0.7), before) > 1e-4
    chrome.value("document.getElementById('auto').click()")
    assert changes(go(chrome, 0.7), before) == 0
    choose(chrome, "high", "-1")                    # no range: it stays as it was
    assert float(chrome.value("document.getElementById('high').value")) == high
    chrome.value("document.getElementById('peak').click()")
    chrome.value("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))")
    found = {name: arm.field(name).envelope() for name in arm.model.bodies}
    body = max(found, key=lambda name: found[name].largest)
    assert text(chrome, "now") == f"t = {found[body].time:g}"
    now = text(chrome, "now-largest")
    assert now.endswith(f"node {found[body].node} of {body}")
    assert float(now.split()[1].rstrip(",")) == pytest.approx(largest, rel=1e-3)
    choose(chrome, "colour", "body")
    assert chrome.value("document.getElementById('legend').hidden")


@chromium
def test_what_is_under_the_pointer(arm, folder, chrome):
    """The value at a vertex against the field, and a node with its joint and load."""
    chrome.open(animate(arm, folder / "arm.html", colour="displacement"))
    go(chrome, 0.9)
    x, y = chrome.value("""(() => {         // the middle of a triangle that is far from all nodes
        const { scene, motion } = page, { renderer } = scene;
        const k = scene.bodies.findIndex((body) => body.name === "fore 2");
        const nodes = motion.nodes.map((_, node) => renderer.pixel(scene.place(node)));
        const far = (at) => Math.min(...nodes.map(([x, y]) => Math.hypot(x - at[0], y - at[1])));
        const corner = Array.from(scene.bodies[k].triangles, (v) => scene.vertex(k, v));
        const middles = corner.filter((_, j) => j % 3 === 0).map((a, j) => renderer.pixel(
            times(1 / 3, add(a, add(corner[3 * j + 1], corner[3 * j + 2])))));
        return middles.reduce((one, at) => (far(at) > far(one) ? at : one));
    })()""")
    chrome.call("Input.dispatchMouseEvent", type="mouseMoved", x=x, y=y)
    said = text(chrome, "tip").splitlines()
    assert said[0] == "fore, fore 2" and re.fullmatch(r"displacement [\d.e-]+", said[1])
    field, place = arm.field("fore 2"), [float(number) for number in said[-1].split(", ")]
    nodes, lengths = field.position(90), np.linalg.norm(field.displacement(90), axis=1)
    along = nodes[-1] - nodes[0]
    part = (nodes - nodes[0]) @ along / (along @ along)
    there = (np.array(place) - nodes[0]) @ along / (along @ along)
    # between two FE nodes the deflection is nearly linear
    assert float(said[1].split()[1]) == pytest.approx(np.interp(there, part, lengths), rel=0.05)
    x, y = chrome.value("page.scene.renderer.pixel(page.scene.place("
                        "page.header.nodes.findIndex((node) => node.name === 'tip')))")
    chrome.call("Input.dispatchMouseEvent", type="mouseMoved", x=x, y=y)
    said = text(chrome, "tip").splitlines()
    assert said[0] in ("tip", "bob") and "spherical: ball" in said
    place = np.array([float(number) for number in said[1].split(", ")])
    np.testing.assert_allclose(place, arm[f"{said[0]}.position"][90], atol=1e-3)
    if said[0] == "tip":
        assert "force: gust, 30" in said
    chrome.call("Input.dispatchMouseEvent", type="mouseMoved", x=300, y=65)
    assert chrome.value("document.getElementById('tip').hidden")


@chromium
def test_bodies_one_by_one(arm, folder, chrome):
    """Hidden, shown and coloured; joints are seen through rigid bodies."""
    chrome.open(animate(arm, folder / "arm.html", colour="body"))
    shown = go(chrome, 0.5)
    names = chrome.value("[...document.querySelectorAll('#list label')].map(l => l.textContent)")
    assert names == ["upper", "fore", "bob"]
    for k in range(3):
        row = f"document.querySelectorAll('#list label')[{k}]"
        chrome.value(f"{row}.querySelector('[type=checkbox]').click()")
        hidden = go(chrome, 0.5)
        assert changes(hidden, shown) > 1e-3, names[k]
        chrome.value(f"{row}.querySelector('[type=checkbox]').click()")
        assert changes(go(chrome, 0.5), shown) == 0
        chrome.value(f"(() => {{ const one = {row}.querySelector('[type=color]'); one.value = "
                     "'#00ff00'; one.dispatchEvent(new Event('input')); })()")
        assert changes(go(chrome, 0.5), shown) > 5e-4, names[k]
        shown = go(chrome, 0.5)
    for name in ("loads", "joints"):
        chrome.value(f"document.getElementById('{name}').click()")
        after = go(chrome, 0.5)
        assert changes(after, shown) > 2e-4, name
        shown = after


@chromium
def test_joints_are_seen_through_bodies(folder, chrome):
    """A joint in the middle of a rigid box, and one in the middle of a thick tube."""
    for make in (inside_a_box, inside_a_tube):
        chrome.open(animate(make(), folder / "inside.html", colour="body"))
        for name in ("nodes", "grid"):
            chrome.value(f"document.getElementById('{name}').click()")
        one = go(chrome, 0.0)
        chrome.value("document.getElementById('joints').click()")
        assert changes(one, go(chrome, 0.0)) > 5e-4, make


@chromium
def test_rigid_bodies_are_seen_through(folder, chrome):
    """The grid behind a box shows through it."""
    chrome.open(animate(inside_a_box(), folder / "inside.html"))
    for name in ("nodes", "joints", "features"):
        chrome.value(f"document.getElementById('{name}').click()")
    x, y = map(int, chrome.value("page.scene.renderer.pixel(page.scene.places[0].origin)"))
    shown = go(chrome, 0.0)[y - 25:y + 25, x - 25:x + 25]
    chrome.value("document.getElementById('grid').click()")
    hidden = go(chrome, 0.0)[y - 25:y + 25, x - 25:x + 25]
    assert 3 < np.abs(shown - hidden).max() < 60


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


def inside_a_box():
    model = Model()
    model.rigid_body("box", model.node("a", (0, 0, 0)), 2.0, [3.0, 2.0, 1.0])
    model.revolute("a", axis=(1, 2, 3))
    model.node("far", (0, 4, 1), "translation")
    model.point_mass("m", "far", 1.0)
    model.spring("far", "a", 10.0)
    model.gravity((0, 0, -1.0))
    return simulate(model, 0.01, 0.05)


def inside_a_tube():
    from sebody.fem import tube

    model = Model()
    for k in range(3):
        model.node(f"n{k}", (k, 0, 0))
    section = tube(0.3, 0.05, 2.1e11, 0.3, 7800.0)
    model.beam("left", ("n0", "n1"), section, elements=2, bodies=1)
    model.beam("right", ("n1", "n2"), section, elements=2, bodies=1)
    model.revolute("n1", axis=(0, 1, 0))
    model.gravity((0, 0, -9.81))
    return simulate(model, 1e-3, 0.01)


@chromium
def test_a_narrow_screen(arm, folder, chrome):
    """Nothing is wider than the screen, controls are within it, and the panel is out of the way."""
    path = animate(arm, folder / "arm.html")
    size = {"deviceScaleFactor": 1, "mobile": False}
    chrome.call("Emulation.setDeviceMetricsOverride", width=400, height=700, **size)
    try:
        chrome.open(path)
        assert chrome.value("document.scrollingElement.scrollWidth") <= 400
        assert not chrome.value("document.getElementById('panel').open")
        for closed in (True, False):
            if not closed:
                chrome.value("document.querySelector('#panel summary').click()")
            boxes = chrome.value(
                "[...document.querySelectorAll('button, select, input, summary, #legend')]"
                ".filter(e => e.checkVisibility()).map(e => [e.id, e.getBoundingClientRect()])"
                ".map(([id, b]) => [id, b.left, b.right, b.top, b.bottom])")
            for name, left, right, top, bottom in boxes:
                assert left >= 0 and right <= 400 and top >= 0 and bottom <= 700, name
        seen = {name for name, *_ in boxes}
        assert {"play", "time", "owner", "quantity", "colour", "reference"} <= seen
    finally:
        chrome.call("Emulation.setDeviceMetricsOverride", width=900, height=640, **size)


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


def test_films(folder):
    result = simulate(squeezer.build().model, 3e-5, 0.015)
    path = animate(result, folder / "film.gif", speed=0.05)
    from PIL import Image
    pictures = Image.open(path)
    assert (pictures.n_frames, pictures.size) == (round(0.015 / 0.05 * 15) + 1, (960, 540))
    shown = []
    for k in (0, pictures.n_frames - 1):
        pictures.seek(k)
        shown.append(np.asarray(pictures.convert("RGB")).astype(int))
    assert np.mean(np.abs(shown[0] - shown[1]).max(axis=2) > 30) > 0.01
    pytest.importorskip("imageio_ffmpeg")
    path = animate(result, folder / "film.mp4", speed=0.1)
    assert path.read_bytes()[4:8] == b"ftyp"


def test_films_with_values(arm, folder):
    """The bodies and the legend have the colours of the values; without, those of the bodies."""
    from PIL import Image

    from sebody.pictures.palette import MAP, rgb
    for colour in ("von_mises", "displacement"):
        pictures = Image.open(animate(arm, folder / "film.gif", speed=0.1, colour=colour))
        assert pictures.n_frames == 16
        pictures.seek(15)
        legend = np.asarray(pictures.convert("RGB"))[540 - 84 - 12:540 - 84, 29:278].astype(int)
        found = legend[6, np.linspace(1, 247, len(MAP)).astype(int)]
        exact = 255 * np.array([rgb(one) for one in MAP])
        # colours of a gif are shared by some columns of the bar
        assert np.abs(found - exact).max() < 16, colour
    frame = animate(arm, folder / "film.gif", speed=0.1, colour=colour, reference="frame")
    other = Image.open(frame)
    other.seek(15)
    assert np.any(np.asarray(other.convert("RGB")) != np.asarray(pictures.convert("RGB")))


def test_the_legend_of_a_film(arm):
    """Its ends, its words and its largest value are those of the field."""
    from matplotlib.figure import Figure

    drawn = scenery(arm, 201, stressed=True)
    bodies, figure = film._Bodies(drawn, "von_mises"), Figure()
    now = bodies.add_legend(figure)
    axes, = figure.axes
    largest = max((arm.field(name).envelope() for name in arm.model.bodies),
                  key=lambda one: one.largest)
    assert axes.get_title(loc="left") == "von Mises stress [force/length^2]"
    np.testing.assert_allclose(axes.get_xlim(), [0.0, largest.largest], rtol=1e-6)
    assert f"at t = {largest.time:g}" in axes.texts[0].get_text()
    solids = bodies.solids(int(np.argmin(np.abs(drawn.t - largest.time))))
    # where the stress is largest the colour is the last one of the map, hardly any green
    assert min(solid.colours[:, 1].min() for solid in solids[:4]) < 0.35
    assert bodies.most == pytest.approx(largest.largest, rel=1e-9) and now.get_text() == ""


@pytest.mark.parametrize("name, given, said", [
    ("a.avi", {}, "animation .*a.avi must end in .html, .gif, .mp4"),
    ("a.gif", {"speed": 0.01}, "the film has 90001 frames, more than 901: give a speed of at "),
    ("a.html", {"speed": 0}, "speed is 0: give a positive number"),
    ("none/a.html", {}, "folder .*none of the animation does not exist")])
def test_refused(name, given, said, beam, tmp_path):
    with pytest.raises(InputError, match=said):
        animate(beam, tmp_path / name, **given)
    assert not list(tmp_path.iterdir())


def test_quantities_that_there_are_not(beam, tmp_path):
    older = tmp_path / "a.html"
    older.write_text("older")
    with pytest.raises(InputError, match="did you mean 'tip.position'"):
        animate(beam, older, "tip.positon")
    with pytest.raises(InputError, match="a film cannot show plots, such as of tip.position"):
        animate(beam, tmp_path / "a.gif", "tip.position")
    assert older.read_text() == "older" and len(list(tmp_path.iterdir())) == 1


def test_results_of_one_state(tmp_path):
    result = simulate(hinged_beam.build(modes=2, elements=4).model, 0.01, 0.0)
    for name in ("a.html", "a.gif"):
        with pytest.raises(InputError, match="holds 1 recorded state, too few for"):
            animate(result, tmp_path / name)


def test_missing_packages(beam, tmp_path, monkeypatch):
    monkeypatch.setattr(film, "find_spec", lambda name: None)
    with pytest.raises(InputError, match=r'need imageio with ffmpeg: pip install "sebody\[film\]'):
        animate(beam, tmp_path / "a.mp4")


def test_the_command(beam, folder, tmp_path, capsys):
    page = tmp_path / "page.html"
    assert main(["animate", str(folder / "beam.npz"), "--output", str(page)]) == 0
    assert capsys.readouterr().out == f"animation: {page}\n"
    assert page.read_text().startswith("<!DOCTYPE html>")
    unknown = [str(folder / "beam.npz"), "tip.x"]
    assert main(["animate", str(folder / "beam.npz"), "--output", str(page), "--colour",
                 "von_mises", "--reference", "frame"]) == 0
    capsys.readouterr()
    header = PageData(page.read_text()).header
    assert header["colour"] == "von_mises" and header["bodies"][0]["reference"] is None
    colour = [str(folder / "beam.npz"), "--colour", "stress"]
    for arguments, said in ((["none.npz"], "none.npz does not exist"),
                            (colour, "colour 'stress' is unknown: use 'body', 'displacement'"),
                            (unknown, "'x' is unknown: a node has position")):
        assert main(["animate", *arguments, "--output", str(page)]) == 2
        assert said in capsys.readouterr().err
    assert page.read_text().startswith("<!DOCTYPE html>")


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write everywhere")
def test_a_folder_that_cannot_be_written(beam, tmp_path):
    tmp_path.chmod(0o500)
    with pytest.raises(InputError, match="cannot be written"):
        animate(beam, tmp_path / "a.html")
    tmp_path.chmod(0o700)


