"""Films, the command, and animations that are refused."""

import os

import numpy as np
import pytest
from page_data import PageData

from sebody import InputError, simulate
from sebody.cli.entry import main
from sebody.pictures import film
from sebody.pictures.scene import scenery
from sebody.results import animate
from sebody.scenes import hinged_beam, squeezer


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
    now = bodies.add_legend(figure, 1.0, True)
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
