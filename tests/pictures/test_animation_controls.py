"""Controls of an animation's page, in a browser without a network."""

import re

import numpy as np
import pytest
from animated_pages import changes, choose, chromium, go, model_of, text

from sebody import Model, simulate
from sebody.pictures.curves import values
from sebody.results import animate


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
