"""`sebody chart`: references, variants, front, and what is written."""

import csv
from dataclasses import replace

import numpy as np
import pytest
from matplotlib.figure import Figure

from sebody.cli.entry import main
from sebody.studies import chart
from sebody.studies.bench import peer
from sebody.studies.chart import cases
from sebody.studies.chart import references as reference_module
from sebody.studies.chart.references import Reference, reference

POINT = chart.Point("modes", "a", 1e-3, 1e-4, 15, 0.01, 2.0)


def test_front_is_what_nothing_beats():
    cheap, good = replace(POINT, cost=1e-5, error=1e-2), replace(POINT, cost=1e-3, error=1e-5)
    beaten = replace(POINT, cost=2e-4, error=2e-3)
    assert chart.front([good, beaten, POINT, cheap]) == [cheap, POINT, good]


def test_report_compares_at_the_same_error():
    rival = replace(POINT, family=peer.NAME, label="beams", cost=7e-4, error=9e-4)
    text = chart.report("hinged-beam", [POINT, rival], Reference(np.zeros(1), 1e-6))
    assert "at an error of 1e-02 Exudyn's best takes 7.0 times as long" in text
    assert "3e-04" not in text      # no point of ours is that good
    alone = chart.report("spin-up", [POINT], Reference(np.zeros(1), 1e-6))
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


@pytest.mark.parametrize("label", ["1 beam", "1 body with a name that is as long as a line"])
def test_names_begin_right_of_the_axis(tmp_path, monkeypatch, label):
    figures, save = [], Figure.savefig

    def keep(figure, *arguments, **options):
        figures.append(figure)
        save(figure, *arguments, **options)
    monkeypatch.setattr(Figure, "savefig", keep)
    points = [replace(POINT, label=label, cost=10.0**-k, error=10.0**(k - 6)) for k in (2, 3, 4)]
    chart.draw("hinged-beam", points, points[::-1], 1e-5, tmp_path / "chart.png")
    figures[0].draw_without_rendering()         # at its own resolution, not that of the file
    axes, = figures[0].axes
    names = [text for text in axes.texts if text.get_text() == label]
    assert len(names) == 3
    for name in names:
        assert name.get_window_extent().x0 > axes.get_window_extent().x0


def test_chart_writes_table_and_picture(tmp_path, monkeypatch, capsys):
    """A few variants: errors never below that of the reference, costs of the same runs."""
    monkeypatch.setenv("SEBODY_KERNELS", str(tmp_path / "kernels"))
    monkeypatch.setattr(peer, "available", lambda: False)
    few = [v for v in cases.variants("planar-hinged-beam")
           if v.label in ("1 body, 2 modes", "1 body, 2 modes, B", "2 nonlinear beams, h",
                          "mean frame, A", "1 nonlinear beam, 4 h")]
    monkeypatch.setattr(chart, "variants", lambda scene: few)
    table, picture = tmp_path / "chart.csv", tmp_path / "chart.png"
    assert main(["chart", "planar-hinged-beam", "--csv", str(table), "--output",
                 str(picture)]) == 0
    assert "front" in capsys.readouterr().out and picture.stat().st_size > 10_000
    with table.open() as file:
        rows = list(csv.DictReader(file))
    assert [row["label"] for row in rows] == [v.label for v in few]
    errors = {row["label"]: float(row["error"]) for row in rows}
    assert errors["1 body, 2 modes, B"] == pytest.approx(9.0e-4, rel=0.1)
    assert errors["1 body, 2 modes"] < 3e-4
    assert all(float(row["cost"]) > 0 for row in rows)
    assert errors["2 nonlinear beams, h"] < errors["1 nonlinear beam, 4 h"]


def test_unknown_scene_and_folder(tmp_path, capsys):
    assert main(["chart", "shaft"]) == 2
    assert "there is no chart of scene 'shaft': use hinged-beam" in capsys.readouterr().err
    assert main(["chart", "hinged-beam", "--csv", str(tmp_path / "no" / "a.csv")]) == 2
    assert "of the table does not exist: make it" in capsys.readouterr().err
