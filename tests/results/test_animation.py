"""Animations: the page in a browser without a network, films, and what is refused."""

import json
import os
import re

import browser
import numpy as np
import pytest

from sebody import InputError, Model, Result, simulate
from sebody.cli.entry import main
from sebody.results import animate, film
from sebody.results.scenery import scenery, vertices
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
    one = browser.Browser(folder / "profile")
    yield one
    one.close()


def go(chrome, part):
    """Stop at a part of the duration, and the picture there."""
    chrome.value(f"(() => {{ const time = document.getElementById('time'); time.value = "
                 f"{100000 * part}; time.dispatchEvent(new Event('input')); }})()")
    chrome.value("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))")
    return chrome.picture()


def model_of(picture):
    """The part of the picture that shows the model, not the panel, the legend or the plot."""
    return picture[60:300, 170:450]


@chromium
def test_the_page_of_a_minute(beam, folder, chrome):
    path = animate(beam, folder / "beam.html", title="a beam <&> 'hinge'")
    assert path.stat().st_size < LIMIT
    assert chrome.open(path) < OPENED
    one, other = (model_of(go(chrome, part)) for part in (0.05, 0.11))
    assert np.mean(np.abs(one - other).max(axis=2) > 30) > 0.002
    assert chrome.value("document.querySelector('h1').textContent") == "a beam <&> 'hinge'"
    assert chrome.errors == []


@chromium
def test_the_page_moves_as_the_model_does(beam, folder, chrome):
    """Vertices that the page computes against those of the result, enlarged and not."""
    chrome.open(animate(beam, folder / "beam.html"))
    drawn = scenery(beam, 1801)
    size = np.linalg.norm([100.0, 100.0])
    for k, scale in ((0, 1.0), (777, 1.0), (90, 40.0)):
        found = json.loads(chrome.value(f"""(() => {{
            const header = JSON.parse(document.getElementById("header").textContent);
            const motion = new Motion(header, new Numbers(
                document.getElementById("numbers").textContent));
            motion.seek(motion.t[{k}] + 1e-6);
            const body = motion.bodies[0], count = body.stations.length;
            const local = new Float32Array(3 * count);
            motion.deform(body, {scale}, local, new Float32Array(count), "displacement");
            const {{ origin, axes }} = motion.placeOf(body), found = [];
            for (let v = 0; v < count; v++) {{
                found.push(add(origin, combine(axes, local.subarray(3 * v, 3 * v + 3))));
            }}
            return JSON.stringify(found);
        }})()"""))
        exact = vertices(drawn.bodies[0], k, scale)
        places = np.concatenate([node.position for node in drawn.nodes.values()])
        middle = (places.min(axis=0) + places.max(axis=0)) / 2
        assert np.abs(np.array(found) * size + middle - exact).max() < NEAR * scale * size


@chromium
def test_controls(beam, folder, chrome):
    chrome.open(animate(beam, folder / "beam.html", "energy", speed=5.0))
    before = go(chrome, 0.06)
    options = chrome.value("[...document.getElementById('quantity').options].map(o => o.text)")
    assert options == ["energy"]
    assert chrome.value("document.getElementById('speed').selectedOptions[0].text") == "5 / s"
    for control, value, event in (("scale", "40", "input"), ("colour", "'none'", "change"),
                                  ("trace", "''", "change")):
        chrome.value(f"(() => {{ const one = document.getElementById('{control}'); one.value = "
                     f"{value}; one.dispatchEvent(new Event('{event}')); }})()")
        after = go(chrome, 0.06)
        assert np.abs(model_of(after) - model_of(before)).max() > 30, control
        before = after
    for name in ("joints", "nodes", "names", "frames", "mesh", "ground"):
        chrome.value(f"document.getElementById('{name}').click()")
    before = go(chrome, 0.06)
    for kind, x in (("mousePressed", 250), ("mouseMoved", 320), ("mouseReleased", 320)):
        chrome.call("Input.dispatchMouseEvent", type=kind, x=x, y=200, button="left", buttons=1,
                    clickCount=1)
    assert np.abs(model_of(go(chrome, 0.06)) - model_of(before)).max() > 30
    chrome.value("document.getElementById('play').click()")
    start = chrome.value("document.getElementById('now').textContent")
    chrome.wait(f"document.getElementById('now').textContent !== '{start}'")
    assert chrome.errors == []


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
    model.superelement("arm", body, ["n0", "n1", "n2"], inertia="b")
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
def test_without_webgl(beam, folder, chrome):
    path = animate(beam, folder / "beam.html")
    path.write_text(path.read_text().replace('getContext("webgl2"', 'getContext("webgl9"'))
    chrome.call("Page.navigate", url=path.as_uri())
    chrome.wait("document.getElementById('failure')?.hidden === false")
    said = chrome.value("document.getElementById('failure').textContent")
    assert said == ("The animation cannot be shown: this browser offers no WebGL 2, which draws "
                    "the model.")
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
    with pytest.raises(InputError, match="a film shows no plots, such as of tip.position"):
        animate(beam, tmp_path / "a.gif", "tip.position")
    assert older.read_text() == "older" and len(list(tmp_path.iterdir())) == 1


def test_results_of_one_state(tmp_path):
    result = simulate(hinged_beam.build(modes=2, elements=4).model, 0.01, 0.0)
    for name in ("a.html", "a.gif"):
        with pytest.raises(InputError, match="holds 1 recorded state, which make"):
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
    for arguments, said in ((["none.npz"], "none.npz does not exist"),
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


