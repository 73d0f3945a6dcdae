"""Pictures: what is drawn, by node and by kind of motion."""

from itertools import pairwise

import numpy as np
import pytest
from matplotlib.figure import Figure

from sebody import InputError, simulate
from sebody.pictures import plots as plot
from sebody.pictures.wireframe import lines_of, neighbours
from sebody.scenes import box, heavy_top, hinged_beam, spherical_beam_strong, squeezer


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


def test_bodies_are_drawn_where_they_are(tmp_path, drawn):
    """Not a line from base to tip: the squeezer has no body there."""
    scene = squeezer.build()
    result = simulate(scene.model, scene.h, 5 * scene.h)
    plot.save_picture(result, tmp_path / "squeezer.png", scene.base, scene.tip)
    start = next(line for line in drawn[0].axes[1].lines if line.get_label().endswith("start"))
    # drawn one after the other, with a gap before each
    ends = start.get_xydata()[1:].reshape(-1, 3, 2)[:, :2].round(12).tolist()
    bodies = {"crank": ["pin"], "pin": ["point"], "frame": ["spring end", "frame end"],
              "lower arm": ["lower elbow"], "lower rod": ["lower end"],
              "upper arm": ["upper elbow"], "upper rod": ["upper end"]}
    points = {name: node.point.round(12).tolist() for name, node in scene.model.nodes.items()}
    expected = [[points[one], points[other]] for one, others in bodies.items() for other in others]
    assert sorted(ends) == sorted(expected)


def test_nodes_of_a_body_are_joined_to_their_neighbours():
    model = box.build().model
    points = {name: node.point for name, node in model.nodes.items()}
    along = [np.flatnonzero(points[one] != points[other]).tolist()
             for one, other in lines_of(model)]
    assert sorted(along) == [[0]] * 4 + [[1]] * 4 + [[2]] * 4
    divided = hinged_beam.build(modes=0, elements=4, bodies=4).model
    assert lines_of(divided) == [("base", "beam 1"), ("beam 1", "beam 2"), ("beam 2", "beam 3"),
                                 ("beam 3", "tip")]


@pytest.mark.parametrize("turn", [0.3, 1.2])
def test_relative_neighbours_do_not_depend_on_the_axes(turn):
    c, s = np.cos(turn), np.sin(turn)
    R = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]) @ np.array([[1, 0, 0], [0, c, -s], [0, s, c]])
    cube = np.array([[i, j, k] for i in (0, 1) for j in (0, 1) for k in (0, 1)], dtype=float)
    assert neighbours(1e-3 * cube @ R.T + 5.0) == [
        (i, j) for i in range(8) for j in range(i + 1, 8) if bin(i ^ j).count("1") == 1]


def test_labels_of_ticks_do_not_collide(tmp_path, drawn):
    """In space, and in a plane with long numbers."""
    for scene, steps in ((heavy_top.build(), 2000), (squeezer.build(), 500)):
        result = simulate(scene.model, scene.h, steps * scene.h)
        plot.save_picture(result, tmp_path / "a.png", scene.base, scene.tip)
        axes = drawn[-1].axes[1]
        renderer = drawn[-1].canvas.get_renderer()
        for name in "xyz"[:2 if axes.name == "rectilinear" else 3]:
            axis = getattr(axes, f"{name}axis")
            low, high = sorted(axis.get_view_interval())
            boxes = [tick.label1.get_window_extent(renderer) for tick in axis.get_major_ticks()
                     if low <= tick.get_loc() <= high]
            assert len(boxes) >= 2
            assert not any(one.overlaps(other) for one, other in pairwise(boxes)), name


@pytest.mark.parametrize("name, message", [
    ("beam.txt", "beam.txt must end in .png, .pdf, .svg"),
    ("nowhere/beam.png", "folder .*nowhere of the picture does not exist: make it")])
def test_files_that_cannot_be_written(tmp_path, name, message):
    with pytest.raises(InputError, match=message):
        plot.check_picture(tmp_path / name)


def test_matplotlib_is_missing(tmp_path, monkeypatch):
    monkeypatch.setattr(plot, "find_spec", lambda name: None)
    with pytest.raises(InputError, match=r'need matplotlib: pip install "sebody\[plot\]"'):
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
