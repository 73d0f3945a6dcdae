"""The report of a run, and what notebooks show."""

import re

import browser
import numpy as np
import pytest

from sebody import InputError, Model, Result, SimulationError, simulate
from sebody.cli.entry import main
from sebody.results import report
from sebody.scenes import four_bar, hinged_beam


@pytest.fixture(scope="module")
def saved(tmp_path_factory):
    path = tmp_path_factory.mktemp("report") / "bar.npz"
    return simulate(four_bar.build().model, 1e-3, 0.5).save(path)


def sections(text):
    """The page's own text by the names of its sections, the animation left out."""
    plain = re.sub(r'srcdoc="[^"]*"', "", text)
    found = re.findall(r'<section id="(\w+)">(.*?)</section>', plain, re.S)
    return {name: re.sub(r"<[^>]+>", " ", content) for name, content in found}


def test_the_page(saved, tmp_path):
    result = Result.load(saved)
    path = report(result, tmp_path / "bar.html", "B0.position.x:y", "energy", title="four <bars>")
    text = path.read_text()
    found = sections(text)
    assert list(found) == ["audit", "warnings", "animation", "plots", "unknowns", "model", "run"]
    assert "<h1>four &lt;bars&gt;</h1>" in text
    assert found["audit"].count("good") == 6
    assert "None." in found["warnings"]
    counts = re.findall(r"<td>([^<]*)</td><td>(\d+)</td>", text.partition('id="unknowns"')[2]
                        .partition("</section>")[0])
    assert sum(int(count) for _, count in counts) == result.numbering.free
    assert "multipliers of spherical at end 0" in dict(counts)
    for name in (*result.model.nodes, *result.model.rigid_bodies):
        assert name in found["model"]
    assert "iterations per step" in found["run"]
    outside = re.sub(r'src="data:[^"]*"|srcdoc="[^"]*"', "", text)
    assert not re.search(r"(src|href)\s*=|https?://|{{", outside)


@pytest.mark.skipif(browser.COMMAND is None, reason="no Chromium is installed")
def test_the_page_in_a_browser(saved, tmp_path):
    path = report(Result.load(saved), tmp_path / "bar.html")
    chrome = browser.Browser(tmp_path / "profile")
    try:
        chrome.call("Page.navigate", url=path.as_uri())
        chrome.wait("document.querySelector('iframe')?.contentDocument?.body?.dataset.drawn")
        assert chrome.value("document.querySelector('#plots img').naturalWidth") > 300
        assert chrome.errors == []
    finally:
        chrome.close()


def test_runs_that_failed_or_warned(tmp_path):
    model = Model(planar=True)
    model.point_mass("ball", model.node("ball", (1.0, 0.0), keeps="translation"), 1.0)

    def broken(t, positions, velocities, force):
        force[0] = -positions[0] if t < 0.3 else np.nan
    model.user_force("broken", ["ball"], broken)
    with pytest.raises(SimulationError) as caught:
        simulate(model, 0.01, 1.0)
    text = report(caught.value.result, tmp_path / "failed.html").read_text()
    found = sections(text)
    assert "bad" in found["audit"] and "ended at t = 0.29" in found["audit"]
    assert "broken" in found["warnings"]


def test_the_command(saved, tmp_path, capsys):
    path = tmp_path / "bar.html"
    assert main(["report", str(saved), "B0.position", "--output", str(path)]) == 0
    assert capsys.readouterr().out == f"report: {path}\n"
    before = path.read_text()
    for arguments, said in (([str(saved), "B0.positio"], "did you mean 'B0.position'"),
                            (["none.npz"], "none.npz does not exist")):
        assert main(["report", *arguments, "--output", str(path)]) == 2
        assert said in capsys.readouterr().err
    assert main(["report", str(saved), "--output", "report.pdf"]) == 2
    assert "report report.pdf must end in .html" in capsys.readouterr().err
    assert path.read_text() == before


def test_results_of_one_state(tmp_path):
    result = simulate(hinged_beam.build(modes=2, elements=4).model, 0.01, 0.0)
    with pytest.raises(InputError, match="holds the state at t = 0 alone"):
        report(result, tmp_path / "a.html")
    assert not list(tmp_path.iterdir())


def test_notebooks_show_models_and_results():
    scene = hinged_beam.build(modes=2, elements=4)
    scene.model.node("<odd>", (1.0, 2.0, 3.0), keeps="translation")
    scene.model.fix("<odd>", "position")
    text = scene.model._repr_html_()
    assert "spatial model: 1 superelement, 3 nodes, 1 joint, 1 load" in text
    assert "&lt;odd&gt;" in text and "<odd>" not in text
    assert re.search(r"<td>base</td><td>\(0, 0, 0\)</td><td>fixed</td><td>3 unknowns</td>", text)
    result = simulate(hinged_beam.build(modes=2, elements=4).model, 0.01, 0.1)
    rows = dict(re.findall(r"<tr><td>([^<]*)</td><td>([^<]*)</td></tr>", result._repr_html_()))
    assert rows["unknowns"] == str(result.numbering.free)
    assert rows["steps"].startswith("10 (0 rejected)")
    assert Model()._repr_html_() == "<p>spatial model: empty</p>"
