"""Plots as users ask for them, in Python and on the command line."""

import numpy as np
import pytest

from sebody import InputError, simulate
from sebody.cli.entry import main
from sebody.pictures import drawing
from sebody.results import plot
from sebody.scenes import hinged_beam, squeezer


@pytest.fixture(scope="module")
def beam():
    return simulate(hinged_beam.build(modes=2, elements=4).model, 0.01, 1.0)


@pytest.fixture
def saved(beam, tmp_path):
    return str(beam.save(tmp_path / "beam.npz"))


def titles(figure):
    return [axes.get_title(loc="left") for axes in figure.axes]


def test_an_overview(beam):
    figure = plot(beam)
    assert titles(figure) == ["tip.position", "tip.angular_velocity", "energy",
                              "revolute at base.force"]
    lines = figure.axes[0].lines
    assert [line.get_label() for line in lines] == ["x", "y", "z"]
    assert np.array_equal(lines[1].get_ydata(), beam["tip.position"][:, 1])


def test_an_overview_of_a_mechanism():
    figure = plot(simulate(squeezer.build().model, 1e-5, 2e-4))
    assert titles(figure)[2] == "energy" and len(figure.axes) == 4


@pytest.mark.parametrize("suffix, start", [("png", b"\x89PNG"), ("svg", b"<?xml"),
                                           ("pdf", b"%PDF")])
def test_files(beam, tmp_path, suffix, start):
    path = tmp_path / f"picture.{suffix}"
    plot(beam, "tip.position.x:y", "beam.forces", output=path)
    assert path.read_bytes().startswith(start)


def test_results_are_told_apart(beam):
    figure = plot({"one": beam, "other": beam}, "tip.position.x", "energy.kinetic")
    assert [text.get_text() for text in figure.legends[0].get_texts()] == ["one", "other"]
    first, second = figure.axes[0].lines        # which would hide the first if it were not dashed
    assert (first.get_linestyle(), second.get_linestyle()) == ("-", "--")
    assert titles(plot([beam, beam], "energy.strain")) == ["energy.strain"]


def test_the_command(saved, tmp_path, capsys):
    picture = tmp_path / "picture.png"
    assert main(["plot", saved, "tip.velocity.norm", "energy", "--output", str(picture)]) == 0
    assert capsys.readouterr().out == f"picture: {picture}\n"
    assert picture.read_bytes().startswith(b"\x89PNG")
    assert main(["list", saved]) == 0
    assert {"tip.position", "beam.modes"} <= set(capsys.readouterr().out.split())


def test_files_are_compared(beam, saved, tmp_path, monkeypatch):
    other = str(beam.save(tmp_path / "other.npz"))
    drawn, draw = [], drawing.draw
    monkeypatch.setattr(drawing, "draw", lambda *given: drawn.append(given) or draw(*given))
    assert main(["plot", saved, other, "energy.kinetic", "--output",
                 str(tmp_path / "a.png")]) == 0
    (panel,), compared = drawn[0]
    assert compared and [curve.label for curve in panel.curves] == ["beam", "other"]


@pytest.mark.parametrize("arguments, said", [
    (["tip.positon"], "did you mean 'tip.position'"),
    (["none.npz"], "results file none.npz does not exist"),
    (["{saved}"], "one is given twice")])
def test_what_is_refused_leaves_the_older_file(arguments, said, saved, tmp_path, capsys):
    picture = tmp_path / "picture.png"
    picture.write_text("older")
    words = [word.format(saved=saved) for word in arguments]
    assert main(["plot", saved, *words, "--output", str(picture)]) == 2
    assert said in capsys.readouterr().err
    assert picture.read_text() == "older"


@pytest.mark.parametrize("given, said", [
    ((), "results is empty"), ((3,), "result 1 is 3: give the Result of a run"),
    ({"": None}, "label of a result is '': give a text")])
def test_what_is_no_result(given, said):
    with pytest.raises(InputError, match=said):
        plot(given)


def test_other_endings(beam, tmp_path):
    with pytest.raises(InputError, match="picture .*a.gif must end in .png"):
        plot(beam, output=tmp_path / "a.gif")
