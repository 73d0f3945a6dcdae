"""Pictures: what is drawn, by node and by kind of motion."""

import numpy as np
import pytest
from matplotlib.figure import Figure

from sebody import InputError, simulate
from sebody.results import plots as plot
from sebody.scenes import box, hinged_beam, spherical_beam_strong


@pytest.fixture
def drawn(monkeypatch):
    """Figures that were saved, still open."""
    figures = []
    save = Figure.savefig

    def keep(figure, *arguments, **options):
        figures.append(figure)
        save(figure, *arguments, **options)

    monkeypatch.setattr(Figure, "savefig", keep)
    return figures


def test_motion_in_a_plane(tmp_path, drawn):
    scene = hinged_beam.build(modes=0, elements=4)
    result = simulate(scene.model, 0.01, 1.0)
    path = plot.save_picture(result, tmp_path / "beam.png", scene.base, scene.tip)
    assert path.read_bytes().startswith(b"\x89PNG")
    rate, trace = drawn[0].axes
    assert (rate.get_xlabel(), rate.get_ylabel()) == ("time", "about z")
    assert rate.get_title(loc="left") == "angular velocity of the base"
    assert np.array_equal(rate.lines[0].get_ydata(), result["base.angular_velocity"][:, 2])
    assert np.array_equal(trace.lines[0].get_xydata(), result["tip.position"][:, :2])
    assert trace.name == "rectilinear"
    assert len(trace.lines) > plot.INSTANTS


def test_motion_in_space(tmp_path, drawn):
    scene = spherical_beam_strong.build()
    scene.model.rigid_velocity((0, 0, 0), (0.3, 1.0, 0.2))
    result = simulate(scene.model, scene.h, 0.5)
    plot.save_picture(result, tmp_path / "beam.svg", scene.base, scene.tip)
    rates, trace = drawn[0].axes
    assert [line.get_label() for line in rates.lines] == ["about x", "about y", "about z"]
    assert trace.name == "3d"


def test_base_without_rotation(tmp_path, drawn):
    scene = box.build()
    result = simulate(scene.model, scene.h, 10 * scene.h)
    plot.save_picture(result, tmp_path / "box.png", scene.base, scene.tip)
    assert drawn[0].axes[0].get_title(loc="left") == "velocity of the tip"


@pytest.mark.parametrize("name, message", [
    ("beam.txt", "beam.txt must end in .png, .pdf, .svg"),
    ("nowhere/beam.png", "folder .*nowhere of the picture does not exist: make it")])
def test_files_that_cannot_be_written(tmp_path, name, message):
    with pytest.raises(InputError, match=message):
        plot.check_picture(tmp_path / name)


def test_matplotlib_is_missing(tmp_path, monkeypatch):
    monkeypatch.setattr(plot, "find_spec", lambda name: None)
    with pytest.raises(InputError, match=r"need matplotlib: pip install sebody\[plot\]"):
        plot.check_picture(tmp_path / "beam.png")


def test_unknown_nodes(tmp_path):
    result = simulate(hinged_beam.build(modes=0, elements=4).model, 0.01, 0.02)
    with pytest.raises(InputError, match="'top.position' is unknown: nodes are base, tip"):
        plot.save_picture(result, tmp_path / "beam.png", "base", "top")


@pytest.mark.parametrize("turns, last", [(0.3, 0.3), (3.0, 1.0)])
def test_bodies_are_drawn_over_one_turn(turns, last):
    angle = np.linspace(0, 2 * np.pi * turns, 3001)
    chosen = plot._instants(np.column_stack([np.cos(angle), np.sin(angle)]))
    assert chosen[0] == 0
    assert angle[chosen[-1]] <= 2 * np.pi * last + 1e-9
    assert np.ptp(np.diff(angle[chosen])) < 0.01
