"""`sebody chart`: references, variants, front, and what is written."""

import csv
from dataclasses import replace

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.text import Text

from sebody import InputError, Model
from sebody.cli.entry import main
from sebody.scenes import four_bar
from sebody.scenes.scene import Scene
from sebody.verify import chart
from sebody.verify.bench import peer
from sebody.verify.chart import cases, references as reference_module
from sebody.verify.chart.references import reference
from sebody.verify.chart.timing import repeated

LINKS = '''
"""Two links, turned in the plane."""
from sebody import Model
from sebody.fem import rectangle
from sebody.scenes.scene import Scene

def build():
    model = Model(planar=True)
    model.gravity((3.0, -9.0))
    tip, base = model.node("tip", (1.1, -0.9)), model.node("base", (0.2, 0.1))
    elbow = model.node("elbow", (0.7, -0.2))
    wrist = model.node("wrist", (0.7, -0.2), at=elbow)
    steel = 2.1e11, 0.3, 7800.0
    model.beam("slender", (wrist, tip), rectangle(0.003, 0.02, *steel), 8, 1, 2)
    model.beam("stout", (base, elbow), rectangle(0.04, 0.02, *steel), 8, 1, 2)
    model.fix(base, "position")
    return Scene("links", "two links", model, 0.002, 0.4)
'''
POINT = chart.Point("modes", "a", 1e-3, 1e-4, 15, 0.01, 2.0)


def test_front_is_what_nothing_beats():
    cheap, good = replace(POINT, cost=1e-5, error=1e-2), replace(POINT, cost=1e-3, error=1e-5)
    beaten = replace(POINT, cost=2e-4, error=2e-3)
    assert chart.front([good, beaten, POINT, cheap]) == [cheap, POINT, good]


def test_report_compares_at_the_same_error():
    rival = replace(POINT, family=peer.NAME, label="beams", cost=7e-4, error=9e-4)
    text = chart.report("hinged-beam", [POINT, rival], 1e-6)
    assert "at an error of 1e-02 Exudyn's best takes 7.0 times as long" in text
    assert "3e-04" not in text      # no point of ours is that good
    alone = chart.report("spin-up", [POINT], 1e-6)
    assert "Exudyn" not in alone


@pytest.mark.parametrize("scene", cases.SCENES)
def test_every_scene_has_all_kinds_of_points(scene):
    found = cases.variants(scene)
    assert {"frames and inertia", "modes", "modes, B", "bodies", "steps", "nonlinear beams",
            "schemes"} == {v.family for v in found}
    assert len({(v.label, v.finer) for v in found}) == len(found) > 40


def test_reference_is_kept_and_knows_its_error(tmp_path, monkeypatch):
    """Fewer elements and steps here: the estimate covers the distance from a better one."""
    monkeypatch.setattr(reference_module, "ELEMENTS", 6)
    monkeypatch.setattr(reference_module, "FINER", 2)
    first = reference("planar-hinged-beam", tmp_path)
    file, = tmp_path.iterdir()
    calls = []
    monkeypatch.setattr(reference_module, "history", lambda *a: calls.append(a))
    again = reference("planar-hinged-beam", tmp_path)
    assert not calls and np.array_equal(first.values, again.values)
    monkeypatch.undo()
    better = reference("planar-hinged-beam", tmp_path)
    assert len(list(tmp_path.iterdir())) == 2 and file.exists()
    distance = np.linalg.norm(first.values - better.values) / np.linalg.norm(better.values)
    assert distance < first.error < 20 * distance
    assert better.error < first.error / 5


def test_a_reference_is_computed_where_none_can_be_kept(tmp_path, monkeypatch):
    """A damaged file counts as absent; without a folder that can be written a run goes on."""
    monkeypatch.setattr(reference_module, "history", lambda *a: np.ones((4, 2)))
    reference("planar-hinged-beam", tmp_path)
    file, = tmp_path.iterdir()
    for content in (b"", b"garbage", file.read_bytes()[:100]):
        file.write_bytes(content)
        assert np.array_equal(reference("planar-hinged-beam", tmp_path).values, np.ones((4, 2)))
        with np.load(file) as written:
            assert written["error"] == 0.0
    with pytest.warns(RuntimeWarning, match="the reference is computed again next time: "):
        found = reference("planar-hinged-beam", file / "no folder")
    assert np.array_equal(found.values, np.ones((4, 2)))


@pytest.fixture
def figures(monkeypatch):
    """Figures that are written, at their own resolution."""
    found, save = [], Figure.savefig

    def keep(figure, *arguments, **options):
        found.append(figure)
        save(figure, *arguments, **options)
        figure.draw_without_rendering()
    monkeypatch.setattr(Figure, "savefig", keep)
    return found


@pytest.mark.parametrize("label", ["1 beam", "1 body with a name that is as long as a line"])
def test_names_begin_right_of_the_axis(tmp_path, figures, label):
    points = [replace(POINT, label=label, cost=10.0**-k, error=10.0**(k - 6)) for k in (2, 3, 4)]
    chart.draw("hinged-beam", points, points[::-1], 1e-5, tmp_path / "chart.png")
    axes, = figures[0].axes
    names = [text for text in axes.texts if text.get_text() == label]
    assert len(names) == 3
    for name in names:
        assert name.get_window_extent().x0 > axes.get_window_extent().x0


LONG = "a body of which somebody has said a great deal more than fits beside a point " * 4
PLACES = {  # costs and errors of the points
    "one": [(1e-3, 1e-4)],
    "all the same": [(1e-3, 1e-4)] * 5,
    "far apart": [(1e-12, 1e8), (1e-3, 1e-3), (1e6, 1e-16)],
    "a column": [(1e-3, 10.0**-k) for k in range(8)],
    "a row": [(10.0**-k, 1e-2) for k in range(8)],
    "a front": [(1e-4 * 1.3**k, 1e-1 * 1.4**-k) for k in range(30)],
    "nothing that runs": [(1e-3, np.inf), (1e-3, np.nan), (0.0, 1e-2)],
}


@pytest.mark.parametrize("places, label", [
    ("one", LONG), ("all the same", LONG), ("far apart", "W" * 300), ("a column", LONG),
    ("a row", "1 body, 4 modes, h/4"), ("a front", LONG), ("nothing that runs", "b")])
def test_no_text_leaves_the_picture(tmp_path, figures, places, label):
    points = [replace(POINT, label=label, family=f"{label} {k}" if label == LONG else "modes",
                      cost=cost, error=error, slowest=3.0 * cost)
              for k, (cost, error) in enumerate(PLACES[places])]
    chart.draw(label, points, chart.front(points), 1e-6, tmp_path / "chart.png", points[-1], 1e-2)
    figure, = figures
    (axes,), whole = figure.axes, figure.bbox
    texts = [text for text in figure.findobj(Text) if text.get_text() and text.get_visible()]
    ticks = [text for axis in (axes.xaxis, axes.yaxis) for text in axis.get_majorticklabels()
             + axis.get_minorticklabels()]      # also those beyond the axis, which are not drawn
    drawn = [*(text for text in texts if text not in ticks), axes.xaxis, axes.yaxis]
    assert {"relative error", "tolerance 0.01"} <= {text.get_text() for text in texts}
    for one in drawn:
        box = one.get_tightbbox() if one in drawn[-2:] else one.get_window_extent()
        assert box.x0 >= whole.x0 and box.x1 <= whole.x1, one
        assert box.y0 >= whole.y0 and box.y1 <= whole.y1, one
    frame = axes.get_window_extent()
    names = [text for text in axes.texts if text.get_fontsize() == 8]
    assert bool(names) == (places != "nothing that runs")
    for name in names:
        box = name.get_window_extent()
        assert box.x0 > frame.x0 and box.x1 < frame.x1 and box.y0 > frame.y0 and box.y1 < frame.y1


def test_names_do_not_cover_one_another(tmp_path, figures):
    points = [replace(POINT, label=f"point {k}", cost=1e-4 * 1.2**k, error=1e-2 * 1.5**-k)
              for k in range(6)]
    chart.draw("four-bar", points, points, 0.0, tmp_path / "chart.png")
    boxes = [text.get_window_extent() for text in figures[0].axes[0].texts]
    assert len(boxes) == 6
    assert not any(one.overlaps(other) for k, one in enumerate(boxes) for other in boxes[:k])


def test_the_quickest_of_several_runs_counts():
    """A busy while falls on one run of each; what agrees is not run again."""
    turns, calls = {"quiet": [1.0, 1.01, 9.0], "busy": [5.0, 2.0, 3.0, 1.2, 1.25]}, []

    def run(name):
        calls.append(name)
        return turns[name].pop(0)
    quiet, busy = repeated([lambda: run("quiet"), lambda: run("busy")])
    assert (quiet, busy) == ((1.0, 9.0), (1.2, 5.0))
    assert calls[:6] == ["quiet", "busy"] * 3 and calls[6:] == ["busy"] * 2
    assert repeated([lambda: 30.0]) == [(30.0, 30.0)]       # long runs are not repeated


def test_chart_writes_table_and_picture(tmp_path, monkeypatch, capsys):
    """A few variants: errors never below that of the reference, costs of the same runs."""
    monkeypatch.setenv("SEBODY_KERNELS", str(tmp_path / "kernels"))
    monkeypatch.setattr(peer, "available", lambda: False)
    few = [v for v in cases.variants("planar-hinged-beam")
           if v.label in ("1 body, 2 modes", "1 body, 2 modes, option b",
                          "2 nonlinear beams, step x 1", "mean frame, option a",
                          "1 nonlinear beam, step x 4")]
    monkeypatch.setattr(chart, "variants", lambda scene: few)
    table, picture = tmp_path / "chart.csv", tmp_path / "chart.png"
    assert main(["chart", "planar-hinged-beam", "--csv", str(table), "--output",
                 str(picture)]) == 0
    assert "front" in capsys.readouterr().out and picture.stat().st_size > 10_000
    with table.open() as file:
        rows = list(csv.DictReader(file))
    assert [row["label"] for row in rows[1:]] == [v.label for v in few]
    assert rows[0]["family"] == "advised" and float(rows[0]["error"]) <= 1e-2
    assert {row["quantity"] for row in rows} == {"tip.position"}
    errors = {row["label"]: float(row["error"]) for row in rows}
    assert errors["1 body, 2 modes, option b"] == pytest.approx(9.0e-4, rel=0.1)
    assert errors["1 body, 2 modes"] < 3e-4
    assert all(float(row["cost"]) > 0 for row in rows)
    assert errors["2 nonlinear beams, step x 1"] < errors["1 nonlinear beam, step x 4"]


def test_an_advised_model_in_the_plane_is_compared_in_space(monkeypatch):
    monkeypatch.setattr(peer, "available", lambda: False)
    monkeypatch.setattr(chart, "variants", lambda scene: [])
    study = chart.measure("hinged-beam")
    assert "planar" in study.choice.label and study.choice.error < 1e-2


def test_any_scene_has_a_chart(tmp_path, capsys):
    """Of two links in a file: as rich as they can be is the reference, the tip is compared."""
    file, table = tmp_path / "links.py", tmp_path / "links.csv"
    file.write_text(LINKS)
    picture = tmp_path / "links.png"
    assert main(["chart", str(file), "--csv", str(table), "--output", str(picture)]) == 0
    out = capsys.readouterr().out
    assert out.startswith("links, tip.position: reference good to ")
    assert picture.stat().st_size > 10_000
    with table.open() as written:
        points = {row["label"]: row for row in csv.DictReader(written)}
    assert {"advised", "modes", "bodies", "inertia", "rigid", "steps", "schemes"} == {
        point["family"] for point in points.values()}
    errors = {label: float(point["error"]) for label, point in points.items()}
    limit = float(out.split("good to ")[1].split(",")[0])
    assert 0.0 < limit < 1e-4 and min(errors.values()) >= 0.99 * limit     # printed with 2 digits
    assert errors["all rigid"] > 10 * errors["reference, step / 4"]
    # the other link alone: the stiff one may be rigid
    assert errors["stout rigid"] < 0.1 * errors["slender rigid"]
    assert all(float(point["slowest"]) >= float(point["cost"]) > 0 for point in points.values())


def test_a_mechanism_has_a_chart_of_steps_and_schemes():
    """Rigid bodies: errors fall with the square of the step; the reference knows its own error."""
    studies = chart.measure_any(replace(four_bar.build(1), t_end=0.4),
                                ["B1.velocity", "B0.position rms"])
    study, other = studies
    errors = {point.label: point.error for point in study.points}
    assert study.quantity == "B1.velocity" and set(p.family for p in study.points) == {
        "advised", "steps", "schemes"}
    assert errors["step x 4"] / errors["step x 2"] == pytest.approx(4.0, rel=0.1)
    assert errors["step / 2"] / errors["step / 4"] == pytest.approx(4.0, rel=0.1)
    assert study.error < 0.01 * errors["step / 4"]
    # the other quantity is of the same runs
    assert other.quantity == "B0.position rms"
    assert [(p.label, p.cost) for p in other.points] == [(p.label, p.cost) for p in study.points]
    assert [p.error for p in other.points] != [p.error for p in study.points]
    # the advised model keeps both
    assert study.choice.family == "advised" and study.choice.cost == other.choice.cost
    assert max(study.choice.error, other.choice.error) <= study.tolerance == 1e-2


def test_several_quantities_are_panels_with_what_errors_and_bars_mean(tmp_path, figures):
    ring = replace(POINT, family="advised", label="advised: rigid; step 0.1", cost=2e-4, error=5e-3)
    studies = [chart.Study([POINT, ring, replace(POINT, label="b", cost=3e-4, slowest=9e-4,
                                                 error=error)], name, 1e-6, ring, 1e-2,
                           ("error: of the largest", "time: bars end at slowest", "peers: none"))
               for name, error in (("tip.position", 1e-4), ("tip.velocity rms", 2e-4))]
    chart.draw_panels("links", chart.panels(studies), tmp_path / "chart.png", studies[0].notes)
    figure, = figures
    left, right = figure.axes
    assert [axes.get_title("left").splitlines()[0] for axes in (left, right)] == [
        study.quantity for study in studies]
    assert left.get_title("left").splitlines()[1:] == list(studies[0].notes)
    for axes in (left, right):
        rings = [line for line in axes.lines if line.get_markersize() == 13]
        assert [(line.get_xdata()[0], line.get_ydata()[0]) for line in rings] == [(2e-4, 5e-3)]
        assert "advised: rigid; step 0.1" in [text.get_text() for text in axes.texts]


def test_what_has_no_chart_is_refused():
    scene = four_bar.build(1)
    with pytest.raises(InputError, match="quantity 'ground 0.position' does not change: give one"):
        chart.measure_any(replace(scene, t_end=0.1), ["ground 0.position"])
    with pytest.raises(InputError, match="'C.position' is unknown: did you mean"):
        chart.measure_any(replace(scene, t_end=0.1), ["C.position"])
    still = Model(planar=True)
    still.point_mass("mass", still.node("a", (1.0, 2.0), "translation"), 1.0)
    with pytest.raises(InputError, match="nothing moves: give the scene a load, a drive or"):
        chart.measure_any(Scene("still", "", still, 0.1, 1.0))


def test_unknown_scene_and_folder(tmp_path, capsys):
    assert main(["chart", "moon"]) == 2
    assert "scene 'moon' is unknown: there are" in capsys.readouterr().err
    assert main(["chart", "hinged-beam", "--csv", str(tmp_path / "no" / "a.csv")]) == 2
    assert "of the table does not exist: make it" in capsys.readouterr().err
